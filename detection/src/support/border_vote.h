#pragma once

#include <vector>

#include "orbifit/model/motion.h"
#include "orbifit/model/run_context.h"

#include "surface/surface_patch.h"

namespace orbifit {

/// Where a border may go: a region that others have taken faces from has them no more.
enum class BorderMoves { both_ways, inwards };

/// A region whose border is drawn face by face, drawn anew as most of its images have it: of the faces on both sides of
/// the border those are in that lie, with their images, in the region more often than not. Where images of the border
/// are apart each of them then moves half of the way, where trimming from one side (trim_regions()) would go on and on.
/// A face that a motion takes away from the whole surface does not come in. Some passes at most, each by one face.
/// \param motions  the group's elements but the identity  \param faces  ascending
/// \return ascending. Costs O(B M log F) a pass for B faces at the border.
std::vector<int> voted_border(const PreparedMesh& prepared, double tolerance, const std::vector<Motion>& motions,
                              const std::vector<int>& faces, BorderMoves moves, const RunContext& context);

}  // namespace orbifit
