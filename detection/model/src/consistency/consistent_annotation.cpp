#include "orbifit/model/consistent_annotation.h"

#include <utility>

#include "consistency/consistency_choice.h"

namespace orbifit {

std::string to_string(const LeftOut& left_out) {
  const std::string kind = left_out.pattern ? "pattern " : "region ";
  const std::string name = left_out.name.empty() ? "" : " \"" + left_out.name + "\"";
  return kind + std::to_string(left_out.id) + name + " (" + left_out.group + "): " + left_out.reason;
}

ConsistentAnnotation consistent_annotation(const Mesh& mesh, const SymmetryAnnotation& annotation,
                                           const RunContext& context) {
  if (annotation.regions.empty() && annotation.patterns.empty()) return {annotation, {}, 0, 0};
  return chosen_annotation(mesh, annotation, context);
}

SymmetryAnnotation made_consistent(const Mesh& mesh, const SymmetryAnnotation& annotation, const RunContext& context) {
  ConsistentAnnotation result = consistent_annotation(mesh, annotation, context);
  for (const LeftOut& left_out : result.left_out) context.message("left out " + to_string(left_out));
  if (result.added > 0) {
    context.message("added " + std::to_string(result.added) + " images of regions that the annotation lacked");
  }
  return std::move(result.annotation);
}

}  // namespace orbifit
