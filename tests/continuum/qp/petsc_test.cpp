// MPRGP against PETSc's gpcg and bntr, on problems of the solver itself as they are recorded.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include <Eigen/Dense>
#include <nlohmann/json.hpp>

#include "continuum/qp/problem_file.h"
#include "continuum/stress/assemble.h"
#include "tests/continuum/qp/collapse_problems.h"
#include "tests/program.h"

namespace talus {
namespace {

using testing::run_program;
using testing::TestFolder;

constexpr double minimiser_agreement = 1e-8;   // of the largest value
constexpr double objective_agreement = 1e-10;  // relative

/// As tight as round-off allows.
BoundQp tightened(BoundQp problem) {
  problem.settings = {1e-13 * problem.linear.abs().maxCoeff(), 100000};
  return problem;
}

struct OracleSolution {
  std::string method;
  Eigen::ArrayXd x;
  double objective;
};

/// Through the file, as a user would.
std::vector<OracleSolution> solved_by_petsc(const BoundQp& problem) {
  const TestFolder folder;
  const std::string dump = (folder.path() / "problem.h5").string(),
                    answer = (folder.path() / "answer.json").string();
  write_problem(dump, problem, "petsc_test");
  const auto run = run_program(
      {"/usr/bin/python3", TALUS_SOURCE_DIR "/tests/continuum/qp/petsc_oracle.py", answer, dump}, 60.0);
  if (run.exit_code != 0) throw std::runtime_error(run.output);
  const nlohmann::json methods = nlohmann::json::parse(read_file(answer)).at(dump);
  std::vector<OracleSolution> solutions;
  for (const auto& [method, solution] : methods.items()) {
    const auto x = solution.at("x").get<std::vector<double>>();
    solutions.push_back({method,
                         Eigen::Map<const Eigen::ArrayXd>(x.data(), static_cast<Eigen::Index>(x.size())),
                         solution.at("objective").get<double>()});
  }
  return solutions;
}

double relative_difference(const Eigen::ArrayXd& a, const Eigen::ArrayXd& b) {
  return (a - b).abs().maxCoeff() / b.abs().maxCoeff();
}

enum class Compare { minimisers, range };

/// Where A has null vectors the minimiser is not unique, but A x is: compare that (Compare::range).
void expect_petsc_agrees(const BoundQp& given, Compare compare) {
  const BoundQp problem = tightened(given);
  ASSERT_EQ(find_defect(problem), std::nullopt);
  const BoundQpSolution ours = solve(problem);
  EXPECT_TRUE(ours.result.converged);
  EXPECT_LE(optimality_residual(problem, ours.x), 1e-12 * problem.linear.abs().maxCoeff());
  const auto solutions = solved_by_petsc(problem);
  ASSERT_EQ(solutions.size(), 2u);
  for (const OracleSolution& petsc : solutions) {
    const auto range = [&](const Eigen::ArrayXd& x) {
      return Eigen::ArrayXd((problem.matrix * x.matrix()).array());
    };
    const double minimiser = compare == Compare::minimisers
                                 ? relative_difference(ours.x, petsc.x)
                                 : relative_difference(range(ours.x), range(petsc.x));
    const double objectives =
        std::abs(objective(problem, ours.x) - petsc.objective) / std::abs(petsc.objective);
    // gpcg stops as soon as the objective no longer falls, which leaves the square root of round-off in x.
    EXPECT_LT(minimiser, petsc.method == "gpcg" ? 10.0 * minimiser_agreement : minimiser_agreement)
        << petsc.method;
    EXPECT_LT(objectives, objective_agreement) << petsc.method;
    std::printf("%-8s %5td unknowns, %4d iterations of ours, %s: %s differ by %.1e, objectives by %.1e\n",
                problem.name.c_str(), problem.linear.size(), ours.result.iterations, petsc.method.c_str(),
                compare == Compare::minimisers ? "minimisers" : "A x", minimiser, objectives);
  }
}

Field random_velocity(const testing::CollapseMoment& moment, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal(0.0, 9.81 * moment.dt);
  return Field::NullaryExpr(moment.velocity.size(), [&] { return normal(random); });
}

const testing::CollapseMoment& plane_strain() {
  static const auto moment = testing::collapse_moment({10, 1, 10}, 20);
  return moment;
}

const testing::CollapseMoment& three_dimensional() {
  static const auto moment = testing::collapse_moment({10, 8, 12}, 8);
  return moment;
}

TEST(Petsc, FindsThePressureOfACollapse) {
  expect_petsc_agrees(testing::pressure_problem(plane_strain(), plane_strain().velocity),
                      Compare::minimisers);
  expect_petsc_agrees(testing::pressure_problem(three_dimensional(), three_dimensional().velocity),
                      Compare::minimisers);
}

TEST(Petsc, FindsThePressureOfRandomVelocities) {
  for (unsigned seed = 0; seed < 3; ++seed) {
    expect_petsc_agrees(testing::pressure_problem(plane_strain(), random_velocity(plane_strain(), seed)),
                        Compare::minimisers);
  }
  expect_petsc_agrees(testing::pressure_problem(three_dimensional(), random_velocity(three_dimensional(), 3)),
                      Compare::minimisers);
}

TEST(Petsc, FindsThePressureAtBodies) {
  expect_petsc_agrees(std::get<BoundQp>(testing::step_with_bodies(0.01).last("pressure")),
                      Compare::minimisers);
}

TEST(Petsc, FindsThePackingCorrection) {
  std::mt19937_64 random(5);
  expect_petsc_agrees(testing::packing_problem(plane_strain(), random), Compare::minimisers);
  expect_petsc_agrees(testing::packing_problem(three_dimensional(), random), Compare::minimisers);
}

TEST(Petsc, FindsAShearStressBetweenTwoBounds) {
  expect_petsc_agrees(testing::shear_problem(plane_strain(), 1), Compare::minimisers);
  for (int axis = 0; axis < 3; ++axis)
    expect_petsc_agrees(testing::shear_problem(three_dimensional(), axis), Compare::minimisers);
}

/// All problems of one step of a run, in the order in which they were solved.
std::vector<Problem> dumped_problems(const std::string& scheme) {
  const TestFolder folder;
  const std::string scene = read_file(TALUS_SOURCE_DIR "/tests/continuum/data/small_column.toml");
  write_file_atomically(folder.path() / "scene.toml", scene + "[solver]\nscheme = \"" + scheme + "\"\n");
  const auto run = run_program({"talus", "run", (folder.path() / "scene.toml").string(), "--output",
                                (folder.path() / "out").string(), "--dump-qp", "6"});
  EXPECT_EQ(run.exit_code, 0) << run.output;
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path() / "out" / "qp" / "step_000006"))
    files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  std::vector<Problem> problems;
  for (std::size_t i = 0; i < files.size(); ++i) {
    EXPECT_EQ(std::stoul(files[i].filename().string().substr(0, 2)), i);
    problems.push_back(read_problem(files[i]));
  }
  return problems;
}

