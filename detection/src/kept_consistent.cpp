#include "kept_consistent.h"

#include <algorithm>
#include <functional>
#include <iterator>
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
#include "support/yielding_borders.h"

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

// Whether what was left out is none of those listed but an image that was added to them.
bool is_image(const LeftOut& left_out, const SymmetryAnnotation& listed) {
  return !left_out.pattern &&
         std::ranges::none_of(listed.regions, [&](const Region& region) { return region.id == left_out.id; });
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
    trim_regions(prepared, kept.tolerance, BorderMoves::inwards, context, changed, explanation);
    any = any || changed.front().faces != region.faces;
    region.faces = std::move(changed.front().faces);
    if (changed.front().residual) {  // else another pass measures it, without those that go
      region.residual = *changed.front().residual;
      measured.push_back(region);
    }
  }
  return any;
}

// Trimmed and measured where consistency changed it, with all that had to be left out.
ConsistentAnnotation trimmed(const PreparedMesh& prepared, const ShapeSurface& surface, std::vector<Region>& measured,
                             ConsistentAnnotation kept, Explanation* explanation, const RunContext& context) {
  while (trim_changed(prepared, measured, kept.annotation, explanation, context)) {
    ConsistentAnnotation again = consistent_annotation(surface, kept.annotation, context);
    kept.annotation = std::move(again.annotation);
    std::ranges::move(again.left_out, std::back_inserter(kept.left_out));
  }
  return kept;
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
  std::vector<Region> measured = found.regions;
  SymmetryAnnotation apart = found;
  number(apart);
  yield_to_parts(surface, border_places(prepared, apart.regions, apart.tolerance, context), apart, explanation,
                 context);
  ConsistentAnnotation kept = consistent_annotation(surface, apart, context);
  kept = trimmed(prepared, surface, measured, std::move(kept), explanation, context);
  note_left_out(kept.left_out, explanation);
  return sorted(mesh, std::move(kept.annotation), kept.left_out.size(), context);
}

SymmetryAnnotation kept_without_what_follows(const PreparedMesh& prepared, const Mesh& mesh, SymmetryAnnotation found,
                                             Explanation* explanation, const RunContext& context) {
  number(found);
  const ShapeSurface surface = ConsistencySearch::surface_of(mesh, found.tolerance, context);
  const std::vector<BorderPlace> borders = border_places(prepared, found.regions, found.tolerance, context);
  std::vector<Region> measured = found.regions;
  std::size_t gone = 0;
  while (true) {
    SymmetryAnnotation listed = without_what_follows(prepared, found, context);
    Explanation yielding;
    yield_to_parts(surface, borders, listed, &yielding, context);
    ConsistentAnnotation kept = consistent_annotation(surface, listed, context);
    if (kept.left_out.empty()) {
      kept = trimmed(prepared, surface, measured, std::move(kept), explanation, context);
    }
    std::erase_if(kept.left_out, [&](const LeftOut& each) { return is_image(each, listed); });
    if (kept.left_out.empty()) {
      if (explanation != nullptr) std::ranges::move(yielding.notes, std::back_inserter(explanation->notes));
      return sorted(mesh, std::move(kept.annotation), gone, context);
    }
    note_left_out(kept.left_out, explanation);
    take_out(found, kept.left_out);
    gone += kept.left_out.size();
  }
}

SymmetryAnnotation kept_when_read(const Mesh& mesh, SymmetryAnnotation listed, Explanation* explanation,
                                  const RunContext& context) {
  while (true) {
    const ConsistentAnnotation read = consistent_annotation(mesh, listed, context);
    std::vector<LeftOut> left_out = read.left_out;
    std::erase_if(left_out, [&](const LeftOut& each) { return is_image(each, listed); });
    if (left_out.empty()) break;
    note_left_out(left_out, explanation);
    take_out(listed, left_out);
  }
  number(listed);
  set_parents(listed.regions);
  return listed;
}

}  // namespace orbifit
