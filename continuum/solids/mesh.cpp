#include "continuum/solids/mesh.h"

// With sanitizers, g++ 12 suspects an empty boost::optional in CGAL.
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif
#include <CGAL/AABB_face_graph_triangle_primitive.h>
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/compute_normal.h>
#include <CGAL/Polygon_mesh_processing/measure.h>
#include <CGAL/Polygon_mesh_processing/orientation.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/repair_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Side_of_triangle_mesh.h>
#include <CGAL/Surface_mesh.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "continuum/files/input_error.h"
#include "continuum/solids/mesh_file.h"

namespace talus {
namespace {

namespace processing = CGAL::Polygon_mesh_processing;
// The sign is exact; distances are rounded.
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Surface = CGAL::Surface_mesh<Point>;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, CGAL::AABB_face_graph_triangle_primitive<Surface>>>;

/// The same as in a file (mesh_file.h), in m.
struct Soup {
  std::vector<Point> points;
  std::vector<std::array<std::size_t, 3>> triangles;
};

InputError fault(const std::filesystem::path& file, std::string_view why) {
  return InputError(fmt::format("{}: {}", file.string(), why));
}

Soup read_soup(const std::filesystem::path& file, double scale, const Eigen::Vector3d& offset) {
  TriangleSoup read = read_triangles_of_file(file);
  Soup soup;
  soup.triangles = std::move(read.triangles);
  soup.points.reserve(read.points.size());
  for (const Eigen::Vector3f& vertex : read.points) {
    const Eigen::Vector3d at = scale * vertex.cast<double>() + offset;
    if (!at.allFinite()) {
      throw fault(file,
                  fmt::format("has a vertex at ({}, {}, {}); every coordinate must be finite, also after "
                              "scale and offset; mend the file",
                              vertex[0], vertex[1], vertex[2]));
    }
    soup.points.emplace_back(at[0], at[1], at[2]);
  }
  return soup;
}

void join_vertices(Soup& soup) {
  processing::merge_duplicate_points_in_polygon_soup(soup.points, soup.triangles);
  std::erase_if(soup.triangles, [](const auto& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; });
  // CGAL looks for the outermost triangle at the outermost vertex, and reads past its tables where that belongs to none.
  processing::remove_isolated_points_in_polygon_soup(soup.points, soup.triangles);
}

void require_area(const std::filesystem::path& file, const Soup& soup) {
  const auto flat = std::count_if(soup.triangles.begin(), soup.triangles.end(), [&](const auto& t) {
    return CGAL::collinear(soup.points[t[0]], soup.points[t[1]], soup.points[t[2]]);
  });
  if (flat == static_cast<std::ptrdiff_t>(soup.triangles.size()))
    throw fault(file, "has no triangle with an area; give a surface that encloses the solid");
  if (flat > 0) {
    throw fault(file,
                fmt::format("has {} triangle(s) whose three corners lie on one line; remove them in a mesh "
                            "editor, joining the edges they lie between",
                            flat));
  }
}

/// Every edge must belong to two triangles that pass it in opposite directions.
void require_closed_manifold(const std::filesystem::path& file, const Soup& soup) {
  std::map<std::pair<std::size_t, std::size_t>, std::array<int, 2>> edges;  // uses upwards, downwards
  for (const auto& triangle : soup.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t from = triangle[i], to = triangle[(i + 1) % 3];
      ++edges[std::minmax(from, to)][from < to ? 0 : 1];
    }
  }
  std::size_t open = 0, crowded = 0, opposed = 0;
  for (const auto& [ends, uses] : edges) {
    const int total = uses[0] + uses[1];
    if (total == 1)
      ++open;
    else if (total > 2)
      ++crowded;
    else if (uses[0] != uses[1])
      ++opposed;
  }
  if (crowded > 0) {
    throw fault(file,
                fmt::format("is not manifold: {} edge(s) belong to more than two triangles; remove inner and "
                            "doubled faces in a mesh editor",
                            crowded));
  }
  if (open > 0) {
    throw fault(file,
                fmt::format("is not closed: {} edge(s) belong to one triangle only; join vertices and fill "
                            "holes in a mesh editor",
                            open));
  }
  if (opposed > 0) {
    throw fault(file,
                fmt::format("has triangles that face opposite ways across {} edge(s); make all normals point "
                            "out of the solid in a mesh editor",
                            opposed));
  }
  if (!processing::is_polygon_soup_a_polygon_mesh(soup.triangles)) {
    throw fault(
        file,
        "is not manifold: parts of the surface touch in a vertex; move them apart or join them by faces");
  }
}

void require_solid(const std::filesystem::path& file, const Surface& surface) {
  if (processing::does_self_intersect(surface)) {
    throw fault(file,
                "intersects itself; unite overlapping parts (a boolean union) in a mesh editor, so that one "
                "surface encloses the solid");
  }
  // The first alone would also pass a surface that is inside out as a whole.
  if (!processing::does_bound_a_volume(surface) || processing::volume(surface) <= 0.0) {
    throw fault(
        file,
        "is oriented inside out, whole or in part; flip the triangles so that all normals point out of "
        "the solid (into its cavities, if it has any)");
  }
}

Point to_point(const Eigen::Vector3d& at) { return {at[0], at[1], at[2]}; }

}  // namespace