TEST(Petsc, FindsEveryBoundQpThatARunDumpsInBothSchemes) {
  std::map<std::string, int> found;
  for (const char* scheme : {"consistent", "paper"}) {
    for (const Problem& problem : dumped_problems(scheme)) {
      if (const auto* cone = std::get_if<ConeQp>(&problem)) {
        EXPECT_TRUE(solve(*cone).result.converged);
        ++found[cone->name];
        continue;
      }
      const BoundQp& qp = std::get<BoundQp>(problem);
      EXPECT_TRUE(solve(qp).result.converged) << qp.name;
      ++found[qp.name];
      // A component that moves nothing (plane strain), or is not pushed, has nothing to compare.
      if (qp.matrix.nonZeros() == 0 || (solve(tightened(qp)).x == 0.0).all()) continue;
      expect_petsc_agrees(
          qp, qp.name == "pressure" || qp.name == "packing" ? Compare::minimisers : Compare::range);
    }
  }
  EXPECT_GE(found["packing"], 1);  // solved only where sand is too dense
  found.erase("packing");
  const std::map<std::string, int> expected{
      {"friction", 2}, {"pressure", 4}, {"stress_up", 2}, {"stress_pair", 2}, {"stress_shear", 6}};
  EXPECT_EQ(found, expected);
}

TEST(Petsc, FindsThePressureOfABoxWithoutFreeSurface) {
  // Walls all around and every cell full: pressures are known up to a constant, so A x is compared.
  const Grid grid{Eigen::Vector3d::Zero(), 1.0, {6, 5, 4}, {false, false, false}};
  DomainSides sides;
  for (auto& axis : sides) axis = {Side{true, 0.0}, Side{true, 0.0}};
  Eigen::Matrix3Xd centres(3, grid.cells.prod());
  for (int cell = 0; cell < grid.cells.prod(); ++cell)
    centres.col(cell) = grid.cell_of_index(cell).cast<double>().array() + 0.5;
  const ActiveRegion region = make_active_region(grid, sides, centres);
  std::mt19937_64 random(9);
  std::normal_distribution<double> normal;
  const Field velocity = Field::NullaryExpr(region.open_faces, [&] { return normal(random); });
  const auto gradient = sparse_gradient(region);
  const Eigen::Index n = region.cell_count();
  const Field none = Field::Zero(n);
  const BoundQp problem{"sealed",
                        normal_matrix(gradient, Field::Ones(region.open_faces)),
                        -(gradient.transpose() * velocity.matrix()).array(),
                        none,
                        Field::Constant(n, std::numeric_limits<double>::infinity()),
                        none,
                        2.0,
                        {0.0, 0}};
  const Eigen::VectorXd spectrum =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(Eigen::MatrixXd(problem.matrix)).eigenvalues();
  ASSERT_LT(spectrum[0], 1e-12);
  ASSERT_GT(spectrum[1], 1e-3);
  expect_petsc_agrees(problem, Compare::range);
}

}  // namespace
}  // namespace talus
