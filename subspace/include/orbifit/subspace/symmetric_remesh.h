#pragma once

#include <string>
#include <vector>

#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"

namespace orbifit {

struct SymmetricRemeshOptions {
  /// Of a region, in [0, 1]: the least share of its surface whose images, under every element, must lie on it to within
  /// the annotation's tolerance. Detection asks for 0.96 of its samples. On 32 real meshes 222 of 223 detected regions
  /// have 0.95 and more, and of 364 mirrors set beside or across the true ones 5 do, where 12 have 0.9.
  double min_score = 0.95;
  /// In [0, 0.4]: a vertex nearer to a cut than this share of the edge that is cut is moved onto it.
  double snap = 0.2;

  void validate() const;  ///< \throw UsageError
};

/// What happened to a region or a pattern. Lengths are fractions of the diagonal.
struct SymmetricRemeshItem {
  bool pattern = false;
  int id = 0;
  std::string name;
  std::string group;    ///< Schoenflies symbol, or the pattern's kind
  std::string kept_as;  ///< the group that the new triangles have, of a continuous group a finite one; "" if left out
  double score = 0;     ///< share of the surface whose images lie on it, in [0, 1]
  std::string reason;   ///< why it was left out, or ""
};

struct SymmetricRemesh {
  Mesh mesh;
  /// Of `mesh`: what was kept; of continuous groups the finite one that the triangles have.
  SymmetryAnnotation annotation;
  std::vector<int> source_face;     ///< #F of `mesh`: the face that it was cut from
  std::vector<Motion> motions;      ///< the identity first
  std::vector<int> motion_of_face;  ///< #F: which of the motions took the cut face to where it is
  std::vector<SymmetricRemeshItem> items;
  double largest_distance = 0;  ///< between the given and the new surface
  double mean_distance = 0;     ///< over both surfaces' area; both are fractions of the given mesh's diagonal
};

/// Judges the regions of whole components, before an annotation is made consistent: that leaves out what contradicts
/// the shape, where one that asks for it wants to be told.
/// \throw NoResultError naming a region whose score is below `min_score`
void require_scores(const Mesh& mesh, const SymmetryAnnotation& annotation, const SymmetricRemeshOptions& options,
                    const RunContext& context);

/// A mesh whose vertices and triangles map onto one another under every element of every region that is kept, to
/// rounding. Regions, and a pattern's instances, count as whole connected components of the mesh; those that are parts
/// of one are left out.
///
/// Motions take components to components; of those that they relate the first is made anew and the others are its
/// images. (Components that have no counterpart of their own are taken together with others of their regions, as one
/// surface.) What takes one to itself is a finite group: it is cut along the walls of a Dirichlet domain of it
/// (docs/method.md 5.1), and the images of what is inside are welded along the walls by their numbers. Of some twenty
/// domains the one is taken whose images are nearest to the surface: the best side, not a mean. Before, the surface is
/// moved as a whole to where its centroid and its tensor of inertia are as symmetric as the group asks. At a mirror,
/// cut vertices are their own images; elsewhere the curves along which the two sides meet get one another's vertices,
/// and each place the mean of all that meet there.
///
/// A continuous group is kept as the finite one that the tessellation has, or else, where nothing else holds the same
/// components, as one with about as many rotations as the tessellation has steps about the axis (a sphere as Ih).
/// \pre the annotation is consistent
/// Where no domain's sides can be welded, the least important region or pattern that asks for that is left out.
/// \throw NoResultError where a region's score is below `min_score`
SymmetricRemesh symmetric_remesh(const Mesh& mesh, const SymmetryAnnotation& annotation,
                                 const SymmetricRemeshOptions& options, const RunContext& context);

}  // namespace orbifit
