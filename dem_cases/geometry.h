// The shapes that cases are made of, as the user gives them; no code-specific word. All lengths in metres, z upwards.
#pragma once

#include <variant>

namespace talus::dem {

/// Quasi-2-D column behind a gate, in a tank that is periodic across its thickness (y). x runs from the back
/// wall, z up from the floor.
struct ColumnGeometry {
  double column_length;  // L0
  double column_height;  // H0 = a L0, nominal: what the settled column is prepared to
  double thickness;      // W
  double tank_length;    // where the far wall stands
  bool rough_floor;      // a layer of fixed grains; otherwise a flat frictional floor
};

/// A cylinder of grains about the z axis, on a rough floor, in a tube that is taken away at once.
struct CylinderGeometry {
  double radius;      // R0
  double height;      // H0, nominal
  double floor_side;  // the floor is a square about the axis
};

/// The same, in a tube that is lifted slowly: the grains flow out under its rim into a heap.
struct HeapGeometry {
  double radius;      // of the tube
  double height;      // nominal
  double floor_side;  // as above
  double lift_speed;  // m/s
};

/// Quasi-2-D silo, periodic across its thickness (y), with smooth side walls at x = 0 and x = width, a rough flat bottom at
/// z = 0, and a slot of width `opening` in its middle between the surfaces of the bottom's edge grains. What comes
/// out falls onto a flat floor at z = -drop.
struct SlotGeometry {
  double width;
  double height;  // nominal, of the fill
  double thickness;
  double opening;  // D
  double drop;
};

/// Two bulbs about the z axis, each a cone that widens from the throat at z = 0 and a tube after it. The fill stands in the
/// upper one, which is open at its top.
struct HourglassGeometry {
  double throat_radius;  // D / 2
  double bulb_radius;    // of the tubes
  double cone_height;
  double height;       // nominal, of the fill above the throat
  double bulb_height;  // of the lower bulb, from its flat floor to the throat
};

/// Quasi-2-D bed on a rough ledge from x = 0 (a smooth wall) to x = length, periodic across its thickness (y). When the gate at
/// x = length goes, what lies above the angle of repose falls over the edge, onto a flat floor at z = -drop.
struct LedgeGeometry {
  double length;
  double height;  // nominal, of the fill
  double thickness;
  double drop;
  double tank_length;  // where the far wall stands
};

/// A settled bed in a square box about the z axis, with smooth walls and a rough floor at z = 0, and a sphere that falls on its middle.
struct ImpactGeometry {
  double side;
  double height;  // nominal, of the bed
  double sphere_diameter;
  double sphere_density;  // kg/m^3
  double impact_speed;    // m/s, with which its lowest point passes the nominal height
};

using Geometry = std::variant<ColumnGeometry, CylinderGeometry, HeapGeometry, SlotGeometry, HourglassGeometry,
                              LedgeGeometry, ImpactGeometry>;

/// Nominal height of the fill, m.
double fill_height(const Geometry& geometry);

/// Bulk volume that the fill is to have at its nominal height, m^3.
double fill_volume(const Geometry& geometry);

/// Area of a rough floor of fixed grains, m^2; 0 without one.
double floor_area(const Geometry& geometry);

/// Thickness of a quasi-2-D geometry, m; 0 for one in 3-D.
double periodic_thickness(const Geometry& geometry);

}  // namespace talus::dem
