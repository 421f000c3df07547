#include "continuum/io/state_archive.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "continuum/files/provenance.h"
#include "continuum/io/archive.h"
#include "continuum/solids/body_step.h"
#include "continuum/stress/friction_fields.h"

namespace talus {
namespace {

// Each description is of a value and of a const one alike: the archive says which way things go.

template <class Archive, class Of>
void describe_particles(Archive& archive, Of& particles) {
  archive.list("positions", particles.positions);
  archive.list("velocities", particles.velocities);
  archive.list("masses", particles.masses);
  archive.list("materials", particles.materials);
  archive.list("shapes", particles.shapes);
  archive.list("gradients", particles.gradients);
}

template <class Archive, class Of>
void describe_render_points(Archive& archive, Of& points) {
  archive.number("per_volume", points.per_volume);
  archive.number("seed", points.seed);
  archive.list("offsets", points.offsets);
  archive.list("identities", points.identities);
  archive.list("first", points.first);
  archive.list("hidden", points.hidden);
  archive.number("next_identity", points.next_identity);
  archive.number("hand_overs", points.hand_overs);
}

/// Position, orientation, velocity, angular velocity, and the mass, by which another body is known.
using BodyRows = Eigen::Matrix<double, 14, Eigen::Dynamic>;

BodyRows rows_of(std::span<const Body> bodies) {
  BodyRows rows(14, std::ssize(bodies));
  for (Eigen::Index b = 0; b < rows.cols(); ++b) {
    const Body& body = bodies[static_cast<std::size_t>(b)];
    rows.col(b) << body.pose.position, body.pose.orientation.coeffs(), body.twist.velocity,
        body.twist.angular_velocity, body.mass;
  }
  return rows;
}

using TwistRows = Eigen::Matrix<double, 6, Eigen::Dynamic>;

TwistRows rows_of(std::span<const Twist> twists) {
  TwistRows rows(6, std::ssize(twists));
  for (Eigen::Index b = 0; b < rows.cols(); ++b) {
    const Twist& twist = twists[static_cast<std::size_t>(b)];
    rows.col(b) << twist.velocity, twist.angular_velocity;
  }
  return rows;
}

/// Where the values of a stress lie: of each wall face its cell, its axis and the side that the sand is on; of an edge its dense
/// index and its number.
struct Places {
  std::vector<int> cells;  // dense
  int open_faces = 0;
  std::vector<int> wall_cells, wall_axes, wall_sides;
  std::vector<int> contact_cells;
  std::array<std::vector<int>, 3> edges, edge_numbers;
};

template <class Archive, class Of>
void describe_places(Archive& archive, Of& places) {
  archive.list("cells", places.cells);
  archive.number("open_faces", places.open_faces);
  archive.list("wall_cells", places.wall_cells);
  archive.list("wall_axes", places.wall_axes);
  archive.list("wall_sides", places.wall_sides);
  archive.list("contact_cells", places.contact_cells);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    archive.list(fmt::format("edges_{}", axis), places.edges[axis]);
    archive.list(fmt::format("edge_numbers_{}", axis), places.edge_numbers[axis]);
  }
}

std::size_t edge_total(const Grid& grid, int axis) {
  return static_cast<std::size_t>(grid.extent(Grid::nodal_of_edge(axis)).cast<std::int64_t>().prod());
}
std::size_t face_total(const Grid& grid, int axis) {
  return static_cast<std::size_t>(grid.extent(Grid::nodal_of_face(axis)).cast<std::int64_t>().prod());
}

/// The edges of the region's cells that have a number.
void find_edges(const ActiveRegion& region, Places& places) {
  const Grid& grid = region.grid;
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    for (const int dense_cell : region.dense_of_cell) {
      for (int corner = 0; corner < 4; ++corner) {
        Eigen::Vector3i at = grid.cell_of_index(dense_cell);
        at[next_axis(axis)] += corner % 2;
        at[last_axis(axis)] += corner / 2;
        places.edges[a].push_back(grid.edge_index(axis, at));
      }
    }
    std::sort(places.edges[a].begin(), places.edges[a].end());
    places.edges[a].erase(std::unique(places.edges[a].begin(), places.edges[a].end()), places.edges[a].end());
    std::erase_if(places.edges[a],
                  [&](int dense) { return region.edge_of_dense[a][static_cast<std::size_t>(dense)] < 0; });
    for (const int dense : places.edges[a])
      places.edge_numbers[a].push_back(region.edge_of_dense[a][static_cast<std::size_t>(dense)]);
  }
}

