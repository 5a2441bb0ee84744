#pragma once

#include <memory>
#include <string>

#include "orbifit/subspace/subspace.h"

#include "annotations.h"

namespace orbifit::python {

/// A subspace and what it was built from, which it needs.
struct KeptSubspace {
  MeshPointer mesh;
  AnnotationPointer annotation;  ///< consistent: of the groups that the subspace keeps
  Subspace subspace;
};
using SubspacePointer = std::shared_ptr<KeptSubspace>;

/// "fixed", "floating" or "moving". \throw UsageError
GroupMode mode_from(const std::string& text);

/// "orbit" or "paper". \throw UsageError
LiftKind lift_kind_from(const std::string& text);

/// Options as Subspace() takes them. \param relative_radii  one for each vertex, or none
SubspaceOptions subspace_options(const std::string& mode, const std::string& lift, std::optional<double> radius,
                                 std::optional<int> samples, const std::optional<ArrayLike>& relative_radii,
                                 bool sharp_features_first, const Mesh& mesh);

/// A state, of a subspace with as many degrees of freedom: coordinates, or what a deformation left.
SubspaceState state_from(const KeptSubspace& kept, const py::handle& state);

}  // namespace orbifit::python
