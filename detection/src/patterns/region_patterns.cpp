#include "patterns/region_patterns.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "patterns/pattern_search.h"
#include "surface/components.h"

namespace orbifit {

namespace {

constexpr std::size_t kMin = 3;  // instances: any two regions alike are a pair

// For comparing groups by size: continuous ones exceed all finite ones.
int elements_of(const FoundRegion& region) {
  constexpr int kContinuous = 100000;
  const PointGroup& group = region.placement.group;
  return group.continuous() ? kContinuous : group.order();
}

double area_marked(const PreparedMesh& prepared, const std::vector<int>& faces, const std::vector<char>& marks) {
  double area = 0;
  for (const int face : faces) {
    if (marks[static_cast<std::size_t>(face)] != 0) area += prepared.areas[face];
  }
  return area;
}

void mark(const std::vector<int>& faces, std::vector<char>& marks) {
  for (const int face : faces) marks[static_cast<std::size_t>(face)] = 1;
}

// Small regions apart from one another, those of the larger groups before others; in the order of their faces.
std::vector<const FoundRegion*> regions_apart(const PreparedMesh& prepared, const std::vector<FoundRegion>& regions) {
  constexpr double kLargest = 0.1;  // of the mesh's area
  constexpr double kApart = 0.05;   // of the region's
  std::vector<const FoundRegion*> candidates;
  for (const FoundRegion& region : regions) {
    if (region.area < kLargest * prepared.area) candidates.push_back(&region);
  }
  std::ranges::stable_sort(candidates, std::greater<>(), [](const FoundRegion* region) {
    return std::pair{elements_of(*region), region->area};
  });
  std::vector<char> taken(static_cast<std::size_t>(prepared.mesh.faces.rows()), 0);
  std::vector<const FoundRegion*> result;
  for (const FoundRegion* region : candidates) {
    if (area_marked(prepared, region->faces, taken) > kApart * region->area) continue;
    mark(region->faces, taken);
    result.push_back(region);
  }
  std::ranges::sort(result, {}, [](const FoundRegion* region) { return region->faces.front(); });
  return result;
}

// Leaves out regions of which there are not several of about the same area.
void drop_lone(std::vector<const FoundRegion*>& regions) {
  constexpr double kAlike = 0.1;  // of the area
  const std::vector<const FoundRegion*> all = regions;
  std::erase_if(regions, [&](const FoundRegion* region) {
    const auto alike = std::ranges::count_if(
        all, [&](const FoundRegion* other) { return std::abs(other->area - region->area) <= kAlike * region->area; });
    return alike < static_cast<std::ptrdiff_t>(kMin);
  });
}

// A component for each region, in their order, and one of what is left.
Components components_of(const PreparedMesh& prepared, const std::vector<const FoundRegion*>& regions) {
  Components result;
  result.faces.resize(regions.size() + 1);
  result.component_of_face.assign(static_cast<std::size_t>(prepared.mesh.faces.rows()),
                                  static_cast<int>(regions.size()));
  for (std::size_t r = regions.size(); r-- > 0;) {
    for (const int face : regions[r]->faces)
      result.component_of_face[static_cast<std::size_t>(face)] = static_cast<int>(r);
  }
  for (std::size_t f = 0; f < result.component_of_face.size(); ++f) {
    result.faces[static_cast<std::size_t>(result.component_of_face[f])].push_back(static_cast<int>(f));
  }
  return result;
}

std::vector<int> faces_of(const Pattern& pattern) {
  std::vector<int> faces;
  for (const PatternInstance& instance : pattern.instances) {
    faces.insert(faces.end(), instance.faces.begin(), instance.faces.end());
  }
  return faces;
}

}  // namespace

std::vector<Pattern> find_region_patterns(const PreparedMesh& prepared, const std::vector<FoundRegion>& regions,
                                          const std::vector<Pattern>& known, const PartRegionOptions& options,
                                          const RunContext& context) {
  constexpr double kKnown = 0.5;  // of a pattern's area
  std::vector<const FoundRegion*> copies = regions_apart(prepared, regions);
  drop_lone(copies);
  if (copies.size() < kMin) return {};
  PreparedMesh partition = prepared;
  partition.components = components_of(prepared, copies);
  PartRegions parts;
  parts.survey = survey_components(partition, options.tolerance, options.least_share, context);
  for (const CongruenceClass& kind : parts.survey.classes) {
    const auto first = static_cast<std::size_t>(kind.members.front());
    parts.own_groups.emplace_back();
    if (first < copies.size()) parts.own_groups.back() = copies[first]->placement;
  }
  std::vector<char> said(static_cast<std::size_t>(prepared.mesh.faces.rows()), 0);
  for (const Pattern& pattern : known) mark(faces_of(pattern), said);
  std::vector<Pattern> result;
  for (Pattern& pattern : find_patterns(partition, parts, regions, options, context)) {
    const std::vector<int> faces = faces_of(pattern);
    if (pattern.instances.size() < kMin || area_marked(prepared, faces, said) > kKnown * area_of(prepared, faces)) {
      continue;
    }
    pattern.id = static_cast<int>(known.size() + result.size());
    result.push_back(std::move(pattern));
  }
  return result;
}

}  // namespace orbifit
