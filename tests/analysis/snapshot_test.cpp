// The snapshot file: what goes in comes out, and nothing that is not a whole run passes for one.
#include "analysis/snapshot.h"

#include <H5Cpp.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <fstream>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/child_reading.h"
#include "analysis/xdmf.h"

namespace talus::analysis {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

Snapshot cloud(double time, Eigen::Index count) {
  std::srand(42);  // Eigen's Random draws from it
  return {time, Vectors::Random(3, count), Vectors::Random(3, count),
          Eigen::VectorXd::Random(count).array() + 1.5};
}

std::string content_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

class SnapshotFile : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    folder = fs::path(::testing::TempDir()) / fmt::format("talus-{}-{}", test->name(), ::getpid());
    fs::create_directories(folder);
    file = folder / "snapshots.h5";
  }
  void TearDown() override { fs::remove_all(folder); }

  std::size_t files_left() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
  }

  /// The message of the error that reading the file must give; it names the file.
  std::string reading_error() const {
    try {
      read_snapshots(file);
    } catch (const SnapshotError& error) {
      EXPECT_THAT(error.what(), HasSubstr(file.string()));
      return error.what();
    }
    ADD_FAILURE() << "read_snapshots accepted " << file;
    return {};
  }

  fs::path folder, file;
};

TEST_F(SnapshotFile, RoundTripIsExact) {
  // Frames of several sizes, one of them larger than an HDF5 chunk, one of them empty.
  const SnapshotSeries written{cloud(0.0, 7), cloud(0.1, 70000), cloud(0.25, 0), cloud(1.0 / 3.0, 1)};
  write_snapshots(file, written, R"({"program": "test"})");
  const SnapshotSeries read = read_snapshots(file);
  ASSERT_EQ(read.size(), written.size());
  for (std::size_t k = 0; k < read.size(); ++k) {
    EXPECT_EQ(read[k].time, written[k].time);
    EXPECT_EQ(read[k].positions, written[k].positions);
    EXPECT_EQ(read[k].velocities, written[k].velocities);
    EXPECT_EQ(read[k].volumes, written[k].volumes);
  }
  EXPECT_EQ(files_left(), 2u);  // and nothing but the HDF5 and its XDMF
}

TEST_F(SnapshotFile, SaysWhatMadeIt) {
  write_snapshots(file, {cloud(0.0, 3)}, "talus test, gr\u00e4n");
  const H5::H5File hdf5(file.string(), H5F_ACC_RDONLY);
  std::string made_by;
  const H5::Attribute attribute = hdf5.openAttribute("made_by");
  attribute.read(attribute.getStrType(), made_by);
  EXPECT_EQ(made_by, "talus test, gr\u00e4n");
}

TEST_F(SnapshotFile, UnfinishedWriterLeavesNothing) {
  {
    SnapshotWriter writer(file, "test");
    writer.append(cloud(0.0, 5));
    EXPECT_FALSE(fs::exists(file));
  }
  EXPECT_EQ(files_left(), 0u);
}

TEST_F(SnapshotFile, UnfinishedWriterLeavesTheOldFileAlone) {
  write_snapshots(file, {cloud(0.0, 5)}, "test");
  const std::string before = content_of(file);
  { SnapshotWriter(file, "test").append(cloud(0.0, 9)); }
  EXPECT_EQ(content_of(file), before);
}

TEST_F(SnapshotFile, KilledRunDoesNotPassEvenIfRenamed) {
  SnapshotWriter writer(file, "test");
  writer.append(cloud(0.0, 5));
  H5::H5File(file.string() + ".partial", H5F_ACC_RDWR).flush(H5F_SCOPE_GLOBAL);
  fs::copy(file.string() + ".partial", file);  // what stands on the disk when a run is killed
  reading_error();
}

