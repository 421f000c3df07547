// `talus render` and `talus export` as a user meets them: pictures and films that are looked at, files that VTK reads.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "continuum/files/atomic_file.h"
#include "continuum/render/colours.h"
#include "continuum/render/render_file.h"
#include "tests/continuum/render/heap.h"

namespace talus {
namespace {

using ::testing::HasSubstr;
using testing::run_program;
using testing::run_scene;
using testing::TestFolder;
namespace fs = std::filesystem;

constexpr int width = 120, height = 80;              // pixels
constexpr double field_of_view = 20.0;               // degrees
constexpr double viewer_height = 0.4;                // m, above the middle of the floor
constexpr double middle = testing::domain_size / 2;  // m

/// One run for all tests: it is not what they test.
const fs::path& finished_run() {
  static const TestFolder folder;
  static const fs::path run = run_scene(folder.path(), testing::with_points);
  return run;
}

/// Eight bits a channel.
struct Picture {
  std::string pixels;
  Colour at(int column, int row) const {
    const auto first = static_cast<std::size_t>(3 * (row * width + column));
    const auto level = [&](std::size_t channel) {
      return static_cast<unsigned char>(pixels.at(first + channel));
    };
    return {static_cast<double>(level(0)), static_cast<double>(level(1)), static_cast<double>(level(2))};
  }
};

/// As another program decodes it.
Picture read_png(const fs::path& file) {
  EXPECT_EQ(read_file(file).substr(0, 8), "\x89PNG\r\n\x1a\n");
  const TestFolder folder;
  const auto raw = folder.path() / "raw";
  const auto result = run_program({"ffmpeg", "-loglevel", "error", "-i", file.string(), "-f", "rawvideo",
                                   "-pix_fmt", "rgb24", raw.string()});
  EXPECT_EQ(result.exit_code, 0) << result.output;
  const std::string pixels = read_file(raw);
  EXPECT_EQ(pixels.size(), static_cast<std::size_t>(3 * width * height));
  return {pixels};
}

std::vector<std::string> render_command(const fs::path& run, const fs::path& output,
                                        std::vector<std::string> options) {
  std::vector<std::string> command{"talus",
                                   "render",
                                   run.string(),
                                   "--output",
                                   output.string(),
                                   "--width",
                                   std::to_string(width),
                                   "--height",
                                   std::to_string(height)};
  command.insert(command.end(), options.begin(), options.end());
  return command;
}

/// Frame 0 as seen from straight above its middle.
Picture seen_from_above(const fs::path& run, std::vector<std::string> options = {}) {
  const TestFolder folder;
  options.insert(options.end(),
                 {"--frames", "0", "--camera", fmt::format("{}", middle), fmt::format("{}", middle),
                  fmt::format("{}", viewer_height), "--look-at", fmt::format("{}", middle),
                  fmt::format("{}", middle), "0", "--field-of-view", fmt::format("{}", field_of_view)});
  const auto result = run_program(render_command(run, folder.path(), options));
  EXPECT_EQ(result.exit_code, 0) << result.output;
  return read_png(folder.path() / "frame_000000.png");
}

/// What is seen at a point of a level z, from above.
Colour colour_at(const Picture& picture, double x, double y, double z) {
  const double pixels_per_metre =
      0.5 * width / ((viewer_height - z) * std::tan(field_of_view * std::numbers::pi / 360.0));
  return picture.at(static_cast<int>(0.5 * width + pixels_per_metre * (x - middle)),
                    static_cast<int>(0.5 * height - pixels_per_metre * (y - middle)));
}

/// Of a square of sand on top of the block: many points, so that their shades average out.
Colour colour_of_sand(const Picture& picture) {
  Colour sum = Colour::Zero();
  constexpr int side = 9;
  for (int i = 0; i < side * side; ++i)
    sum += colour_at(picture, middle + 0.002 * (i % side - side / 2), middle + 0.002 * (i / side - side / 2),
                     testing::block_height);
  return sum / (side * side);
}

constexpr double beside = 0.012;  // m: as far from the block as its shadow covers well
double right_of_block(const Picture& picture) {
  return colour_at(picture, testing::block_upper + beside, middle, 0.0).mean();
}
double left_of_block(const Picture& picture) {
  return colour_at(picture, testing::block_lower - beside, middle, 0.0).mean();
}

TEST(TalusRender, DrawsSandOnALitFloorWithItsShadow) {
  const Picture picture = seen_from_above(finished_run());
  EXPECT_GT(left_of_block(picture), 120.0);
  EXPECT_LT(right_of_block(picture), 0.75 * left_of_block(picture));  // the sun stands to the left
  const Colour sand = colour_of_sand(picture);
  EXPECT_GT(sand[0], 1.15 * sand[1]);  // warm
  EXPECT_GT(sand[1], 1.15 * sand[2]);
  EXPECT_GT(sand[0], 90.0);
}

TEST(TalusRender, DrawsTheSameTwice) {
  EXPECT_EQ(seen_from_above(finished_run()).pixels,
            seen_from_above(finished_run(), {"--threads", "2"}).pixels);
}

TEST(TalusRender, TheSunAndColoursAreTheUsersChoice) {
  const Picture picture =
      seen_from_above(finished_run(), {"--sun", "1", "0", "1", "--colour", "sand=#2050ff"});
  EXPECT_LT(left_of_block(picture), 0.75 * right_of_block(picture));
  const Colour sand = colour_of_sand(picture);
  EXPECT_GT(sand[2], 2.0 * sand[0]);
}

/// A run folder of links, into which a test may put more.
void link_run(const fs::path& folder) {
  for (const char* file : {"render.h5", "run.json", "run.toml"})
    fs::create_symlink(finished_run() / file, folder / file);
}

TEST(TalusRender, DrawsBodiesWhereTheyAre) {
  const TestFolder folder;
  link_run(folder.path());
  fs::create_directories(folder.path() / "bodies");
  // A square of 2 cm, which the pose lays flat over the lit side of the floor.
  write_file_atomically(folder.path() / "bodies" / "plate.stl",
                        "solid s\n"
                        "facet normal 0 1 0\nouter loop\nvertex -0.01 0 -0.01\nvertex 0.01 0 -0.01\n"
                        "vertex 0.01 0 0.01\nendloop\nendfacet\n"
                        "facet normal 0 1 0\nouter loop\nvertex -0.01 0 -0.01\nvertex 0.01 0 0.01\n"
                        "vertex -0.01 0 0.01\nendloop\nendfacet\nendsolid s\n");
  write_file_atomically(
      folder.path() / "bodies.csv",
      fmt::format("time_s,body,x_m,y_m,z_m,qw,qx,qy,qz\n0,plate,{},{},0.02,0.70710678,0.70710678,0,0\n",
                  testing::block_lower - 0.015, middle));
  const Picture without = seen_from_above(finished_run()), with = seen_from_above(folder.path());
  const auto on_plate = [](const Picture& picture) {
    return colour_at(picture, testing::block_lower - 0.015, middle, 0.02);
  };
  EXPECT_GT((on_plate(with) - on_plate(without)).norm(), 20.0);
  EXPECT_EQ(colour_at(with, middle, testing::block_upper + 0.01, 0.0),
            colour_at(without, middle, testing::block_upper + 0.01, 0.0));
}

TEST(TalusRender, DrawsTheBodiesOfARun) {
  const TestFolder folder;
  const std::string body =
      "[[body]]\nname = \"crate\"\ndensity_kg_m3 = 500.0\nrough = true\n"
      "shape = { kind = \"box\", lower_m = [0.002, 0.04, 0.0], upper_m = [0.018, 0.06, 0.02] }\n";
  const auto run = run_scene(folder.path(), testing::with_points + body);
  const auto on_top = [](const fs::path& of) { return colour_at(seen_from_above(of), 0.01, middle, 0.02); };
  EXPECT_GT((on_top(run) - on_top(finished_run())).norm(), 20.0);
}

/// The line of a scene that says where the camera stands, unless it is told.
std::string default_camera(const fs::path& run) {
  const TestFolder folder;
  const auto result =
      run_program(render_command(run, folder.path(), {"--frames", "0", "--samples", "1", "--keep-scenes"}));
  EXPECT_EQ(result.exit_code, 0) << result.output;
  const std::string scene = read_file(folder.path() / "frame_000000.pov");
  const auto at = scene.find("camera {");
  return scene.substr(at, scene.find('\n', at) - at);
}

TEST(TalusRender, TheCameraSeesBodiesToo) {
  const TestFolder near, far;
  for (const auto& [folder, place] :
       {std::pair{&near, "0.05,0.05,0.02"}, std::pair{&far, "0.05,0.05,0.048"}}) {
    link_run(folder->path());
    fs::create_directories(folder->path() / "bodies");
    write_file_atomically(folder->path() / "bodies" / "chip.stl",
                          "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 0.001 0 0\n"
                          "vertex 0 0.001 0\nendloop\nendfacet\nendsolid s\n");
    write_file_atomically(folder->path() / "bodies.csv",
                          fmt::format("time_s,body,x_m,y_m,z_m,qw,qx,qy,qz\n0,chip,{},1,0,0,0\n", place));
  }
  EXPECT_EQ(default_camera(near.path()), default_camera(finished_run()));  // in the sand
  EXPECT_NE(default_camera(far.path()), default_camera(finished_run()));   // above it
}

TEST(TalusRender, DrawsWallsThatStandAndNotThoseThatAreOpen) {
  const TestFolder folder;
  // In the middle of the lit side; sand does not come there.
  const std::string wall =
      "[[wall]]\nrough = true\nopens_at_s = 0.03\n"
      "shape = { kind = \"box\", lower_m = [0.0, 0.03, 0.0], upper_m = [0.02, 0.07, 0.02] }\n";
  const auto run = run_scene(folder.path(), testing::with_points + wall);
  const auto draw = [&](const char* frame) {
    const auto result =
        run_program(render_command(run, folder.path(),
                                   {"--frames", frame, "--camera", "0.05", "0.05", "0.4", "--look-at", "0.05",
                                    "0.05", "0", "--field-of-view", "20"}));
    EXPECT_EQ(result.exit_code, 0) << result.output;
    return read_png(folder.path() / fmt::format("frame_00000{}.png", frame));
  };
  const Colour closed = colour_at(draw("0"), 0.012, middle, 0.02),
               open = colour_at(draw("2"), 0.012, middle, 0.02);
  EXPECT_GT((closed - open).norm(), 20.0);
}

TEST(TalusRender, DrawsMeshesAsTheShapesThatTheyAre) {
  const auto picture = [](const std::string& shape) {
    const TestFolder folder;
    // Like the box that it stands for; on the lit side, where no sand comes.
    write_file_atomically(folder.path() / "block.obj",
                          "v 0 0.03 0\nv 0.02 0.03 0\nv 0.02 0.07 0\nv 0 0.07 0\nv 0 0.03 0.02\n"
                          "v 0.02 0.03 0.02\nv 0.02 0.07 0.02\nv 0 0.07 0.02\n"
                          "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n");
    const auto run =
        run_scene(folder.path(), testing::with_points + "[[wall]]\nrough = true\nshape = " + shape);
    const auto result =
        run_program(render_command(run, folder.path(),
                                   {"--frames", "0", "--camera", "0.05", "0.05", "0.4", "--look-at", "0.05",
                                    "0.05", "0", "--field-of-view", "20"}));
    EXPECT_EQ(result.exit_code, 0) << result.output;
    return colour_at(read_png(folder.path() / "frame_000000.png"), 0.012, middle, 0.02);
  };
  const Colour as_box =
                   picture("{ kind = \"box\", lower_m = [0.0, 0.03, 0.0], upper_m = [0.02, 0.07, 0.02] }\n"),
               as_mesh = picture("{ kind = \"mesh\", file = \"block.obj\" }\n"),
               elsewhere = picture(
                   "{ kind = \"box\", lower_m = [0.0, 0.0, 0.0], upper_m = [0.001, 0.001, 0.001] }\n");
  EXPECT_LT((as_mesh - as_box).norm(), 2.0);
  EXPECT_GT((as_mesh - elsewhere).norm(), 20.0);
}

TEST(TalusRender, MakesAFilm) {
  const TestFolder folder;
  const auto result =
      run_program(render_command(finished_run(), folder.path(),
                                 {"--frames", "0,2-last", "--samples", "1", "--film", "sand.mp4",
                                  "--pictures-per-second", "10", "--keep-scenes"}));
  ASSERT_EQ(result.exit_code, 0) << result.output;
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder.path()))
    names.push_back(entry.path().filename().string());
  EXPECT_THAT(names, ::testing::UnorderedElementsAre("frame_000000.png", "frame_000002.png",
                                                     "frame_000003.png", "frame_000000.pov",
                                                     "frame_000002.pov", "frame_000003.pov", "sand.mp4"));
  const auto probed = run_program({"ffprobe", "-v", "error", "-count_frames", "-show_entries",
                                   "stream=codec_name,width,height,r_frame_rate,nb_read_frames", "-of",
                                   "csv=p=0", (folder.path() / "sand.mp4").string()});
  EXPECT_THAT(probed.output, HasSubstr(fmt::format("h264,{},{},10/1,3", width, height)));
}

