#pragma once

#include "orbifit/detection/explanation.h"
#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"

#include "surface/surface_patch.h"

namespace orbifit {

/// What every subspace can keep of what was found, largest regions first, numbered in that order. What is left out is
/// told in one message, and each with its reason in `explanation` (may be null). See consistent_annotation().
SymmetryAnnotation kept_consistent(const Mesh& mesh, const SymmetryAnnotation& found, Explanation* explanation,
                                   const RunContext& context);

/// The same, of what was found on `mesh`, of which `prepared` is made: where that moved a region, or took faces from
/// it, faces that an element takes farther than the tolerance from those that are left go too (trim_regions()), and its
/// residual is measured anew.
SymmetryAnnotation kept_consistent(const PreparedMesh& prepared, const Mesh& mesh, const SymmetryAnnotation& found,
                                   Explanation* explanation, const RunContext& context);

/// As above, of what was found without what follows from the rest (without_what_follows()), so that this stands in
/// nothing's way: what follows from something that cannot be kept comes back. What is left out has no part in what is
/// kept: it is all done anew without it, as found.
/// \param found  in the frame of `mesh`, of which `prepared` is made
SymmetryAnnotation kept_without_what_follows(const PreparedMesh& prepared, const Mesh& mesh, SymmetryAnnotation found,
                                             Explanation* explanation, const RunContext& context);

/// A list without what would be left out when it is read: thresholds are fractions of the diagonal, which is another
/// one in the pose that a mesh is given in than in the one that detection works in.
/// \param mesh  as it is given
SymmetryAnnotation kept_when_read(const Mesh& mesh, SymmetryAnnotation listed, Explanation* explanation,
                                  const RunContext& context);

}  // namespace orbifit
