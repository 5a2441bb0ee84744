#pragma once

#include <filesystem>

#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"
#include "orbifit/subspace/subspace.h"

namespace orbifit {

/// Stores a subspace for the mesh and annotation that it was built from (docs/basis-format.md). The same subspace gives
/// the same bytes. Written under a temporary name, then renamed.
/// \throw InputError when the file cannot be written
void write_subspace(const std::filesystem::path& file, const Subspace& subspace, const Mesh& mesh,
                    const SymmetryAnnotation& annotation);

/// The subspace as it was written: its displacements are the same bytes.
/// \throw InputError naming file, section and reason, when the file cannot be read, is no basis or one of another
/// version,
///        is cut off or damaged, or belongs to another mesh or annotation
Subspace read_subspace(const std::filesystem::path& file, const Mesh& mesh, const SymmetryAnnotation& annotation,
                       const RunContext& context);

}  // namespace orbifit
