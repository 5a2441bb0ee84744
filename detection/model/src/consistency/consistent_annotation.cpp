#include "orbifit/model/consistent_annotation.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "consistency/closed_borders.h"
#include "consistency/consistency_choice.h"
#include "consistency/consistency_closure.h"
#include "consistency/consistency_search.h"
#include "consistency/surface_consistency.h"

namespace orbifit {

std::string to_string(const LeftOut& left_out) {
  const std::string kind = left_out.pattern ? "pattern " : "region ";
  const std::string name = left_out.name.empty() ? "" : " \"" + left_out.name + "\"";
  return kind + std::to_string(left_out.id) + name + " (" + left_out.group + "): " + left_out.reason;
}

namespace {

// Whether what was left out is of the annotation, and not an image that was added to it.
bool is_given(const LeftOut& left_out, const SymmetryAnnotation& annotation) {
  return left_out.pattern ||
         std::ranges::any_of(annotation.regions, [&](const Region& region) { return region.id == left_out.id; });
}

}  // namespace

ConsistentAnnotation consistent_annotation(const Mesh& mesh, const SymmetryAnnotation& annotation,
                                           const RunContext& context) {
  if (annotation.regions.empty() && annotation.patterns.empty()) return {annotation, {}, 0, 0};
  const ShapeSurface surface = ConsistencySearch::surface_of(mesh, annotation.tolerance, context);
  ConsistentAnnotation result = consistent_annotation(surface, annotation, context);
  result.surface_index = surface.index;
  return result;
}

ConsistentAnnotation consistent_annotation(const ShapeSurface& surface, const SymmetryAnnotation& annotation,
                                           const RunContext& context) {
  ConsistentAnnotation result{annotation, {}, 0, 0};
  const auto take = [&](ConsistentAnnotation chosen) {
    result.annotation = std::move(chosen.annotation);
    result.largest_movement = std::max(result.largest_movement, chosen.largest_movement);
    result.added += chosen.added;
    for (LeftOut& left_out : chosen.left_out) {
      if (is_given(left_out, annotation)) {
        result.left_out.push_back(std::move(left_out));
      } else {
        --result.added;
      }
    }
  };
  bool settled = true;
  if (std::optional<ConsistentAnnotation> chosen = chosen_annotation(surface, annotation, context)) {
    settled = chosen->left_out.empty() && chosen->added == 0;
    take(std::move(*chosen));
  }
  // What was added or given up may contradict what else is kept; every repetition leaves out more, so there is an end.
  // Groups that do not close may do so once borders are given up, which costs less.
  while (true) {
    if (close_borders(surface, result.annotation, context) || !settled) {
      if (std::optional<ConsistentAnnotation> again = chosen_annotation(surface, result.annotation, context)) {
        settled = again->left_out.empty();
        take(std::move(*again));
        continue;
      }
    }
    if (!leave_out_unclosed(surface.mesh, surface.domains, annotation, result, context)) break;
    settled = false;
  }
  return result;
}

void tell_changes(const ConsistentAnnotation& result, const RunContext& context) {
  for (const LeftOut& left_out : result.left_out) context.message("left out " + to_string(left_out));
  if (result.added > 0) {
    context.message("added " + std::to_string(result.added) + " images of regions that the annotation lacked");
  }
}

SymmetryAnnotation made_consistent(const Mesh& mesh, const SymmetryAnnotation& annotation, const RunContext& context) {
  ConsistentAnnotation result = consistent_annotation(mesh, annotation, context);
  tell_changes(result, context);
  return std::move(result.annotation);
}

}  // namespace orbifit
