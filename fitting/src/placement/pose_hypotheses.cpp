#include "placement/pose_hypotheses.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/Geometry>

namespace orbifit {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr int kBins = 8;          // of |cosine|, of each angle
constexpr double kMinSine = 0.3;  // of the normal with the line, so that the two fix a rotation
constexpr double kFlat = 0.1;     // cosines below: both points on one plane, which says little

// The bin of a pair by |n_p . d|, |n_q . d|, |n_p . n_q|; none for pairs that fix no pose.
std::optional<std::size_t> bin_of(const Vector3d& direction, const Vector3d& p_normal, const Vector3d& q_normal) {
  const double along_p = std::abs(p_normal.dot(direction));
  const double along_q = std::abs(q_normal.dot(direction));
  const double across = std::abs(p_normal.dot(q_normal));
  if (along_p * along_p > 1 - kMinSine * kMinSine) return std::nullopt;
  if (along_p < kFlat && along_q < kFlat && across > 1 - kFlat) return std::nullopt;
  // Angles rather than cosines: bins of even width.
  const auto bin = [](double cosine) {
    const double angle = std::acos(std::min(1.0, cosine)) * (2 / 3.14159265358979323846);
    return static_cast<std::size_t>(std::min<int>(kBins - 1, static_cast<int>(angle * kBins)));
  };
  return (bin(along_p) * kBins + bin(along_q)) * kBins + bin(across);
}

// A right-handed frame: the line, the normal's part across it, and their product.
Matrix3d frame_of(const Vector3d& direction, const Vector3d& normal) {
  Matrix3d frame;
  frame.col(0) = direction;
  frame.col(1) = (normal - normal.dot(direction) * direction).normalized();
  frame.col(2) = frame.col(0).cross(frame.col(1));
  return frame;
}

}  // namespace

PoseHypotheses::PoseHypotheses(const SurfaceSamples& samples)
    : samples_(samples), pairs_(static_cast<std::size_t>(kBins) * kBins * kBins) {
  const auto count = static_cast<int>(samples.points.rows());
  const double least = 0.15 * diagonal(samples.points);
  for (int i = 0; i < count; ++i) {
    for (int j = 0; j < count; ++j) {
      const Vector3d line = samples.points.row(j) - samples.points.row(i);
      const double length = line.norm();
      if (length < least) continue;
      const auto bin = bin_of(line / length, samples.normals.row(i), samples.normals.row(j));
      if (bin) pairs_[*bin].push_back({i, j});
    }
  }
}

void PoseHypotheses::propose(const Vector3d& p, const Vector3d& p_normal, const Vector3d& q, const Vector3d& q_normal,
                             int most, Random& random, const std::function<void(const Similarity&)>& take) const {
  constexpr double kCompatible = 0.85;  // cosine of the second point's normals
  const double length = (q - p).norm();
  if (!(length > 0)) return;
  const Vector3d direction = (q - p) / length;
  const auto bin = bin_of(direction, p_normal, q_normal);
  if (!bin || pairs_[*bin].empty()) return;
  const std::vector<Pair>& pairs = pairs_[*bin];
  const Matrix3d there = frame_of(direction, p_normal);
  for (int k = 0; k < most; ++k) {
    const Pair& pair = pairs[random.below(pairs.size())];
    const Vector3d from = samples_.points.row(pair.first);
    const Vector3d line = samples_.points.row(pair.second).transpose() - from;
    const double own = line.norm();
    const Matrix3d here = frame_of(line / own, samples_.normals.row(pair.first));
    const double scale = length / own;
    for (const double sign : {1.0, -1.0}) {
      const Matrix3d rotation = there * Vector3d(1, sign, sign).asDiagonal() * here.transpose();
      const Vector3d normal = rotation * samples_.normals.row(pair.second).transpose();
      if (std::abs(normal.dot(q_normal)) < kCompatible) continue;
      take({scale, rotation, p - scale * (rotation * from)});
    }
  }
}

}  // namespace orbifit
