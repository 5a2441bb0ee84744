#include "surface/canonical_pose.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <utility>

#include "consistency/group_place.h"
#include "surface/canonical_order.h"

namespace orbifit {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr std::size_t kTold = 50000;      // faces by which frames are told apart: a tenth of a second for a hundred
constexpr double kAlike = 1e-7;           // of the largest: rounding in sums over many corners, several times
constexpr double kGrid = 1e-9;            // of the diagonal: coordinates that differ by less are in no order
constexpr std::size_t kCandidates = 100;  // corners as far as the farthest, and frames: most groups have fewer elements

using Monomials = Eigen::Matrix<double, 6, 1>;

Monomials squares_of(const Vector3d& p) {
  Monomials result;
  result << p.x() * p.x(), p.y() * p.y(), p.z() * p.z(), p.x() * p.y(), p.x() * p.z(), p.y() * p.z();
  return result;
}

/// Corners of faces about their mean, in units of the farthest one's distance. The mesh is kept by reference.
class CentredCorners {
 public:
  explicit CentredCorners(const Mesh& mesh) : mesh_(mesh) {
    for_each_vertex([&](const Vector3d& p) { mean_ += p; });
    if (mesh.faces.size() > 0) mean_ /= static_cast<double>(mesh.faces.size());
    double farthest = 0;
    for_each_vertex([&](const Vector3d& p) { farthest = std::max(farthest, (p - mean_).norm()); });
    if (farthest > 0) scale_ = 1 / farthest;
    for_each([&](const Vector3d& p) {
      const Monomials squares = squares_of(p);
      third_ += p * squares.transpose();
      fourth_ += squares * squares.transpose();
    });
  }

  const Vector3d& mean() const { return mean_; }

  template <typename Look>
  void for_each(const Look& look) const {
    for_each_vertex([&](const Vector3d& p) { look(scale_ * (p - mean_)); });
  }

  // The middles of the faces farthest from the mean, of those that are as far all: kTold of them, or a few more.
  std::vector<Vector3d> outermost() const {
    std::vector<Vector3d> middles;
    std::vector<double> distances;
    for (Eigen::Index f = 0; f < mesh_.faces.rows(); ++f) {
      Vector3d sum = Vector3d::Zero();
      for (int k = 0; k < 3; ++k) sum += scale_ * (vertex(f, k) - mean_);
      middles.emplace_back(sum / 3);
      distances.push_back(middles.back().norm());
    }
    if (middles.size() <= kTold) return middles;
    std::vector<double> sorted = distances;
    const auto at = sorted.end() - static_cast<std::ptrdiff_t>(kTold);
    std::ranges::nth_element(sorted, at);
    std::size_t i = 0;
    std::erase_if(middles, [&](const Vector3d&) { return distances[i++] < *at - kAlike; });
    return middles;
  }

  // The sum of (p . q)^3 and (p . q)^4 over all corners q: the same for images under a symmetry.
  double descriptor(const Vector3d& p) const {
    Monomials squares = squares_of(p);
    squares.tail<3>() *= 2;
    return p.dot(third_ * squares) + squares.dot(fourth_ * squares);
  }

 private:
  template <typename Look>
  void for_each_vertex(const Look& look) const {
    for (Eigen::Index f = 0; f < mesh_.faces.rows(); ++f) {
      for (int k = 0; k < 3; ++k) look(vertex(f, k));
    }
  }
  Vector3d vertex(Eigen::Index f, int k) const { return mesh_.vertices.row(mesh_.faces(f, k)); }

  const Mesh& mesh_;
  Vector3d mean_ = Vector3d::Zero();
  double scale_ = 0;
  Eigen::Matrix<double, 3, 6> third_ = Eigen::Matrix<double, 3, 6>::Zero();
  Eigen::Matrix<double, 6, 6> fourth_ = Eigen::Matrix<double, 6, 6>::Zero();
};

// The distinct corners for which `rank` is largest, then `descriptor`; of more than kCandidates the first.
template <typename Rank>
std::vector<Vector3d> leading(const CentredCorners& corners, const Rank& rank) {
  double most = 0;
  corners.for_each([&](const Vector3d& p) { most = std::max(most, rank(p)); });
  std::vector<std::pair<double, Vector3d>> as_far;
  double largest = -std::numeric_limits<double>::infinity();
  double magnitude = 0;
  corners.for_each([&](const Vector3d& p) {
    if (rank(p) < most - kAlike) return;
    as_far.emplace_back(corners.descriptor(p), p);
    largest = std::max(largest, as_far.back().first);
    magnitude = std::max(magnitude, std::abs(as_far.back().first));
  });
  std::vector<Vector3d> result;
  for (const auto& [descriptor, p] : as_far) {
    if (result.size() == kCandidates) break;
    if (descriptor < largest - kAlike * magnitude) continue;
    const bool known = std::ranges::any_of(result, [&](const Vector3d& q) { return (q - p).norm() < kAlike; });
    if (!known) result.push_back(p);
  }
  return result;
}

// What a frame, by its rows, makes of points: sums of waves along directions that no symmetry has, in units of the
// farthest corner's distance. Of mirror images, and of corners that are as far by chance, they differ; the shorter
// waves tell turns by parts of a circle apart that moments do not, up to some ninety parts.
using Signature = std::array<double, 3>;

Signature signature_of(const std::vector<Vector3d>& points, const Matrix3d& frame) {
  Matrix3d waves;
  waves << 5, 7, 4, 17, -11, 21, -47, 53, 59;
  const Matrix3d phases = waves * frame;
  Signature result{};
  for (const Vector3d& p : points) {
    const Vector3d phase = phases * p;
    for (std::size_t k = 0; k < 3; ++k) result[k] += std::sin(phase[static_cast<Eigen::Index>(k)] + 1);
  }
  for (double& term : result) term /= static_cast<double>(points.size());
  return result;
}

// The first that is larger by more than rounding decides.
bool larger(const Signature& a, const Signature& b) {
  for (std::size_t k = 0; k < a.size(); ++k) {
    if (std::abs(a[k] - b[k]) > kAlike) return a[k] > b[k];
  }
  return false;
}

}  // namespace

