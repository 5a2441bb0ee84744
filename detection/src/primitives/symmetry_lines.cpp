#include "primitives/symmetry_lines.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>

#include <Eigen/Geometry>

#include "base/dense.h"
#include "surface/thresholds.h"

namespace orbifit {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kMinShare = 0.001;    // of the mesh's area that a part, or all its copies, must have
constexpr std::size_t kMaxPairs = 24;  // members of a class of which all pairs are looked at
constexpr std::size_t kNeighbours = 6;
constexpr std::size_t kMaxAxes = 60;
constexpr std::size_t kMaxPlanes = 40;

// What a motion that carries one part onto another must carry along.
struct Shape {
  Vector3d centroid = Vector3d::Zero();
  Vector3d vector = Vector3d::Zero();  // area vector, the sum of area times normal; 0 for closed parts
  Matrix3d covariance = Matrix3d::Zero();
  double area = 0;
  double size = 0;  // square root of the covariance's trace
};

Shape shape_of(const PreparedMesh& prepared, const std::vector<int>& faces, const SurfaceMoments& moments) {
  Shape shape{moments.centroid, Vector3d::Zero(), moments.covariance, moments.area, 0};
  for (const int f : faces) shape.vector += prepared.areas[f] * prepared.normals.row(f).transpose();
  shape.size = std::sqrt(std::max(moments.covariance.trace(), 1e-300));
  return shape;
}

bool carries(const Matrix3d& linear, const Shape& from, const Shape& to) {
  if ((linear * from.vector - to.vector).norm() > 0.15 * from.area) return false;
  return (linear * from.covariance * linear.transpose() - to.covariance).norm() <= 0.2 * from.size * from.size;
}

// Votes for lines or planes, those alike added up.
class Votes {
 public:
  /// \param planes whether points may differ across the direction (a plane) or along it (a line)
  Votes(bool planes, double tolerance) : planes_(planes), tolerance_(tolerance) {}

  void add(Vector3d point, Vector3d direction, double weight) {
    if (!point.allFinite() || !direction.allFinite() || point.norm() > 3) return;
    for (CandidateLine& known : votes_) {
      const Line& line = known.line;
      if (line.direction.cross(direction).norm() > kSameDirection) continue;
      const Vector3d apart = point - line.point;
      const double along = std::abs(apart.dot(line.direction));
      const double across = (apart - line.direction * apart.dot(line.direction)).norm();
      if ((planes_ ? along : across) > 1.5 * tolerance_) continue;
      known.weight += weight;
      return;
    }
    votes_.push_back({{point, direction}, weight});
  }

  std::vector<CandidateLine> best(std::size_t most) {
    std::ranges::stable_sort(votes_, std::greater<>(), &CandidateLine::weight);
    if (votes_.size() > most) votes_.resize(most);
    return std::move(votes_);
  }

 private:
  bool planes_;
  double tolerance_;
  std::vector<CandidateLine> votes_;
};

// The axis of one part by itself, if it looks round.
std::optional<Line> own_axis(const PreparedMesh& prepared, const std::vector<int>& faces, const Shape& shape,
                             double tolerance) {
  const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(shape.covariance);
  const Vector3d deviations = solver.eigenvalues().cwiseMax(0).cwiseSqrt();
  if (deviations[0] < 0.5 * tolerance) {  // flat: round, or a regular polygon, if both variances agree
    if (deviations[2] - deviations[1] > 0.03 * deviations[2]) return std::nullopt;
    return Line{shape.centroid, solver.eigenvectors().col(0)};
  }
  constexpr std::size_t kMaxFaces = 600;
  const std::size_t count = std::min(faces.size(), kMaxFaces);
  Points points(static_cast<Eigen::Index>(count), 3);
  Points normals(static_cast<Eigen::Index>(count), 3);
  Eigen::VectorXd weights(static_cast<Eigen::Index>(count));
  for (std::size_t i = 0; i < count; ++i) {
    const int f = faces[i * faces.size() / count];
    const auto row = static_cast<Eigen::Index>(i);
    points.row(row) =
        (prepared.mesh.vertices.row(prepared.mesh.faces(f, 0)) + prepared.mesh.vertices.row(prepared.mesh.faces(f, 1)) +
         prepared.mesh.vertices.row(prepared.mesh.faces(f, 2))) /
        3;
    normals.row(row) = prepared.normals.row(f);
    weights[row] = prepared.areas[f];
  }
  const std::optional<RevolutionFit> fit = fit_axis_of_revolution(points, normals, weights, kRevolutionAngle);
  if (!fit || fit->planar || fit->spherical || fit->inliers < 0.85) return std::nullopt;
  return fit->axis;
}

class LineSearch {
 public:
  LineSearch(const PreparedMesh& prepared, const ComponentSurvey& survey, double tolerance)
      : prepared_(prepared), survey_(survey), tolerance_(tolerance), axes_(false, tolerance), planes_(true, tolerance) {
    for (std::size_t c = 0; c < survey.moments.size(); ++c) {
      shapes_.push_back(shape_of(prepared, prepared.components.faces[c], survey.moments[c]));
    }
  }