TEST(TalusRender, MakesAFilmForTheWeb) {
  const TestFolder folder;
  const auto result = run_program(render_command(
      finished_run(), folder.path(), {"--frames", "0,last", "--samples", "1", "--film", "sand.webm"}));
  ASSERT_EQ(result.exit_code, 0) << result.output;
  const auto probed = run_program({"ffprobe", "-v", "error", "-count_frames", "-show_entries",
                                   "stream=codec_name,width,height,nb_read_frames", "-of", "csv=p=0",
                                   (folder.path() / "sand.webm").string()});
  EXPECT_THAT(probed.output, HasSubstr(fmt::format("vp9,{},{},2", width, height)));
}

TEST(TalusRender, TellsWhatIsWrong) {
  const TestFolder folder;
  const auto error_of = [&](const fs::path& run, const std::vector<std::string>& options) {
    const auto result = run_program(render_command(run, folder.path() / "pictures", options));
    EXPECT_EQ(result.exit_code, 2) << result.output;
    return result.output;
  };
  EXPECT_THAT(error_of(folder.path() / "absent", {}), HasSubstr("absent: no such folder"));
  EXPECT_THAT(error_of(folder.path(), {}), HasSubstr("[render_points] per_particle"));
  EXPECT_THAT(error_of(finished_run(), {"--frames", "4"}), HasSubstr("the run has frames 0 to 3"));
  EXPECT_THAT(error_of(finished_run(), {"--film", "sand.avi"}), HasSubstr("must end in .mp4 or .webm"));
  EXPECT_THAT(error_of(finished_run(), {"--colour", "salt=#ffffff"}), HasSubstr("no material 'salt'"));
  EXPECT_THAT(error_of(finished_run(), {"--sun", "0", "0", "0"}), HasSubstr("must point somewhere"));
  EXPECT_THAT(error_of(finished_run(), {"--sun", "1", "0"}), HasSubstr("--sun"));
  EXPECT_THAT(error_of(finished_run(), {"--samples", "0"}), HasSubstr("--samples"));
  EXPECT_FALSE(fs::exists(folder.path() / "pictures" / "frame_000000.png"));
}

