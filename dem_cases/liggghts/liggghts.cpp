#include "dem_cases/liggghts/liggghts.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <fstream>

#include "continuum/files/atomic_file.h"
#include "continuum/files/checked_table.h"
#include "continuum/files/process.h"
#include "dem_cases/container.h"
#include "dem_cases/falling_sphere.h"
#include "dem_cases/grain_dump.h"
#include "dem_cases/time_step.h"

namespace talus::dem::liggghts {
namespace {

constexpr std::string_view deck_file = "in.liggghts";
constexpr std::string_view data_file = "packing.data";
constexpr std::string_view log_name = "log.liggghts";

/// What a sphere or a wall is made of; LIGGGHTS numbers these "atom types" from 1.
enum Material { column_grain, floor_grain, wall, flat_floor, falling_ball };

int material_count(const Case& a_case) { return falling_sphere(a_case) ? falling_ball + 1 : flat_floor + 1; }

double friction_between(const Contact& contact, int a, int b) {
  return a == wall || b == wall ? contact.wall_friction : contact.friction;
}

/// Against a plane LIGGGHTS takes the grain's whole radius for R1 R2 / (R1 + R2), twice what two equal grains
/// have; so planes get half the coefficient, to resist rolling as a plane of grains would.
double rolling_friction_between(const Contact& contact, int a, int b) {
  const bool plane = a == wall || b == wall || a == flat_floor || b == flat_floor;
  return plane ? 0.5 * contact.rolling_friction : contact.rolling_friction;
}

/// A process on its own asks Open MPI for neither a daemon nor ssh, which a small machine may not have.
std::vector<std::string> on_one_core(const std::filesystem::path& program,
                                     const std::vector<std::string>& arguments) {
  std::vector<std::string> command{"/usr/bin/env", "OMP_NUM_THREADS=1", "OMPI_MCA_ess_singleton_isolated=1",
                                   program.string()};
  command.insert(command.end(), arguments.begin(), arguments.end());
  return command;
}

template <class Function>
std::string pair_table(const Case& a_case, Function value) {
  const int count = material_count(a_case);
  std::string text = fmt::format("{}", count);
  for (int a = 0; a < count; ++a) {
    for (int b = 0; b < count; ++b) text += fmt::format(" {}", value(a_case.contact, a, b));
  }
  return text;
}

std::string per_material(const Case& a_case, double value) {
  std::string text;
  for (int material = 0; material < material_count(a_case); ++material) text += fmt::format(" {}", value);
  return text;
}

/// Spheres in the order of the packing: ids count from 1, fixed grains first.
std::string data_text(const Case& a_case, const Packing& packing) {
  const Container container = container_of(a_case);
  const double top = std::max(container.upper.z(), packing.top() + 4.0 * a_case.grains.diameter);
  std::string text = fmt::format(
      "packing of case {} for seed {}, made by talus\n\n{} atoms\n{} atom types\n"
      "{} {} xlo xhi\n{:.17g} {:.17g} ylo yhi\n{} {} zlo zhi\n\nAtoms\n\n",
      a_case.name, packing.seed, packing.count(), material_count(a_case), container.lower.x(),
      container.upper.x(), container.lower.y(), container.upper.y(), container.lower.z(), top);
  for (Eigen::Index i = 0; i < packing.count(); ++i) {  // id type diameter density x y z
    const auto& p = packing.positions;
    text +=
        fmt::format("{} {} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g}\n", i + 1, i < packing.fixed_count ? 2 : 1,
                    2.0 * packing.radii[i], a_case.grains.density, p(0, i), p(1, i), p(2, i));
  }
  text += "\nVelocities\n\n";
  for (Eigen::Index i = 0; i < packing.count(); ++i) {  // id, velocity, angular velocity
    const auto& v = packing.velocities;
    text += fmt::format("{} {:.17g} {:.17g} {:.17g} 0 0 0\n", i + 1, v(0, i), v(1, i), v(2, i));
  }
  return text;
}

// limitForce: grains without cohesion never pull; it stands after the primitive in wall commands.
constexpr std::string_view model = "model hertz tangential history rolling_friction epsd2";

std::string stl_name(const Shell& shell) { return shell.name + ".stl"; }

std::string stl_text(const Shell& shell) {
  std::string text = fmt::format("solid {}\n", shell.name);
  for (const Triangle& triangle : triangles_of(shell)) {
    const Eigen::Vector3d normal = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]).normalized();
    text +=
        fmt::format("facet normal {:.9g} {:.9g} {:.9g}\n outer loop\n", normal.x(), normal.y(), normal.z());
    for (const auto& corner : triangle)
      text += fmt::format("  vertex {:.12g} {:.12g} {:.12g}\n", corner.x(), corner.y(), corner.z());
    text += " endloop\nendfacet\n";
  }
  return text + fmt::format("endsolid {}\n", shell.name);
}

