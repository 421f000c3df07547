#include "continuum/render/pov_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <iterator>
#include <numbers>

#include "continuum/files/input_error.h"

namespace talus {
namespace {

using Eigen::Vector3d;

// How bright the lights are, and their colours: a warm sun, the sky, and what the ground throws back from behind.
constexpr std::array<double, 3> sunlight{1.95, 1.80, 1.54}, skylight{0.40, 0.45, 0.50},
    backlight{0.15, 0.15, 0.17};
constexpr int sun_samples =
    5;  // along each side of the sun's disc; jittered, pictures would differ from draw to draw
constexpr double haze = 45.0;  // sizes of the domain over which the ground fades, so that it has no edge
constexpr const char* air = "srgb <0.80,0.79,0.77>";
constexpr double far_away = 1000.0;  // in sizes of the domain: rays of the sun are parallel

std::string text_of(const Vector3d& v) { return fmt::format("<{:.9g},{:.9g},{:.9g}>", v[0], v[1], v[2]); }
std::string text_of(const std::array<double, 3>& v) { return fmt::format("<{},{},{}>", v[0], v[1], v[2]); }

/// Goes to the disk as it is written: the text of millions of points is longer than they are.
class Text {
 public:
  explicit Text(const std::filesystem::path& file)
      : file_(file), out_(file, std::ios::binary | std::ios::trunc) {}
  template <class... Values>
  void add(fmt::format_string<Values...> format, Values&&... values) {
    fmt::format_to(std::back_inserter(buffer_), format, std::forward<Values>(values)...);
    if (buffer_.size() > (1u << 20)) flush();
  }
  void finish() {
    flush();
    out_.close();
    if (!out_) throw InputError(fmt::format("{}: cannot write", file_.string()));
  }

 private:
  void flush() {
    out_.write(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
    buffer_.clear();
  }
  std::filesystem::path file_;
  std::ofstream out_;
  fmt::memory_buffer buffer_;
};

double size_of_domain(const Scene& scene) { return (scene.grid.upper() - scene.grid.origin).norm(); }

void write_view(const Scene& scene, const Look& look, Text& text) {
  const Camera& camera = look.camera;
  text.add(
      "#version 3.7;\nglobal_settings {{ assumed_gamma 1.0 max_trace_level 8 }}\n"
      "#default {{ finish {{ ambient 0 diffuse 0.9 }} }}\nbackground {{ {} }}\nfog {{ distance {:.9g} {} }}\n"
      // POV-Ray's axes are left-handed unless right points to minus x.
      "camera {{ location {} sky {} up z right -{:.9g}*x angle {:.9g} look_at {} }}\n",
      air, haze * size_of_domain(scene), air, text_of(camera.position), text_of(camera.up), look.aspect,
      camera.field_of_view, text_of(camera.look_at));
  const ViewAxes axes = view_axes(scene);
  const double distance = far_away * size_of_domain(scene);
  const double width = 2.0 * distance * std::tan(look.sun_width * std::numbers::pi / 360.0);
  const Vector3d across = look.sun.unitOrthogonal(), along = look.sun.cross(across);
  text.add("light_source {{ {} color rgb {}", text_of(distance * look.sun), text_of(sunlight));
  if (width > 0.0) {
    text.add(" area_light {},{},{},{} adaptive 1 circular", text_of(width * across), text_of(width * along),
             sun_samples, sun_samples);
  }
  text.add(" }}\n");
  const auto fill = [&](const Vector3d& towards, const std::array<double, 3>& colour) {
    text.add("light_source {{ {} color rgb {} parallel point_at 0 shadowless }}\n",
             text_of(distance * towards.normalized()), text_of(colour));
  };
  fill(0.25 * axes.right - 0.35 * axes.away + axes.up, skylight);
  fill(axes.right + 0.7 * axes.away + 0.5 * axes.up, backlight);
}

/// The end of the domain that sand falls to, if it is a wall.
void write_floor(const Scene& scene, Text& text) {
  const Vector3d up = view_axes(scene).up;
  int axis = 0;
  up.cwiseAbs().maxCoeff(&axis);
  const std::size_t end = up[axis] > 0.0 ? 0 : 1;
  if (!scene.sides[static_cast<std::size_t>(axis)][end].wall) return;
  const Vector3d inward = (end == 0 ? 1.0 : -1.0) * Vector3d::Unit(axis);
  const Vector3d corner = end == 0 ? scene.grid.origin : scene.grid.upper();
  text.add("plane {{ {}, {:.9g} pigment {{ srgb <0.66,0.64,0.61> }} }}\n", text_of(inward),
           inward.dot(corner));
}

/// `columns`: where the axes of what stands before go to.
std::string matrix_of(const Eigen::Matrix3d& columns, const Vector3d& translation) {
  std::string matrix = "matrix <";
  for (int column = 0; column < 3; ++column)
    matrix +=
        fmt::format("{:.9g},{:.9g},{:.9g},", columns(0, column), columns(1, column), columns(2, column));
  return matrix + fmt::format("{:.9g},{:.9g},{:.9g}>", translation[0], translation[1], translation[2]);
}

/// The body of an object, without its closing brace.
struct WriteGeometry {
  Text& text;