Motion canonical_motion(const Mesh& mesh) {
  const CentredCorners corners(mesh);
  if (!corners.mean().allFinite()) return {};  // beyond what sums can hold
  std::vector<Matrix3d> frames;
  for (const Vector3d& first : leading(corners, [](const Vector3d& p) { return p.norm(); })) {
    if (!(first.norm() > 0)) continue;
    const Vector3d x = first.normalized();
    const auto away = [&](const Vector3d& p) -> Vector3d { return p - p.dot(x) * x; };
    for (const Vector3d& second : leading(corners, [&](const Vector3d& p) { return away(p).norm(); })) {
      const Vector3d y = away(second).norm() > kAlike ? away(second).normalized() : x.unitOrthogonal();
      Matrix3d frame;
      frame << x.transpose(), y.transpose(), x.cross(y).transpose();
      frames.push_back(nearest_orthogonal(frame));
    }
    if (frames.size() >= kCandidates) break;
  }
  Matrix3d linear = frames.empty() ? Matrix3d::Identity() : frames.front();
  if (frames.size() > 1) {
    const std::vector<Vector3d> points = corners.outermost();
    Signature best = signature_of(points, linear);
    for (std::size_t i = 1; i < frames.size(); ++i) {
      const Signature signature = signature_of(points, frames[i]);
      if (!larger(signature, best)) continue;
      best = signature;
      linear = frames[i];
    }
  }
  return {linear, -linear * corners.mean()};
}

CanonicalPose::CanonicalPose(const Mesh& given) {
  const CanonicalOrder in_order(given);  // sums of the same mesh are then the same to the last digit
  motion = canonical_motion(in_order.mesh);
  const Mesh there = moved(in_order.mesh);
  const double own = diagonal(there.vertices);
  if (own > 0) stretch = diagonal(given.vertices) / own;
  CanonicalOrder order(there, kGrid * own);
  mesh = std::move(order.mesh);
  for (const int face : order.face_of) face_of.push_back(in_order.face_of[static_cast<std::size_t>(face)]);
}

Mesh CanonicalPose::moved(Mesh given) const {
  for (Eigen::Index v = 0; v < given.vertices.rows(); ++v) {
    given.vertices.row(v) = motion(given.vertices.row(v).transpose()).transpose();
  }
  return given;
}

SymmetryAnnotation CanonicalPose::as_given(const SymmetryAnnotation& annotation, const Mesh& given) const {
  const Motion back = inverse(motion);
  const auto faces_given = [&](std::vector<int>& faces) {
    for (int& face : faces) face = face_of[static_cast<std::size_t>(face)];
    std::ranges::sort(faces);
  };
  const auto residual_given = [&](Residual& residual) {
    residual.rms /= stretch;
    residual.max /= stretch;
  };
  // What shifts shifts on: to turn there and back would leave rounding.
  const auto motion_given = [&](Motion& moving) {
    const bool shift = moving.linear == Matrix3d::Identity();
    moving = shift ? Motion{Matrix3d::Identity(), back.linear * moving.translation} : conjugate(back, moving);
  };
  SymmetryAnnotation result = annotation;
  result.tolerance /= stretch;
  result.mesh_diagonal = diagonal(given.vertices);
  for (Region& region : result.regions) {
    if (const std::optional<GroupPlace> place = place_of(region)) {
      const GroupPlace there = image_of(*place, back);
      Region placed = make_region(there.group, there.centre, there.frame, {}, {});
      region.centre = placed.centre;
      region.axis = placed.axis;
      region.generators = std::move(placed.generators);
      region.elements = std::move(placed.elements);
    }
    faces_given(region.faces);
    residual_given(region.residual);
  }
  for (Pattern& pattern : result.patterns) {
    std::ranges::for_each(pattern.generators, motion_given);
    for (PatternInstance& instance : pattern.instances) {
      motion_given(instance.motion);
      faces_given(instance.faces);
    }
    residual_given(pattern.residual);
  }
  return result;
}

}  // namespace orbifit