std::string contact_law(const Case& a_case) {
  const Grains& grains = a_case.grains;
  const auto restitution = [](const Contact& law, int, int) { return law.restitution; };
  return fmt::format("fix modulus all property/global youngsModulus peratomtype{}\n",
                     per_material(a_case, grains.youngs_modulus)) +
         fmt::format("fix poisson all property/global poissonsRatio peratomtype{}\n",
                     per_material(a_case, grains.poissons_ratio)) +
         fmt::format("fix restitution all property/global coefficientRestitution peratomtypepair {}\n",
                     pair_table(a_case, restitution)) +
         fmt::format("fix friction all property/global coefficientFriction peratomtypepair {}\n",
                     pair_table(a_case, friction_between)) +
         fmt::format("fix rolling all property/global coefficientRollingFriction peratomtypepair {}\n",
                     pair_table(a_case, rolling_friction_between)) +
         fmt::format("pair_style gran {} limitForce on\npair_coeff * *\n", model);
}

std::string walls(const Container& container) {
  std::string text;
  for (const Plane& plane : container.planes) {
    const int material = plane.surface == Surface::floor ? flat_floor : wall;
    text += fmt::format("fix {} mobile wall/gran {} primitive type {} {}plane {:.17g} limitForce on\n",
                        plane.name, model, material + 1, "xyz"[plane.axis], plane.at);
  }
  for (const Shell& shell : container.shells) {
    text += fmt::format(
        "fix {0}_mesh all mesh/surface file {1} type {2}\n"
        "fix {0} mobile wall/gran {3} mesh n_meshes 1 meshes {0}_mesh limitForce on\n",
        shell.name, stl_name(shell), wall + 1, model);
  }
  return text;
}

std::string release(const Container& container) {
  std::string text;
  for (const Plane& plane : container.planes) {
    if (plane.until_release) text += fmt::format("unfix {}\n", plane.name);
  }
  for (const Shell& shell : container.shells) {
    if (shell.until_release) text += fmt::format("unfix {0}\nunfix {0}_mesh\n", shell.name);
  }
  text += "unfix tell\nreset_timestep 0\n";
  for (const Shell& shell : container.shells) {
    if (shell.rise_speed != 0.0) {
      text += fmt::format("fix {0}_rise all move/mesh mesh {0}_mesh linear 0 0 {1:.17g}\n", shell.name,
                          shell.rise_speed);
    }
  }
  return text;
}

/// A sphere like the others, but for its size and density, that joins the grains; and its track, as analysis/body_track.h has it.
std::string ball(const FallingSphere& sphere, const Packing& packing, std::int64_t every) {
  const auto place =
      fmt::format("{:.17g} {:.17g} {:.17g}", sphere.centre.x(), sphere.centre.y(), sphere.centre.z());
  std::string text = fmt::format(
      "create_atoms {0} single {1} units box\n"
      "set type {0} diameter {2:.17g} density {3:.17g} vz {4:.17g}\n"
      "group mobile type {0}\n",
      falling_ball + 1, place, 2.0 * sphere.radius, sphere.density, -sphere.speed);
  text += "variable time equal step*dt\n";
  for (const auto name : {"x", "y", "z", "vx", "vy", "vz"})
    text += fmt::format("variable ball_{0} equal {0}[{1}]\n", name, packing.count() + 1);
  const std::string_view row = "${time},ball,${ball_x},${ball_y},${ball_z},${ball_vx},${ball_vy},${ball_vz}";
  return text +
         fmt::format(
             "print \"time_s,body,x_m,y_m,z_m,vx_m_s,vy_m_s,vz_m_s\" file {0} screen no\n"
             "fix track all print {1} \"{2}\" append {0} screen no title \"0,ball,{3},0,0,{4:.17g}\"\n",
             analysis::body_track_file, every, row, fmt::join(sphere.centre, ","), -sphere.speed);
}

