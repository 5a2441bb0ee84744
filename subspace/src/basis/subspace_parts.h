#pragma once

#include <memory>
#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "orbifit/model/mesh.h"
#include "orbifit/subspace/subspace.h"

#include "basis/annotated_surface.h"
#include "basis/orbit_lift.h"
#include "basis/symmetric_basis.h"
#include "basis/vertex_orbits.h"
#include "sampling/symmetric_sampling.h"
#include "symmetry/group_words.h"
#include "symmetry/region_map.h"

namespace orbifit {

/// A basis of the displacements that are symmetric under the groups as they are now, conjugated by the motions of their
/// regions, and what the lift needs of it.
struct ConjugatedBasis : SymmetricBasis {
  std::vector<Eigen::Matrix3d> rotations;  ///< R of each region; empty: not turned
  CarriedTransports transports;
  Eigen::SparseMatrix<double, Eigen::RowMajor> atoms;  ///< 3#A by DoF: the atoms' displacements
  Eigen::VectorXd atom_offset;                         ///< 3#A
  std::vector<Eigen::Matrix3d> atom_rotations;         ///< #A where turned: of the region around each atom
  std::vector<Eigen::Vector3d> atom_positions;         ///< #A where turned: at rest; of some kinds about the axis
  std::vector<Binding> bindings;                       ///< of the vertex orbits
};

/// What a Subspace is made of.
struct SubspaceParts {
  GroupMode mode = GroupMode::floating;
  LiftKind lift_kind = LiftKind::orbit;
  std::shared_ptr<AnnotatedSurface> surface;  ///< shared by subspaces of the same; null where read from a file
  std::shared_ptr<const RegionMap> regions;   ///< of `surface`, where there is one
  std::shared_ptr<const GroupWords> words;
  SymmetricSampling sampling;
  VertexOrbits orbits;  ///< of the vertices
  OrbitLift lift;
  ConjugatedBasis basis;  ///< at rest
  double diagonal = 0;    ///< of the mesh

  int degrees_of_freedom() const { return basis.degrees_of_freedom(); }
};

/// build_subspace() of the mesh and the annotation of another subspace with other options: takes over what these have
/// in common. Not while another thread uses either.
Subspace rebuilt_subspace(const Subspace& other, const Mesh& mesh, const SymmetryAnnotation& annotation,
                          const SubspaceOptions& options, const RunContext& context);

/// The basis when region i's group is turned by rotations[i] about its carried centre (mode moving).
ConjugatedBasis conjugated_basis(const Subspace& subspace, const std::vector<Eigen::Matrix3d>& rotations);

/// Whether groups turned so agree with one another to `tolerance`, mesh units, and leave the samples and the vertices
/// as free as they are at rest.
bool keeps_freedom(const Subspace& subspace, const std::vector<Eigen::Matrix3d>& rotations, double tolerance);

/// The basis of a state's coordinates.
const ConjugatedBasis& basis_of(const Subspace& subspace, const SubspaceState& state);

/// How a vertex follows its representative (VertexOrbits): u(vertex) = along * u + the carried translations, where u is
/// what representative_rows() say of it. What turned groups add whatever the coordinates are, is left out.
struct VertexWay {
  int representative = 0;
  Eigen::Matrix3d along;
  Carried carried;
};
VertexWay vertex_way(const Subspace& subspace, const ConjugatedBasis& basis, int vertex);

/// Adds what the lift makes of a representative, before anything binds it, to three linear forms in a basis'
/// coordinates. \param rows  3 by DoF
void add_representative_rows(const Subspace& subspace, const ConjugatedBasis& basis, int representative,
                             Eigen::Ref<Eigen::Matrix3Xd> rows);

/// Adds u(vertex) to three linear forms in a basis' coordinates; what turned groups add whatever the coordinates are,
/// is left out. \param rows  3 by DoF
void add_vertex_rows(const Subspace& subspace, const ConjugatedBasis& basis, int vertex,
                     Eigen::Ref<Eigen::Matrix3Xd> rows);

}  // namespace orbifit