TEST_F(SnapshotFile, WriterRefusesWhatIsNotASnapshot) {
  SnapshotWriter writer(file, "test");
  writer.append(cloud(1.0, 3));
  EXPECT_THROW(writer.append(cloud(1.0, 3)), SnapshotError);  // time stands still
  Snapshot bad = cloud(2.0, 3);
  bad.velocities.resize(3, 2);
  EXPECT_THROW(writer.append(bad), SnapshotError);
  bad = cloud(2.0, 3);
  bad.positions(1, 1) = not_a_number;
  EXPECT_THROW(writer.append(bad), SnapshotError);
  bad = cloud(2.0, 3);
  bad.volumes[0] = 0.0;
  EXPECT_THROW(writer.append(bad), SnapshotError);
  EXPECT_THROW(writer.append(cloud(not_a_number, 3)), SnapshotError);
  writer.append(cloud(2.0, 3));  // what was refused did no harm
  writer.finish();
  EXPECT_EQ(read_snapshots(file).size(), 2u);
  EXPECT_THROW(writer.append(cloud(3.0, 3)), SnapshotError);
  EXPECT_THROW(writer.finish(), SnapshotError);
}

TEST_F(SnapshotFile, UnwritableFolder) {
  EXPECT_THROW(SnapshotWriter(folder / "absent" / "snapshots.h5", "test"), SnapshotError);
}

TEST_F(SnapshotFile, NoRoomOnTheDiskIsAnErrorAndLeavesNothing) {
  rlimit before{};
  ::getrlimit(RLIMIT_FSIZE, &before);
  const rlimit small{2'000'000, before.rlim_max};
  ::setrlimit(RLIMIT_FSIZE, &small);
  std::string message;
  try {
    write_snapshots(file, {cloud(0.0, 10000), cloud(1.0, 10000), cloud(2.0, 40000)}, "test");
  } catch (const SnapshotError& error) {
    message = error.what();
  }
  ::setrlimit(RLIMIT_FSIZE, &before);
  EXPECT_THAT(message, HasSubstr("no room for the next frame"));
  EXPECT_THAT(message, HasSubstr(file.string()));
  EXPECT_EQ(files_left(), 0u);
}

TEST_F(SnapshotFile, MissingFile) { EXPECT_THAT(reading_error(), HasSubstr("no such file")); }

TEST_F(SnapshotFile, ForeignFiles) {
  std::ofstream(file) << "time,x,y,z\n";
  EXPECT_THAT(reading_error(), HasSubstr("not a snapshot file"));
  H5::H5File(file.string(), H5F_ACC_TRUNC).createGroup("frame_000000");
  EXPECT_THAT(reading_error(), HasSubstr("not a Talus snapshot file"));
}

TEST_F(SnapshotFile, TruncatedAnywhere) {
  write_snapshots(file, {cloud(0.0, 500), cloud(1.0, 500)}, "test");
  const std::string whole = content_of(file);
  for (const double part : {0.0, 0.01, 0.3, 0.9, 0.999}) {
    std::ofstream(file, std::ios::binary)
        << whole.substr(0, static_cast<std::size_t>(part * static_cast<double>(whole.size())));
    reading_error();
  }
}

TEST_F(SnapshotFile, DamagedDataIsNoticed) {
  write_snapshots(file, {cloud(0.0, 20000)}, "test");
  std::string damaged = content_of(file);
  for (std::size_t k = damaged.size() / 2; k < damaged.size() / 2 + 200; ++k) damaged[k] = '\x55';
  std::ofstream(file, std::ios::binary) << damaged;
  reading_error();
}

/// Opens a good file and lets `change` spoil it.
template <typename Change>
void spoil(const fs::path& file, Change&& change) {
  H5::H5File hdf5(file.string(), H5F_ACC_RDWR);
  change(hdf5);
}

TEST_F(SnapshotFile, NotFiniteOrInconsistentContent) {
  const SnapshotSeries good{cloud(0.0, 4), cloud(1.0, 4)};
  write_snapshots(file, good, "test");
  spoil(file, [](H5::H5File& hdf5) {
    const Vectors bad = Vectors::Constant(3, 4, not_a_number);
    hdf5.openDataSet("frame_000001/velocities").write(bad.data(), H5::PredType::NATIVE_DOUBLE);
  });
  EXPECT_THAT(reading_error(), HasSubstr("frame 1 (t = 1 s): a velocity is not finite"));

  write_snapshots(file, good, "test");
  spoil(file, [](H5::H5File& hdf5) {
    const double zero = 0.0;
    hdf5.openGroup("frame_000001").openAttribute("time").write(H5::PredType::NATIVE_DOUBLE, &zero);
  });
  EXPECT_THAT(reading_error(), HasSubstr("times must increase"));

  write_snapshots(file, good, "test");
  spoil(file, [](H5::H5File& hdf5) {
    hdf5.unlink("frame_000000/volumes");
    hdf5.move("frame_000001/volumes", "frame_000000/volumes");
  });
  reading_error();

  write_snapshots(file, good, "test");
  spoil(file, [](H5::H5File& hdf5) {  // n x 3 where n is wanted
    hdf5.unlink("frame_000000/volumes");
    hdf5.move("frame_000001/positions", "frame_000000/volumes");
  });
  EXPECT_THAT(reading_error(), HasSubstr("not a float table"));
}