std::string deck_text(const Case& a_case, const Packing& packing) {
  const StepSchedule schedule = step_schedule(a_case);
  const Container container = container_of(a_case);
  const auto sphere = falling_sphere(a_case);
  std::string text = fmt::format(
      "# case {}, point {}; written by talus\n"
      "atom_style granular\n"
      "atom_modify map array\n"
      "boundary f {} f\n"
      "newton off\n"
      "communicate single vel yes\n"
      "units si\n"
      "read_data {}\n"
      "neighbor {:.17g} bin\n"
      "neigh_modify delay 0\n"
      "group mobile type 1\n"
      "{}",
      a_case.name, a_case.point, container.periodic ? "p" : "f", data_file, 0.3 * a_case.grains.diameter,
      sphere ? "group bed type 1\n" : "");
  if (packing.fixed_count > 0) text += "group fixed type 2\nneigh_modify exclude group fixed fixed\n";
  text += contact_law(a_case);
  text += fmt::format("timestep {:.17g}\n", a_case.protocol.time_step);
  text += walls(container);
  text += fmt::format("fix gravity mobile gravity {:.17g} vector 0 0 -1\n", a_case.protocol.gravity);
  text += "fix integrate mobile nve/sphere\n";
  if (packing.fixed_count > 0) text += "fix freeze fixed freeze\n";
  text += fmt::format("thermo_style custom step atoms ke\nthermo {}\nthermo_modify lost error norm no\n",
                      schedule.per_snapshot);
  const auto tell = [&](std::string_view stage, std::string_view mode) {
    return fmt::format("fix tell all print {} \"{} ${{now}}\" {} {} screen no title \"\"\n",
                       schedule.per_snapshot, stage, mode, progress_file);
  };
  text += "variable now equal step\n" + tell("settling", "file");
  text += fmt::format("run {}\n", schedule.settle) + release(container) + tell("running", "append");
  if (sphere) text += ball(*sphere, packing, schedule.per_snapshot);
  // Of the first and the last moment: places of the two centres, their ids, force on the first.
  text += fmt::format(
      "compute contacts all pair/gran/local pos id force\n"
      "dump contacts all local {} {} c_contacts[1] c_contacts[2] c_contacts[3] c_contacts[4] c_contacts[5] "
      "c_contacts[6] c_contacts[7] c_contacts[8] c_contacts[10] c_contacts[11] c_contacts[12]\n",
      schedule.run(), contacts_file);
  text += fmt::format(
      "dump grains {} custom {} {} id x y z vx vy vz\n"
      "dump_modify grains sort id format \"%d %.10g %.10g %.10g %.10g %.10g %.10g\"\n"
      "run {}\n",
      sphere ? "bed" : "mobile", schedule.per_snapshot, dump_file, schedule.run());
  return text;
}

}  // namespace

std::string version() {
  const auto program = find_program("liggghts", "liggghts");
  const std::string said = output_of(on_one_core(program, {"-in", "/dev/null", "-log", "none"}));
  constexpr std::string_view before = "LIGGGHTS-PUBLIC ";
  const auto at = said.find(before);
  if (at == std::string::npos)
    throw InputError(fmt::format("{}: does not tell its version; it said: {}", program.string(), said));
  const auto begin = at + before.size();
  return said.substr(begin, said.find_first_of(",) \n", begin) - begin);
}

void write_input(const Case& column, const Packing& packing, const std::filesystem::path& folder) {
  check_time_step(column);
  make_writable_folder(folder);
  for (const auto stale : {std::string_view(analysis::body_track_file), dump_file, contacts_file,
                           progress_file, log_name, log_file})
    std::filesystem::remove(folder / stale);
  write_file_atomically(folder / data_file, data_text(column, packing));
  for (const Shell& shell : container_of(column).shells)
    write_file_atomically(folder / stl_name(shell), stl_text(shell));
  write_file_atomically(folder / deck_file, deck_text(column, packing));
}

std::vector<std::string> command() {
  return on_one_core(find_program("liggghts", "liggghts"),
                     {"-in", std::string(deck_file), "-log", std::string(log_name)});
}

double progress(const Case& column, const std::filesystem::path& folder) {
  return progress_of_run(column, folder);
}

/// LIGGGHTS says "ERROR: ..." once, on the screen and in the log.
std::string failure_text(const std::filesystem::path& folder) {
  for (const auto name : {log_name, log_file}) {
    std::ifstream in(folder / name);
    for (std::string line; std::getline(in, line);) {
      if (line.starts_with("ERROR")) return line;
    }
  }
  return {};
}

analysis::SnapshotSeries read_output(const Case& column, const Packing& packing,
                                     const std::filesystem::path& folder) {
  return read_grain_dump(column, packing, folder);
}

}  // namespace talus::dem::liggghts
