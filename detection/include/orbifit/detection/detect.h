#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "orbifit/detection/explanation.h"
#include "orbifit/detection/surface_colours.h"
#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"

namespace orbifit {

/// What a mesh's file calls the parts of it: Appearance::parts.
struct NamedParts {
  std::vector<int> part_of_face;   ///< #F, -1 for none; empty: no face has a name
  std::vector<std::string> names;  ///< may be repeated
};

struct DetectOptions {
  /// Largest distance between g(S) and S that still counts as symmetric, as a fraction of the mesh's diagonal.
  double tolerance = 0.005;  // 1e-6 <= tolerance <= 0.1
  /// Surface samples on which a whole mesh is verified; parts get a share by area.
  int samples = 4000;  // >= 100
  /// Meshes of at least as many faces are looked at by a coarser proxy mesh, where the tolerance allows one of at most
  /// half the faces, and what is found there is carried back, refined and verified on the mesh itself; 0: none are.
  int simplify_above_faces = 60000;  // >= 0
  /// Stop after this many seconds and return what is verified by then.
  double time_budget = 0;  // >= 0; 0: no limit
  /// List all that was found and can be kept, also what saves next to nothing beside what is listed before it.
  bool all = false;
  /// Which way is up, for the names of regions ("upper ring").
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();  // not zero
  /// Names that go before those by shape.
  NamedParts named_parts;
  /// Colours that take part: of each symmetry of the shape the largest subgroup that keeps them is listed; null, or one
  /// colour everywhere: the shape alone counts.
  const SurfaceColours* colours = nullptr;
  /// Where to list what of the shape's symmetries the colours break; null: nowhere.
  std::vector<BrokenByColours>* broken_by_colours = nullptr;
  /// Where to note what each stage kept and dropped; null: nowhere.
  Explanation* explanation = nullptr;

  /// \throw UsageError naming the field, its value and the rule
  void validate() const;
};

/// Finds the symmetric regions of a mesh (paper, section 3): the point group of the whole surface, the own groups of
/// its connected components and sets of congruent components, and the congruences among components as patterns. Every
/// element of a returned group was verified against the surface, and the groups agree with one another exactly
/// (consistent_annotation()). Ordered by importance, what each saves of the surface given those before it; images of
/// one another follow one another and have the importance of all. What follows from those before it, and is no main
/// part, is left out. Named by their parts' names or by what they are, and by where; parents set. The result is the
/// same for any number of threads. Costs O(F log F), for each region too, for meshes finer than the tolerance asks for;
/// the search itself depends on how much shape there is at the size of the tolerance. With colours the list is made
/// once more where `broken_by_colours` is asked for.
/// \throw InputError when the mesh has no area
SymmetryAnnotation detect(const Mesh& mesh, const DetectOptions& options, RunContext& context);

}  // namespace orbifit
