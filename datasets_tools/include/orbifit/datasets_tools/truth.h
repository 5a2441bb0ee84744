#pragma once

#include <map>
#include <vector>

#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"

namespace orbifit {

/// What a detector should find on a mesh, and what it may find besides.
struct DetectionTruth {
  SymmetryAnnotation expected;
  std::vector<Region> optional_regions;    ///< as right as the expected ones, but not missed
  std::vector<Pattern> optional_patterns;  ///< likewise
  /// By the id of a region, expected or optional: further face sets, each ascending, that are as right as its own.
  std::map<int, std::vector<std::vector<int>>> also_accepted;
};

struct TruthModel {
  Mesh mesh;
  DetectionTruth truth;
};

}  // namespace orbifit
