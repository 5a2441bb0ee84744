#pragma once

#include <memory>
#include <string>
#include <utility>

#include <Eigen/Core>

#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/motion.h"
#include "orbifit/model/run_context.h"

namespace orbifit {

/// What may become of a region's group in a deformation (docs/method.md 2.2).
enum class GroupMode {
  fixed,     ///< kept as it is (the paper)
  floating,  ///< carried along by a translation of its own
  moving     ///< carried along by a rigid motion of its own
};

std::string to_string(GroupMode mode);

/// How displacements go from the samples to the vertices.
enum class LiftKind {
  paper,  ///< Gaussians (paper, section 5): not exact on partial regions
  orbit   ///< averaged over orbits, exact (docs/method.md 2.3)
};

std::string to_string(LiftKind kind);

struct SubspaceOptions {
  GroupMode mode = GroupMode::floating;
  LiftKind lift = LiftKind::orbit;
  /// Sampling radius r in mesh units; 0: chosen for `samples`, or for about 200 degrees of freedom, but at most
  /// about 2400 samples.
  double radius = 0;  // >= 0
  /// Number of samples to aim at when no radius is given; 0: see `radius`.
  int samples = 0;  // 0, or >= 4
  /// r at each vertex relative to `radius` (docs/method.md 2.5), #V, > 0; empty: 1 everywhere.
  Eigen::VectorXd relative_radii;
  /// Draw samples on sharp edges and corners first (paper, section 7).
  bool sharp_features_first = false;

  void validate() const;  ///< \throw UsageError
};

struct ConjugatedBasis;
struct SubspaceParts;
struct SurfaceDetail;

/// The symmetric, low-frequency displacements of a mesh (paper, section 5): coordinates q -> samples -> vertices. A
/// handle: copies are cheap and share what it holds, which does not change.
class Subspace {
 public:
  Subspace() = default;  ///< empty: nothing but assigning to it makes sense
  explicit Subspace(std::shared_ptr<const SubspaceParts> parts) : parts_(std::move(parts)) {}

  GroupMode mode() const;
  LiftKind lift_kind() const;
  int degrees_of_freedom() const;
  int regions() const;            ///< of the annotation that it was built from
  const Points& samples() const;  ///< #S by 3, at rest
  double radius() const;          ///< r, mesh units: the least distance between samples where r is the same everywhere
  double diagonal() const;        ///< of the mesh

  /// What it is made of, for our own libraries: basis/subspace_parts.h.
  const SubspaceParts& operator*() const { return *parts_; }
  const SubspaceParts* operator->() const { return parts_.get(); }

 private:
  std::shared_ptr<const SubspaceParts> parts_;
};

/// Samples the mesh symmetrically, builds the basis and bakes the lift. O(vertices) for a given radius.
/// \throw InputError when the mesh has no area, or orbits do not close
Subspace build_subspace(const Mesh& mesh, const SymmetryAnnotation& annotation, const SubspaceOptions& options,
                        const RunContext& context);

/// A state of the deformation: coordinates in a basis.
struct SubspaceState {
  Eigen::VectorXd q;
  std::shared_ptr<const ConjugatedBasis> basis;  ///< null: the subspace's, at rest
  /// Of the vertices, finer than the samples tell; as symmetric. Null: none.
  std::shared_ptr<const SurfaceDetail> detail = nullptr;
};

/// U q as #S by 3.
Points sample_displacements(const Subspace& subspace, const SubspaceState& state);
Points sample_displacements(const Subspace& subspace, const Eigen::VectorXd& q);

/// The rigid motion that carries a region's group: y -> R (y - c) + c + t; the identity when groups are fixed.
Motion region_motion(const Subspace& subspace, const SubspaceState& state, int region);
Eigen::Vector3d region_translation(const Subspace& subspace, const Eigen::VectorXd& q, int region);

/// Where the regions' centres are now, #regions by 3.
Points region_centres(const Subspace& subspace, const SubspaceState& state);

/// The lifted displacements of the mesh's vertices, #V by 3. Images of a vertex are exact copies of its displacement.
Points vertex_displacements(const Subspace& subspace, const SubspaceState& state,
                            const RunContext& context = RunContext{});
Points vertex_displacements(const Subspace& subspace, const Eigen::VectorXd& q);

/// The annotation of the deformed mesh: the same regions and patterns, carried along.
SymmetryAnnotation deformed_annotation(const SymmetryAnnotation& annotation, const Subspace& subspace,
                                       const SubspaceState& state, const Mesh& deformed);
SymmetryAnnotation deformed_annotation(const SymmetryAnnotation& annotation, const Subspace& subspace,
                                       const Eigen::VectorXd& q, const Mesh& deformed);

}  // namespace orbifit
