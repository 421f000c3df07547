#include "continuum/render/render.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>

#include "continuum/files/atomic_file.h"
#include "continuum/files/input_error.h"
#include "continuum/files/process.h"
#include "continuum/render/pov_scene.h"
#include "continuum/render/programs.h"
#include "continuum/render/run_folder.h"

namespace talus {
namespace {

// Mean radius of a point over the points' distance: spheres that just overlap, so that no light falls through sand.
constexpr double radius_of_spacing = 0.55;

std::filesystem::path film_program(const RenderOptions& options) {
  if (!options.film) return {};
  const std::string& film = *options.film;
  if (!film.ends_with(".mp4") && !film.ends_with(".webm"))
    throw InputError(fmt::format("--film {}: must end in .mp4 or .webm", film));
  if (std::filesystem::path(film).has_parent_path())
    throw InputError(fmt::format("--film {}: is a name, and stands in the output folder", film));
  return find_program("ffmpeg", "ffmpeg");
}

/// Corners of what is inside hollow walls, as far as it lies in the domain.
void add_vessels(const Scene& scene, Eigen::Matrix3Xd& subject) {
  for (const Wall& wall : scene.walls) {
    if (!wall.shape.hollow) continue;
    Shape inside = wall.shape;
    inside.hollow = false;
    const Eigen::AlignedBox3d box = bounds(inside).intersection({scene.grid.origin, scene.grid.upper()});
    subject.conservativeResize(3, subject.cols() + 8);
    for (int corner = 0; corner < 8; ++corner)
      subject.col(subject.cols() - 8 + corner) =
          box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner));
  }
}

/// Corners of the boxes about the bodies at a time, as far as they lie in the domain.
void add_bodies(const RunFolder& run, double time, Eigen::Matrix3Xd& subject) {
  const Eigen::AlignedBox3d domain(run.scene.grid.origin, run.scene.grid.upper());
  for (const DrawnBody& body : run.bodies) {
    Eigen::AlignedBox3d box;
    for (const Eigen::Vector3f& corner : body.surface.corners) box.extend(corner.cast<double>().eval());
    for (const Eigen::Isometry3d& image : images_at(body, time, run.scene.grid)) {
      for (int corner = 0; corner < 8; ++corner) {
        const Eigen::Vector3d at = image * box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner));
        if (!domain.contains(at)) continue;
        subject.conservativeResize(3, subject.cols() + 1);
        subject.col(subject.cols() - 1) = at;
      }
    }
  }
}

/// What the camera must see: vessels, bodies, and sand at five moments of the whole run, whichever of its frames are drawn, so that
/// pictures drawn now and later are taken from one place. Of many points, some; without any, the corners of the domain.
Eigen::Matrix3Xd subject_of(const RunFolder& run) {
  constexpr std::size_t moments = 5;
  constexpr Eigen::Index enough = 20000;
  Eigen::Matrix3Xd subject(3, 0);
  for (std::size_t i = 0; i < moments; ++i) {
    const RenderFrame frame = read_frame(run, i * (run.frame_count() - 1) / (moments - 1));
    add_bodies(run, frame.time, subject);
    const Eigen::Index stride = frame.positions.cols() / enough + 1, before = subject.cols(),
                       added = (frame.positions.cols() + stride - 1) / stride;
    subject.conservativeResize(3, before + added);
    for (Eigen::Index k = 0; k < added; ++k)
      subject.col(before + k) = frame.positions.col(k * stride).cast<double>();
  }
  add_vessels(run.scene, subject);
  if (subject.cols() > 0) return subject;
  subject.resize(3, 2);
  subject << run.scene.grid.origin, run.scene.grid.upper();
  return subject;
}

Look look_of(const RunFolder& run, const RenderOptions& options) {
  Look look{};
  look.colours = colours_of(run.scene.materials, options.colours);
  look.aspect = static_cast<double>(options.width) / options.height;
  look.sun = options.sun ? *options.sun : default_sun(run.scene);
  if (look.sun.norm() == 0.0) throw InputError("--sun 0 0 0: must point somewhere");
  look.sun.normalize();
  look.sun_width = options.sun_width;
  look.radius = options.point_size * radius_of_spacing * point_spacing(run);
  look.camera = camera_for(run.scene, subject_of(run), look.aspect, options.camera);
  return look;
}

/// Returns how many points there are. They are not in memory while the frame is drawn.
std::size_t write_frame(const RunFolder& run, std::size_t index, const Look& look,
                        const std::filesystem::path& scene) {
  const RenderFrame frame = read_frame(run, index);
  write_pov_scene(scene, run, frame, look);
  return frame.count();
}

}  // namespace

void render(const RenderOptions& options) {
  const RunFolder run = open_run(options.run);
  const std::vector<std::size_t> frames = chosen_frames(options.frames, run.frame_count());
  const std::filesystem::path povray = find_program("povray", "povray"), ffmpeg = film_program(options);
  const std::filesystem::path output = options.output.value_or(options.run / "pictures");
  make_writable_folder(output);
  const Look look = look_of(run, options);
  std::vector<std::string> pictures;
  for (const std::size_t index : frames) {
    const std::string name = fmt::format("frame_{:06}", index), scene = name + ".pov";
    std::size_t count = 0;
    try {
      count = write_frame(run, index, look, output / scene);
      draw_with_povray(povray, output, scene, name + ".png", {options.width, options.height}, options.samples,
                       options.threads);
    } catch (...) {
      std::filesystem::remove(output / scene);  // long, and of no use to those who interrupt
      throw;
    }
    pictures.push_back(name + ".png");
    if (!options.keep_scenes) std::filesystem::remove(output / scene);
    spdlog::info("{}: {} points, t = {:.4f} s", (output / pictures.back()).string(), count,
                 run.points.time(index));
  }
  if (!options.film) return;
  film_with_ffmpeg(ffmpeg, output, pictures, options.pictures_per_second, *options.film);
  spdlog::info("{}: {} pictures, {} a second", (output / *options.film).string(), pictures.size(),
               options.pictures_per_second);
}

}  // namespace talus
