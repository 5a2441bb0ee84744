#include "placement/pose_score.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "registration/alignment.h"

namespace orbifit {

namespace {

using Eigen::Vector3d;

constexpr double kNormalCosine = 0.7;

}  // namespace

bool PoseScore::explains(const Similarity& back, int point, double reach) const {
  const TemplateField::Value* value = data_.field.at(back(data_.scan.points.row(point)));
  if (value == nullptr || value->distance > reach) return false;
  const Vector3d normal = back.linear * data_.scan.normals.row(point).transpose();
  return std::abs(value->normal.cast<double>().dot(normal)) >= kNormalCosine;
}

// The share of the first `count` points that the pose explains; gives up where it cannot reach `least`.
double PoseScore::share(const Similarity& back, std::size_t count, double reach, double least) const {
  count = std::min(count, data_.order.size());
  const double most = static_cast<double>(count);
  std::size_t hits = 0;
  for (std::size_t i = 0; i < count; ++i) {
    hits += explains(back, data_.order[i], reach) ? 1U : 0U;
    if (static_cast<double>(hits + count - 1 - i) < least * most) return 0;
  }
  return static_cast<double>(hits) / most;
}

double PoseScore::reach_of(const Similarity& pose) const {
  constexpr double kOfScan = 0.6;
  return options_.reach * std::min(data_.size * pose.scale, kOfScan * data_.extent);
}

double PoseScore::closeness(const Similarity& back, double reach, std::size_t count) const {
  count = std::min(count, data_.order.size());
  double sum = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Vector3d normal = back.linear * data_.scan.normals.row(data_.order[i]).transpose();
    const auto near = data_.surface.index.nearest_facing(back(data_.scan.points.row(data_.order[i])), normal,
                                                         kNormalCosine, reach, true);
    if (near.face >= 0) sum += 1 - (near.distance / reach) * (near.distance / reach);
  }
  return sum / static_cast<double>(count);
}

std::optional<Similarity> PoseScore::at_known_scale(const Similarity& pose) const {
  constexpr double kMuchTheSame = 0.2;  // of its logarithm: how far lengths of shapes of one kind differ
  if (!options_.scale) return pose;
  if (std::abs(std::log(pose.scale / *options_.scale)) > kMuchTheSame) return std::nullopt;
  return rescaled(pose, *options_.scale, data_.surface.mesh());
}

double PoseScore::judged(const Similarity& pose, double bar) const {
  const double relative = pose.scale * data_.size / data_.extent;
  if (relative < options_.min_scale || relative > options_.max_scale) return 0;
  const Similarity back = inverse(pose);
  const double reach = reach_of(pose) / pose.scale;
  if (share(back, 24, reach, 0.7 * bar) <= 0 || share(back, 80, reach, 0.9 * bar) <= 0) return 0;
  return share(back, 300, reach, bar);
}

}  // namespace orbifit
