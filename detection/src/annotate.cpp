#include "orbifit/detection/annotate.h"

#include <algorithm>
#include <functional>
#include <utility>

#include "orbifit/detection/surface_patch.h"
#include "orbifit/detection/verification.h"

namespace orbifit {

namespace {

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
    Region region = make_region(placement.group, prepared.input_of_normalised(placement.centre), placement.frame,
                                each.faces, each.name);
    if (each.residual) {
      region.residual = *each.residual;
    } else {
      const SurfacePatch patch = make_patch(prepared, each.faces, 1000, tolerance, context, "residual");
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
