#pragma once

#include <memory>
#include <string>
#include <vector>

#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"

namespace orbifit {

class SurfaceIndex;

/// A region or pattern that cannot be kept beside larger ones.
struct LeftOut {
  bool pattern = false;
  int id = 0;
  std::string name;
  std::string group;   ///< Schoenflies symbol, or the pattern's kind
  std::string reason;  ///< "the group of "whole" (Cs) takes it where there is no such region"
};

/// "region 3 "leg" (C2v): ..."
std::string to_string(const LeftOut& left_out);

struct ConsistentAnnotation {
  SymmetryAnnotation annotation;
  std::vector<LeftOut> left_out;  ///< larger ones first
  int added = 0;                  ///< images of regions that the annotation lacked
  double largest_movement = 0;    ///< of a group on its own region, fraction of the diagonal
  /// Of the mesh, for who would make it again, as fit() would; null where it was not needed.
  std::shared_ptr<const SurfaceIndex> surface_index = nullptr;
};

/// Makes the groups of an annotation agree with one another exactly, so that every subspace can keep all of them.
///
/// Regions that were found, or written, one by one agree to the tolerance only: a plane misses its parent's, an axis
/// does not meet another. Then going to and fro between them carries a point ever farther, and nothing keeps both. An
/// annotation is consistent where, for every region or pattern A, every motion g of A and every region B that shares
/// faces with A and does not hold all of it, there is a region C that is the image of B: C has B's group, placed by g
/// exactly, and holds what g makes of the faces that A and B share (docs/method.md 3). Of continuous groups that hold
/// all of a pattern's instance there is an image as well.
/// Shared planes and axes, axes in planes and right angles are the cases in which C is B itself. None is needed where
/// regions whose groups hold those of A and of B hold all that A and B share: they say what would be asked there.
///
/// Regions are taken largest first. Each comes with all its images under those already taken (its family); images that
/// the annotation lacks are added where the surface has them. The placement of the family's first region is fitted:
/// as near as possible to where the placements of all members, taken back to it, are, subject to what the motions
/// that take it to itself ask of it, which then holds to rounding. The others are its images, in closed form. A family
/// that cannot be placed within the annotation's tolerance is refused, with its reason. Of two regions that overlap in
/// part, and where the one's group has no image of the other, the smaller gives up what the larger takes of it, with
/// all images of that, as long as half of it stays. Patterns take part in the same way: their steps are fitted to the
/// groups around them, and take regions within one instance to those of the others. Copies that touch one another, or a
/// region whose group the pattern's motions do not take along, give up the faces there.
///
/// What contradicts what is only known by then, so this is done several times: what was refused is kept instead of what
/// barred it where that saves more, and so is what was given up. A region of order |G| saves its area log2 |G| times,
/// as often as its group halves it, less where its residual is beyond the tolerance, by as many times; a pattern of n
/// instances saves theirs log2 n times. Regions of the whole are never given up. Where motions of a region take part of
/// another past an end of the surface, as where it was cut, the region leaves out all of the other, with all images of
/// that, if that saves more, as long as half of it stays. Of regions on the same faces what both save by the same
/// elements counts once. What a region holds of another but for a sliver at the border counts as all of it. At last
/// regions give up faces around vertices whose images lie in regions that they do not.
///
/// An annotation that is consistent comes back as it is.
/// \pre the annotation fits the mesh (read_annotation checks it)
/// Cost O(F) and, for each pair of regions that overlap, some hundred nearest-point queries; where much is
/// refused, a multiple of that which is the smaller the more there is to do.
ConsistentAnnotation consistent_annotation(const Mesh& mesh, const SymmetryAnnotation& annotation,
                                           const RunContext& context);

/// What is left out and added, as messages.
void tell_changes(const ConsistentAnnotation& result, const RunContext& context);

/// The consistent annotation alone; tells its changes.
SymmetryAnnotation made_consistent(const Mesh& mesh, const SymmetryAnnotation& annotation, const RunContext& context);

}  // namespace orbifit