TEST(TalusRender, NamesThePackageOfAMissingProgram) {
  const TestFolder folder;
  const auto error_with = [&](const fs::path& programs, std::vector<std::string> options) {
    auto command = render_command(finished_run(), folder.path() / "pictures", std::move(options));
    command.front() = (fs::path(TALUS_BINARY_DIR) / "bin" / "talus").string();
    command.insert(command.begin(), {"/usr/bin/env", "PATH=" + programs.string()});
    const auto result = run_program(command);
    EXPECT_EQ(result.exit_code, 2) << result.output;
    return result.output;
  };
  EXPECT_THAT(error_with(folder.path(), {}), HasSubstr("apt-get install povray"));
  write_file_atomically(folder.path() / "povray", "#!/bin/sh\n");
  fs::permissions(folder.path() / "povray", fs::perms::owner_all);
  EXPECT_THAT(error_with(folder.path(), {"--film", "sand.mp4"}), HasSubstr("apt-get install ffmpeg"));
}

TEST(TalusRender, SaysWhatARendererThatFailsSaid) {
  const TestFolder folder;
  write_file_atomically(folder.path() / "povray", "#!/bin/sh\necho out of paint\nexit 3\n");
  fs::permissions(folder.path() / "povray", fs::perms::owner_all);
  auto command = render_command(finished_run(), folder.path() / "pictures", {"--frames", "0"});
  command.front() = (fs::path(TALUS_BINARY_DIR) / "bin" / "talus").string();
  command.insert(command.begin(), {"/usr/bin/env", "PATH=" + folder.path().string() + ":/bin"});
  const auto result = run_program(command);
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.output, ::testing::AllOf(HasSubstr("exit code 3"), HasSubstr("out of paint")));
  std::vector<std::string> left;
  for (const auto& entry : fs::directory_iterator(folder.path() / "pictures"))
    left.push_back(entry.path().filename().string());
  EXPECT_THAT(left, ::testing::ElementsAre("frame_000000.png.log"));
}

