#pragma once

#include <optional>
#include <vector>

#include "orbifit/datasets_tools/truth.h"
#include "orbifit/model/annotation.h"

#include "detection_score/face_set.h"
#include "detection_score/group_comparison.h"

namespace orbifit::scoring {

/// A region with what comparisons need, worked out once. Keeps a reference to the region.
struct ScoredRegion {
  ScoredRegion(const MeasuredMesh& measured, const Region& given);

  const Region& region;
  PlacedGroup group;
  FaceSet set;
  double area = 0;
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
};

/// The face sets that are right for an expected region.
struct AcceptedFaces {
  std::vector<FaceSet> sets;  ///< the first is the region's own
  FaceSet core, full;         ///< what all of them hold, and what any of them holds

  /// Where several are right, the best over all sets between core and full, but no more than the share of the core that
  /// is found.
  double iou(const MeasuredMesh& measured, const FaceSet& found) const;
};

AcceptedFaces accepted_faces(const Region& region, const DetectionTruth& truth);

struct RegionMatch {
  bool strict = false, loose = false;
  bool modest = false;  ///< loose, and claims no more than the truth
  double iou = 0;
  std::optional<double> axis_error;    ///< degrees
  std::optional<double> offset_error;  ///< fraction of the diagonal

  bool better_than(const RegionMatch& other) const;
};

RegionMatch match_regions(const MeasuredMesh& measured, const ScoredRegion& expected, const AcceptedFaces& accepted,
                          const ScoredRegion& found);

/// Whether `other` says what `region` says: the same group on the same faces where it is the earlier one, or more, on
/// faces that hold the region's. Of two that are as good as equal the first one stays.
bool repeats(const MeasuredMesh& measured, const ScoredRegion& region, const ScoredRegion& other,
             bool other_is_earlier);

}  // namespace orbifit::scoring
