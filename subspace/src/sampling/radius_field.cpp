#include "orbifit/subspace/radius_field.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <queue>
#include <string>
#include <utility>

#include "orbifit/model/errors.h"

#include "geometry/point_index.h"
#include "geometry/surface_index.h"

namespace orbifit {

namespace {

using Eigen::Index;
using Eigen::Vector3d;

constexpr int kNearest = 8;
constexpr int kMaxShrinkings = 30;
constexpr double kOpposite = 0.5;  // cosine: faces that look the other way by at least 120 degrees
constexpr double kTouching = 1e-6;
constexpr double kPerThickness = 0.5;  // r as a fraction of the thickness

// Diameter of the largest ball that touches the surface at `point` from inside and no opposite face, at most `most`:
// a ball is shrunk until it holds no point of one (Ma, Bae and Choi 2012).
double thickness(const SurfaceIndex& surface, const Vector3d& point, const Vector3d& normal, double most) {
  double radius = most / 2;
  for (int step = 0; step < kMaxShrinkings; ++step) {
    const Vector3d centre = point - radius * normal;
    const SurfaceIndex::Nearest nearest = surface.nearest_facing(centre, -normal, kOpposite, radius);
    if (nearest.face < 0 || nearest.distance >= radius * (1 - kTouching)) break;
    const Vector3d offset = point - nearest.point;
    const double depth = 2 * normal.dot(offset);
    if (!(depth > 0)) break;
    radius = std::min(radius, offset.squaredNorm() / depth);
  }
  return 2 * radius;
}

Eigen::VectorXd radii_from_thickness(const Mesh& mesh, const RadiusFieldOptions& options, const RunContext& context) {
  const SurfaceIndex surface(mesh);
  const Points normals = vertex_normals(mesh);
  const double largest = options.largest * options.base;
  Eigen::VectorXd radii = Eigen::VectorXd::Constant(mesh.vertices.rows(), largest);
  parallel_for(context, static_cast<std::size_t>(mesh.vertices.rows()), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto v = static_cast<Index>(i);
      if (normals.row(v).squaredNorm() == 0) continue;
      const double here =
          thickness(surface, mesh.vertices.row(v).transpose(), normals.row(v).transpose(), largest / kPerThickness);
      radii[v] = std::clamp(kPerThickness * here, options.smallest * options.base, largest);
    }
  });
  return radii;
}

// The smallest factor of the areas that hold a point.
std::optional<double> painted_factor(const std::vector<PaintedArea>& areas, const Vector3d& point) {
  std::optional<double> factor;
  for (const PaintedArea& area : areas) {
    if ((point - area.centre).norm() > area.radius) continue;
    factor = std::min(factor.value_or(area.factor), area.factor);
  }
  return factor;
}

// Lowers radii to r(v) <= r(w) + gradation |v - w|, in the order of the radii (Dijkstra).
void limit_gradation(const Mesh& mesh, double gradation, const RunContext& context, Eigen::VectorXd& radii) {
  const auto count = static_cast<std::size_t>(radii.size());
  std::vector<std::vector<int>> neighbours(count);
  const PointIndex index(mesh.vertices);
  parallel_for(context, count, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      for (const auto& near : index.nearest(mesh.vertices.row(static_cast<Index>(v)).transpose(), kNearest + 1)) {
        neighbours[v].push_back(near.index);
      }
    }
  });
  for (Index f = 0; f < mesh.faces.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      neighbours[static_cast<std::size_t>(mesh.faces(f, k))].push_back(mesh.faces(f, (k + 1) % 3));
      neighbours[static_cast<std::size_t>(mesh.faces(f, k))].push_back(mesh.faces(f, (k + 2) % 3));
    }
  }
  // Nearness is not mutual: what is near v must know v too.
  std::vector<std::pair<int, int>> back;
  for (std::size_t v = 0; v < count; ++v) {
    for (const int w : neighbours[v]) back.emplace_back(w, static_cast<int>(v));
  }
  for (const auto& [w, v] : back) neighbours[static_cast<std::size_t>(w)].push_back(v);
  using Entry = std::pair<double, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  for (Index v = 0; v < radii.size(); ++v) queue.emplace(radii[v], static_cast<int>(v));
  while (!queue.empty()) {
    const auto [radius, vertex] = queue.top();
    queue.pop();
    if (radius > radii[vertex]) continue;
    for (const int other : neighbours[static_cast<std::size_t>(vertex)]) {
      const double limit = radius + gradation * (mesh.vertices.row(other) - mesh.vertices.row(vertex)).norm();
      if (limit >= radii[other]) continue;
      radii[other] = limit;
      queue.emplace(limit, other);
    }
  }
}

}  // namespace

void RadiusFieldOptions::validate() const {
  require(base > 0 && std::isfinite(base), "base", base, "positive");
  require(smallest > 0 && std::isfinite(smallest), "smallest", smallest, "positive");
  require(largest >= smallest && std::isfinite(largest), "largest", largest, "at least smallest");
  require(gradation > 0 && std::isfinite(gradation), "gradation", gradation, "positive");
  for (std::size_t a = 0; a < areas.size(); ++a) {
    const std::string name = "areas[" + std::to_string(a) + "].";
    require(areas[a].centre.allFinite(), name + "centre", areas[a].centre[0], "finite");
    require(areas[a].radius > 0 && std::isfinite(areas[a].radius), name + "radius", areas[a].radius, "positive");
    require(areas[a].factor > 0 && std::isfinite(areas[a].factor), name + "factor", areas[a].factor, "positive");
  }
}

Eigen::VectorXd radius_field(const Mesh& mesh, const RadiusFieldOptions& options, const RunContext& context) {
  options.validate();
  Eigen::VectorXd radii = options.feature_size ? radii_from_thickness(mesh, options, context)
                                               : Eigen::VectorXd::Constant(mesh.vertices.rows(), options.base);
  for (Index v = 0; v < radii.size(); ++v) {
    const std::optional<double> factor = painted_factor(options.areas, mesh.vertices.row(v).transpose());
    if (factor) radii[v] = *factor * options.base;
  }
  limit_gradation(mesh, options.gradation, context, radii);
  // Fine areas reach out in space, whatever vertices they hold.
  for (const PaintedArea& area : options.areas) {
    for (Index v = 0; v < radii.size(); ++v) {
      const double outside = std::max(0.0, (mesh.vertices.row(v).transpose() - area.centre).norm() - area.radius);
      radii[v] = std::min(radii[v], area.factor * options.base + options.gradation * outside);
    }
  }
  return radii;
}

Eigen::VectorXd relative_radii(const Mesh& mesh, const std::filesystem::path& file, const SubspaceOptions& options,
                               const RunContext& context) {
  constexpr double kUsualSamples = 600;
  options.validate();
  const double area = face_areas(mesh).sum();
  if (!(area > 0)) throw InputError("", "mesh", "its faces have no area");
  const double samples = options.samples > 0 ? options.samples : kUsualSamples;
  const double base = options.radius > 0 ? options.radius : std::sqrt(area / (0.7 * samples));
  return radius_field(mesh, read_radius_field(file, base), context) / base;
}

}  // namespace orbifit
