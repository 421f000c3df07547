// Problems on disk: replayed to the last bit, whole or not there, and damage noticed.
#include "continuum/qp/problem_file.h"

#include <H5Cpp.h>
#include <gmock/gmock.h>

#include <cstring>
#include <fstream>

#include "continuum/files/atomic_file.h"
#include "tests/continuum/qp/collapse_problems.h"
#include "tests/test_folder.h"

/// HDF5 1.10 leaks a little for each wrong checksum it meets: asked by the address sanitizer what to overlook.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() { return "leak:libhdf5_serial"; }

namespace talus {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::input_error;
using testing::TestFolder;

bool same_bits(const Eigen::ArrayXd& a, const Eigen::ArrayXd& b) {
  return a.size() == b.size() &&
         std::memcmp(a.data(), b.data(), static_cast<std::size_t>(a.size()) * sizeof(double)) == 0;
}

bool same_bits(const Eigen::SparseMatrix<double>& a, const Eigen::SparseMatrix<double>& b) {
  const auto as_arrays = [](const Eigen::SparseMatrix<double>& m) {
    return std::array{Eigen::ArrayXi(Eigen::Map<const Eigen::ArrayXi>(m.outerIndexPtr(), m.outerSize() + 1)),
                      Eigen::ArrayXi(Eigen::Map<const Eigen::ArrayXi>(m.innerIndexPtr(), m.nonZeros()))};
  };
  return a.rows() == b.rows() && a.cols() == b.cols() && a.nonZeros() == b.nonZeros() &&
         (as_arrays(a)[0] == as_arrays(b)[0]).all() && (as_arrays(a)[1] == as_arrays(b)[1]).all() &&
         same_bits(Eigen::ArrayXd(a.coeffs()), Eigen::ArrayXd(b.coeffs()));
}

bool same_bits(const BoundQp& a, const BoundQp& b) {
  return a.name == b.name && same_bits(a.matrix, b.matrix) && same_bits(a.linear, b.linear) &&
         same_bits(a.lower, b.lower) && same_bits(a.upper, b.upper) && same_bits(a.start, b.start) &&
         a.norm == b.norm && a.settings.tolerance == b.settings.tolerance &&
         a.settings.max_iterations == b.settings.max_iterations;
}

bool same_bits(const ConeQp& a, const ConeQp& b) {
  return a.name == b.name && same_bits(a.k, b.k) && same_bits(a.mass, b.mass) &&
         same_bits(a.free_velocity, b.free_velocity) && a.balls.size == b.balls.size &&
         a.balls.count == b.balls.count && same_bits(a.balls.radius, b.balls.radius) &&
         same_bits(a.balls.curvature, b.balls.curvature) && same_bits(a.start, b.start) &&
         a.lipschitz == b.lipschitz && a.settings.gap_tolerance == b.settings.gap_tolerance &&
         a.settings.max_iterations == b.settings.max_iterations;
}

class ProblemFile : public ::testing::Test {
 protected:
  static const testing::CollapseMoment& moment() {
    static const auto moment = testing::collapse_moment({6, 1, 6}, 5);
    return moment;
  }
  static BoundQp bound() { return testing::pressure_problem(moment(), moment().velocity); }
  static ConeQp cone() { return testing::friction_problem(moment()); }
  /// What reading says after `change` has been made to a file by HDF5 itself, so that checksums are right.
  template <class Change>
  std::string error_after(const Problem& problem, Change change) {
    write_problem(file_, problem, "test");
    {
      H5::H5File file(file_.string(), H5F_ACC_RDWR);
      change(file);
    }
    return input_error([&] { read_problem(file_); });
  }

