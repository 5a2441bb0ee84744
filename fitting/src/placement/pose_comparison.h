#pragma once

#include "orbifit/model/motion.h"

#include "placement/placement_data.h"

namespace orbifit {

/// Whether two poses of the template are one.
class PoseComparison {
 public:
  /// \param data  kept by reference
  explicit PoseComparison(const PlacementData& data) : data_(data) {}

  /// Whether ICP will bring two proposals to one pose, or to two that a symmetry of the template makes one.
  bool alike(const Similarity& a, const Similarity& b) const;

  /// Whether two refined poses are one: nearly the same motion, or another by one of the template's symmetries, under
  /// which it comes to lie on itself more closely than the ICP is exact.
  bool one(const Similarity& a, const Similarity& b) const;

 private:
  bool same(const Similarity& a, const Similarity& b, double tolerance) const;

  const PlacementData& data_;
};

}  // namespace orbifit
