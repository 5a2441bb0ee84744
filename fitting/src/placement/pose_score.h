#pragma once

#include <cstddef>
#include <optional>

#include "orbifit/fitting/placement.h"
#include "orbifit/model/motion.h"

#include "placement/placement_data.h"

namespace orbifit {

/// How much of the scan poses explain. A pose takes the template's frame to the scan's; `back` is its inverse.
class PoseScore {
 public:
  /// Both kept by reference.
  PoseScore(const PlacementData& data, const PlacementOptions& options) : data_(data), options_(options) {}

  /// How far points may be from the template, scan units. A template far larger than the scan must not explain
  /// everything that is anywhere near.
  double reach_of(const Similarity& pose) const;

  /// The mean over the first `count` points of 1 - (distance / reach)^2, 0 where nothing with a like normal is in
  /// reach.
  double closeness(const Similarity& back, double reach, std::size_t count) const;

  /// Where the scale is known, the pose at that one, if it was proposed at much the same.
  std::optional<Similarity> at_known_scale(const Similarity& pose) const;

  /// The share of the points that a pose explains; 0 below the bar, and for scales that are not allowed.
  double judged(const Similarity& pose, double bar) const;

 private:
  bool explains(const Similarity& back, int point, double reach) const;
  double share(const Similarity& back, std::size_t count, double reach, double least) const;

  const PlacementData& data_;
  const PlacementOptions& options_;
};

}  // namespace orbifit