struct MeshSurface {
  explicit MeshSurface(Surface sound)
      : surface(std::move(sound)),
        tree(faces(surface).begin(), faces(surface).end(), surface),
        side_of(tree) {
    tree.build();
    tree.accelerate_distance_queries();  // now, so that queries change nothing
  }
  MeshSurface(const MeshSurface&) = delete;  // the tree points to the surface
  MeshSurface& operator=(const MeshSurface&) = delete;

  Surface surface;
  Tree tree;
  CGAL::Side_of_triangle_mesh<Surface, Kernel> side_of;
};

Mesh read_mesh(const std::filesystem::path& file, double scale, const Eigen::Vector3d& offset) {
  Soup soup = read_soup(file, scale, offset);
  join_vertices(soup);
  require_area(file, soup);
  require_closed_manifold(file, soup);
  Surface surface;
  processing::polygon_soup_to_polygon_mesh(soup.points, soup.triangles, surface);
  require_solid(file, surface);
  return {std::make_shared<const MeshSurface>(std::move(surface))};
}

std::vector<Triangle> triangles_of(const Mesh& mesh) {
  const Surface& surface = mesh.surface->surface;
  std::vector<Triangle> triangles;
  triangles.reserve(surface.number_of_faces());
  for (const auto face : surface.faces()) {
    Triangle triangle;
    std::size_t corner = 0;
    for (const auto vertex : surface.vertices_around_face(surface.halfedge(face))) {
      const Point& at = surface.point(vertex);
      triangle[corner++] = {at.x(), at.y(), at.z()};
    }
    triangles.push_back(triangle);
  }
  return triangles;
}

Mesh shifted(const Mesh& mesh, const Eigen::Vector3d& by) {
  Surface surface = mesh.surface->surface;
  for (const auto vertex : surface.vertices())
    surface.point(vertex) = surface.point(vertex) + Kernel::Vector_3(by[0], by[1], by[2]);
  return {std::make_shared<const MeshSurface>(std::move(surface))};
}

double signed_distance(const Mesh& mesh, const Eigen::Vector3d& point) {
  const Point at = to_point(point);
  const double distance = std::sqrt(mesh.surface->tree.squared_distance(at));
  return mesh.surface->side_of(at) == CGAL::ON_BOUNDED_SIDE ? -distance : distance;
}

double thinnest_part(const Mesh& mesh) {
  constexpr double opposite = -0.8;  // at most, cosine of normals
  const Surface& surface = mesh.surface->surface;
  double thinnest = std::numeric_limits<double>::infinity();
  for (const auto face : surface.faces()) {
    const auto corner = surface.halfedge(face);
    const Point middle =
        CGAL::centroid(surface.point(surface.source(corner)), surface.point(surface.target(corner)),
                       surface.point(surface.target(surface.next(corner))));
    const auto normal = processing::compute_face_normal(face, surface);
    const auto hit = mesh.surface->tree.first_intersection(Kernel::Ray_3(middle, -normal),
                                                           [&](const auto other) { return other == face; });
    const Point* const exit = hit ? boost::get<Point>(&hit->first) : nullptr;
    if (!exit || processing::compute_face_normal(hit->second, surface) * normal > opposite) continue;
    thinnest = std::min(thinnest, std::sqrt(CGAL::squared_distance(middle, *exit)));
  }
  return thinnest;
}

Eigen::AlignedBox3d bounds(const Mesh& mesh) {
  const auto box = mesh.surface->tree.bbox();
  return {Eigen::Vector3d(box.xmin(), box.ymin(), box.zmin()),
          Eigen::Vector3d(box.xmax(), box.ymax(), box.zmax())};
}

}  // namespace talus
