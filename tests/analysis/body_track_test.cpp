#include "analysis/body_track.h"

#include <gmock/gmock.h>

#include "analysis/snapshot.h"
#include "continuum/files/atomic_file.h"
#include "tests/test_folder.h"

namespace talus::analysis {
namespace {

using ::testing::HasSubstr;

class Track : public ::testing::Test {
 protected:
  BodyTrack read(const std::string& text) {
    write_file_atomically(file_, text);
    return read_body_track(file_);
  }
  std::string error(const std::string& text) {
    try {
      read(text);
    } catch (const SnapshotError& caught) {
      return caught.what();
    }
    return "no error";
  }
  testing::TestFolder folder_;
  std::filesystem::path file_ = folder_.path() / body_track_file;
};

TEST_F(Track, ColumnsAreFoundByName) {
  const auto track = read(
      "vz_m_s,time_s,body,x_m,y_m,z_m,qw,vx_m_s,vy_m_s\n-1,0,ball,1,2,3,1,4,5\n-2,0.5,ball,6,7,8e-1,1,9,"
      "10\n");
  ASSERT_EQ(track.size(), 2u);
  EXPECT_EQ(track[0].position, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(track[1].time, 0.5);
  EXPECT_EQ(track[1].position.z(), 0.8);
  EXPECT_EQ(track[1].velocity, Eigen::Vector3d(9, 10, -2));
}

TEST_F(Track, MistakesAreToldWithTheirLine) {
  const std::string header = "time_s,x_m,y_m,z_m,vx_m_s,vy_m_s,vz_m_s\n";
  EXPECT_THAT(error("time_s,x_m,y_m,vx_m_s,vy_m_s,vz_m_s\n"), HasSubstr("bodies.csv:1: has no column z_m"));
  EXPECT_THAT(error(header), HasSubstr("holds no row"));
  EXPECT_THAT(error(header + "0,0,0,0,0,0,0\n1,0,0,0,0,0\n"), HasSubstr("bodies.csv:3: has 6 cells"));
  EXPECT_THAT(error(header + "0,0,0,oops,0,0,0\n"), HasSubstr("bodies.csv:2: 'oops'"));
  EXPECT_THAT(error(header + "0,0,0,nan,0,0,0\n"), HasSubstr("not a finite number"));
  EXPECT_THAT(error(header + "0,0,0,0,0,0,0\n0,0,0,0,0,0,0\n"),
              HasSubstr("bodies.csv:3: the time does not increase"));
  std::filesystem::remove(file_);
  EXPECT_THROW(read_body_track(file_), SnapshotError);
}

}  // namespace
}  // namespace talus::analysis
