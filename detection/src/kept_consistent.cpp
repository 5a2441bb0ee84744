#include "kept_consistent.h"

#include <algorithm>
#include <functional>
#include <string>
#include <utility>

#include "orbifit/model/consistent_annotation.h"

namespace orbifit {

SymmetryAnnotation kept_consistent(const Mesh& mesh, const SymmetryAnnotation& found, Explanation* explanation,
                                   const RunContext& context) {
  ConsistentAnnotation result = consistent_annotation(mesh, found, context);
  if (explanation != nullptr) {
    for (const LeftOut& left_out : result.left_out) {
      explanation->notes.push_back({"consistency", left_out.group + " on " + left_out.name, false, left_out.reason});
    }
  }
  if (!result.left_out.empty()) {
    const std::size_t count = result.left_out.size();
    context.message("left out " + std::to_string(count) +
                    (count == 1 ? " region or pattern" : " regions and patterns") +
                    " that cannot be kept exactly beside larger ones (--explain says which and why)");
  }
  SymmetryAnnotation& annotation = result.annotation;
  const Eigen::VectorXd areas = face_areas(mesh);
  const auto area = [&](const Region& region) {
    double sum = 0;
    for (const int face : region.faces) sum += areas[face];
    return sum;
  };
  std::ranges::stable_sort(annotation.regions, std::greater<>(), area);
  for (std::size_t i = 0; i < annotation.regions.size(); ++i) annotation.regions[i].id = static_cast<int>(i);
  for (std::size_t i = 0; i < annotation.patterns.size(); ++i) annotation.patterns[i].id = static_cast<int>(i);
  set_parents(annotation.regions);
  return std::move(annotation);
}

}  // namespace orbifit
