#pragma once

#include <vector>

#include "orbifit/model/annotation.h"
#include "orbifit/model/run_context.h"

#include "base/random.h"
#include "detection_score/face_set.h"

namespace orbifit::scoring {

/// A pattern with the face sets of its instances.
struct PlacedPattern {
  PlacedPattern(const MeasuredMesh& measured, const Pattern& given);

  const Pattern& pattern;
  std::vector<FaceSet> sets;  ///< of the instances
  double area = 0;            ///< of all together
};

struct PatternMatch {
  bool strict = false, loose = false;
  double median_iou = 0;

  bool better_than(const PatternMatch& other) const;
};

PatternMatch match_patterns(const MeasuredMesh& measured, const PlacedPattern& truth, const PlacedPattern& predicted,
                            Random& random, const RunContext& context);

/// Whether the finite group of a predicted region relates all instances of a pattern.
bool region_relates(const MeasuredMesh& measured, const PlacedPattern& truth, const Region& region, const FaceSet& set,
                    Random& random, const RunContext& context);

/// Mean over the instances of the share that is on instance 0 and covers it; at most 40 of them, drawn.
double pattern_validity(const MeasuredMesh& measured, const Pattern& pattern, Random& random,
                        const RunContext& context);

/// Whether both have as many instances, and these the same faces: a median IoU above 0.9.
bool repeats(const MeasuredMesh& measured, const PlacedPattern& pattern, const PlacedPattern& earlier);

}  // namespace orbifit::scoring
