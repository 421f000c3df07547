// Scene files: what is read, and what is refused.
#include "continuum/scene/scene.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <fstream>

#include "tests/test_folder.h"

#include "continuum/files/atomic_file.h"
#include "continuum/files/checked_table.h"

namespace talus {
namespace {

using ::testing::HasSubstr;

const std::string good_scene = read_file(TALUS_SOURCE_DIR "/tests/continuum/data/small_column.toml");

Scene read(const std::string& text) {
  const testing::TestFolder folder;
  const auto file = folder.path() / "scene.toml";
  std::ofstream(file) << text;
  return read_scene(file, {.memory = 1e12});  // whatever this machine has
}

std::string with(const std::string& from, const std::string& to) {
  return testing::replaced(good_scene, from, to);
}

void expect_error(const std::string& text, const std::string& part) {
  EXPECT_THAT(testing::input_error([&] { read(text); }), HasSubstr(part));
}

TEST(Scene, ReadsAGoodOne) {
  const Scene scene = read(good_scene);
  EXPECT_EQ(scene.grid.cells, Eigen::Vector3i(20, 1, 10));
  EXPECT_TRUE(scene.grid.periodic[1]);
  EXPECT_NEAR(scene.sides[2][0].friction, 1.0, 1e-12);
  EXPECT_EQ(scene.sides[0][0].friction, 0.0);
  EXPECT_FALSE(scene.sides[0][1].wall);
  EXPECT_NEAR(scene.materials[0].friction, std::tan(M_PI / 6), 1e-12);
}

TEST(Scene, FillsItsBoxesWithTheRightMassAndTheSeedDecides) {
  const Scene scene = read(good_scene);
  const State a = initial_state(scene), b = initial_state(scene);
  EXPECT_EQ(a.particles.count(), 5 * 1 * 5 * 8);
  EXPECT_NEAR(a.particles.masses.sum(), 0.05 * 0.01 * 0.05 * 0.6 * 2500.0, 1e-12);
  EXPECT_EQ(a.particles.positions, b.particles.positions);
  const State c = initial_state(read(with("seed = 3", "seed = 4")));
  EXPECT_NE(a.particles.positions, c.particles.positions);
  EXPECT_GE(c.particles.positions.minCoeff(), 0.0);
  EXPECT_LE(c.particles.positions.row(2).maxCoeff(), 0.05);
}

TEST(Scene, ChoosesTheScheme) {
  const auto scheme = [](const std::string& solver) { return read(good_scene + solver).settings.scheme; };
  EXPECT_EQ(scheme(""), Scheme::consistent);
  EXPECT_EQ(scheme("[solver]\niterations = 2\n"), Scheme::consistent);
  EXPECT_EQ(scheme("[solver]\nscheme = \"consistent\"\n"), Scheme::consistent);
  EXPECT_EQ(scheme("[solver]\nscheme = \"paper\"\n"), Scheme::paper);
  expect_error(good_scene + "[solver]\nscheme = \"papre\"\n", "paper");
}

TEST(Scene, CourantFactorScalesBothLimitsOfTheTimeStep) {
  const auto settings = [](const std::string& solver) { return read(good_scene + solver).settings; };
  const StepSettings whole = settings("[solver]\ncourant_factor = 1.0\n"),
                     half = settings("[solver]\ncourant_factor = 0.5\n");
  EXPECT_EQ(whole.courant, StepSettings{}.courant);
  EXPECT_EQ(whole.gravity_courant, StepSettings{}.gravity_courant);
  EXPECT_EQ(half.courant, 0.5 * whole.courant);
  EXPECT_EQ(half.gravity_courant, 0.5 * whole.gravity_courant);
  expect_error(good_scene + "[solver]\ncourant_factor = 0.0\n", "between 0.001 and 1");
  expect_error(good_scene + "[solver]\ncourant_factor = 1.5\n", "between 0.001 and 1");
}

TEST(Scene, SolverHasTwoTolerances) {
  const ProjectionSettings given =
      read(good_scene + "[solver]\ntolerance = 0.02\nrelative_tolerance = 0.003\n").settings.projection;
  EXPECT_EQ(given.tolerance, 0.02);
  EXPECT_EQ(given.relative_tolerance, 0.003);
  EXPECT_EQ(read(good_scene).settings.projection.relative_tolerance, ProjectionSettings{}.relative_tolerance);
  expect_error(good_scene + "[solver]\nrelative_tolerance = 2.0\n", "between 0 and 1");
}

TEST(Scene, IsBrokenOnPurposeWhereItSaysSo) {
  const Scene sound = read(good_scene + "[solver]\niterations = 2\n"),
              pulls = read(good_scene + "[solver]\nbroken = \"pressure_pulls\"\n"),
              overfull = read(good_scene + "[solver]\nbroken = \"no_density_correction\"\n");
  EXPECT_EQ(sound.broken, "");
  EXPECT_FALSE(sound.settings.projection.pressure_pulls);
  EXPECT_EQ(sound.settings.packing_tolerance, StepSettings{}.packing_tolerance);
  EXPECT_EQ(pulls.broken, "pressure_pulls");
  EXPECT_TRUE(pulls.settings.projection.pressure_pulls);
  EXPECT_EQ(pulls.settings.packing_tolerance, StepSettings{}.packing_tolerance);
  EXPECT_EQ(overfull.broken, "no_density_correction");
  EXPECT_FALSE(overfull.settings.projection.pressure_pulls);
  EXPECT_EQ(overfull.settings.packing_tolerance, std::numeric_limits<double>::infinity());
  expect_error(good_scene + "[solver]\nbroken = \"pressure_pull\"\n", "no_density_correction");
  expect_error(good_scene + "[solver]\nbroken = false\n", "broken");
  expect_error(good_scene + "[solver]\nscheme = \"paper\"\nbroken = \"pressure_pulls\"\n",
               "breaks the consistent scheme only");
}

TEST(Scene, RefusesWhatCannotBeMeant) {
  expect_error(with("friction_angle_deg = 30.0", "friction_angle_deg = 300.0"), "between 0 and 60");
  expect_error(with("max_volume_fraction = 0.6", "max_volume_fraction = 60"), "between 0.1 and 0.8");
  expect_error(with("size_m = [0.2, 0.01, 0.1]", "size_m = [0.205, 0.01, 0.1]"), "whole number of cells");
  expect_error(with("size_m = [0.2, 0.01, 0.1]", "size_m = [1e6, 1e3, 1e6]"), "at most");
  expect_error(with("upper_m = [0.05, 0.01, 0.05]", "upper_m = [0.5, 0.01, 0.05]"), "inside the domain");
  expect_error(with("material = \"sand\"", "material = \"gravel\""), "must be one of: sand");
  expect_error(with("periodic = [\"y\"]", "periodic = [\"z\"]"), "a periodic axis has no sides");
  expect_error(with("per_cell_axis = 2", "per_cell_axis = 1"), "between 2 and 8");
  expect_error(with("per_cell_axis = 2", "per_cell = [2, 0, 2]"), "between 1 and 8");
  expect_error(with("per_cell_axis = 2", "per_cell = [2, 2]"), "three whole numbers");
  expect_error(with("per_cell_axis = 2", "per_cell_axis = 2\nper_cell = [2, 1, 2]"), "give one of the two");
  expect_error(with("frame_interval_s = 0.01", "frame_interval_s = 1e-9"), "more than 1e+06 frames");
  expect_error(with("seed = 3", "sead = 3"), "is missing");
  expect_error(with("jitter = 0.5", "jitter = 0.5\njiter = 1"), "did you mean 'jitter'");
}

TEST(Scene, HasRenderPointsWhereItAsksForThem) {
  EXPECT_EQ(read(good_scene).render_points_per_particle, 0);
  EXPECT_FALSE(initial_state(read(good_scene)).render_points.wanted());
  const Scene scene = read(good_scene + "[render_points]\nper_particle = 12\n");
  EXPECT_EQ(scene.render_points_per_particle, 12);
  const State state = initial_state(scene);
  EXPECT_GT(state.render_points.count(), 0);
  EXPECT_FALSE(state.particles.has_origins());
  for (std::size_t p = 0; p < state.render_points.hidden.size(); ++p) {
    const std::int64_t points = state.render_points.first[p + 1] - state.render_points.first[p];
    EXPECT_EQ(points, state.render_points.hidden[p] ? 0 : 12);
  }
  expect_error(good_scene + "[render_points]\nper_particle = -1\n", "between 0 and 1000");
  // What counts is all shapes together.
  const std::string sand = "[[sand]]\nmaterial = \"sand\"\nshape = { kind = \"box\", ",
                    left = sand + "lower_m = [0.0, 0.0, 0.0], upper_m = [10.0, 0.01, 8.0] }\n",
                    right = sand + "lower_m = [10.0, 0.0, 0.0], upper_m = [20.0, 0.01, 8.0] }\n",
                    wide = with("size_m = [0.2, 0.01, 0.1]", "size_m = [21.0, 0.01, 10.0]"),
                    points = "[render_points]\nper_particle = 100\n";  // of 6.4 million particles a shape
  EXPECT_EQ(read(wide + left + points).fillings.size(), 2u);
  expect_error(wide + left + right + points, "gives 1.28e+09 points; at most 1e+09");
  expect_error(good_scene + "[render_points]\nper_partikel = 1\n", "per_particle");
  expect_error(good_scene + "[render_points]\nper_particle = 1\ncolour = 2\n", "colour");
}

const std::string ramp =
    "[[wall]]\nshape = { kind = \"plane\", point_m = [0.1, 0.0, 0.0], normal = [-1.0, 0.0, 1.0] }\n"
    "friction_angle_deg = 45.0\n";

TEST(Scene, ReadsWallsAndGates) {
  EXPECT_TRUE(read(good_scene).walls.empty());
  const Scene scene = read(
      good_scene + ramp +
      "[[wall]]\nshape = { kind = \"sphere\", centre_m = [0.1, 0.005, 0.0], radius_m = 0.02 }\nrough = true\n"
      "opens_at_s = 0.25\n");
  ASSERT_EQ(scene.walls.size(), 2u);
  EXPECT_NEAR(scene.walls[0].friction, 1.0, 1e-12);
  EXPECT_TRUE(scene.walls[0].stands_at(1e9));
  EXPECT_NEAR(signed_distance(scene.walls[0].shape, {0.1, 0.0, 0.02}), 0.02 / std::sqrt(2.0), 1e-12);
  EXPECT_EQ(scene.walls[1].friction, as_rough_as_sand);
  EXPECT_EQ(scene.walls[1].opens_at, 0.25);
  EXPECT_TRUE(initial_state(scene).openings.any());

  expect_error(good_scene + testing::replaced(ramp, "45.0", "75.0"), "between 0 and 60");
  expect_error(good_scene + testing::replaced(ramp, "friction_angle_deg = 45.0\n", ""),
               "friction_angle_deg': is missing");
  expect_error(good_scene + ramp + "rough = true\n", "what is rough has the sand's");
  expect_error(good_scene + ramp + "opens_at_s = 0.0\n", "opens_at_s' = 0: must be greater than 0");
  expect_error(good_scene + ramp + "open_at_s = 1.0\n", "did you mean 'opens_at_s'");
  expect_error(good_scene + "[[wall]]\nrough = true\n", "shape");
}

TEST(Scene, RoughSidesOfTheDomain) {
  const Scene scene = read(with("z_lower = { kind = \"wall\", friction_angle_deg = 45.0 }",
                                "z_lower = { kind = \"wall\", rough = true }"));
  EXPECT_TRUE(scene.sides[2][0].wall);
  EXPECT_EQ(scene.sides[2][0].friction, as_rough_as_sand);
}

const std::string inlet =
    "[[source]]\nmaterial = \"sand\"\noutline = \"rectangle\"\nlower_m = [0.0, 0.0, 0.1]\n"
    "upper_m = [0.05, 0.01, 0.1]\nvelocity_m_s = [0.0, 0.0, -0.5]\n";

TEST(Scene, ReadsSources) {
  EXPECT_TRUE(read(good_scene).sources.empty());
  const Source plain = read(good_scene + inlet).sources.at(0);
  EXPECT_EQ(plain.material, 0);
  EXPECT_EQ(plain.normal(), 2);
  EXPECT_EQ(plain.lower, Eigen::Vector3d(0.0, 0.0, 0.1));
  EXPECT_EQ(plain.upper, Eigen::Vector3d(0.05, 0.01, 0.1));
  EXPECT_EQ(plain.velocity, Eigen::Vector3d(0.0, 0.0, -0.5));
  EXPECT_FALSE(plain.round);
  EXPECT_EQ(plain.fill, 1.0);
  EXPECT_EQ(plain.start, 0.0);
  EXPECT_EQ(plain.end, std::numeric_limits<double>::infinity());
  EXPECT_NEAR(plain.spacing, 0.005, 1e-15);
  EXPECT_EQ(plain.layers, 0);
  const Source full = read(good_scene + testing::replaced(inlet, "rectangle", "ellipse") +
                           "fill = 0.5\nstart_s = 0.1\nend_s = 0.2\n")
                          .sources.at(0);
  EXPECT_TRUE(full.round);
  EXPECT_EQ(full.fill, 0.5);
  EXPECT_EQ(full.start, 0.1);
  EXPECT_EQ(full.end, 0.2);
}

TEST(Scene, RefusesSourcesThatCannotBeMeant) {
  const auto refused = [](const std::string& from, const std::string& to, const std::string& why) {
    expect_error(good_scene + testing::replaced(inlet, from, to), why);
  };
  refused("upper_m = [0.05, 0.01, 0.1]", "upper_m = [0.05, 0.01, 0.11]", "must equal lower_m along one axis");
  refused("upper_m = [0.05, 0.01, 0.1]", "upper_m = [0.05, 0.0, 0.1]", "must equal lower_m along one axis");
  refused("upper_m = [0.05, 0.01, 0.1]", "upper_m = [-0.05, 0.01, 0.1]", "lie above it along the others");
  refused("upper_m = [0.05, 0.01, 0.1]", "upper_m = [0.5, 0.01, 0.1]", "must lie inside the domain");
  refused("[0.0, 0.0, -0.5]", "[0.5, 0.0, 0.0]", "must not be 0 along the inlet's normal");
  refused("\"rectangle\"", "\"square\"", "rectangle");
  refused("outline = \"rectangle\"\n", "", "outline': is missing");
  refused("material = \"sand\"", "material = \"salt\"", "did you mean 'sand'?");
  expect_error(good_scene + inlet + "fill = 1.2\n", "between 0.01 and 1");
  expect_error(good_scene + inlet + "fill = 0.0\n", "between 0.01 and 1");
  expect_error(good_scene + inlet + "start_s = -1.0\n", "start_s");
  expect_error(good_scene + inlet + "start_s = 2.0\nend_s = 2.0\n", "must come after start_s");
  expect_error(good_scene + inlet + "stop_s = 2.0\n", "stop_s");
}

std::string without_sand() {
  const auto from = good_scene.find("[[sand]]"), to = good_scene.find("[particles]");
  return std::string(good_scene).erase(from, to - from);
}

TEST(Scene, NeedsSandOrASourceOfIt) {
  expect_error(without_sand(), "there is neither [[sand]] nor a [[source]] of it");
  EXPECT_EQ(initial_state(read(without_sand() + inlet)).particles.count(), 0);
}

TEST(Scene, ReadsRateDependence) {
  const std::string rate =
      "friction_angle_deg = 30.0\nrate_dependence = { fast_friction_angle_deg = 40.0, inertial_number = 0.3, "
      "grain_diameter_m = 0.001 }";
  const auto dependent = [&](const std::string& from, const std::string& to) {
    return with("friction_angle_deg = 30.0", testing::replaced(rate, from, to));
  };
  const Material sand = read(dependent("40.0", "40.0")).materials[0];
  EXPECT_NEAR(sand.rate.fast_friction, std::tan(40.0 * M_PI / 180.0), 1e-12);
  EXPECT_EQ(sand.rate.inertial_number, 0.3);
  EXPECT_EQ(sand.rate.grain_diameter, 0.001);
  EXPECT_EQ(read(good_scene).materials[0].rate.inertial_number, 0.0);
  expect_error(dependent("40.0", "29.0"), "fast_friction_angle_deg' = 29: must be between 30 and 60");
  expect_error(dependent("40.0", "61.0"), "and 60");
  expect_error(dependent("inertial_number = 0.3", "inertial_number = 0.0"), "between 1e-06 and 100");
  expect_error(dependent("grain_diameter_m = 0.001", "grain_diameter_m = 0.0"), "between 1e-07 and 10");
  expect_error(dependent(", inertial_number = 0.3", ""), "inertial_number': is missing");
  // The same angle is friction that does not depend on the rate.
  for (int angle = 20; angle < 50; ++angle)
    EXPECT_NO_THROW(read(with("friction_angle_deg = 30.0",
                              testing::replaced(testing::replaced(rate, "30.0", std::to_string(angle)),
                                                "40.0", std::to_string(angle)))));
}

TEST(Scene, ChoosesTransferAndReshaping) {
  const auto settings = [](const std::string& more) {
    return read(with("jitter = 0.5", "jitter = 0.5\n" + more)).settings;
  };
  EXPECT_EQ(settings("").transfer, Transfer::flip);
  EXPECT_TRUE(settings("").reshape);
  EXPECT_EQ(settings("transfer = \"flip\"").transfer, Transfer::flip);
  EXPECT_EQ(settings("transfer = \"apic\"").transfer, Transfer::apic);
  EXPECT_FALSE(settings("split_and_merge = false").reshape);
  expect_error(with("jitter = 0.5", "jitter = 0.5\ntransfer = \"pic\""), "apic");
  expect_error(with("jitter = 0.5", "jitter = 0.5\nsplit_and_merge = 1"), "split_and_merge");
}

TEST(Scene, MaterialsGoByTheirNames) {
  const std::string second =
      "[[material]]\nname = \"salt\"\ngrain_density_kg_m3 = 1000.0\nmax_volume_fraction = 0.5\n"
      "friction_angle_deg = 20.0\n[[sand]]\nmaterial = \"salt\"\nshape = { kind = \"box\", lower_m = [0.1, "
      "0.0, 0.0], "
      "upper_m = [0.12, 0.01, 0.03] }\nvelocity_m_s = [1.0, 0.0, -2.0]\n";
  const Scene scene = read(good_scene + second + testing::replaced(inlet, "\"sand\"", "\"salt\""));
  ASSERT_EQ(scene.materials.size(), 2u);
  EXPECT_EQ(scene.fillings[0].material, 0u);
  EXPECT_EQ(scene.fillings[1].material, 1u);
  EXPECT_EQ(scene.sources[0].material, 1);
  const Particles particles = initial_state(scene).particles;
  double salt = 0.0;
  for (Eigen::Index p = 0; p < particles.count(); ++p) {
    const bool is_salt = particles.materials[static_cast<std::size_t>(p)] == 1;
    EXPECT_EQ(is_salt, particles.positions(0, p) > 0.08);
    EXPECT_EQ(particles.velocities.col(p),
              is_salt ? Eigen::Vector3d(1.0, 0.0, -2.0) : Eigen::Vector3d::Zero());
    salt += is_salt ? particles.masses[p] : 0.0;
  }
  EXPECT_NEAR(salt, 500.0 * 0.02 * 0.01 * 0.03, 1e-12);
}

TEST(Scene, SandMustLieInsideTheDomain) {
  const auto shaped = [](const std::string& shape) {
    return with("shape = { kind = \"box\", lower_m = [0.0, 0.0, 0.0], upper_m = [0.05, 0.01, 0.05] }",
                "shape = " + shape);
  };
  expect_error(shaped("{ kind = \"sphere\", centre_m = [0.05, 0.005, 0.05], radius_m = 0.006 }"),
               "inside the domain");
  EXPECT_NO_THROW(read(shaped("{ kind = \"sphere\", centre_m = [0.05, 0.005, 0.05], radius_m = 0.005 }")));
  expect_error(shaped("{ kind = \"plane\", point_m = [0, 0, 0.05], normal = [0, 0, 1] }"),
               "inside the domain");
  expect_error(
      shaped("{ kind = \"box\", lower_m = [0.0, 0.0, 0.0], upper_m = [0.05, 0.01, 0.05], hollow = true }"),
      "inside the domain");
}

TEST(Scene, SandLeavesOutWhatIsInWalls) {
  // A container that is smaller than the filling, and a ball in it.
  const Scene scene = read(good_scene +
                           "[[wall]]\nrough = true\nshape = { kind = \"box\", lower_m = [0.01, -1.0, 0.01], "
                           "upper_m = [0.04, 1.0, 0.2], "
                           "hollow = true }\n"
                           "[[wall]]\nrough = true\nshape = { kind = \"sphere\", centre_m = [0.025, 0.005, "
                           "0.03], radius_m = 0.01 }\n");
  const Particles particles = initial_state(scene).particles;
  EXPECT_GE(particles.positions.row(0).minCoeff(), 0.01);
  EXPECT_LE(particles.positions.row(0).maxCoeff(), 0.04);
  EXPECT_GE(particles.positions.row(2).minCoeff(), 0.01);
  EXPECT_GE((particles.positions.colwise() - Eigen::Vector3d(0.025, 0.005, 0.03)).colwise().norm().minCoeff(),
            0.01);
  // 3 x 4 cells of 8 particles less the ball's, give or take those that jitter moved across.
  EXPECT_NEAR(static_cast<double>(particles.count()), 96.0 - 8.0 * 2.9, 10.0);
}

TEST(Scene, OursCanAllBeRead) {
  int scenes = 0;
  for (const auto& entry : std::filesystem::directory_iterator(TALUS_SOURCE_DIR "/continuum/scenes")) {
    if (entry.path().extension() != ".toml") continue;
    EXPECT_NO_THROW(read_scene(entry.path())) << entry.path();
    ++scenes;
  }
  EXPECT_GE(scenes, 4);
}

TEST(Scene, TellsWhatReadsFilesThatAreNoScenes) {
  expect_error(read_file(TALUS_SOURCE_DIR "/dem_cases/column_collapse/case.toml"),
               "talus-dem check reads it");
  expect_error(read_file(TALUS_SOURCE_DIR "/validation/suites/smoke.toml"), "talus-validate list reads it");
}

TEST(Scene, RefusesWallsThatTheGridCannotSeeOrThatDifferAtPeriodicEnds) {
  const auto walled = [&](const std::string& shape) {
    return testing::replaced(good_scene, "[particles]",
                             "[[wall]]\nrough = true\nshape = " + shape + "\n[particles]");
  };
  expect_error(walled("{ kind = \"box\", lower_m = [-1.0, -1.0, 0.081], upper_m = [1.0, 1.0, 0.089] }"),
               "is thinner than a cell");
  // Plates that hold neither a cell's corner nor its middle: across x, across z, and as thin as 1/50 of a cell.
  for (const char* plate : {"lower_m = [0.1002, -1.0, -1.0], upper_m = [0.1048, 1.0, 1.0]",
                            "lower_m = [0.1006, -1.0, -1.0], upper_m = [0.1096, 1.0, 1.0]",
                            "lower_m = [-1.0, -1.0, 0.0851], upper_m = [1.0, 1.0, 0.0898]",
                            "lower_m = [0.1003, -1.0, -1.0], upper_m = [0.1005, 1.0, 1.0]"})
    expect_error(walled(fmt::format("{{ kind = \"box\", {} }}", plate)), "is thinner than a cell");
  // Ends and edges of what is thick may lie anywhere.
  for (const char* block : {"lower_m = [0.1002, -1.0, -1.0], upper_m = [0.1448, 1.0, 0.0556]",
                            "lower_m = [0.1056, -1.0, 0.0556], upper_m = [0.1456, 1.0, 0.0956]"})
    EXPECT_NO_THROW(read(walled(fmt::format("{{ kind = \"box\", {} }}", block)))) << block;
  EXPECT_NO_THROW(
      read(walled("{ kind = \"box\", lower_m = [-1.0, -1.0, 0.08], upper_m = [1.0, 1.0, 0.09] }")));
  expect_error(walled("{ kind = \"sphere\", centre_m = [0.15, 0.0, 0.05], radius_m = 0.02 }"),
               "the same at both ends of the periodic y axis");
}

TEST(Scene, RefusesSandThatCannotBeMeant) {
  const std::string again =
      "[[sand]]\nmaterial = \"sand\"\nshape = { kind = \"box\", lower_m = [0.04, 0.0, 0.0], upper_m = ";
  const auto state_of = [&](const std::string& text) { initial_state(read(text)); };
  EXPECT_THAT(
      testing::input_error([&] {
        state_of(testing::replaced(good_scene, "[particles]", again + "[0.1, 0.01, 0.05] }\n[particles]"));
      }),
      HasSubstr("two [[sand]] shapes overlap"));
  EXPECT_THAT(testing::input_error([&] {
                state_of(testing::replaced(
                    good_scene, "[particles]",
                    "[[wall]]\nrough = true\nshape = { kind = \"plane\", point_m = [0.0, 0.0, 0.07], "
                    "normal = [0.0, 0.0, 1.0] }\n[particles]"));
              }),
              HasSubstr("holds no particle"));
  expect_error(
      testing::replaced(good_scene, "[[sand]]",
                        "[[material]]\nname = \"sand\"\ngrain_density_kg_m3 = 2500.0\nmax_volume_fraction = "
                        "0.6\nfriction_angle_deg = 20.0\n[[sand]]"),
      "is there twice");
}

}  // namespace
}  // namespace talus
