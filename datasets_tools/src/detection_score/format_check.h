#pragma once

#include <string>
#include <vector>

#include "orbifit/model/annotation.h"

#include "detection_score/face_set.h"

namespace orbifit::scoring {

/// What breaks the rules of the annotation format; a reader refuses some of it, and passes the rest.
struct FormatReport {
  std::vector<std::string> breaches;
  std::vector<char> regions;   ///< 1 where a region is well formed
  std::vector<char> patterns;  ///< likewise
};

FormatReport check_format(const MeasuredMesh& measured, const SymmetryAnnotation& annotation);

/// Rules that a region, or a pattern, breaks by itself.
std::vector<std::string> region_breaches(const MeasuredMesh& measured, const Region& region);
std::vector<std::string> pattern_breaches(const MeasuredMesh& measured, const Pattern& pattern);

}  // namespace orbifit::scoring
