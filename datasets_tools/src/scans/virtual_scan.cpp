#include "orbifit/datasets_tools/virtual_scan.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "orbifit/model/errors.h"

#include "base/random.h"
#include "geometry/surface_index.h"

namespace orbifit {

namespace {

using Eigen::Vector3d;

double radians(double degrees) {
  return degrees * std::numbers::pi / 180;
}

// A pinhole camera that looks at a point.
struct Camera {
  Vector3d position;
  Vector3d forward, right, down;  // unit
  double focal_length;            // pixels
  int width, height;

  // Unit direction through the middle of a pixel; row 0 on top.
  Vector3d ray(int column, int row) const {
    const double x = (column + 0.5 - 0.5 * width) / focal_length;
    const double y = (row + 0.5 - 0.5 * height) / focal_length;
    return (forward + x * right + y * down).normalized();
  }
};

Camera camera_of_view(const ScanOptions& options, int view, const Vector3d& centre, double diagonal_length) {
  const Vector3d up = options.up.normalized();
  const Vector3d x = Vector3d::UnitX() - up.x() * up;
  // Azimuth counts from x; where `up` is x itself, from y.
  const Vector3d ahead =
      x.norm() > 1e-6 ? Vector3d(x.normalized()) : Vector3d((Vector3d::UnitY() - up.y() * up).normalized());
  const Vector3d aside = up.cross(ahead);
  const double azimuth = radians(options.azimuth + 360.0 * view / options.views);
  const double elevation = radians(options.elevation);
  const Vector3d outwards =
      std::cos(elevation) * (std::cos(azimuth) * ahead + std::sin(azimuth) * aside) + std::sin(elevation) * up;
  Camera camera;
  camera.position = centre + options.distance * diagonal_length * outwards;
  camera.forward = -outwards;
  camera.right = camera.forward.cross(up).normalized();
  camera.down = camera.forward.cross(camera.right);
  camera.focal_length = 0.5 * options.height / std::tan(0.5 * radians(options.field_of_view));
  camera.width = options.width;
  camera.height = options.height;
  return camera;
}

struct Seen {
  Vector3d point;
  int view;
  bool clutter;
};

void add_box(Mesh& mesh, const Eigen::AlignedBox3d& box) {
  const auto first = static_cast<int>(mesh.vertices.rows());
  mesh.vertices.conservativeResize(first + 8, 3);
  for (int k = 0; k < 8; ++k) {
    mesh.vertices.row(first + k) = box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(k)).transpose();
  }
  constexpr int kFaces[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                 {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  const Eigen::Index at = mesh.faces.rows();
  mesh.faces.conservativeResize(at + 12, 3);
  for (int f = 0; f < 12; ++f) {
    for (int k = 0; k < 3; ++k) mesh.faces(at + f, k) = first + kFaces[f][k];
  }
}

// The mesh on a floor, with blocks beside it; `up` is upwards. The mesh's faces come first.
Mesh cluttered(const Mesh& mesh, const Vector3d& up, std::uint64_t seed) {
  Random random(seed, "scan clutter");
  const Eigen::Matrix3d frame =
      Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), up.normalized()).toRotationMatrix();
  Mesh scene = mesh;
  scene.vertices = mesh.vertices * frame;  // up is z
  const Eigen::AlignedBox3d box(scene.vertices.colwise().minCoeff().transpose(),
                                scene.vertices.colwise().maxCoeff().transpose());
  const double size = box.diagonal().norm();
  const Vector3d middle(box.center().x(), box.center().y(), box.min().z());
  add_box(scene, {middle + size * Vector3d(-0.8, -0.8, -0.02), middle + size * Vector3d(0.8, 0.8, -0.001)});
  for (int block = 0; block < 3; ++block) {
    const double angle = radians(random.uniform(0, 360));
    const double beside = 0.5 * box.sizes().head<2>().norm() + random.uniform(0.08, 0.25) * size;
    const Vector3d at = middle + beside * Vector3d(std::cos(angle), std::sin(angle), 0);
    const Vector3d half = size * Vector3d(random.uniform(0.03, 0.1), random.uniform(0.03, 0.1), 0);
    const Vector3d height = size * Vector3d(0, 0, random.uniform(0.1, 0.4));
    add_box(scene, {at - half, at + half + height});
  }
  scene.vertices = scene.vertices * frame.transpose();
  return scene;
}

// Leaves as many points of clutter as make up the fraction.
void thin_clutter(std::vector<Seen>& seen, double fraction, std::uint64_t seed) {
  const auto all = static_cast<double>(std::ranges::count_if(seen, &Seen::clutter));
  const double wanted = (static_cast<double>(seen.size()) - all) * fraction / (1 - fraction);
  if (all <= wanted) return;
  Random random(seed, "scan thinning");
  std::erase_if(seen, [&](const Seen& each) { return each.clutter && random.uniform() * all >= wanted; });
}

// The points of one row of pixels; its random numbers are its own, whatever thread it runs on.
std::vector<Seen> scan_row(const SurfaceIndex& surface, const Points& normals, const Camera& camera,
                           const ScanOptions& options, int view, int row, std::uint64_t seed, double deviation,
                           int own_faces) {
  std::vector<Seen> seen;
  Random random(seed, "scan " + std::to_string(view) + " " + std::to_string(row));
  const double least_cosine = std::cos(radians(options.grazing_limit));
  for (int column = 0; column < camera.width; ++column) {
    const Vector3d direction = camera.ray(column, row);
    const auto hit = surface.cast(camera.position, direction);
    if (!hit || std::abs(normals.row(hit->face).dot(direction)) < least_cosine) continue;
    Vector3d point = hit->point;
    if (deviation > 0) {
      // A triangulating sensor's error grows with the square of the depth.
      const double depth = (point - camera.position).dot(camera.forward);
      point += random.normal() * deviation * depth * depth * direction;
    }
    seen.push_back({point, view, hit->face >= own_faces});
  }
  return seen;
}

void scatter_outliers(std::vector<Seen>& seen, double fraction, const Mesh& mesh, std::uint64_t seed) {
  const std::size_t count = static_cast<std::size_t>(std::lround(fraction * static_cast<double>(seen.size())));
  if (count == 0) return;
  Random random(seed, "scan outliers");
  const Vector3d low = mesh.vertices.colwise().minCoeff();
  const Vector3d high = mesh.vertices.colwise().maxCoeff();
  std::vector<std::size_t> order(seen.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  for (std::size_t i = 0; i < count; ++i) {
    std::swap(order[i], order[i + random.below(order.size() - i)]);
    Vector3d& point = seen[order[i]].point;
    for (int k = 0; k < 3; ++k) point[k] = random.uniform(low[k], high[k]);
  }
}

void demand(bool holds, const char* name, double value, const char* rule) {
  if (holds) return;
  std::ostringstream text;
  text << name << " = " << value << ": must be " << rule;
  throw UsageError(text.str());
}

}  // namespace

void ScanOptions::validate() const {
  demand(views >= 1, "views", views, "at least 1");
  demand(std::isfinite(azimuth), "azimuth", azimuth, "finite");
  demand(elevation > -90 && elevation < 90, "elevation", elevation, "between -90 and 90 degrees");
  demand(distance > 0.6 && std::isfinite(distance), "distance", distance, "above 0.6 diagonals");
  demand(width >= 8, "width", width, "at least 8 pixels");
  demand(height >= 8, "height", height, "at least 8 pixels");
  demand(field_of_view > 1 && field_of_view < 120, "field_of_view", field_of_view, "between 1 and 120 degrees");
  demand(noise >= 0 && std::isfinite(noise), "noise", noise, "at least 0");
  demand(outliers >= 0 && outliers < 1, "outliers", outliers, "at least 0 and below 1");
  demand(clutter >= 0 && clutter <= 0.9, "clutter", clutter, "from 0 to 0.9");
  demand(grazing_limit > 0 && grazing_limit <= 90, "grazing_limit", grazing_limit, "above 0 and at most 90 degrees");
  demand(up.norm() > 0 && up.allFinite(), "up", up.norm(), "a vector of positive length");
}

PointCloud virtual_scan(const Mesh& mesh, const ScanOptions& options, RunContext& context) {
  options.validate();
  if (mesh.faces.rows() == 0) throw NoResultError("no pixel sees the mesh: it has no faces");
  const double diagonal_length = diagonal(mesh.vertices);
  const Vector3d centre = bounding_box_centre(mesh.vertices);
  const Mesh scene = options.clutter > 0 ? cluttered(mesh, options.up, context.seed) : mesh;
  const SurfaceIndex surface(scene);
  const Points normals = face_normals(scene);
  const double centre_depth = options.distance * diagonal_length;
  const double deviation = options.noise * diagonal_length / (centre_depth * centre_depth);

  std::vector<Camera> cameras;
  cameras.reserve(static_cast<std::size_t>(options.views));
  for (int view = 0; view < options.views; ++view) {
    cameras.push_back(camera_of_view(options, view, centre, diagonal_length));
  }
  const std::size_t height = static_cast<std::size_t>(options.height);
  std::vector<Seen> seen;
  for (int view = 0; view < options.views; ++view) {
    context.progress("scan", static_cast<double>(view) / options.views);
    std::vector<std::vector<Seen>> rows(height);
    parallel_for(context, height, [&](std::size_t begin, std::size_t end) {
      for (std::size_t row = begin; row < end; ++row) {
        rows[row] = scan_row(surface, normals, cameras[static_cast<std::size_t>(view)], options, view,
                             static_cast<int>(row), context.seed, deviation, static_cast<int>(mesh.faces.rows()));
      }
    });
    for (const std::vector<Seen>& row : rows) seen.insert(seen.end(), row.begin(), row.end());
  }
  if (std::ranges::all_of(seen, &Seen::clutter)) {
    throw NoResultError("no pixel sees the mesh; a wider field of view or more pixels may help");
  }
  if (options.clutter > 0) thin_clutter(seen, options.clutter, context.seed);
  scatter_outliers(seen, options.outliers, mesh, context.seed);

  PointCloud scan;
  scan.points.resize(static_cast<Eigen::Index>(seen.size()), 3);
  scan.viewpoints.resize(scan.points.rows(), 3);
  for (std::size_t i = 0; i < seen.size(); ++i) {
    scan.points.row(static_cast<Eigen::Index>(i)) = seen[i].point;
    scan.viewpoints.row(static_cast<Eigen::Index>(i)) = cameras[static_cast<std::size_t>(seen[i].view)].position;
  }
  return scan;
}

}  // namespace orbifit
