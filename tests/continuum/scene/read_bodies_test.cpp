// Bodies and explosions in scene files: what is read, what is refused, and that sand keeps out of bodies.
#include <gmock/gmock.h>

#include <fstream>

#include "continuum/files/atomic_file.h"
#include "continuum/scene/scene.h"
#include "continuum/solids/body_step.h"
#include "tests/continuum/solids/mesh_files.h"
#include "tests/test_folder.h"

namespace talus {
namespace {

using Eigen::Vector3d;
using ::testing::AllOf;
using ::testing::HasSubstr;

const std::string column = read_file(TALUS_SOURCE_DIR "/tests/continuum/data/small_column.toml");

// The domain is 0.2 x 0.01 x 0.1 m with cells of 0.01 m, periodic along y, with a floor.
const std::string ball =
    "[[body]]\nname = 'ball'\nshape = { kind = 'sphere', centre_m = [0.1, 0.005, 0.06], radius_m = 0.005 }\n"
    "density_kg_m3 = 7800.0\nfriction_angle_deg = 45.0\n";

class ReadBodies : public ::testing::Test {
 protected:
  Scene read(const std::string& more) {
    std::ofstream(folder_.path() / "scene.toml") << column << more;
    return read_scene(folder_.path() / "scene.toml");
  }
  void expect_error(const std::string& more, const std::string& key, const std::string& why) {
    EXPECT_THAT(
        testing::input_error([&] { read(more); }),
        AllOf(HasSubstr("scene.toml:"), ::testing::ContainsRegex("key 'body.[0-9]+.." + key), HasSubstr(why)))
        << more;
  }
  static std::string with(const std::string& from, const std::string& to) {
    return testing::replaced(ball, from, to);
  }
  static std::string with_shape(const std::string& shape) {
    return with("{ kind = 'sphere', centre_m = [0.1, 0.005, 0.06], radius_m = 0.005 }", "{ " + shape + " }");
  }
  testing::TestFolder folder_;
};

TEST_F(ReadBodies, AFreeOneWithWhatIsUsual) {
  EXPECT_TRUE(read("").bodies.empty());
  const Body body = read(ball).bodies.at(0);
  EXPECT_EQ(body.name, "ball");
  EXPECT_NEAR(body.mass, 7800.0 * 4.0 / 3.0 * M_PI * 125e-9, 1e-12);
  EXPECT_NEAR(body.friction, 1.0, 1e-12);
  EXPECT_EQ(body.contact_friction, 0.5);
  EXPECT_EQ(body.restitution, 0.0);
  EXPECT_TRUE(std::holds_alternative<Free>(body.motion));
  EXPECT_EQ(body.twist.velocity, Vector3d::Zero());
  EXPECT_EQ(body.pose.position, Vector3d(0.1, 0.005, 0.06));
}

TEST_F(ReadBodies, AllKeys) {
  const Body body =
      read(with("friction_angle_deg = 45.0",
                "rough = true\ncontact_friction = 0.25\nrestitution = 0.75\n"
                "velocity_m_s = [1, 2, 3]\nangular_velocity_rad_s = [4, 5, 6]\nmotion = { kind = 'free' }"))
          .bodies.at(0);
  EXPECT_EQ(body.friction, as_rough_as_sand);
  EXPECT_EQ(body.contact_friction, 0.25);
  EXPECT_EQ(body.restitution, 0.75);
  EXPECT_EQ(body.twist.velocity, Vector3d(1, 2, 3));
  EXPECT_EQ(body.twist.angular_velocity, Vector3d(4, 5, 6));
}

TEST_F(ReadBodies, Hinges) {
  const std::string motion =
      "motion = { kind = 'hinge', pivot_m = [0.1, 0, 0.07], axis = [0, 2, 0], torque_n_m = 0.5 }\n";
  const Body body = read(ball + motion + "angular_velocity_rad_s = [0, 3, 0]\n").bodies.at(0);
  const Hinge& hinge = std::get<Hinge>(body.motion);
  EXPECT_EQ(hinge.axis, Vector3d::UnitY());
  EXPECT_EQ(hinge.torque, 0.5);
  EXPECT_LT((body.twist.velocity - Vector3d(-0.03, 0, 0)).norm(), 1e-15);  // 0.01 m below the pivot
  expect_error(ball + motion + "velocity_m_s = [1, 0, 0]\n", "velocity_m_s", "follows from the hinge");
  expect_error(ball + motion + "angular_velocity_rad_s = [0, 3, 1]\n", "angular_velocity_rad_s",
               "along the axis");
  expect_error(ball + testing::replaced(motion, "[0, 2, 0]", "[0, 0, 0]"), "motion.axis",
               "must be a direction");
  expect_error(ball + testing::replaced(motion, "torque_n_m", "torque_nm"), "motion.torque_nm",
               "did you mean 'torque_n_m'");
}

TEST_F(ReadBodies, PrescribedMotion) {
  const std::string motion =
      "motion = { kind = 'prescribed', velocity_m_s = [1, 0, 0], start_s = 0.5, end_s = 2.0 }\n";
  const Body body = read(ball + motion).bodies.at(0);
  const Prescribed& prescribed = std::get<Prescribed>(body.motion);
  EXPECT_EQ(prescribed.twist.velocity, Vector3d(1, 0, 0));
  EXPECT_EQ(prescribed.start, 0.5);
  EXPECT_EQ(prescribed.end, 2.0);
  EXPECT_EQ(body.twist.velocity, Vector3d::Zero());
  expect_error(ball + testing::replaced(motion, "2.0", "0.5"), "motion.end_s", "must come after start_s");
  expect_error(ball + motion + "velocity_m_s = [1, 0, 0]\n", "velocity_m_s", "is prescribed in motion");
  expect_error(ball + motion + "angular_velocity_rad_s = [1, 0, 0]\n", "angular_velocity_rad_s",
               "is prescribed in motion");
}

TEST_F(ReadBodies, RefusesWhatCannotBeMeant) {
  expect_error(ball + ball, "name", "is there twice");
  expect_error(with("'ball'", "'../ball'"), "name", "letters, digits");
  expect_error(with("7800.0", "0.0"), "density_kg_m3", "between 1 and 30000");
  expect_error(with("density_kg_m3 = 7800.0\n", ""), "density_kg_m3", "is missing");
  expect_error(with("friction_angle_deg = 45.0\n", ""), "friction_angle_deg", "is missing");
  expect_error(ball + "restitution = 1.5\n", "restitution", "between 0 and 1");
  expect_error(ball + "contact_friction = -0.1\n", "contact_friction", "between 0 and 10");
  expect_error(ball + "motion = { kind = 'fixed' }\n", "motion.kind", "one of: free, hinge, prescribed");
  expect_error(ball + "colour = 'red'\n", "colour", "is not a key");
  expect_error(with_shape("kind = 'plane', point_m = [0, 0, 0.05], normal = [0, 0, 1]"), "shape",
               "must be bounded");
  expect_error(with_shape("kind = 'sphere', centre_m = [0.1, 0.005, 0.06], radius_m = 0.005, hollow = true"),
               "shape", "must not be hollow");
}

TEST_F(ReadBodies, RefusesPlacesWhereNoneCanBe) {
  expect_error(with("0.06]", "0.098]"), "shape", "must lie inside the domain");
  EXPECT_EQ(read(with("0.005, 0.06]", "0.006, 0.06]")).bodies.size(), 1U);  // over the seam
  expect_error(with("radius_m = 0.005", "radius_m = 0.0051"), "shape", "no longer than the domain");
  expect_error(with("0.06], radius_m = 0.005", "0.06], radius_m = 0.001"), "shape", "is 0.002 m thick");
  const std::string block =
      "[[wall]]\nrough = true\nshape = { kind = 'box', lower_m = [0.104, -1, 0.05], upper_m = [0.15, 1, "
      "0.08] }\n";
  expect_error(block + ball, "shape", "must not lie in a [[wall]]");
  EXPECT_NO_THROW(read(testing::replaced(block, "0.104", "0.10499") + ball));
  EXPECT_NO_THROW(read(block + ball + "motion = { kind = 'prescribed' }\n"));
  expect_error(testing::replaced(block, "0.104", "0.05") + ball, "shape",
               "must not lie in a [[wall]]");  // deep inside
  const std::string other = with("'ball'", "'other'");
  expect_error(ball + testing::replaced(other, "0.1,", "0.109,"), "shape", "must not overlap body 'ball'");
  expect_error(ball + testing::replaced(other, "0.1,", "0.1001,"), "shape", "must not overlap body 'ball'");
  EXPECT_EQ(read(ball + testing::replaced(other, "0.1,", "0.11,")).bodies.size(), 2U);
  const std::string over_the_seam = testing::replaced(other, "0.1, 0.005, 0.06]", "0.1, 0.025, 0.06]");
  expect_error(ball + over_the_seam, "shape", "must not overlap body 'ball'");
}

TEST_F(ReadBodies, MeshesBesideTheSceneFile) {
  testing::write_binary_stl(folder_.path() / "cube.stl", testing::box_mesh({0, 0, 0}, {8, 8, 8}));
  const Body body =
      read(with_shape("kind = 'mesh', file = 'cube.stl', scale = 0.001, offset_m = [0.1, 0.001, 0.05]"))
          .bodies.at(0);
  EXPECT_NEAR(body.mass, 7800.0 * 0.008 * 0.008 * 0.008, 1e-8);
  EXPECT_LT((body.pose.position - Vector3d(0.104, 0.005, 0.054)).norm(), 1e-8);
  EXPECT_NEAR(signed_distance(body, {0.108, 0.005, 0.054}), 0.0, 1e-4);
}

TEST_F(ReadBodies, SandKeepsOutOfThem) {
  const std::string buried =
      "[[body]]\nname = 'cube'\nshape = { kind = 'box', lower_m = [0.01, 0.001, 0.01], upper_m = [0.03, "
      "0.009, 0.03] }\n"
      "density_kg_m3 = 2000.0\nrough = true\n";
  const Scene scene = read(buried);
  const State state = initial_state(scene);
  EXPECT_EQ(state.bodies.size(), 1U);
  EXPECT_TRUE(state.openings.any());
  const State without = initial_state(read(""));
  const double swelling = swellings(scene.bodies, scene.grid.spacing)[0];
  EXPECT_NEAR(swelling, 0.5 * least_thickness * 0.01 - 0.004, 1e-12);
  for (Eigen::Index p = 0; p < state.particles.count(); ++p)
    EXPECT_GE(signed_distance(scene.bodies[0], state.particles.positions.col(p)), swelling);
  const double removed = static_cast<double>(without.particles.count() - state.particles.count());
  EXPECT_NEAR(removed, 8.0 * 2.5 * 2.5, 6.0);  // 2 x 2 cells, and the quarter of one that it is swollen by
}

TEST_F(ReadBodies, Explosions) {
  const std::string blast =
      "[[explosion]]\ntime_s = 0.02\ncentre_m = [0.02, 0.005, 0.01]\nradius_m = 0.015\nspeed_m_s = 4.0\n";
  EXPECT_TRUE(read("").explosions.empty());
  const Explosion explosion = read(blast).explosions.at(0);
  EXPECT_EQ(explosion.time, 0.02);
  EXPECT_EQ(explosion.centre, Vector3d(0.02, 0.005, 0.01));
  EXPECT_EQ(explosion.radius, 0.015);
  EXPECT_EQ(explosion.speed, 4.0);
  const auto refused = [&](const std::string& from, const std::string& to, const std::string& why) {
    EXPECT_THAT(testing::input_error([&] { read(testing::replaced(blast, from, to)); }), HasSubstr(why));
  };
  refused("0.02\n", "-0.1\n", "explosion[0].time_s' = -0.1: must be between 1e-09 and");
  refused("0.015", "0.0", "explosion[0].radius_m' = 0");
  refused("speed_m_s = 4.0\n", "", "explosion[0].speed_m_s': is missing");
  refused("speed_m_s = 4.0\n", "speed_m_s = 4.0\nsped = 1\n", "is not a key");
}

}  // namespace
}  // namespace talus