/// Edges have values of their own in the source's scheme alone.
Places places_of(const ActiveRegion& region, bool edges) {
  Places places{region.dense_of_cell, region.open_faces, {}, {}, {}, {}, {}, {}};
  for (const WallFace& wall : region.wall_faces) {
    places.wall_cells.push_back(wall.cell);
    places.wall_axes.push_back(wall.axis);
    places.wall_sides.push_back(wall.inward < 0.0 ? -1 : 1);
  }
  for (const Contact& contact : region.contacts) places.contact_cells.push_back(contact.cell);
  if (edges) find_edges(region, places);
  return places;
}

bool all_in(std::span<const int> values, std::int64_t low, std::int64_t end) {
  return std::all_of(values.begin(), values.end(), [&](int v) { return v >= low && v < end; });
}

void check_places(const ArchiveReader& archive, const Grid& grid, const Places& places) {
  const auto cells = std::ssize(places.cells);
  const auto require = [&](bool holds, std::string_view name) {
    if (!holds) archive.fail(name, "is not that of a region of the scene's grid");
  };
  require(all_in(places.cells, 0, grid.cells.cast<std::int64_t>().prod()) &&
              std::adjacent_find(places.cells.begin(), places.cells.end(), std::greater_equal<>()) ==
                  places.cells.end(),
          "cells");
  require(places.open_faces >= 0 && places.open_faces <= 6 * cells, "open_faces");
  require(all_in(places.wall_cells, 0, cells), "wall_cells");
  require(places.wall_axes.size() == places.wall_cells.size() && all_in(places.wall_axes, 0, 3), "wall_axes");
  require(places.wall_sides.size() == places.wall_cells.size() && all_in(places.wall_sides, -1, 2) &&
              std::count(places.wall_sides.begin(), places.wall_sides.end(), 0) == 0,
          "wall_sides");
  require(all_in(places.contact_cells, 0, cells), "contact_cells");
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto dense = static_cast<std::int64_t>(edge_total(grid, static_cast<int>(axis)));
    require(all_in(places.edges[axis], 0, dense) &&
                places.edge_numbers[axis].size() == places.edges[axis].size() &&
                all_in(places.edge_numbers[axis], 0, 12 * cells),
            fmt::format("edges_{}", axis));
  }
}

/// What take_tables leaves of a region.
ActiveRegion region_of(const Grid& grid, const Places& places) {
  ActiveRegion region;
  region.grid = grid;
  region.dense_of_cell = places.cells;
  region.cell_of_dense.reset(static_cast<std::size_t>(grid.cells.prod()));
  for (std::size_t c = 0; c < places.cells.size(); ++c)
    region.cell_of_dense.set(static_cast<std::size_t>(places.cells[c]), static_cast<int>(c));
  region.open_faces = places.open_faces;
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    region.face_of_dense[a].reset(face_total(grid, axis));
    region.edge_of_dense[a].reset(edge_total(grid, axis));
    for (std::size_t e = 0; e < places.edges[a].size(); ++e)
      region.edge_of_dense[a].set(static_cast<std::size_t>(places.edges[a][e]), places.edge_numbers[a][e]);
  }
  for (std::size_t w = 0; w < places.wall_cells.size(); ++w) {
    WallFace wall{};
    wall.cell = places.wall_cells[w];
    wall.axis = places.wall_axes[w];
    wall.inward = places.wall_sides[w];
    wall.face = region.open_faces + 1 + static_cast<int>(w);
    Eigen::Vector3i at = grid.cell_of_index(places.cells[static_cast<std::size_t>(wall.cell)]);
    if (wall.inward < 0.0) ++at[wall.axis];
    region.face_of_dense[static_cast<std::size_t>(wall.axis)].set(
        static_cast<std::size_t>(grid.face_index(wall.axis, at)), wall.face);
    region.wall_faces.push_back(wall);
  }
  for (const int cell : places.contact_cells) {
    region.contacts.push_back(
        {cell, Eigen::Vector3d::Zero(), 0.0, 0.0, -1, {}, Eigen::Matrix<double, 3, 2>::Zero()});
  }
  return region;
}

template <class Archive, class Of>
void describe_stress(Archive& archive, Of& stress) {
  if (auto* paper = std::get_if<PaperStress>(&stress)) {
    archive.list("pressure", paper->pressure);
    archive.list("diagonal", paper->friction.diagonal);
    archive.list("shear", paper->friction.shear);
    archive.list("contact", paper->friction.contact);
  } else {
    auto& ours = std::get<Stress>(stress);
    archive.list("pressure", ours.pressure);
    archive.list("copies", ours.copies);
  }
}

