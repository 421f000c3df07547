#include "tests/continuum/bench/kernels.h"

#include <benchmark/benchmark.h>

#include <memory>

#include "continuum/stress/friction.h"
#include "continuum/stress/packing.h"
#include "continuum/stress/pressure.h"
#include "tests/continuum/bench/machine.h"
#include "tests/continuum/scenes.h"

namespace talus::bench {
namespace {

constexpr double number = sizeof(double), index = sizeof(int), vector = 3 * sizeof(double);
constexpr double weights_flops = 22.0;  // of the eight weights of a kernel at one point
constexpr double tolerance = 0.01;      // of both solves, in units of g dt, as a run has it
constexpr int most_iterations = 2000;

/// How many there are of each thing.
struct Counts {
  double particles, cells, faces, all_faces, edges, values, balls;
  explicit Counts(const Specimen& s)
      : particles(static_cast<double>(s.state.particles.count())),
        cells(s.region().cell_count()),
        faces(s.region().open_faces),
        all_faces(s.region().face_count()),
        edges(s.region().edge_count()),
        values(static_cast<double>(s.moment.stress.copies.size())),
        balls(copies_per_cell * cells +
              copies_per_wall_face * static_cast<double>(s.region().wall_faces.size())) {}
};

template <class Function>
Sample timed(const Function& f) {
  const double start = cpu_seconds();
  if constexpr (std::is_void_v<decltype(f())>) {
    f();
    benchmark::ClobberMemory();
    return {cpu_seconds() - start};
  } else {
    auto result = f();
    benchmark::DoNotOptimize(result);
    return {cpu_seconds() - start};
  }
}

Kernel simple(const Work& work, std::function<Sample()> run) {
  return {work, {}, [] {}, std::move(run)};
}

template <class Vector>
double bytes_of(const Vector& v) {
  return static_cast<double>(v.size()) * sizeof(*v.data());
}

/// The region's own tables but for its stencils and maps: its output, so whatever it is made of.
double bytes_of_tables(const ActiveRegion& r) {
  return bytes_of(r.dense_of_cell) + bytes_of(r.cell_faces) + bytes_of(r.cell_edges) +
         bytes_of(r.cell_parity) + bytes_of(r.cell_share) + bytes_of(r.cell_kernel) + bytes_of(r.face_axis) +
         bytes_of(r.face_cells) + bytes_of(r.face_strained_cells) + bytes_of(r.face_area) +
         bytes_of(r.face_kernel) + bytes_of(r.face_edges) + bytes_of(r.wall_faces) + bytes_of(r.edge_axis) +
         bytes_of(r.edge_faces) + bytes_of(r.edge_copies);
}

/// Reads positions; writes the tables.
Kernel active_region(const Specimen& s, Start) {
  const Counts n(s);
  return simple({vector * n.particles + bytes_of_tables(s.region()), 6.0 * n.particles}, [&s] {
    return timed([&] {
      return make_active_region(s.state.grid, s.state.sides, s.state.particles.positions, s.state.openings);
    });
  });
}

/// Reads position, velocity, mass, material, mu of each particle (with FLIP no gradient); writes fill and mu of cells; mass,
/// volume, velocity of faces. Of flops, a particle: weights and 4 x 8 on cells, weights and 6 x 8 on faces of each axis.
Work deposit_work(const Counts& n) {
  return {(2.0 * vector + 2.0 * number + index) * n.particles + (2.0 * number + index) * n.cells +
              3.0 * number * n.all_faces,
          (weights_flops + 32.0 + 3.0 * (weights_flops + 48.0)) * n.particles};
}

Kernel deposition(const Specimen& s, Start) {
  return simple(deposit_work(Counts(s)), [&s] {
    return timed(
        [&] { return deposit(s.region(), s.points, s.state.particles, s.state.materials, s.friction); });
  });
}

/// Reads positions and a face field; writes a vector a particle.
Work gather_work(const Counts& n) {
  return {2.0 * vector * n.particles + number * n.all_faces + index * n.cells,
          3.0 * (weights_flops + 16.0) * n.particles};
}

Kernel gather(const Specimen& s, Start) {
  return simple(gather_work(Counts(s)), [&s] {
    return timed([&] { return interpolate(s.region(), s.points, s.velocity, s.state.particles.positions); });
  });
}

/// Reads two face fields, mass and material; reads and writes position, velocity and shape. Of flops, a particle: 2 x 8
/// products an axis and 9 x 8 for the gradient; shapes by two 3 x 3 products, and their bounds.
Kernel advancing(const Specimen& s, Start) {
  const Counts n(s);
  const auto particles = std::make_shared<Particles>(s.state.particles);
  return {{(8.0 * vector + number + index) * n.particles + 2.0 * number * n.all_faces + index * n.cells,
           (3.0 * weights_flops + 3.0 * 2.0 * 16.0 + 9.0 * 16.0 + 150.0) * n.particles},
          {},
          [&s, particles] { *particles = s.state.particles; },
          [&s, particles] {
            return timed([&] {
              return advance(s.region(), s.points, s.moment.grid.velocity, s.velocity,
                             {s.moment.dt, Transfer::flip, 0.02, true}, s.state.materials, *particles);
            });
          }};
}

/// Reads cells, face areas and faces; writes faces.
Kernel gradient(const Specimen& s, Start) {
  const Counts n(s);
  return simple({(number + index) * n.cells + 3.0 * number * n.faces, 4.0 * n.faces},
                [&s, faces = Field(s.velocity)]() mutable {
                  return timed([&] { add_gradient(s.region(), s.moment.stress.pressure, -1.0, faces); });
                });
}

/// Reads faces and their areas; writes cells.
Kernel divergence(const Specimen& s, Start) {
  const Counts n(s);
  return simple({(number + index) * n.cells + 2.0 * number * n.faces, 11.0 * n.cells},
                [&s, cells = Field(s.moment.stress.pressure)]() mutable {
                  return timed([&] { gradient_transpose(s.region(), s.velocity, cells); });
                });
}

/// Reads the stress, three numbers a cell and one an edge, and faces; writes faces.
Kernel stress_divergence(const Specimen& s, Start) {
  const Counts n(s);
  StressField stress = make_stress_field(s.region());
  FrictionOperator(s.region()).stress_of(s.moment.stress.copies, stress);
  return simple({(vector + index) * n.cells + number * n.edges + 2.0 * number * n.faces, 6.0 * n.faces},
                [&s, stress, faces = Field(s.velocity)]() mutable {
                  return timed([&] { add_stress_divergence(s.region(), stress, faces); });
                });
}

/// Reads faces; writes a strain.
Kernel strain(const Specimen& s, Start) {
  const Counts n(s);
  return simple({(vector + index) * n.cells + number * n.edges + number * n.faces, 3.0 * (n.cells + n.edges)},
                [&s, strain = make_stress_field(s.region())]() mutable {
                  return timed([&] { stress_divergence_transpose(s.region(), s.velocity, strain); });
                });
}

/// Twenty copies a cell to two means of four and twelve shares of edges, then D2.
double friction_flops(const Counts& n) { return (8.0 + 24.0) * n.cells + 6.0 * n.faces; }

/// Reads the copies; writes faces.
Kernel friction_apply(const Specimen& s, Start) {
  const Counts n(s);
  const auto friction = std::make_shared<FrictionOperator>(s.region());
  return simple({number * n.values + index * n.cells + number * n.faces, friction_flops(n)},
                [&s, friction, impulse = Field(s.region().open_faces + 1)]() mutable {
                  return timed([&] { friction->apply(s.moment.stress.copies, impulse); });
                });
}

/// Reads faces; writes copies.
Kernel friction_apply_transpose(const Specimen& s, Start) {
  const Counts n(s);
  const auto friction = std::make_shared<FrictionOperator>(s.region());
  return simple({number * n.values + index * n.cells + number * n.faces, friction_flops(n)},
                [&s, friction, strain = Eigen::ArrayXd(s.moment.stress.copies.size())]() mutable {
                  return timed([&] { friction->apply_transpose(s.velocity, strain); });
                });
}

/// An iteration of accelerated projected gradient: reads stress now and before, writes the next; reads radius and curvature of
/// each ball; reads velocity now and before, free velocity and inverse mass, writes the next velocity. Of flops 12 a value, for
/// momentum, step, projection and the two tests, and K and K^T once each.
Work friction_iteration(const Counts& n) {
  return {3.0 * number * n.values + 2.0 * number * n.balls + 5.0 * number * n.faces + index * n.cells,
          12.0 * n.values + 2.0 * friction_flops(n) + 8.0 * n.faces};
}

Kernel friction_solve(const Specimen& s, Start start) {
  return {{},
          friction_iteration(Counts(s)),
          [] {},
          [&s, start] {
            ProjectionSettings settings;
            settings.tolerance = tolerance;
            Stress stress = start == Start::warm ? s.moment.stress : zero_stress(s.region());
            Field velocity = s.velocity;
            FrictionSolver solver = start == Start::warm ? s.state.friction_solver : FrictionSolver{};
            const double began = cpu_seconds();
            Stopwatch wall;
            const ProjectionReport report =
                project(s.region(), s.moment.grid, s.moment.dt, testing::gravity * s.moment.dt,
                        start == Start::cold, settings, solver, stress, velocity);
            // Its share of the whole is known by the clock on the wall.
            return Sample{(cpu_seconds() - began) * report.seconds[Phase::friction] / wall.lap(),
                          report.friction_iterations};
          }};
}

/// What a pressure solve reads and writes whatever it does: inverse mass and free velocity of faces, room and pressure of cells.
Work pressure_once(const Counts& n) {
  return {2.0 * number * n.faces + 3.0 * number * n.cells + index * n.cells, 11.0 * n.cells + n.faces};
}

/// An iteration of conjugate gradients on the fine grid, which a multigrid preconditioner comes on top of: reads x, gradient,
/// direction and its product, writes the first three; reads the inverse masses. Of flops 10 a cell, and D1 and D1^T.
Work pressure_iteration(const Counts& n) {
  return {7.0 * number * n.cells + number * n.faces + index * n.cells, 21.0 * n.cells + 5.0 * n.faces};
}

/// With the friction of the last step, as the second round of a step meets it.
Kernel pressure_solve(const Specimen& s, Start start) {
  const Counts n(s);
  const Eigen::Index faces = s.region().open_faces + 1;
  Field impulse(faces);
  FrictionOperator(s.region()).apply(s.moment.stress.copies, impulse);
  const Field free = s.velocity.head(faces) + s.inverse_mass * impulse;
  const Field room = (packed_fill - s.moment.grid.fill).max(0.0) * (s.region().grid.spacing / s.moment.dt);
  return {pressure_once(n), pressure_iteration(n), [] {},
          [&s, start, room, free] {
            Field pressure =
                start == Start::warm ? s.moment.stress.pressure : Field::Zero(s.region().cell_count() + 1);
            const double began = cpu_seconds();
            const auto result =
                solve_pressure(s.region(), s.inverse_mass, free, room,
                               {tolerance * testing::gravity * s.moment.dt, most_iterations}, pressure);
            return Sample{cpu_seconds() - began, result.iterations};
          }};
}

/// Deposits fill and face volume (position, mass, material of a particle), solves for a pressure, and gathers displacements
/// into positions.
Kernel density_correction(const Specimen& s, Start) {
  const Counts n(s);
  const auto particles = std::make_shared<Particles>(s.state.particles);
  const Work once{(2.0 * vector + number + index) * n.particles + number * (n.cells + n.faces),
                  deposit_work(n).flops + gather_work(n).flops};
  return {once, pressure_iteration(n), [&s, particles] { *particles = s.state.particles; },
          [&s, particles] {
            const double began = cpu_seconds();
            const PackingResult result =
                correct_packing(s.region(), s.points, s.state.materials,
                                {StepSettings{}.packing_tolerance, most_iterations}, *particles);
            return Sample{cpu_seconds() - began, result.solve.iterations};
          }};
}

/// Reads shape, position, mass and material; what few particles change counts nothing.
Kernel reshaping(const Specimen& s, Start) {
  const Counts n(s);
  const auto particles = std::make_shared<Particles>(s.state.particles);
  return {{(3.0 * vector + number + index) * n.particles, 20.0 * n.particles},
          {},
          [&s, particles] { *particles = s.state.particles; },
          [&s, particles] {
            return timed([&] {
              return split_and_merge(
                  s.state.grid, s.state.materials, [](const auto&, const auto&) { return true; }, {},
                  s.moment.dt, *particles);
            });
          }};
}

/// What a step does to render points: reads a face field and its particles' positions and shapes; reads and writes offsets to
/// move them, offsets and identities to lay them out anew. Of flops, a point: 2 x 4 and 3 interpolations of 16 to move; an
/// ellipsoid's distance. Twelve points a particle, about the median of the source's table 5.1.
Kernel render_points(const Specimen& s, Start) {
  constexpr int each = 12;
  constexpr double offset = 3.0 * sizeof(float), identity = sizeof(std::uint32_t);
  const Counts n(s);
  struct Data {
    Particles particles;
    RenderPoints original, drawn;
  };
  const auto data = std::make_shared<Data>();
  data->particles = s.state.particles;
  const Surroundings around{s.state.grid, s.state.sides, s.state.openings, nullptr, {}};
  data->original = sample_render_points(around, s.state.materials, each * 8.0 / s.state.grid.cell_volume(), 1,
                                        data->particles);
  data->particles.track_origins();
  const auto points = static_cast<double>(data->original.count());
  return {{(4.0 * offset + 2.0 * identity) * points + 3.0 * vector * n.particles + number * n.all_faces +
               index * n.cells,
           (3.0 * (weights_flops + 16.0) + 9.0 + 18.0) * points},
          {},
          [data] { data->drawn = data->original; },
          [&s, data, around] {
            return timed([&] {
              move_render_points(s.region(), s.points, s.velocity, s.moment.dt, data->particles, data->drawn);
              return hand_over(around, s.state.materials, data->particles.positions, data->particles,
                               data->drawn);
            });
          }};
}

/// Reads and writes the stress, and where the cells are in both regions.
Kernel carrying_over(const Specimen& s, Start) {
  const Counts n(s);
  return simple({2.0 * number * (n.values + n.cells) + 2.0 * index * n.cells, n.values + n.cells}, [&s] {
    return timed([&] {
      return carry_over(s.state.warm->region, std::get<Stress>(s.state.warm->stress), s.region(), 1.0);
    });
  });
}

}  // namespace

std::vector<NamedKernel> kernels() {
  return {
      {"make_active_region", false, active_region},
      {"density_correction", false, density_correction},
      {"deposit", false, deposition},
      {"carry_over", false, carrying_over},
      {"D1", false, gradient},
      {"D1_transpose", false, divergence},
      {"D2", false, stress_divergence},
      {"D2_transpose", false, strain},
      {"friction_apply", false, friction_apply},
      {"friction_apply_transpose", false, friction_apply_transpose},
      {"friction_solve", true, friction_solve},
      {"pressure_solve", true, pressure_solve},
      {"gather", false, gather},
      {"advance", false, advancing},
      {"split_and_merge", false, reshaping},
      {"render_points", false, render_points},
  };
}

}  // namespace talus::bench
