#include "orbifit/apps/upright.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "files/file.h"

namespace orbifit {

namespace {

using Polygon = std::vector<Eigen::Vector2d>;

double cross(const Eigen::Vector2d& origin, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return (a.x() - origin.x()) * (b.y() - origin.y()) - (a.y() - origin.y()) * (b.x() - origin.x());
}

// Counter-clockwise, by Andrew's monotone chain.
Polygon convex_hull(Polygon points) {
  std::ranges::sort(points,
                    [](const auto& a, const auto& b) { return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y(); });
  Polygon hull;
  const auto add = [&](const Eigen::Vector2d& point, std::size_t least) {
    while (hull.size() >= least && cross(hull[hull.size() - 2], hull.back(), point) <= 0) hull.pop_back();
    hull.push_back(point);
  };
  for (const Eigen::Vector2d& point : points) add(point, 2);
  const std::size_t lower = hull.size() + 1;
  for (std::size_t i = points.size(); i-- > 1;) add(points[i - 1], lower);
  if (hull.size() > 1) hull.pop_back();
  return hull;
}

double area_of(const Polygon& hull) {
  double area = 0;
  for (std::size_t i = 2; i < hull.size(); ++i) area += 0.5 * cross(hull[0], hull[i - 1], hull[i]);
  return area;
}

bool holds(const Polygon& hull, const Eigen::Vector2d& point) {
  for (std::size_t i = 0; i < hull.size(); ++i) {
    if (cross(hull[i], hull[(i + 1) % hull.size()], point) < 0) return false;
  }
  return hull.size() > 2;
}

/// How a shape stands with one coordinate axis up.
struct Stance {
  double support = 0;    ///< convex hull of what touches the ground, as a share of the footprint's
  double flat = 0;       ///< area of faces that lie on the ground, likewise
  double asymmetry = 0;  ///< share of the area that has none at the same place of the other half
  bool stable = false;   ///< the centre of area is above what touches the ground

  /// 0 for a shape that would fall over, or looks the same upside down; 1 at best.
  double score() const { return stable ? support * asymmetry : 0; }
};

class StandingShape {
 public:
  explicit StandingShape(const Mesh& mesh) : mesh_(mesh), areas_(face_areas(mesh)) {
    used_.assign(static_cast<std::size_t>(mesh.vertices.rows()), 0);
    centres_.resize(mesh.faces.rows(), 3);
    low_.setConstant(std::numeric_limits<double>::infinity());
    high_ = -low_;
    for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
      centres_.row(f).setZero();
      for (int k = 0; k < 3; ++k) {
        const Eigen::RowVector3d corner = mesh.vertices.row(mesh.faces(f, k));
        used_[static_cast<std::size_t>(mesh.faces(f, k))] = 1;
        centres_.row(f) += corner / 3;
        low_ = low_.cwiseMin(corner);
        high_ = high_.cwiseMax(corner);
      }
    }
    ground_ = kTouch * (high_ - low_).norm();
  }

  Stance stance(int up) const {
    const int u = (up + 1) % 3;
    const int v = (up + 2) % 3;
    Polygon all;
    Polygon touching;
    for (Eigen::Index i = 0; i < mesh_.vertices.rows(); ++i) {
      if (used_[static_cast<std::size_t>(i)] == 0) continue;
      all.emplace_back(mesh_.vertices(i, u), mesh_.vertices(i, v));
      if (mesh_.vertices(i, up) - low_[up] < ground_) touching.push_back(all.back());
    }
    const double footprint = area_of(convex_hull(std::move(all)));
    const double total = areas_.sum();
    Stance result;
    if (!(footprint > 0 && total > 0)) return result;
    const Polygon base = convex_hull(std::move(touching));
    const Eigen::RowVector3d centre = areas_.transpose() * centres_ / total;
    result.support = area_of(base) / footprint;
    result.stable = holds(base, {centre[u], centre[v]});
    result.flat = lying_area(up) / footprint;
    result.asymmetry = asymmetry(up, total);
    return result;
  }

 private:
  static constexpr double kTouch = 0.01;  // of the diagonal: what is nearer to the ground touches it

  double lying_area(int up) const {
    double area = 0;
    for (Eigen::Index f = 0; f < mesh_.faces.rows(); ++f) {
      double highest = 0;
      for (int k = 0; k < 3; ++k) highest = std::max(highest, mesh_.vertices(mesh_.faces(f, k), up) - low_[up]);
      if (highest < ground_) area += areas_[f];
    }
    return area;
  }

  double asymmetry(int up, double total) const {
    constexpr int kSlices = 32;
    std::array<double, kSlices> slices{};
    for (Eigen::Index f = 0; f < mesh_.faces.rows(); ++f) {
      const double height = (centres_(f, up) - low_[up]) / std::max(high_[up] - low_[up], 1e-300);
      slices[static_cast<std::size_t>(std::clamp(static_cast<int>(height * kSlices), 0, kSlices - 1))] += areas_[f];
    }
    double difference = 0;
    for (std::size_t i = 0; i < kSlices; ++i) difference += 0.5 * std::abs(slices[i] - slices[kSlices - 1 - i]);
    return difference / total;
  }

  const Mesh& mesh_;
  Eigen::VectorXd areas_;
  std::vector<char> used_;
  Points centres_;  // of faces
  Eigen::RowVector3d low_, high_;
  double ground_ = 0;
};

// The axis of a group of all faces, where it is far from the coordinate axes.
std::optional<Eigen::Vector3d> oblique_axis(const Mesh& mesh, const SymmetryAnnotation& annotation) {
  constexpr double kAside = 0.996;  // cosine of 5 degrees: less is a scan's misalignment
  for (const Region& region : annotation.regions) {
    if (static_cast<Eigen::Index>(region.faces.size()) != mesh.faces.rows()) continue;
    if (!region.group.has_axis() || region.group.family == PointGroup::Family::Cs) continue;
    const Eigen::Vector3d axis = region.axis.normalized();
    if (axis.cwiseAbs().maxCoeff() < kAside) return axis;
  }
  return std::nullopt;
}

}  // namespace

std::optional<Eigen::Vector3d> format_up(const std::filesystem::path& file) {
  const std::string ending = lower_extension(file);
  if (ending == ".gltf" || ending == ".glb") return Eigen::Vector3d::UnitY();
  return std::nullopt;
}

Eigen::Vector3d guess_up(const Mesh& mesh) {
  constexpr double kFlat = 0.5;     // of the footprint lies on the ground: a block, which stands as it is
  constexpr double kMargin = 0.05;  // of the score: less says nothing
  const StandingShape shape(mesh);
  const Stance z = shape.stance(2);
  if (z.stable && z.support > kFlat && z.flat > kFlat) return Eigen::Vector3d::UnitZ();
  return shape.stance(1).score() > z.score() + kMargin ? Eigen::Vector3d::UnitY() : Eigen::Vector3d::UnitZ();
}

Eigen::Vector3d up_of(const Mesh& mesh, const std::filesystem::path& file, const SymmetryAnnotation* annotation) {
  if (annotation != nullptr && annotation->up) return annotation->up->normalized();
  const std::optional<Eigen::Vector3d> prescribed = format_up(file);
  const Eigen::Vector3d up = prescribed ? *prescribed : guess_up(mesh);
  const std::optional<Eigen::Vector3d> axis = annotation == nullptr ? std::nullopt : oblique_axis(mesh, *annotation);
  if (!axis) return up;
  return axis->dot(up) < 0 ? -*axis : *axis;
}

}  // namespace orbifit
