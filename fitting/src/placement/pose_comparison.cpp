#include "placement/pose_comparison.h"

#include <cmath>

#include <Eigen/Geometry>

namespace orbifit {

namespace {

using Eigen::Vector3d;

constexpr double kAlike = 0.06;  // of the diagonal, mean distance: before they are refined
constexpr double kSame = 0.02;   // and after

}  // namespace

bool PoseComparison::alike(const Similarity& a, const Similarity& b) const {
  constexpr double kTurn = 0.4;  // radians
  constexpr double kItself = 0.015;
  if (!same(a, b, kAlike)) return false;
  return axis_angle(a.linear * b.linear.transpose()).angle < kTurn || same(a, b, kItself);
}

bool PoseComparison::one(const Similarity& a, const Similarity& b) const {
  constexpr double kTurn = 0.17;  // radians
  constexpr double kItself = 0.004;
  if (!same(a, b, kSame)) return false;
  return axis_angle(a.linear * b.linear.transpose()).angle < kTurn || same(a, b, kItself);
}

// Whether two poses bring the template to the same place, in the mean over its surface: the field tells it to a cell.
bool PoseComparison::same(const Similarity& a, const Similarity& b, double tolerance) const {
  constexpr double kOfField = 0.02;
  if (std::abs(std::log(a.scale / b.scale)) > 4 * tolerance) return false;
  constexpr Eigen::Index kLooks = 128;
  const Similarity back = inverse(b);
  double sum = 0;
  for (Eigen::Index i = 0; i < kLooks; ++i) {
    const Vector3d point = back(a(data_.samples.points.row(i * data_.samples.points.rows() / kLooks)));
    const TemplateField::Value* value = data_.field.at(point);
    if (tolerance < kOfField) {
      sum += data_.surface.index.nearest(point).distance / data_.size;
    } else {
      sum += value == nullptr ? 0.2 : value->distance / data_.size;
    }
    if (sum > tolerance * kLooks) return false;
  }
  return true;
}

}  // namespace orbifit
