#pragma once

#include "orbifit/model/annotation.h"
#include "orbifit/model/consistent_annotation.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"

namespace orbifit {

/// Leaves out of `kept` what disagreements() names, until it names nothing: of all families of claims that disagree,
/// again and again the one that saves least for what it bars. The whole shape's regions are never given up.
/// \param given  where `kept` was chosen from
void leave_out_disagreements(const Mesh& mesh, const SymmetryAnnotation& given, ConsistentAnnotation& kept,
                             const RunContext& context);

/// The same of what unclosed_groups() names. \return whether anything had to go
bool leave_out_unclosed(const Mesh& mesh, const SymmetryAnnotation& given, ConsistentAnnotation& kept,
                        const RunContext& context);

}  // namespace orbifit
