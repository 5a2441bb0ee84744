#pragma once

#include <optional>

#include "orbifit/fitting/fit.h"
#include "orbifit/model/mesh.h"
#include "orbifit/subspace/subspace.h"

#include "fit_loop.h"
#include "start/placed_scan.h"

namespace orbifit {

/// Whether shapes of one kind may differ in size by so much.
bool of_one_kind(double scale, double other);

/// The start with the scale that brings the template, as it is, nearest to the scan. Lengths of which the shape has
/// more, such as a taller back, take a fit at the template's scale to the wrong slat; from there it may find the right
/// one. \return none where the scale is much the same, or other than shapes of one kind have
std::optional<PlacedScan> at_other_scale(const FitInput& input, const PlacedScan& start, const RunContext& context);

/// The same shape in the same place where the pose has another scale: the rest is deformation. Scaling about a point
/// keeps all groups, whose centres go along, so that it lies in a floating subspace, and is nearest to it in others.
FitState with_scale(double scale, const Similarity& pose, const SubspaceState& state, const Subspace& subspace,
                    const Mesh& mesh);

}  // namespace orbifit
