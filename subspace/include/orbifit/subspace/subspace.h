#pragma once

#include <memory>
#include <string>
#include <vector>

#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"
#include "orbifit/subspace/group_words.h"
#include "orbifit/subspace/orbit_lift.h"
#include "orbifit/subspace/region_map.h"
#include "orbifit/subspace/symmetric_basis.h"
#include "orbifit/subspace/symmetric_sampling.h"
#include "orbifit/subspace/vertex_orbits.h"

namespace orbifit {

/// What may become of a region's group in a deformation (method notes 2.2).
enum class GroupMode {
  fixed,     ///< kept as it is (the paper)
  floating,  ///< carried along by a translation of its own
  moving     ///< carried along by a rigid motion of its own
};

std::string to_string(GroupMode mode);

/// How displacements go from the samples to the vertices.
enum class LiftKind {
  paper,  ///< Gaussians (paper, section 5): not exact on partial regions
  orbit   ///< averaged over orbits, exact (method notes 2.1)
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
  /// r at each vertex relative to `radius` (method notes 2.4), #V, > 0; empty: 1 everywhere.
  Eigen::VectorXd relative_radii;
  /// Draw samples on sharp edges and corners first (paper, section 7).
  bool sharp_features_first = false;

  void validate() const;  ///< \throw UsageError
};

/// A basis with the groups turned as they are now, and what the lift needs of it.
struct CarriedBasis : SymmetricBasis {
  std::vector<Eigen::Matrix3d> rotations;  ///< R of each region; empty: not turned
  CarriedTransports transports;
  Eigen::SparseMatrix<double, Eigen::RowMajor> atoms;  ///< 3#A by DoF: the atoms' displacements
  Eigen::VectorXd atom_offset;                         ///< 3#A
  std::vector<Eigen::Matrix3d> atom_rotations;         ///< #A where turned: of the region around each atom
  std::vector<Eigen::Vector3d> atom_positions;         ///< #A where turned: at rest; of some kinds about the axis
  std::vector<Binding> bindings;                       ///< of the vertex orbits
};

/// The symmetric, low-frequency displacements of a mesh (paper, section 5): coordinates q -> samples -> vertices.
struct Subspace {
  GroupMode mode = GroupMode::floating;
  LiftKind lift_kind = LiftKind::orbit;
  std::shared_ptr<const RegionMap> regions;
  std::shared_ptr<const GroupWords> words;
  SymmetricSampling sampling;
  VertexOrbits orbits;  ///< of the vertices
  OrbitLift lift;
  CarriedBasis basis;   ///< at rest
  double diagonal = 0;  ///< of the mesh

  int degrees_of_freedom() const { return basis.degrees_of_freedom(); }
};

/// Samples the mesh symmetrically, builds the basis and bakes the lift. O(vertices) for a given radius.
/// \throw InputError when the mesh has no area, or orbits do not close
Subspace build_subspace(const Mesh& mesh, const SymmetryAnnotation& annotation, const SubspaceOptions& options,
                        const RunContext& context);

/// The basis when region i's group is turned by rotations[i] about its carried centre (mode moving).
CarriedBasis carried_basis(const Subspace& subspace, const std::vector<Eigen::Matrix3d>& rotations);

/// Whether groups turned so agree with one another to `tolerance`, mesh units, and leave the samples and the vertices
/// as free as they are at rest.
bool keeps_freedom(const Subspace& subspace, const std::vector<Eigen::Matrix3d>& rotations, double tolerance);

/// A state of the deformation: coordinates in a basis.
struct SubspaceState {
  Eigen::VectorXd q;
  std::shared_ptr<const CarriedBasis> basis;  ///< null: the subspace's, at rest
};

const CarriedBasis& basis_of(const Subspace& subspace, const SubspaceState& state);

/// U q as #S by 3.
Points sample_displacements(const Subspace& subspace, const SubspaceState& state);
Points sample_displacements(const Subspace& subspace, const Eigen::VectorXd& q);

/// The rigid motion that carries a region's group: y -> R (y - c) + c + t; the identity when groups are fixed.
Motion carried_motion(const Subspace& subspace, const SubspaceState& state, int region);
Eigen::Vector3d carried_translation(const Subspace& subspace, const Eigen::VectorXd& q, int region);

/// Where the regions' centres are now, #regions by 3.
Points carried_centres(const Subspace& subspace, const SubspaceState& state);

/// The lifted displacements of the mesh's vertices, #V by 3. Images of a vertex are exact copies of its displacement.
Points vertex_displacements(const Subspace& subspace, const SubspaceState& state,
                            const RunContext& context = RunContext{});
Points vertex_displacements(const Subspace& subspace, const Eigen::VectorXd& q);

/// How a vertex follows its representative (VertexOrbits): u(vertex) = along * u + the carried translations, where u is
/// what representative_rows() say of it. What turned groups add whatever the coordinates are, is left out.
struct VertexWay {
  int representative = 0;
  Eigen::Matrix3d along;
  Carried carried;
};
VertexWay vertex_way(const Subspace& subspace, const CarriedBasis& basis, int vertex);

/// Adds what the lift makes of a representative, before anything binds it, to three linear forms in a basis'
/// coordinates. \param rows  3 by DoF
void add_representative_rows(const Subspace& subspace, const CarriedBasis& basis, int representative,
                             Eigen::Ref<Eigen::Matrix3Xd> rows);

/// Adds u(vertex) to three linear forms in a basis' coordinates; what turned groups add whatever the coordinates are,
/// is left out. \param rows  3 by DoF
void add_vertex_rows(const Subspace& subspace, const CarriedBasis& basis, int vertex,
                     Eigen::Ref<Eigen::Matrix3Xd> rows);

/// The annotation of the deformed mesh: the same regions and patterns, carried along.
SymmetryAnnotation carried_annotation(const SymmetryAnnotation& annotation, const Subspace& subspace,
                                      const SubspaceState& state, const Mesh& deformed);
SymmetryAnnotation carried_annotation(const SymmetryAnnotation& annotation, const Subspace& subspace,
                                      const Eigen::VectorXd& q, const Mesh& deformed);

}  // namespace orbifit