  void operator()(const Plane& plane) const {
    text.add("plane {{ {}, {:.9g}", text_of(plane.normal), plane.normal.dot(plane.point));
  }
  void operator()(const Box& box) const {
    text.add("box {{ {}, {} {}", text_of(Vector3d(-box.half_size)), text_of(box.half_size),
             matrix_of(box.rotation, box.centre));
  }
  void operator()(const Sphere& sphere) const {
    text.add("sphere {{ {}, {:.9g}", text_of(sphere.centre), sphere.radius);
  }
  void operator()(const Revolved& solid) const {  // POV-Ray turns profiles about y
    text.add("lathe {{ linear_spline {}", solid.profile.size() + 1);
    for (std::size_t i = 0; i <= solid.profile.size(); ++i) {
      const Eigen::Vector2d& corner = solid.profile[i % solid.profile.size()];
      text.add(", <{:.9g},{:.9g}>", corner[0], corner[1]);
    }
    Eigen::Matrix3d axes;
    axes.col(1) = solid.axis;
    axes.col(0) = solid.axis.unitOrthogonal();
    axes.col(2) = axes.col(0).cross(axes.col(1));
    text.add(" {}", matrix_of(axes, solid.base));
  }
  void operator()(const Capsule& capsule) const {
    text.add("sphere_sweep {{ linear_spline 2, {}, {:.9g}, {}, {:.9g}", text_of(capsule.from), capsule.radius,
             text_of(capsule.to), capsule.radius);
  }
  void operator()(const Mesh& mesh) const {
    const std::vector<Triangle> triangles = triangles_of(mesh);
    text.add("mesh {{\n");
    for (const auto& [a, b, c] : triangles)
      text.add("triangle {{ {}, {}, {} }}\n", text_of(a), text_of(b), text_of(c));
  }
  void operator()(const SampledMesh&) const {}  // of bodies alone, which have a surface of their own
};

/// Hollow ones are of clear glass that bends no ray; solid ones are left out where the viewer would stand in them.
void write_wall(const Wall& wall, const Camera& camera, Text& text) {
  if (!wall.shape.hollow && signed_distance(wall.shape, camera.position) <= 0.0) return;
  std::visit(WriteGeometry{text}, wall.shape.geometry);
  if (wall.shape.hollow)
    text.add(
        " pigment {{ srgbt <0.90,0.96,0.98,0.90> }} finish {{ diffuse 0.5 specular 0.5 roughness 0.01 }} "
        "no_shadow }}\n");
  else
    text.add(" pigment {{ srgb <0.55,0.57,0.60> }} finish {{ specular 0.1 }} }}\n");
}

void write_body(const DrawnBody& body, const Eigen::Isometry3d& placement, Text& text) {
  text.add("mesh2 {{ vertex_vectors {{ {}", body.surface.corners.size());
  for (const Eigen::Vector3f& corner : body.surface.corners)
    text.add(", <{:.9g},{:.9g},{:.9g}>", corner[0], corner[1], corner[2]);
  text.add(" }}\nface_indices {{ {}", body.surface.faces.size());
  for (const auto& [a, b, c] : body.surface.faces) text.add(", <{},{},{}>", a, b, c);
  text.add(" }}\n{} pigment {{ srgb <0.62,0.66,0.72> }} finish {{ specular 0.4 roughness 0.03 }} }}\n",
           matrix_of(placement.linear(), placement.translation()));
}

std::size_t texture_of(const RenderFrame& frame, std::size_t point) {
  return static_cast<std::size_t>(frame.materials[point] * shades + shade_of(frame.identities[point]));
}

/// The points' numbers, by texture: those of texture t are [first[t], first[t + 1]).
struct ByTexture {
  std::vector<std::size_t> first;
  std::vector<std::uint32_t> points;
};

ByTexture by_texture(const RenderFrame& frame, std::size_t textures) {
  ByTexture sorted{std::vector<std::size_t>(textures + 1, 0), std::vector<std::uint32_t>(frame.count())};
  for (std::size_t k = 0; k < frame.count(); ++k) ++sorted.first[texture_of(frame, k) + 1];
  for (std::size_t t = 0; t < textures; ++t) sorted.first[t + 1] += sorted.first[t];
  std::vector<std::size_t> next(sorted.first.begin(), sorted.first.end() - 1);
  for (std::size_t k = 0; k < frame.count(); ++k)
    sorted.points[next[texture_of(frame, k)]++] = static_cast<std::uint32_t>(k);
  return sorted;
}

void write_sand(const RenderFrame& frame, const Look& look, double smallest, Text& text) {
  const std::size_t textures = look.colours.size() * shades;
  const ByTexture sorted = by_texture(frame, textures);
  const int decimals = std::max(3, static_cast<int>(std::ceil(-std::log10(smallest))));
  for (std::size_t t = 0; t < textures; ++t) {
    if (sorted.first[t] == sorted.first[t + 1]) continue;
    const Colour colour = shaded(look.colours[t / shades], static_cast<int>(t % shades));
    text.add("union {{\n");
    for (std::size_t i = sorted.first[t]; i < sorted.first[t + 1]; ++i) {
      const std::uint32_t k = sorted.points[i];
      const auto at = frame.positions.col(k);
      text.add("sphere{{<{:.{}f},{:.{}f},{:.{}f}>,{:.4g}}}\n", at[0], decimals, at[1], decimals, at[2],
               decimals, look.radius * size_of(frame.identities[k]));
    }
    text.add("pigment {{ srgb {} }} }}\n", text_of(colour));
  }
}

}  // namespace

Eigen::Vector3d default_sun(const Scene& scene) {
  const ViewAxes axes = view_axes(scene);
  return (-axes.right - 0.2 * axes.away + 0.95 * axes.up).normalized();
}

void write_pov_scene(const std::filesystem::path& file, const RunFolder& run, const RenderFrame& frame,
                     const Look& look) {
  constexpr double share_of_radius = 0.02;  // to which places are written
  Text text(file);
  write_view(run.scene, look, text);
  write_floor(run.scene, text);
  for (const Wall& wall : run.scene.walls) {
    if (wall.stands_at(frame.time)) write_wall(wall, look.camera, text);
  }
  for (const DrawnBody& body : run.bodies) {
    for (const Eigen::Isometry3d& image : images_at(body, frame.time, run.scene.grid))
      write_body(body, image, text);
  }
  write_sand(frame, look, share_of_radius * look.radius, text);
  text.finish();
}

}  // namespace talus