  SymmetryLines run() {
    for (const CongruenceClass& kind : survey_.classes) {
      double area = 0;
      for (const int c : kind.members) area += shape(c).area;
      if (area < kMinShare * prepared_.area) continue;
      vote_for_own_axes(kind);
      vote_for_circles(kind);
      vote_for_pairs(kind);
    }
    return {axes_.best(kMaxAxes), planes_.best(kMaxPlanes)};
  }

 private:
  const Shape& shape(int c) const { return shapes_[static_cast<std::size_t>(c)]; }

  void vote_for_own_axes(const CongruenceClass& kind) {
    const int first = kind.members.front();
    const std::optional<Line> axis =
        own_axis(prepared_, prepared_.components.faces[static_cast<std::size_t>(first)], shape(first), tolerance_);
    if (!axis) return;
    for (std::size_t i = 0; i < kind.members.size(); ++i) {
      axes_.add(kind.motions[i](axis->point), kind.motions[i].linear * axis->direction, shape(first).area);
    }
  }

  // The copies nearest to each one, nearest first.
  std::vector<int> neighbours(const CongruenceClass& kind, int of) const {
    std::vector<int> result;
    for (const int c : kind.members) {
      if (c != of) result.push_back(c);
    }
    const Vector3d here = shape(of).centroid;
    std::ranges::stable_sort(result, {}, [&](int c) { return (shape(c).centroid - here).squaredNorm(); });
    if (result.size() > kNeighbours) result.resize(kNeighbours);
    return result;
  }

  void vote_for_circles(const CongruenceClass& kind) {
    if (kind.members.size() < 3) return;
    for (const int middle : kind.members) {
      const std::vector<int> near = neighbours(kind, middle);
      for (std::size_t a = 0; a < near.size(); ++a) {
        for (std::size_t b = a + 1; b < near.size(); ++b) vote_for_circle(near[a], middle, near[b]);
      }
    }
  }

  void vote_for_circle(int before, int middle, int after) {
    const Vector3d p = shape(before).centroid - shape(middle).centroid;
    const Vector3d q = shape(after).centroid - shape(middle).centroid;
    if (std::abs(p.norm() - q.norm()) > tolerance_) return;
    const Vector3d normal = p.cross(q);
    if (normal.norm() < 1e-3 * p.squaredNorm()) return;
    const Vector3d bisector = p + q;  // towards the centre
    if (bisector.norm() < 1e-9) return;
    const double radius = p.squaredNorm() / (2 * p.dot(bisector.normalized()));
    const Vector3d centre = shape(middle).centroid + radius * bisector.normalized();
    const double step = 2 * std::asin(std::min(1.0, p.norm() / (2 * radius)));
    const double order = 2 * std::numbers::pi / step;
    if (order > kHighestOrder + 0.5 || std::abs(order - std::round(order)) * step * radius > order * tolerance_) return;
    const Vector3d axis = normal.normalized();
    // From before to middle to after the turn has the sense that brings p's end to q's.
    for (const double angle : {step, -step}) {
      const Matrix3d turn = axis_rotation(axis, angle);
      if ((turn * (shape(before).centroid - centre) - (shape(middle).centroid - centre)).norm() > 3 * tolerance_)
        continue;
      if (!carries(turn, shape(before), shape(middle)) || !carries(turn, shape(middle), shape(after))) continue;
      axes_.add(centre, axis, 3 * shape(middle).area);
      return;
    }
  }

  void vote_for_pairs(const CongruenceClass& kind) {
    const std::size_t count = kind.members.size();
    if (count > kMaxPairs) {
      for (const int c : kind.members) {
        for (const int other : neighbours(kind, c)) {
          if (c < other) vote_for_pair(c, other);
        }
      }
      return;
    }
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t j = i + 1; j < count; ++j) vote_for_pair(kind.members[i], kind.members[j]);
    }
  }

  void vote_for_pair(int first, int second) {
    const Shape& a = shape(first);
    const Shape& b = shape(second);
    const Vector3d apart = b.centroid - a.centroid;
    const Vector3d middle = 0.5 * (a.centroid + b.centroid);
    if (apart.norm() < 2 * tolerance_) return;
    const Vector3d normal = apart.normalized();
    if (carries(Matrix3d::Identity() - 2 * normal * normal.transpose(), a, b)) {
      planes_.add(middle, normal, a.area + b.area);
    }
    const auto try_axis = [&](Vector3d axis) {
      axis -= normal * normal.dot(axis);
      if (axis.norm() < 1e-6) return;
      axis.normalize();
      if (carries(2 * axis * axis.transpose() - Matrix3d::Identity(), a, b)) axes_.add(middle, axis, a.area + b.area);
    };
    const Vector3d sum = a.vector + b.vector;
    if (sum.norm() > 0.05 * a.area) {
      try_axis(sum);
    } else if (a.vector.norm() > 0.05 * a.area) {
      try_axis(a.vector.cross(normal));
    }
    const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(a.covariance + b.covariance);
    for (int k = 0; k < 3; ++k) try_axis(solver.eigenvectors().col(k));
  }

  const PreparedMesh& prepared_;
  const ComponentSurvey& survey_;
  double tolerance_;
  std::vector<Shape> shapes_;
  Votes axes_, planes_;
};

}  // namespace

SymmetryLines find_symmetry_lines(const PreparedMesh& prepared, const ComponentSurvey& survey, double tolerance) {
  return LineSearch(prepared, survey, tolerance).run();
}

}  // namespace orbifit
