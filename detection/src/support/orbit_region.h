#pragma once

#include <vector>

#include "orbifit/model/run_context.h"

#include "group/refinement.h"
#include "surface/surface_patch.h"

namespace orbifit {

/// The maximal region of a known group, by the orbit test on faces: S(G) = {x : g x is on the surface for all g in G}.
/// A face belongs when 97 % of its sample points stay within `tolerance` of the surface under every judged motion
/// (verification.h) with a normal within 25 degrees, whichever way it faces; next to a crease any normal will do. A
/// face has one sample point where its edges are short (four tolerances), else one for each of up to 64 equal
/// triangles, so that a coarse triangle of which only a part is symmetric is out. Then faces leave of whose images
/// under some motion most lie off the faces that are in, until none does.
/// Costs O(P M log F), P points, M judged motions, most faces that do not belong ending after a few queries; rounds
/// after the first look again only at faces that had images on a face that left. Memory O(P M) at most.
/// \param whole index of the whole mesh
/// \param tolerance a length of the normalised mesh, > 0
/// \return ascending; empty when nothing belongs
std::vector<int> symmetric_faces(const PreparedMesh& prepared, const SurfaceIndex& whole,
                                 const GroupPlacement& placement, double tolerance, const RunContext& context);

/// Of the faces that a group permutes those that belong to the seeds: the edge-connected piece of each seed, and pieces
/// that are images of these, in full or for the most part, until closed.
/// Costs O(P M log F) for the points P of the pieces taken.
/// \param symmetric ascending, of symmetric_faces() with the same placement and tolerance
/// \param seeds face numbers; those not among `symmetric` say nothing
/// \return ascending; empty when no seed is among `symmetric`
std::vector<int> connected_orbit(const PreparedMesh& prepared, const GroupPlacement& placement,
                                 const std::vector<int>& symmetric, const std::vector<int>& seeds, double tolerance,
                                 const RunContext& context);

}  // namespace orbifit