nlohmann::json read_back(const fs::path& file) {
  const auto result = run_program(
      {"/usr/bin/python3", TALUS_SOURCE_DIR "/tests/continuum/render/read_back.py", file.string()}, 60.0);
  EXPECT_EQ(result.exit_code, 0) << result.output;
  return nlohmann::json::parse(result.output);
}

/// Frame 1 in a format, as VTK reads it, beside what the run wrote.
void expect_read_back(const nlohmann::json& read, const char* normals, const char* colours) {
  const RenderFrame frame = RenderReader(finished_run() / "render.h5").read(1);
  EXPECT_EQ(read["points"], frame.count());
  const Colour sand = colours_of({{"sand", 2500.0, 0.6, 0.5}}, {})[0];
  for (Eigen::Index k = 0; k < 3; ++k) {
    const auto at = static_cast<std::size_t>(k);
    const Colour colour = (255.0 * shaded(sand, shade_of(frame.identities[at]))).array().round();
    for (Eigen::Index i = 0; i < 3; ++i) {
      const auto c = static_cast<std::size_t>(i);
      EXPECT_EQ(read["positions"][at][c].get<float>(), frame.positions(i, k));
      EXPECT_EQ(read["arrays"][normals][at][c].get<float>(), frame.normals(i, k));
      EXPECT_EQ(read["arrays"][colours][at][c].get<double>(), colour[i]);
    }
  }
}

