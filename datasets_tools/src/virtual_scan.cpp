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
#include "orbifit/model/random.h"
#include "orbifit/model/surface_index.h"

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
};

// The points of one row of pixels; its random numbers are its own, whatever thread it runs on.
std::vector<Seen> scan_row(const SurfaceIndex& surface, const Points& normals, const Camera& camera,
                           const ScanOptions& options, int view, int row, std::uint64_t seed, double deviation) {
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
    seen.push_back({point, view});
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
  demand(grazing_limit > 0 && grazing_limit <= 90, "grazing_limit", grazing_limit, "above 0 and at most 90 degrees");
  demand(up.norm() > 0 && up.allFinite(), "up", up.norm(), "a vector of positive length");
}

PointCloud virtual_scan(const Mesh& mesh, const ScanOptions& options, RunContext& context) {
  options.validate();
  if (mesh.faces.rows() == 0) throw NoResultError("no pixel sees the mesh: it has no faces");
  const double diagonal_length = diagonal(mesh.vertices);
  const Vector3d centre = bounding_box_centre(mesh.vertices);
  const SurfaceIndex surface(mesh);
  const Points normals = face_normals(mesh);
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
                             static_cast<int>(row), context.seed, deviation);
      }
    });
    for (const std::vector<Seen>& row : rows) seen.insert(seen.end(), row.begin(), row.end());
  }
  if (seen.empty()) throw NoResultError("no pixel sees the mesh; a wider field of view or more pixels may help");
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