template <class Archive, class Of>
void describe_fields(Archive& archive, Of& warm) {
  describe_stress(archive, warm.stress);
  archive.list("shear_rate", warm.shear_rate);
  archive.list("confining_pressure", warm.confining_pressure);
  archive.number("dt", warm.dt);
}

void write_warm(ArchiveWriter& archive, const State::Warm& warm) {
  const bool paper = std::holds_alternative<PaperStress>(warm.stress);
  archive.number("paper_scheme", paper);
  const Places places = places_of(warm.region, paper);
  describe_places(archive, places);
  describe_fields(archive, warm);
  archive.list("sand_acceleration", rows_of(warm.sand_acceleration));
}

void check_stress(const ArchiveReader& archive, const ActiveRegion& region, const Places& places,
                  const SchemeStress& stress) {
  const Eigen::Index cells = region.cell_count(), walls = std::ssize(region.wall_faces),
                     contacts = std::ssize(region.contacts);
  const auto require = [&](bool holds, std::string_view name) {
    if (!holds) archive.fail(name, "is of the wrong size for its cells");
  };
  require(pressure_of(stress).size() == cells + 1, "pressure");
  if (const auto* paper = std::get_if<PaperStress>(&stress)) {
    int most = -1;
    for (const auto& numbers : places.edge_numbers) {
      for (const int number : numbers) most = std::max(most, number);
    }
    require(paper->friction.diagonal.cols() == cells + 1, "diagonal");
    require(paper->friction.shear.size() > most, "shear");
    require(paper->friction.contact.size() == values_per_contact * contacts, "contact");
  } else {
    require(std::get<Stress>(stress).copies.size() ==
                values_per_cell * cells + 2 * copies_per_wall_face * walls + values_per_contact * contacts,
            "copies");
  }
}

State::Warm read_warm(ArchiveReader& archive, const State& state) {
  State::Warm warm{};
  bool paper = false;
  archive.number("paper_scheme", paper);
  if (paper) warm.stress = PaperStress{};
  Places places;
  describe_places(archive, places);
  check_places(archive, state.grid, places);
  describe_fields(archive, warm);
  warm.region = region_of(state.grid, places);
  check_stress(archive, warm.region, places, warm.stress);
  if (warm.shear_rate.size() < warm.region.cell_count() ||
      warm.confining_pressure.size() < warm.region.cell_count())
    archive.fail("shear_rate", "is of the wrong size for its cells");
  if (!(warm.dt > 0.0)) archive.fail("dt", "is no time step");
  TwistRows rows;
  archive.list("sand_acceleration", rows);
  if (rows.cols() != std::ssize(state.bodies)) archive.fail("sand_acceleration", "is of other bodies");
  for (Eigen::Index b = 0; b < rows.cols(); ++b)
    warm.sand_acceleration.push_back({rows.col(b).head<3>(), rows.col(b).tail<3>()});
  return warm;
}

/// A name for the walls that stand, and so for their meshes.
std::string walls_digest(const Openings& walls) {
  const auto* bytes = reinterpret_cast<const char*>(walls.distance.data());
  return sha256({bytes, sizeof(double) * static_cast<std::size_t>(walls.distance.size())});
}

template <class Archive, class Of>
void describe_time(Archive& archive, Of& state) {
  archive.number("time", state.time);
  archive.number("contact_changed", state.contact_changed);
}

void check_particles(const ArchiveReader& archive, const State& state) {
  const Particles& particles = state.particles;
  const Eigen::Index n = particles.count();
  if (particles.positions.cols() != n || particles.velocities.cols() != n || particles.shapes.cols() != n ||
      std::ssize(particles.materials) != n ||
      (particles.gradients.cols() != n && particles.gradients.cols() != 0))
    archive.fail("particles/masses", "differs in length from other lists of particles");
  if (!particles.velocities.allFinite() || !particles.shapes.allFinite() || !particles.gradients.allFinite())
    archive.fail("particles/velocities", "or what is beside it is not finite");
  if (!(particles.masses > 0.0).all() || !particles.masses.allFinite())
    archive.fail("particles/masses", "is not positive throughout");
  if (!all_in(particles.materials, 0, std::ssize(state.materials)))
    archive.fail("particles/materials", "names materials that the scene does not have");
  for (Eigen::Index p = 0; p < n; ++p) {
    if (!state.grid.contains(particles.positions.col(p)))
      archive.fail("particles/positions", "has particles outside the domain");
  }
}

