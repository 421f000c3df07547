// What the two codes are told, read back from their input files; no code is run.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "dem_cases/liggghts/liggghts.h"
#include "dem_cases/yade/yade.h"
#include "tests/dem_cases/case_files.h"

namespace talus::dem {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class Decks : public ::testing::Test {
 protected:
  Decks() : column_(read_case(column_collapse_file)), packing_(make_packing(column_, 1)) { write(); }

  void write() {
    liggghts::write_input(column_, packing_, folder_.path() / "liggghts");
    yade::write_input(column_, packing_, folder_.path() / "yade");
    deck_ = read_file(folder_.path() / "liggghts/in.liggghts");
    parameters_ = nlohmann::json::parse(read_file(folder_.path() / "yade/parameters.json"));
  }

  std::string script() const { return read_file(folder_.path() / "yade/gravity_flow.py"); }

  TestFolder folder_;
  Case column_;
  Packing packing_;
  std::string deck_;
  nlohmann::json parameters_;
};

// Positions, velocities and radii come back to the last bit from both.
TEST_F(Decks, BothHoldTheIdenticalSpheres) {
  std::istringstream spheres(read_file(folder_.path() / "yade/packing.txt"));
  std::istringstream atoms(read_file(folder_.path() / "liggghts/packing.data"));
  std::string line;
  std::getline(spheres, line);
  while (line != "Atoms") ASSERT_TRUE(std::getline(atoms, line));
  std::getline(atoms, line);
  for (Eigen::Index i = 0; i < packing_.count(); ++i) {
    Eigen::Vector3d position, velocity;
    double radius = 0.0;
    for (double& value : position) spheres >> value;
    for (double& value : velocity) spheres >> value;
    ASSERT_TRUE(spheres >> radius);
    EXPECT_EQ(position, packing_.positions.col(i));
    EXPECT_EQ(velocity, packing_.velocities.col(i));
    EXPECT_EQ(radius, packing_.radii[i]);

    long id = 0, type = 0;
    double diameter = 0.0, density = 0.0;
    ASSERT_TRUE(atoms >> id >> type >> diameter >> density);
    for (double& value : position) ASSERT_TRUE(atoms >> value);
    EXPECT_EQ(id, i + 1);
    EXPECT_EQ(type, i < packing_.fixed_count ? 2 : 1);
    EXPECT_EQ(0.5 * diameter, packing_.radii[i]);
    EXPECT_EQ(density, column_.grains.density);
    EXPECT_EQ(position, packing_.positions.col(i));
  }
  while (line != "Velocities") ASSERT_TRUE(std::getline(atoms, line));
  for (Eigen::Index i = 0; i < packing_.count(); ++i) {
    long id = 0;
    Eigen::Vector3d velocity, spin;
    ASSERT_TRUE(atoms >> id);
    for (double& value : velocity) ASSERT_TRUE(atoms >> value);
    for (double& value : spin) ASSERT_TRUE(atoms >> value);
    EXPECT_EQ(velocity, packing_.velocities.col(i));
  }
}

// Rows and columns: grain, fixed grain, wall and gate, flat floor.
TEST_F(Decks, LiggghtsHasTheContactLaw) {
  EXPECT_THAT(deck_, HasSubstr("coefficientRestitution peratomtypepair 4 0.5 0.5 0.5 0.5 "));
  EXPECT_THAT(
      deck_,
      HasSubstr("coefficientFriction peratomtypepair 4 0.5 0.5 0 0.5 0.5 0.5 0 0.5 0 0 0 0 0.5 0.5 0 0.5\n"));
  EXPECT_THAT(deck_,
              HasSubstr("coefficientRollingFriction peratomtypepair 4 0.2 0.2 0.1 0.1 0.2 0.2 0.1 0.1 "));
  EXPECT_THAT(deck_, HasSubstr("youngsModulus peratomtype 5000000 5000000 5000000 5000000\n"));
  EXPECT_THAT(deck_, HasSubstr("gravity 9.8100000000000005 vector 0 0 -1\n"));
  EXPECT_THAT(deck_, HasSubstr("run 10000\nunfix gate\n"));
  EXPECT_THAT(deck_, HasSubstr("run 20000\n"));
  EXPECT_THAT(deck_, Not(HasSubstr("zplane")));
}

// One material more, that of the ball, with the grains' law; it joins the grains at the release.
TEST_F(Decks, BothAreToldOfAFallingSphere) {
  EXPECT_THAT(deck_, Not(HasSubstr("create_atoms")));
  EXPECT_FALSE(parameters_.contains("sphere"));
  EXPECT_EQ(script(), read_file(TALUS_SOURCE_DIR "/dem_cases/yade/gravity_flow.py"));
  column_ = read_case(TALUS_SOURCE_DIR "/tests/dem_cases/data/tiny_impact.toml");
  packing_ = make_packing(column_, 1);
  write();
  EXPECT_THAT(deck_, HasSubstr("coefficientRestitution peratomtypepair 5 0.5 0.5 0.5 0.5 0.5 "));
  EXPECT_THAT(deck_, HasSubstr("coefficientFriction peratomtypepair 5 0.5 0.5 0 0.5 0.5 "));
  EXPECT_THAT(deck_, HasSubstr("0.5 0.5 0 0.5 0.5\nfix rolling"));  // the ball's row
  EXPECT_THAT(deck_, HasSubstr("create_atoms 5 single 0 0 0.034"));
  EXPECT_THAT(deck_, HasSubstr("set type 5 diameter 0.012 density 7800 vz -0.5770"));
  EXPECT_THAT(deck_, HasSubstr("dump grains bed custom"));
  EXPECT_LT(deck_.find("reset_timestep 0"), deck_.find("create_atoms"));
  EXPECT_NEAR(parameters_["sphere"]["speed_m_s"], 0.5771, 1e-4);
  EXPECT_EQ(parameters_["sphere"]["centre_m"][2], 0.034);
  EXPECT_LT(script().find("erase(body)"), script().find("'ball'"));
  EXPECT_LT(script().find("'ball'"), script().find("with open('grains.dump'"));
}

TEST_F(Decks, YadeHasTheContactLaw) {
  EXPECT_EQ(parameters_["restitution"], 0.5);
  EXPECT_EQ(parameters_["friction"], 0.5);
  EXPECT_EQ(parameters_["wall_friction"], 0.0);
  EXPECT_EQ(parameters_["rolling_resistance"], 0.1);                  // mu_r / 2
  EXPECT_NEAR(parameters_["rolling_stiffness_n_m"], 2.2e-4, 0.3e-4);  // worked by hand from k_t R*^2
  EXPECT_EQ(parameters_["youngs_modulus_pa"], 5e6);
  EXPECT_EQ(parameters_["settle_steps"], 10000);
  EXPECT_EQ(parameters_["steps_per_snapshot"], 200);
  EXPECT_EQ(parameters_["snapshot_count"], 100);
  EXPECT_EQ(parameters_["fixed_count"], packing_.fixed_count);
}

// A limit of 0 means to YADE that there is no limit: the spring itself must go.
TEST_F(Decks, NoRollingFrictionMeansNoRollingSpringInYade) {
  column_.contact.rolling_friction = 0.0;
  write();
  EXPECT_EQ(parameters_["rolling_resistance"], 0.0);
  EXPECT_EQ(parameters_["rolling_stiffness_n_m"], 0.0);
}

TEST_F(Decks, FlatFloorIsAPlaneInBoth) {
  column_geometry(column_).rough_floor = false;
  packing_ = make_packing(column_, 1);
  write();
  EXPECT_THAT(deck_, HasSubstr("type 4 zplane 0 "));
  const auto& plane = parameters_["planes"].back();
  EXPECT_EQ(plane["axis"], 2);
  EXPECT_EQ(plane["at_m"], 0.0);
  EXPECT_EQ(plane["material"], "grain");
}

TEST_F(Decks, WritingAgainRemovesAnEarlierRun) {
  for (const char* file :
       {"liggghts/grains.dump", "liggghts/log.liggghts", "yade/grains.dump", "yade/progress.txt"}) {
    write_file_atomically(folder_.path() / file, "old");
  }
  write();
  for (const char* file :
       {"liggghts/grains.dump", "liggghts/log.liggghts", "yade/grains.dump", "yade/progress.txt"}) {
    EXPECT_FALSE(std::filesystem::exists(folder_.path() / file)) << file;
  }
}

TEST_F(Decks, UnwritableFolderIsAClearError) {
  EXPECT_THAT(input_error([&] { liggghts::write_input(column_, packing_, "/proc/talus"); }),
              HasSubstr("/proc/talus"));
  EXPECT_THAT(input_error([&] { yade::write_input(column_, packing_, "/proc/talus"); }),
              HasSubstr("/proc/talus"));
}

}  // namespace
}  // namespace talus::dem
