#pragma once

#include <string>
#include <vector>

#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"
#include "orbifit/subspace/handles.h"
#include "orbifit/subspace/subspace.h"

namespace orbifit {

/// A field residual above this share of the diagonal is no rounding error.
constexpr double kExactResidual = 1e-9;

/// "symmetric to 2e-16 of the diagonal", for a summary line.
std::string exactness(double field_residual);

/// What a person should know of an edit that was made, a line each, none where all went as asked: handles far from
/// their targets, with the regions whose groups forbid what they ask; a shape that was moved as a whole; a displacement
/// that is not exactly symmetric. \param annotation  of the regions that the subspace keeps \param edited  the mesh
/// after the edit \param field_residual  worst of the regions, a fraction of the diagonal
std::vector<std::string> edit_warnings(const Mesh& mesh, const SymmetryAnnotation& annotation, const Subspace& subspace,
                                       const std::vector<Handle>& handles, const Mesh& edited, double field_residual);

}  // namespace orbifit
