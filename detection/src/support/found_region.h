#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "orbifit/detection/explanation.h"
#include "orbifit/model/annotation.h"
#include "orbifit/model/run_context.h"

#include "group/refinement.h"
#include "surface/surface_patch.h"

namespace orbifit {

/// A region on the way to the annotation, in the normalised mesh's frame.
struct FoundRegion {
  GroupPlacement placement;
  std::vector<int> faces;  ///< ascending
  double area = 0;         ///< of the faces that count
  std::string name;
  bool of_pieces = false;                 ///< made of pieces of surface, not of whole components
  std::optional<Residual> residual = {};  ///< where it was measured
};

/// Area of the faces of `inner` that are not in `outer`; both ascending.
double area_outside(const PreparedMesh& prepared, const std::vector<int>& inner, const std::vector<int>& outer);

/// Whether `inner` lies in `outer` but for a sliver: a twentieth of it and 0.2 % of the mesh's area, whichever is less,
/// not counting small triangles along the border of `outer`.
bool covers(const PreparedMesh& prepared, const FoundRegion& outer, const FoundRegion& inner);

/// The share of what a subgroup keeps that may lie outside of a larger group's region without being news: few elements
/// keep much by chance. \return `share`; of mirrors and half-turns beside large groups up to four times that, of groups
/// of up to four elements up to twice
double share_by_chance(double share, const PointGroup& larger, const PointGroup& smaller);

/// The same for groups of few elements beside far larger ones, as a fraction of area; 0 for all others.
double share_of_few(const PointGroup& larger, const PointGroup& smaller);

/// Whether one of the others says what the region says: it holds all but `outside` of the region's area, and its group
/// all elements of the region's, to twice the tolerance. More may be outside by chance, see share_by_chance().
/// \param tolerance of the detector, a fraction of the diagonal \param outside a fraction of the region's area
bool says_nothing_new_beside(const PreparedMesh& prepared, std::span<const FoundRegion> others,
                             const FoundRegion& region, double tolerance, double outside);

/// Drops regions inside another one whose group holds all their elements: they say nothing new. Of two that say the
/// same of one another the earlier stays. A group that keeps but a little more than a far larger one, see
/// share_of_few(), says nothing new either, unless on nearly the whole mesh. A region of whole components stays beside
/// one of pieces that fits far less well, unless that has the same group and is more than twice as large, and beside
/// one that is far from exact where it is exact itself. One of pieces takes the placement of components of the same
/// group that go, where it fits as well with that. \param tolerance of the detector, a fraction of the diagonal
void drop_repeats(const PreparedMesh& prepared, double tolerance, std::vector<FoundRegion>& regions,
                  Explanation* explanation = nullptr);

/// Faces have one maximal group. Where several that do not hold one another were found on the same faces, a larger one
/// narrowly failed: the one of most elements stays, of equal ones the one that fits best. Of two of the
/// same group on faces that differ by a thirtieth of their area the larger stays.
/// \param tolerance of the detector, a fraction of the diagonal
void drop_lesser_groups(const PreparedMesh& prepared, double tolerance, std::vector<FoundRegion>& regions,
                        Explanation* explanation = nullptr);

/// Whether a region is symmetric by coincidence: it is far off, while another one, around it and at least twice as
/// large, is exact and shows that this mesh is: triangles that know no symmetry fit no part exactly. Kept, its group
/// would also clash with the exact ones. To be asked of finite groups only: a turned part's residual is that of its
/// facets and says nothing.
/// \param residual, residual_around largest residuals \param tolerance of the detector; all fractions of the diagonal
bool by_coincidence(double area, double residual, double area_around, double residual_around, double tolerance);

/// Drops regions of at most half the surface to which only their border gives a group: pieces of a larger plane,
/// cylinder or sphere. \param whole index of the whole mesh
void drop_featureless(const PreparedMesh& prepared, const SurfaceIndex& whole, double tolerance,
                      const RunContext& context, std::vector<FoundRegion>& regions, Explanation* explanation = nullptr);

}  // namespace orbifit
