#pragma once

#include <optional>
#include <vector>

#include "primitives/revolution.h"
#include "support/own_group.h"
#include "surface/components.h"
#include "surface/surface_patch.h"

namespace orbifit {

// Groups that a set of parts has for reasons that say nothing about the shape. Lengths in the prepared mesh's units;
// `tolerance` is a fraction of the mesh's diagonal.

/// Whether the parts are a flat sheet.
bool flat(const SurfaceMoments& moments, double tolerance);

/// Whether the group is the mirror in a flat sheet's own plane.
bool flat_mirror_only(const SurfaceMoments& moments, const GroupPlacement& placement, double tolerance);

/// Whether two parts of a kind with more than two members are all there is: any two copies of a symmetric part are
/// symmetric together, wherever they are.
bool mere_pair(const std::vector<int>& parts, const std::vector<CongruenceClass>& kinds);

/// Kinds of at least five members of which some, but neither one nor all, are among the parts, where they make up most
/// of the parts' area: then the parts are some of a row or a grid. Empty where they are not.
std::vector<std::size_t> kinds_of_a_row(const std::vector<int>& parts, const std::vector<CongruenceClass>& kinds,
                                        const std::vector<SurfaceMoments>& moments);

/// Whether the parts are mostly some, six at least, of kinds of eight members and more, and the group has no rotation
/// but half-turns: of many equal parts in a grid any mirror or half-turn of the grid keeps some, wherever it is.
bool some_of_a_grid(const PointGroup& group, const std::vector<int>& parts, const std::vector<CongruenceClass>& kinds,
                    const std::vector<SurfaceMoments>& moments);

/// The fit of an axis of revolution to the patch's samples.
std::optional<RevolutionFit> revolution_of(const SurfacePatch& patch);

/// Whether pieces of a larger surface have the group by where they end only: a piece of a plane, or a finite group of
/// a surface of revolution.
/// \param moments of the faces
bool mere_border(const PreparedMesh& prepared, const std::vector<int>& faces, const SurfaceMoments& moments,
                 const GroupPlacement& placement, double tolerance, const RunContext& context);

/// Whether what a finite group keeps of the patch fades as the tolerance shrinks to half of it, and where half is not
/// sure and there was no noise, to an eighth. A symmetric part ends where the shape does; of smooth surfaces any mirror
/// keeps some, up to where they differ by the tolerance.
bool fades(const SurfacePatch& patch, const GroupPlacement& placement, const RunContext& context);

/// Copies of a part that happen to sit symmetrically about it are neighbours in a row, not of its own kind of symmetry:
/// takes all of the part's kind but itself out of `parts`.
void drop_siblings(std::vector<int>& parts, int part, const std::vector<CongruenceClass>& kinds);

/// Whether enough of the surface's normals meet the axis for a surface of revolution.
bool turned(const RevolutionFit& fit);

}  // namespace orbifit
