#pragma once

#include <memory>
#include <string>

#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"
#include "orbifit/subspace/lift.h"
#include "orbifit/subspace/region_map.h"
#include "orbifit/subspace/symmetric_basis.h"
#include "orbifit/subspace/symmetric_sampling.h"
#include "orbifit/subspace/vertex_orbits.h"

namespace orbifit {

/// What may become of a region's group in a deformation (method notes 2.2).
enum class GroupMode {
  fixed,    ///< kept as it is (the paper)
  floating  ///< carried along by a translation of its own
};

std::string to_string(GroupMode mode);

struct SubspaceOptions {
  GroupMode mode = GroupMode::floating;
  /// Sampling radius r in mesh units; 0: chosen for `samples`, or for about 200 degrees of freedom.
  double radius = 0;  // >= 0
  /// Number of samples to aim at when no radius is given; 0: see `radius`.
  int samples = 0;  // 0, or >= 4

  void validate() const;  ///< \throw UsageError
};

/// The symmetric, low-frequency displacements of a mesh (paper, section 5): coordinates q -> samples -> vertices.
struct Subspace {
  GroupMode mode = GroupMode::floating;
  std::shared_ptr<const RegionMap> regions;
  SymmetricSampling sampling;
  SymmetricBasis basis;
  LiftWeights lift;     ///< #V by #S
  VertexOrbits orbits;  ///< of the vertices

  int degrees_of_freedom() const { return basis.degrees_of_freedom(); }
};

/// Samples the mesh symmetrically, builds the basis and bakes the lift.
/// \throw InputError when the mesh has no area, or orbits do not close
Subspace build_subspace(const Mesh& mesh, const SymmetryAnnotation& annotation, const SubspaceOptions& options,
                        const RunContext& context);

/// U q as #S by 3.
Points sample_displacements(const Subspace& subspace, const Eigen::VectorXd& q);

/// The translation t_i that carries a region's group; zero when groups are fixed.
Eigen::Vector3d carried_translation(const Subspace& subspace, const Eigen::VectorXd& q, int region);

/// The lifted displacements of the mesh's vertices, #V by 3.
Points vertex_displacements(const Subspace& subspace, const Eigen::VectorXd& q);

/// The displacement field at any points in space, #P by 3.
Points displacement_field(const Subspace& subspace, const Eigen::VectorXd& q, const Points& points,
                          const RunContext& context);

/// The annotation of the deformed mesh: the same regions, their groups carried along.
SymmetryAnnotation carried_annotation(const SymmetryAnnotation& annotation, const Subspace& subspace,
                                      const Eigen::VectorXd& q, const Mesh& deformed);

/// How well the displacement field itself is symmetric: |u(g p) - O u(p) - (I - O) t| over vertices p of a region
/// and elements g, evaluated in space at g p, as a fraction of the diagonal. This has no floor from the tessellation.
/// Of a large region every k-th vertex is taken, so that about 20 000 pairs (p, g) are.
Residual field_residual(const Subspace& subspace, const Mesh& mesh, const Region& region, int region_number,
                        const Eigen::VectorXd& q, const RunContext& context);

}  // namespace orbifit
