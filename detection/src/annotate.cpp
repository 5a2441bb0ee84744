#include "annotate.h"

#include <algorithm>
#include <functional>
#include <string>
#include <utility>

#include "group/verification.h"
#include "support/own_group.h"
#include "surface/surface_patch.h"

namespace orbifit {

namespace {

// What stages after the one that found a region do to it must not spoil it. A share less than where it was verified:
// there are other samples.
constexpr double kMinKept = 0.9;

void note_spoilt(Explanation* explanation, const FoundRegion& region, double kept) {
  if (explanation == nullptr) return;
  const auto percent = static_cast<int>(100 * kept);
  explanation->notes.push_back({"regions", region.placement.group.symbol() + " on " + region.name, false,
                                "in the end its motions together keep " + std::to_string(percent) + " %"});
}

void drop_coincidences(const PreparedMesh& prepared, double tolerance, std::vector<Region>& regions,
                       Explanation* explanation) {
  const std::vector<Region> all = regions;
  std::erase_if(regions, [&](const Region& region) {
    const double area = area_of(prepared, region.faces);
    const bool coincidence = !region.group.continuous() && std::ranges::any_of(all, [&](const Region& around) {
      return around.faces.size() > region.faces.size() &&
             by_coincidence(area, region.residual.max, area_of(prepared, around.faces), around.residual.max,
                            tolerance) &&
             std::ranges::includes(around.faces, region.faces);
    });
    if (coincidence && explanation != nullptr) {
      explanation->notes.push_back({"coincidences", region.group.symbol() + " on " + region.name, false,
                                    "far less exact than a region around it"});
    }
    return coincidence;
  });
}

}  // namespace

std::vector<Region> annotated(const PreparedMesh& prepared, std::vector<FoundRegion> found, double tolerance,
                              const RunContext& context, Explanation* explanation) {
  std::ranges::stable_sort(found, std::greater<>(), &FoundRegion::area);
  std::vector<Region> regions;
  for (const FoundRegion& each : found) {
    const GroupPlacement& placement = each.placement;
    const SurfacePatch patch = make_patch(prepared, each.faces, kResidualSamples, tolerance, context, "residual");
    const double kept = verify_group(patch, placement, context).joint;
    if (kept < kMinKept) {
      note_spoilt(explanation, each, kept);
      continue;
    }
    Region region = make_region(placement.group, prepared.input_of_normalised(placement.centre), placement.frame,
                                each.faces, each.name);
    if (each.residual) {
      region.residual = *each.residual;
    } else {
      region.residual =
          measure_residual(patch, judged_motions(placement.group, placement.frame, placement.centre), context);
    }
    regions.push_back(std::move(region));
  }
  drop_coincidences(prepared, tolerance, regions, explanation);
  for (std::size_t i = 0; i < regions.size(); ++i) regions[i].id = static_cast<int>(i);
  set_parents(regions);
  return regions;
}

}  // namespace orbifit
