#include "kept_consistent.h"

#include <algorithm>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "orbifit/model/consistent_annotation.h"

#include "consistency/consistency_search.h"
#include "consistency/group_place.h"
#include "consistency/surface_consistency.h"
#include "evidence/importance.h"
#include "support/found_region.h"
#include "support/trimmed_regions.h"

namespace orbifit {

namespace {

void note_left_out(const std::vector<LeftOut>& left_out, Explanation* explanation) {
  if (explanation == nullptr) return;
  for (const LeftOut& each : left_out) {
    explanation->notes.push_back({"consistency", each.group + " on " + each.name, false, each.reason});
  }
}

// Numbers of regions, and of patterns, are those of their places.
void number(SymmetryAnnotation& annotation) {
  for (std::size_t i = 0; i < annotation.regions.size(); ++i) annotation.regions[i].id = static_cast<int>(i);
  for (std::size_t i = 0; i < annotation.patterns.size(); ++i) annotation.patterns[i].id = static_cast<int>(i);
}

void take_out(SymmetryAnnotation& annotation, const std::vector<LeftOut>& left_out) {
  const auto gone = [&](bool pattern, int id) {
    return std::ranges::any_of(left_out, [&](const LeftOut& each) { return each.pattern == pattern && each.id == id; });
  };
  std::erase_if(annotation.regions, [&](const Region& region) { return gone(false, region.id); });
  std::erase_if(annotation.patterns, [&](const Pattern& pattern) { return gone(true, pattern.id); });
}

// Largest regions first. \param left_out  how many were, told in a message
SymmetryAnnotation sorted(const Mesh& mesh, SymmetryAnnotation annotation, std::size_t left_out,
                          const RunContext& context) {
  if (left_out > 0) {
    context.message("left out " + std::to_string(left_out) +
                    (left_out == 1 ? " region or pattern" : " regions and patterns") +
                    " that cannot be kept exactly beside larger ones (--explain says which and why)");
  }
  const Eigen::VectorXd areas = face_areas(mesh);
  const auto area = [&](const Region& region) {
    double sum = 0;
    for (const int face : region.faces) sum += areas[face];
    return sum;
  };
  std::ranges::stable_sort(annotation.regions, std::greater<>(), area);
  number(annotation);
  set_parents(annotation.regions);
  return annotation;
}

// Consistency moves groups, and takes faces away whose images then have none: these go as well, as far as
// trim_regions() goes. What changed is measured anew. \param measured  regions as they were measured; those that are
// now are added \return whether faces went
bool trim_changed(const PreparedMesh& prepared, std::vector<Region>& measured, SymmetryAnnotation& kept,
                  Explanation* explanation, const RunContext& context) {
  const auto is_measured = [&](const Region& region) {
    return std::ranges::any_of(measured, [&](const Region& before) {
      return before.group == region.group && before.residual.max == region.residual.max && before.faces == region.faces;
    });
  };
  const SymmetryAnnotation local = transformed(kept, inverse(prepared.input_of_normalised));
  bool any = false;
  for (std::size_t i = 0; i < kept.regions.size(); ++i) {
    Region& region = kept.regions[i];
    const std::optional<GroupPlace> place = place_of(local.regions[i]);
    if (!place || is_measured(region)) continue;
    std::vector<FoundRegion> changed{{{place->group, place->frame, place->centre}, region.faces, 0, region.name}};
    trim_regions(prepared, kept.tolerance, context, changed, explanation);
    if (changed.front().residual) {
      region.residual = *changed.front().residual;
      measured.push_back(region);
    } else {  // without those that go another pass measures it
      region.faces = std::move(changed.front().faces);
      any = true;
    }
  }
  return any;
}

// Trimmed and measured where consistency changed it. \param gone  how many were left out before
SymmetryAnnotation finished(const PreparedMesh& prepared, const ShapeSurface& surface, const SymmetryAnnotation& found,
                            ConsistentAnnotation kept, std::size_t gone, Explanation* explanation,
                            const RunContext& context) {
  std::vector<Region> measured = found.regions;
  while (trim_changed(prepared, measured, kept.annotation, explanation, context)) {
    kept = consistent_annotation(surface, kept.annotation, context);
    note_left_out(kept.left_out, explanation);
    gone += kept.left_out.size();
  }
  return sorted(surface.mesh, std::move(kept.annotation), gone, context);
}

}  // namespace

SymmetryAnnotation kept_consistent(const Mesh& mesh, const SymmetryAnnotation& found, Explanation* explanation,
                                   const RunContext& context) {
  ConsistentAnnotation kept = consistent_annotation(mesh, found, context);
  note_left_out(kept.left_out, explanation);
  return sorted(mesh, std::move(kept.annotation), kept.left_out.size(), context);
}

SymmetryAnnotation kept_consistent(const PreparedMesh& prepared, const Mesh& mesh, const SymmetryAnnotation& found,
                                   Explanation* explanation, const RunContext& context) {
  const ShapeSurface surface = ConsistencySearch::surface_of(mesh, found.tolerance, context);
  ConsistentAnnotation kept = consistent_annotation(surface, found, context);
  note_left_out(kept.left_out, explanation);
  const std::size_t gone = kept.left_out.size();
  return finished(prepared, surface, found, std::move(kept), gone, explanation, context);
}

SymmetryAnnotation kept_without_what_follows(const PreparedMesh& prepared, const Mesh& mesh, SymmetryAnnotation found,
                                             Explanation* explanation, const RunContext& context) {
  number(found);
  SymmetryAnnotation listed = without_what_follows(prepared, found, context);
  const ShapeSurface surface = ConsistencySearch::surface_of(mesh, found.tolerance, context);
  for (std::size_t gone = 0;;) {
    ConsistentAnnotation kept = consistent_annotation(surface, listed, context);
    note_left_out(kept.left_out, explanation);
    gone += kept.left_out.size();
    if (kept.left_out.empty()) return finished(prepared, surface, found, std::move(kept), gone, explanation, context);
    // What was left out may have implied something, moved something, and taken faces from it.
    take_out(found, kept.left_out);
    listed = without_what_follows(prepared, found, context);
  }
}

}  // namespace orbifit
