#include "dem_cases/shear_cell/liggghts_deck.h"

#include <fmt/format.h>

#include <string_view>

#include "dem_cases/shear_cell/measure.h"
#include "dem_cases/shear_cell/schedule.h"

namespace talus::dem {
namespace {

std::string repeated(double value, int count) {
  std::string text;
  for (int i = 0; i < count; ++i) text += fmt::format(" {}", value);
  return text;
}

/// Everything up to the first run that does not depend on the test. `types` materials, all alike.
std::string deck_head(const ShearCell& cell, const ShearMaterial& material, const std::string& title,
                      const std::string& boundary, int types) {
  const Grains& grains = cell.grains;
  const auto per_type = [&](double value) { return repeated(value, types); };
  const auto per_pair = [&](double value) {
    return fmt::format(" {}{}", types, repeated(value, types * types));
  };
  // limitForce: grains without cohesion never pull.
  return fmt::format(
             "# {}; written by talus\n"
             "atom_style granular\n"
             "atom_modify map array\n"
             "boundary {}\n"
             "newton off\n"
             "communicate single vel yes\n"
             "units si\n"
             "read_data packing.data\n"
             "neighbor {:.17g} bin\n"
             "neigh_modify delay 0\n",
             title, boundary, 0.3 * grains.diameter) +
         fmt::format("fix modulus all property/global youngsModulus peratomtype{}\n",
                     per_type(grains.youngs_modulus)) +
         fmt::format("fix poisson all property/global poissonsRatio peratomtype{}\n",
                     per_type(grains.poissons_ratio)) +
         fmt::format("fix restitution all property/global coefficientRestitution peratomtypepair{}\n",
                     per_pair(cell.restitution)) +
         fmt::format("fix friction all property/global coefficientFriction peratomtypepair{}\n",
                     per_pair(cell.friction)) +
         fmt::format("fix rolling all property/global coefficientRollingFriction peratomtypepair{}\n",
                     per_pair(material.rolling_friction)) +
         fmt::format(
             "pair_style gran model hertz tangential history rolling_friction epsd2 limitForce on\n"
             "pair_coeff * *\n"
             "timestep {:.17g}\n"
             "thermo_modify lost error norm no\n",
             cell.protocol.time_step);
}

std::string sample_line(const ShearCell& cell, std::string_view columns, std::string_view variables) {
  return fmt::format("fix sample all print {} \"{}\" file {} screen no title \"{}\"\n",
                     cell.protocol.steps_per_sample, variables, samples_file, columns);
}

}  // namespace

std::string liggghts_packing(const ShearCell& cell, const ShearStart& start) {
  const bool walls = start.wall_count > 0;
  // Between walls the box is open along z: room for the upper wall to rise.
  const double margin = walls ? 4.0 * cell.grains.diameter : 0.0;
  std::string text = fmt::format(
      "start of case {} for seed {}, made by talus\n\n{} atoms\n{} atom types\n"
      "0 {:.17g} xlo xhi\n0 {:.17g} ylo yhi\n{:.17g} {:.17g} zlo zhi\n\nAtoms\n\n",
      cell.name, start.seed, start.count(), walls ? 3 : 1, start.size.x(), start.size.y(), 0.0 - margin,
      start.size.z() + margin);
  const auto type = [&](Eigen::Index i) {
    return i >= 2 * start.wall_count ? 1 : i < start.wall_count ? 2 : 3;
  };
  for (Eigen::Index i = 0; i < start.count(); ++i) {  // id type diameter density x y z
    const auto& p = start.positions;
    text += fmt::format("{} {} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g}\n", i + 1, type(i),
                        2.0 * start.radii[i], cell.grains.density, p(0, i), p(1, i), p(2, i));
  }
  text += "\nVelocities\n\n";
  for (Eigen::Index i = 0; i < start.count(); ++i) {  // id, velocity, angular velocity
    const auto& v = start.velocities;
    text += fmt::format("{} {:.17g} {:.17g} {:.17g} 0 0 0\n", i + 1, v(0, i), v(1, i), v(2, i));
  }
  return text;
}

std::string simple_shear_deck(const ShearCell& cell, const ShearMaterial& material,
                              const SimpleShearPoint& point, const ShearStart& start) {
  const double area = start.size.x() * start.size.y();
  const double load = cell.simple_shear.normal_stress * area / static_cast<double>(start.wall_count);
  std::string text = deck_head(cell, material, "simple shear between rough walls", "p p f", 3);
  text +=
      "group free type 1\n"
      "group lower type 2\n"
      "group upper type 3\n"
      "neigh_modify exclude group lower lower\n"
      "neigh_modify exclude group upper upper\n"
      "fix integrate free nve/sphere\n"
      "fix hold lower setforce 0 0 0\n";
  // The upper wall is a rigid piston: its spheres, all of one mass, share the mean of the contact forces, the load
  // and a drag that limits its speed while nothing resists. `contact` changes nothing; it records the sum of the
  // contact forces before the others change them.
  text += fmt::format(
      "fix contact upper setforce NULL NULL NULL\n"
      "fix drag upper viscous {:.17g}\n"
      "fix slide upper setforce 0 0 NULL\n"
      "fix load upper aveforce NULL NULL {:.17g}\n"
      "fix integrate_upper upper nve\n",
      load / cell.protocol.closing_speed, -load);
  text += fmt::format(
      "thermo_style custom step atoms ke\n"
      "thermo 10000\n"
      "run {}\n"
      "reset_timestep 0\n",
      steps_for(cell.protocol, cell.protocol.compression_time));
  // Solid fraction and shear rate of the middle half, away from the walls: the rate is the slope of the least-squares
  // line of vx over z. A sphere counts where its centre is.
  text += fmt::format(
      "compute height upper reduce ave z\n"
      "variable height equal c_height\n"
      "variable normal_stress equal f_contact[3]/{0:.17g}\n"
      "variable shear_stress equal -f_contact[1]/{0:.17g}\n"
      "variable one atom \"(type == 1)*(z > 0.25*v_height)*(z < 0.75*v_height)\"\n"
      "variable z atom v_one*(z-0.5*v_height)\n"
      "variable zz atom v_z*(z-0.5*v_height)\n"
      "variable v atom v_one*vx\n"
      "variable zv atom v_z*vx\n"
      "variable m atom v_one*mass\n"
      "compute sum all reduce sum v_one v_z v_zz v_v v_zv v_m\n"
      "variable shear_rate equal "
      "(c_sum[5]*c_sum[1]-c_sum[2]*c_sum[4])/(c_sum[3]*c_sum[1]-c_sum[2]*c_sum[2])\n"
      "variable volume_fraction equal c_sum[6]/{1:.17g}/(0.5*v_height*{0:.17g})\n"
      "variable step equal step\n"
      "variable energy equal ke\n"
      "variable grains equal atoms\n",
      area, cell.grains.density);
  text += sample_line(cell, simple_shear_columns,
                      "${step} ${normal_stress} ${shear_stress} ${volume_fraction} ${shear_rate} ${energy} "
                      "${grains}");
  // The flow starts with the linear profile that it would take long to reach from rest.
  text += fmt::format(
      "thermo_style custom step ke c_height\n"  // what it holds is current after the run
      "run 0\n"
      "variable speed equal {:.17g}*${{height}}\n"
      "variable speed equal ${{speed}}\n"
      "velocity upper set ${{speed}} 0 NULL units box\n"
      "velocity free ramp vx 0 ${{speed}} z 0 ${{height}} sum yes units box\n"
      "run {}\n",
      wall_shear_rate(cell, point), step_count(cell, point));
  return text;
}

std::string biaxial_deck(const ShearCell& cell, const ShearMaterial& material, const BiaxialPoint& point,
                         const ShearStart& start) {
  const Biaxial& biaxial = cell.biaxial;
  std::string text = deck_head(cell, material, "plane-strain biaxial compression", "p p p", 1);
  // What the thermo output holds is current between the runs of the loop, where the servo reads it.
  text += fmt::format(
      "fix integrate all nve/sphere\n"
      "compute temperature all temp\n"
      "compute stress all pressure temperature virial\n"
      "thermo_style custom step ke c_stress[1] c_stress[2] c_stress[3]\n"
      "thermo 100000\n"
      "variable wanted equal {:.17g}\n"
      "variable gain equal {:.17g}\n"
      "variable closing equal {:.17g}\n",
      biaxial.lateral_stress, biaxial.servo_gain, biaxial.closing_rate);
  for (const auto& [axis, component] : {std::pair{'x', 1}, std::pair{'y', 2}, std::pair{'z', 3}}) {
    text += fmt::format("variable s{0}{0} equal c_stress[{1}]\n", axis, component);
    text += fmt::format(
        "variable rate_{0} equal \"v_gain*(v_s{0}{0}/v_wanted-1)-v_closing*(v_s{0}{0} < "
        "{1}*v_wanted)\"\n",
        axis, resisting_share);
  }
  // The commands in quotes run after every so many steps: a new rate for each axis.
  text += fmt::format(
      "run 0\n"
      "run {} post no every {} \"fix deform all deform 1 x erate ${{rate_x}} y erate ${{rate_y}} z erate "
      "${{rate_z}} remap x\"\n"
      "unfix deform\n"
      "reset_timestep 0\n",
      steps_for(cell.protocol, cell.protocol.compression_time), cell.protocol.steps_per_sample);
  text += fmt::format(
      "variable length equal lz\n"
      "variable start_length equal ${{length}}\n"
      "variable axial_rate equal {:.17g}\n"
      "variable lateral_rate equal v_axial_rate+v_gain*(v_sxx/v_wanted-1)\n"
      "variable volume_fraction equal {:.17g}/(lx*ly*lz)\n"
      "variable axial_strain equal ln(v_start_length/lz)\n"
      "variable step equal step\n"
      "variable energy equal ke\n"
      "variable grains equal atoms\n",
      axial_rate(cell, point), start.free_volume());
  text += sample_line(cell, biaxial_columns,
                      "${step} ${sxx} ${syy} ${szz} ${volume_fraction} ${axial_strain} ${energy} ${grains}");
  const std::string deform = "fix deform all deform 1 x erate ${lateral_rate} z erate -${axial_rate} remap v";
  text += fmt::format("run 0\n{0}\nrun {1} post no every {2} \"{0}\"\n", deform, step_count(cell, point),
                      cell.protocol.steps_per_sample);
  return text;
}

}  // namespace talus::dem
