#pragma once

#include <functional>
#include <vector>

#include "orbifit/detection/explanation.h"
#include "orbifit/detection/found_region.h"
#include "orbifit/detection/part_regions.h"
#include "orbifit/model/annotation.h"
#include "orbifit/model/run_context.h"

namespace orbifit {

struct PatternSearchOptions {
  double tolerance = 0.005;    ///< fraction of the mesh's diagonal
  double least_share = 0.002;  ///< of the mesh's area: smaller patterns say little
  /// Whether the parts are pieces of larger surfaces: copies without order, and rings, then say nothing.
  bool pieces = false;
  Explanation* explanation = nullptr;  ///< notes are added to it; may be null
  std::function<bool()> late;          ///< whether time is up; may be empty
};

/// The arrangements of congruent parts that no region's group relates. What belongs together is one pattern: parts that
/// touch, and that the same motions carry from instance to instance, such as a window's frame and its pane.
/// \param prepared with the parts for components \param parts what find_part_regions() says of them
/// \param regions all regions found \return in the frame of the mesh as it was given, ids from 0
/// Costs O(C I) look-ups for C components and I instances a pattern.
std::vector<Pattern> find_patterns(const PreparedMesh& prepared, const PartRegions& parts,
                                   const std::vector<FoundRegion>& regions, const PatternSearchOptions& options,
                                   const RunContext& context);

}  // namespace orbifit