TEST(TalusExport, WritesPlyThatVtkReads) {
  const TestFolder folder;
  const auto result = run_program({"talus", "export", finished_run().string(), "--format", "ply", "--frames",
                                   "1", "--output", folder.path().string()});
  ASSERT_EQ(result.exit_code, 0) << result.output;
  expect_read_back(read_back(folder.path() / "frame_000001.ply"), "Normals", "RGB");
  EXPECT_THAT(read_file(folder.path() / "frame_000001.ply").substr(0, 500), HasSubstr("comment t = 0.02 s"));
  EXPECT_FALSE(fs::exists(folder.path() / "frame_000000.ply"));
}

TEST(TalusExport, WritesVtkFilesWithTheirTimes) {
  const TestFolder folder;
  const auto result = run_program(
      {"talus", "export", finished_run().string(), "--format", "vtk", "--output", folder.path().string()});
  ASSERT_EQ(result.exit_code, 0) << result.output;
  const auto read = read_back(folder.path() / "frame_000001.vtp");
  expect_read_back(read, "normal", "colour");
  EXPECT_EQ(read["vertices"], read["points"]);
  EXPECT_EQ(read["time"], 0.02);
  const RenderFrame frame = RenderReader(finished_run() / "render.h5").read(1);
  EXPECT_EQ(read["arrays"]["identity"][2][0], frame.identities[2]);
  EXPECT_EQ(read["arrays"]["speed"][2][0].get<float>(), frame.speeds[2]);
  EXPECT_EQ(read["arrays"]["material"][2][0], 0);
  const std::string times = read_file(folder.path() / "render.pvd");
  for (const char* line :
       {"timestep=\"0\" file=\"frame_000000.vtp\"", "timestep=\"0.02\" file=\"frame_000001.vtp\""})
    EXPECT_THAT(times, HasSubstr(line));
}

TEST(TalusExport, KnowsItsFormats) {
  const auto result = run_program({"talus", "export", finished_run().string(), "--format", "obj"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.output, HasSubstr("ply"));
}

}  // namespace
}  // namespace talus
