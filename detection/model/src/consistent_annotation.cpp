#include "orbifit/model/consistent_annotation.h"

#include "consistency_search.h"

namespace orbifit {

std::string to_string(const LeftOut& left_out) {
  const std::string kind = left_out.pattern ? "pattern " : "region ";
  const std::string name = left_out.name.empty() ? "" : " \"" + left_out.name + "\"";
  return kind + std::to_string(left_out.id) + name + " (" + left_out.group + "): " + left_out.reason;
}

ConsistentAnnotation consistent_annotation(const Mesh& mesh, const SymmetryAnnotation& annotation,
                                           const RunContext& context) {
  if (annotation.regions.empty() && annotation.patterns.empty()) return {annotation, {}, 0, 0};
  return ConsistencySearch(mesh, annotation, context).run();
}

}  // namespace orbifit