TEST_F(SnapshotFile, ClaimsNoMoreRowsThanTheFileCanHold) {
  write_snapshots(file, {cloud(0.0, 4)}, "test");
  spoil(file, [](H5::H5File& hdf5) {  // 24 GB, none of which was ever written
    constexpr hsize_t shape[] = {1'000'000'000, 3}, chunk[] = {1000, 3};
    H5::DSetCreatPropList layout;
    layout.setChunk(2, chunk);
    hdf5.unlink("frame_000000/positions");
    hdf5.createDataSet("frame_000000/positions", H5::PredType::IEEE_F64LE, H5::DataSpace(2, shape), layout);
  });
  EXPECT_THAT(reading_error(), HasSubstr("claims 1000000000 rows, more than the file can hold"));
}

// HDF5 writes all values of an attribute to where one is expected.
TEST_F(SnapshotFile, AnAttributeOfManyValuesIsNotReadIntoTheRoomForOne) {
  for (const auto& [group, name] :
       {std::pair{"/", "frames"}, {"/", "version"}, {"/", "format"}, {"frame_000000", "time"}}) {
    write_snapshots(file, {cloud(0.0, 4)}, "test");
    spoil(file, [&](H5::H5File& hdf5) {
      constexpr hsize_t many = 4000;
      H5::Group object = hdf5.openGroup(group);
      const H5::DataType type = object.openAttribute(name).getDataType();
      object.removeAttr(name);
      const std::vector<std::uint64_t> nothing(2 * many, 0);
      object.createAttribute(name, type, H5::DataSpace(1, &many)).write(type, nothing.data());
    });
    EXPECT_THAT(reading_error(), HasSubstr(std::string("attribute ") + name + " is not one value"));
  }
}

// Found by fuzzing: HDF5 1.10 goes round in its global heap for ever.
TEST_F(SnapshotFile, AFileThatHdf5HangsOverIsAnErrorInSeconds) {
  fs::copy_file(TALUS_SOURCE_DIR "/tests/analysis/data/hdf5_hangs.h5", file);
  EXPECT_THAT(reading_error(), HasSubstr("HDF5 crashes or hangs over it"));
}

TEST(ChildReading, HandsOnWhatTheChildReads) {
  std::vector<double> taken(1'000'000);  // more than a pipe holds
  read_in_child(
      [](const Sink& sink) {
        sink.put(7);
        const std::vector<double> values(1'000'000, 0.25);
        sink.put(values.data(), values.size() * sizeof(double));
      },
      [&](const Source& source) {
        EXPECT_EQ(source.take<int>(), 7);
        source.take(taken.data(), taken.size() * sizeof(double));
      },
      5.0);
  EXPECT_EQ(taken, std::vector<double>(1'000'000, 0.25));
}

TEST(ChildReading, TellsRefusalsFromCrashesAndHangs) {
  const auto one = [](const Source& source) { source.take<int>(); };
  const auto reading = [&](auto give) { read_in_child(give, one, 1.0); };
  try {
    reading([](const Sink&) { throw std::runtime_error("an answer"); });
    ADD_FAILURE();
  } catch (const ChildRefused& refused) {
    EXPECT_STREQ(refused.what(), "an answer");
  }
  EXPECT_THROW(reading([](const Sink&) { std::raise(SIGSEGV); }), ChildDied);
  EXPECT_THROW(reading([](const Sink&) {}), ChildDied) << "ends early";
  EXPECT_THROW(reading([](const Sink&) {
                 for (volatile int spin = 0;;) spin = spin + 1;
               }),
               ChildDied);
  EXPECT_THROW(read_in_child([](const Sink&) { ::pause(); },
                             [](const Source&) { throw std::length_error("not wanted"); }, 1.0),
               std::length_error);
}

TEST_F(SnapshotFile, AnotherVersionOrNotComplete) {
  write_snapshots(file, {cloud(0.0, 4)}, "test");
  const auto set = [&](const char* name, int value) {
    spoil(file, [&](H5::H5File& hdf5) { hdf5.openAttribute(name).write(H5::PredType::NATIVE_INT, &value); });
  };
  set("complete", 0);
  EXPECT_THAT(reading_error(), HasSubstr("did not finish"));
  set("complete", 1);
  set("frames", 2);
  reading_error();
  set("frames", 1);
  set("version", 2);
  EXPECT_THAT(reading_error(), HasSubstr("version 2"));
}

struct Element {
  std::string name, attributes, text;  // the text up to the next tag
};

/// The elements of an XML document in their order; a failure when it is not well-formed.
std::vector<Element> parse_xml(std::string_view document) {
  std::vector<Element> elements;
  std::vector<std::string> open;
  EXPECT_THAT(document, StartsWith("<?xml"));
  document.remove_prefix(document.find("?>") + 2);
  while (document.find('<') != std::string_view::npos) {
    document.remove_prefix(document.find('<') + 1);
    const auto end = document.find('>');
    std::string_view tag = document.substr(0, end);
    EXPECT_EQ(tag.find('<'), std::string_view::npos) << tag;
    EXPECT_EQ(std::count(tag.begin(), tag.end(), '"') % 2, 0) << tag;
    document.remove_prefix(end + 1);
    if (tag.front() == '/') {
      EXPECT_EQ(open.empty() ? "" : open.back(), tag.substr(1));
      if (!open.empty()) open.pop_back();
      continue;
    }
    const bool closed = tag.back() == '/';
    if (closed) tag.remove_suffix(1);
    const auto space = std::min(tag.find(' '), tag.size());
    elements.push_back({std::string(tag.substr(0, space)), std::string(tag.substr(space)),
                        std::string(document.substr(0, document.find('<')))});
    if (!closed) open.push_back(elements.back().name);
  }
  EXPECT_THAT(open, IsEmpty());
  return elements;
}

TEST_F(SnapshotFile, XdmfDescribesTheHdf5) {
  const SnapshotSeries series{cloud(0.0, 5), cloud(0.125, 3)};
  write_snapshots(file, series, "test");
  const H5::H5File hdf5(file.string(), H5F_ACC_RDONLY);
  std::vector<std::string> times, sizes;
  std::size_t data_items = 0;
  for (const Element& element : parse_xml(content_of(xdmf_file(file)))) {
    if (element.name == "Time") times.push_back(element.attributes);
    if (element.name == "Topology") sizes.push_back(element.attributes);
    if (element.attributes.find("Collection") != std::string::npos) {
      EXPECT_THAT(element.attributes, HasSubstr("CollectionType=\"Temporal\""));
    }
    if (element.name != "DataItem") continue;
    ++data_items;
    // Every path is in the HDF5 file beside it, with the size that is stated here.
    const std::string beside = "snapshots.h5:";
    ASSERT_THAT(element.text, StartsWith(beside));
    const auto space = hdf5.openDataSet(element.text.substr(beside.size())).getSpace();
    std::array<hsize_t, 2> shape{};
    space.getSimpleExtentDims(shape.data());
    const bool vector = space.getSimpleExtentNdims() == 2;
    EXPECT_THAT(element.attributes,
                HasSubstr(fmt::format("Dimensions=\"{}{}\"", shape[0], vector ? " 3" : "")));
  }
  EXPECT_EQ(data_items, 3 * series.size());
  EXPECT_THAT(times, ElementsAre(" Value=\"0\"", " Value=\"0.125\""));
  EXPECT_THAT(sizes, ElementsAre(HasSubstr("NumberOfElements=\"5\""), HasSubstr("NumberOfElements=\"3\"")));
}

TEST(Xdmf, EscapesTheFileName) {
  const std::vector<FrameEntry> frames{{0.0, 1}};
  const std::vector<SeriesItem> items{{"positions", "", Number::float32, 3}};
  EXPECT_THAT(xdmf_document("a run", "a&b<c>.h5", items, frames),
              HasSubstr("a&amp;b&lt;c&gt;.h5:/frame_000000/positions"));
}

}  // namespace
}  // namespace talus::analysis
