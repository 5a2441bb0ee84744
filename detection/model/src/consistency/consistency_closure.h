#pragma once

#include "orbifit/model/annotation.h"
#include "orbifit/model/consistent_annotation.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"

#include "domains/known_domains.h"

namespace orbifit {

/// Leaves out of `kept` what disagreements() names, until it names nothing: of all families of claims that disagree,
/// again and again the one that saves least for what it bars. The whole shape's regions are never given up.
/// \param domains  of the mesh \param given  where `kept` was chosen from
void leave_out_disagreements(const Mesh& mesh, KnownDomains& domains, const SymmetryAnnotation& given,
                             ConsistentAnnotation& kept, const RunContext& context);

/// The same of what unclosed_groups() names. \return whether anything had to go
bool leave_out_unclosed(const Mesh& mesh, KnownDomains& domains, const SymmetryAnnotation& given,
                        ConsistentAnnotation& kept, const RunContext& context);

}  // namespace orbifit