void check_render_points(const ArchiveReader& archive, const RenderPoints& points, Eigen::Index particles) {
  const auto require = [&](bool holds, std::string_view name) {
    if (!holds) archive.fail(name, "is not that of the particles' render points");
  };
  require(points.identities.size() == points.offsets.size(), "render_points/identities");
  if (!points.wanted()) return require(points.offsets.empty(), "render_points/offsets");
  require(std::ssize(points.hidden) == particles, "render_points/hidden");
  require(std::ssize(points.first) == particles + 1 && points.first.front() == 0 &&
              points.first.back() == points.count() &&
              std::is_sorted(points.first.begin(), points.first.end()),
          "render_points/first");
}

void read_bodies(ArchiveReader& archive, std::vector<Body>& bodies) {
  BodyRows rows;
  archive.list("bodies", rows);
  if (rows.cols() != std::ssize(bodies) || !rows.allFinite()) archive.fail("bodies", "is of other bodies");
  for (Eigen::Index b = 0; b < rows.cols(); ++b) {
    Body& body = bodies[static_cast<std::size_t>(b)];
    const auto row = rows.col(b);
    if (row[13] != body.mass)
      archive.fail("bodies", fmt::format("tells of another mass than body '{}' has by the scene, {} kg; has "
                                         "its mesh changed?",
                                         body.name, body.mass));
    body.pose.position = row.segment<3>(0);
    body.pose.orientation.coeffs() = row.segment<4>(3);
    body.twist = {row.segment<3>(7), row.segment<3>(10)};
    if (std::abs(body.pose.orientation.norm() - 1.0) > 1e-9) archive.fail("bodies", "has no orientations");
  }
}

void read_sources(ArchiveReader& archive, std::vector<Source>& sources) {
  std::vector<std::int64_t> layers;
  archive.list("source_layers", layers);
  if (layers.size() != sources.size() ||
      std::any_of(layers.begin(), layers.end(), [](auto n) { return n < 0; }))
    archive.fail("source_layers", "is of other sources");
  for (std::size_t s = 0; s < sources.size(); ++s) sources[s].layers = layers[s];
}

/// The walls that stand, and what bodies leave open of the rest.
void restore_openings(const ArchiveReader& archive, const std::string& walls, State& state) {
  Openings standing = openings_of(state.grid, state.walls, state.time);
  if (walls_digest(standing) != walls)
    archive.fail("walls", "is not of the walls that the scene has; have its meshes changed?");
  if (state.bodies.empty()) {
    state.openings = std::move(standing);
    return;
  }
  state.solids.walls = std::move(standing);
  find_openings(state.grid, state.solids.walls, state.bodies, state.solids.swellings, state.openings);
}

}  // namespace

nlohmann::json archive_of(const State& state) {
  ArchiveWriter archive;
  describe_time(archive, state);
  archive.group("particles", [&] { describe_particles(archive, state.particles); });
  archive.group("render_points", [&] { describe_render_points(archive, state.render_points); });
  archive.list("bodies", rows_of(state.bodies));
  std::vector<std::int64_t> layers;
  for (const Source& source : state.sources) layers.push_back(source.layers);
  archive.list("source_layers", layers);
  archive.number("walls", walls_digest(state.bodies.empty() ? state.openings : state.solids.walls));
  archive.number("lipschitz", state.friction_solver.lipschitz());
  archive.number("warm", state.warm.has_value());
  if (state.warm) archive.group("warm_start", [&] { write_warm(archive, *state.warm); });
  return archive.fields();
}

std::string digest_of(const State& state) { return digest_of_fields(archive_of(state)); }

std::string digest_of_fields(const nlohmann::json& fields) {
  std::string content;
  nlohmann::json::to_cbor(fields, content);
  return sha256(content);
}

void restore(const nlohmann::json& fields, const std::string& where, State& state) {
  ArchiveReader archive(fields, where);
  describe_time(archive, state);
  if (!std::isfinite(state.time) || state.time < 0.0) archive.fail("time", "is no time of a run");
  archive.group("particles", [&] { describe_particles(archive, state.particles); });
  check_particles(archive, state);
  archive.group("render_points", [&] { describe_render_points(archive, state.render_points); });
  check_render_points(archive, state.render_points, state.particles.count());
  read_bodies(archive, state.bodies);
  read_sources(archive, state.sources);
  std::string walls;
  archive.number("walls", walls);
  restore_openings(archive, walls, state);
  double lipschitz = 0.0;
  archive.number("lipschitz", lipschitz);
  if (!(lipschitz > 0.0)) archive.fail("lipschitz", "is not positive");
  state.friction_solver = FrictionSolver(lipschitz);
  bool warm = false;
  archive.number("warm", warm);
  state.warm.reset();
  if (warm) archive.group("warm_start", [&] { state.warm = read_warm(archive, state); });
}

}  // namespace talus
