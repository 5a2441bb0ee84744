#pragma once

#include <filesystem>
#include <map>
#include <string>
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

/// The truth as an annotation of the expected regions and patterns with three keys more, which readers of annotations
/// pass over: `optional_regions` and `optional_patterns` beside `regions` and `patterns`, and in a region
/// `also_accept`, a list of face sets. The same truth gives the same bytes.
/// \throw UsageError when `also_accepted` names a region that there is not, or an id occurs twice
std::string to_json(const DetectionTruth& truth);

/// Whole or not at all.
/// \throw UsageError as to_json; InputError when the file cannot be written
void write_truth(const std::filesystem::path& file, const DetectionTruth& truth);

/// Reads a truth of `mesh`; a plain annotation is a truth without the further keys.
/// \throw InputError naming the file, the key and the reason: all that read_annotation() refuses, in the expected and
/// in
///        the optional items, and an `also_accept` that is no list of runs of the mesh's faces
DetectionTruth read_truth(const std::filesystem::path& file, const Mesh& mesh);

}  // namespace orbifit