  TestFolder folder_;
  std::filesystem::path file_ = folder_.path() / "problem.h5";
};

TEST_F(ProblemFile, BoundProblemIsReplayedToTheLastBit) {
  for (const BoundQp& problem : {bound(), testing::shear_problem(moment(), 1)}) {
    write_problem(file_, problem, "test");
    const auto read = std::get<BoundQp>(read_problem(file_));
    EXPECT_TRUE(same_bits(problem, read));
    const BoundQpSolution in_memory = solve(problem), replayed = solve(read);
    EXPECT_GT(in_memory.result.iterations, 0);
    EXPECT_EQ(in_memory.result.iterations, replayed.result.iterations);
    EXPECT_EQ(in_memory.result.residual, replayed.result.residual);
    EXPECT_TRUE(same_bits(in_memory.x, replayed.x));
  }
}

TEST_F(ProblemFile, ConeProblemIsReplayedToTheLastBit) {
  const ConeQp problem = cone();
  write_problem(file_, problem, "test");
  const auto read = std::get<ConeQp>(read_problem(file_));
  EXPECT_TRUE(same_bits(problem, read));
  const ConeQpSolution in_memory = solve(problem), replayed = solve(read);
  EXPECT_GT(in_memory.result.iterations, 0);
  EXPECT_EQ(in_memory.result.iterations, replayed.result.iterations);
  EXPECT_EQ(in_memory.result.gap, replayed.result.gap);
  EXPECT_EQ(in_memory.lipschitz, replayed.lipschitz);
  EXPECT_TRUE(same_bits(in_memory.s, replayed.s));
  EXPECT_TRUE(same_bits(in_memory.velocity, replayed.velocity));
}

TEST_F(ProblemFile, StepsAreRecordedInOrder) {
  const ProblemRecorder record = record_step(folder_.path(), 12, "test");
  record(bound());
  record(cone());
  record(bound());
  const auto step = folder_.path() / "qp" / "step_000012";
  EXPECT_TRUE(same_bits(bound(), std::get<BoundQp>(read_problem(step / "00_pressure.h5"))));
  EXPECT_TRUE(same_bits(cone(), std::get<ConeQp>(read_problem(step / "01_friction.h5"))));
  EXPECT_EQ(problem_path(folder_.path(), 12, 2, "pressure"), step / "02_pressure.h5");
  EXPECT_TRUE(std::filesystem::exists(step / "02_pressure.h5"));
}

TEST_F(ProblemFile, DefectiveProblemsAreNotWritten) {
  BoundQp problem = bound();
  problem.linear[2] = std::nan("");
  EXPECT_THAT(input_error([&] { write_problem(file_, problem, "test"); }),
              AllOf(HasSubstr(file_.string()), HasSubstr("linear is not finite")));
  EXPECT_FALSE(std::filesystem::exists(file_));
  EXPECT_THAT(input_error([&] { write_problem(folder_.path() / "none" / "p.h5", bound(), "test"); }),
              HasSubstr("cannot write here"));
}

TEST_F(ProblemFile, ForeignFilesAreNamed) {
  EXPECT_THAT(input_error([&] { read_problem(file_); }),
              AllOf(HasSubstr(file_.string()), HasSubstr("no such file")));
  std::ofstream(file_) << "not HDF5";
  EXPECT_THAT(input_error([&] { read_problem(file_); }),
              AllOf(HasSubstr(file_.string()), HasSubstr("damaged, or not")));
  H5::H5File(file_.string(), H5F_ACC_TRUNC).close();
  EXPECT_THAT(input_error([&] { read_problem(file_); }), HasSubstr("attribute format is missing"));
}

TEST_F(ProblemFile, OtherVersionsAndMissingPartsAreNamed) {
  const auto set_integer = [](H5::H5File& file, const char* name, std::int64_t value) {
    file.openGroup("/").openAttribute(name).write(H5::PredType::NATIVE_INT64, &value);
  };
  EXPECT_THAT(error_after(bound(), [&](H5::H5File& file) { set_integer(file, "version", 2); }),
              HasSubstr("version 2 of the format; this program reads version 1"));
  EXPECT_THAT(error_after(bound(), [](H5::H5File& file) { file.unlink("upper"); }),
              HasSubstr("dataset upper is missing"));
  EXPECT_THAT(error_after(bound(), [](H5::H5File& file) { file.unlink("matrix"); }),
              HasSubstr("group matrix is missing"));
  EXPECT_THAT(error_after(cone(), [](H5::H5File& file) { file.openGroup("/").removeAttr("lipschitz"); }),
              HasSubstr("attribute lipschitz is missing"));
  EXPECT_THAT(error_after(bound(), [&](H5::H5File& file) { set_integer(file, "max_iterations", -5); }),
              HasSubstr("max_iterations -5 is negative"));
}

TEST_F(ProblemFile, SizesAreNotBelievedUnchecked) {
  const auto replace = [](H5::H5File& file, const char* name, hsize_t size) {
    file.unlink(name);
    const hsize_t chunk = 1024;
    H5::DSetCreatPropList layout;
    layout.setChunk(1, &chunk);
    file.createDataSet(name, H5::PredType::IEEE_F64LE, H5::DataSpace(1, &size), layout);
  };
  EXPECT_THAT(
      error_after(bound(), [&](H5::H5File& file) { replace(file, "linear", hsize_t{1} << 50); }),
      HasSubstr("dataset linear claims 1125899906842624 values, but 0 stored bytes cannot hold them"));
  const auto set_value = [](H5::H5File& file, const char* name, hsize_t at, std::int64_t value) {
    const H5::DataSet set = file.openDataSet(name);
    const H5::DataSpace all = set.getSpace();
    std::vector<std::int64_t> values(static_cast<std::size_t>(all.getSimpleExtentNpoints()));
    set.read(values.data(), H5::PredType::NATIVE_INT64);
    values[at] = value;
    set.write(values.data(), H5::PredType::NATIVE_INT64);
  };
  EXPECT_THAT(error_after(bound(), [&](H5::H5File& file) { set_value(file, "matrix/rows", 3, 1 << 20); }),
              HasSubstr("an entry lies outside"));
  EXPECT_THAT(error_after(bound(), [&](H5::H5File& file) { set_value(file, "matrix/offsets", 3, 1 << 20); }),
              HasSubstr("the offsets do not ascend"));
  EXPECT_THAT(error_after(cone(), [&](H5::H5File& file) { set_value(file, "balls/count", 0, 1 << 30); }),
              HasSubstr("more blocks than values"));
}

TEST_F(ProblemFile, DamageIsNoticedWhereverItIs) {
  const BoundQp problem = bound();
  write_problem(file_, problem, "test");
  const std::string whole = read_file(file_);
  const auto put = [&](std::string_view content) { std::ofstream(file_, std::ios::binary) << content; };
  std::mt19937_64 random(1);
  int refused = 0, tried = 0;
  for (std::size_t at = 0; at < whole.size(); at += 1 + random() % 40, ++tried) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ (1 << random() % 8));
    put(damaged);
    try {  // a byte that nobody uses may change
      EXPECT_TRUE(same_bits(problem, std::get<BoundQp>(read_problem(file_)))) << "byte " << at;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr(file_.string()));
      ++refused;
    }
  }
  EXPECT_GT(tried, 300);
  EXPECT_GT(refused, tried / 4);
  for (const double share : {0.0, 0.1, 0.5, 0.9, 0.999}) {
    put(whole.substr(0, static_cast<std::size_t>(share * static_cast<double>(whole.size()))));
    EXPECT_THAT(input_error([&] { read_problem(file_); }), HasSubstr(file_.string()));
  }
}

}  // namespace
}  // namespace talus
