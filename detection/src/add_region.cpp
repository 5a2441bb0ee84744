#include "orbifit/detection/add_region.h"

#include <algorithm>
#include <functional>
#include <optional>
#include <utility>

#include "orbifit/model/errors.h"

#include "support/found_region.h"
#include "support/region_growth.h"
#include "surface/surface_patch.h"
#include "surface/thresholds.h"

namespace orbifit {

namespace {

// An annotated region as the detector sees it; nothing where its elements form no group.
std::optional<FoundRegion> as_found(const PreparedMesh& prepared, const Region& region) {
  FoundRegion result;
  result.faces = region.faces;
  result.area = area_of(prepared, region.faces);
  result.name = region.name;
  const Similarity& input = prepared.input_of_normalised;
  result.placement.group = region.group;
  result.placement.centre = (region.centre - input.translation) / input.scale;
  if (region.group.continuous()) {
    if (region.group.has_axis()) result.placement.frame = frame_about(region.axis);
    return result;
  }
  std::vector<Eigen::Matrix3d> linear;
  for (const Motion& element : region.elements) linear.push_back(element.linear);
  const std::optional<ClassifiedGroup> known = classify(linear);
  if (!known) return std::nullopt;
  result.placement.group = known->group;
  result.placement.frame = known->frame;
  return result;
}

// Whether `outer` says all that `inner` says.
bool subsumes(const PreparedMesh& prepared, double tolerance, const FoundRegion& outer, const FoundRegion& inner) {
  if (inner.faces.empty() || !covers(prepared, outer, inner)) return false;
  const SurfaceMoments moments = surface_moments(prepared, inner.faces);
  const double reach = tolerance_of_part(tolerance, moments.diagonal);
  return contains_group(outer.placement, inner.placement, moments.centroid, moments.radius, reach);
}

std::string described(const Region& region) {
  return "region " + std::to_string(region.id) + " (" + region.group.symbol() +
         (region.name.empty() ? "" : " on " + region.name) + ")";
}

}  // namespace

RegionAddition add_region(const Mesh& mesh, const Region& added, double tolerance, SymmetryAnnotation& annotation) {
  const PreparedMesh prepared = prepare(mesh);
  const std::optional<FoundRegion> found = as_found(prepared, added);
  if (!found) throw UsageError("the elements of the region to be added form no group " + added.group.symbol());
  RegionAddition result;
  std::vector<Region> kept;
  for (const Region& region : annotation.regions) {
    const std::optional<FoundRegion> known = as_found(prepared, region);
    if (known && subsumes(prepared, tolerance, *known, *found)) {
      throw NoResultError(described(region) + " already says what " + added.group.symbol() + " on these " +
                          std::to_string(added.faces.size()) + " faces would say");
    }
    if (known && subsumes(prepared, tolerance, *found, *known)) {
      result.replaced.push_back(described(region));
    } else {
      kept.push_back(region);
    }
  }
  Region region = added;
  region.id = -1;
  kept.push_back(std::move(region));
  std::ranges::stable_sort(kept, std::greater<>(), [&](const Region& each) { return area_of(prepared, each.faces); });
  for (std::size_t i = 0; i < kept.size(); ++i) {
    if (kept[i].id < 0) result.id = static_cast<int>(i);
    kept[i].id = static_cast<int>(i);
  }
  set_parents(kept);
  annotation.regions = std::move(kept);
  return result;
}

}  // namespace orbifit
