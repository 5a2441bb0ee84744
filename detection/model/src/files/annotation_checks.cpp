#include "files/annotation_checks.h"

#include <algorithm>
#include <optional>

#include "files/json_reader.h"
#include "groups/element_list.h"

namespace orbifit {

namespace {

constexpr std::size_t kMaxElements = 4096;

// Seen from the region's centre: far from the origin the translations alone would have lost their digits.
std::vector<Motion> about_centre(const std::vector<Motion>& given, const Region& region, const std::string& where,
                                 double diagonal, const JsonReader& json) {
  std::vector<Motion> result;
  for (std::size_t i = 0; i < given.size(); ++i) {
    const Motion local{given[i].linear, given[i](region.centre) - region.centre};
    const double moved = local.translation.norm() / diagonal;
    if (!(moved <= kClosedToWithin)) {
      json.refuse(item_path(where, i),
                  "moves the region's centre by " + number_text(moved) + " of the mesh's diagonal");
    }
    result.push_back(local);
  }
  return result;
}

}  // namespace

void check_group(const Region& region, const std::string& where, double diagonal, const JsonReader& json) {
  const std::string symbol = region.group.symbol();
  const std::string inner = key_path(where, "elements");
  about_centre(region.generators, region, key_path(where, "generators"), diagonal, json);
  if (region.group.continuous()) {
    if (!region.elements.empty()) json.refuse(inner, "must be [] for the continuous group " + symbol);
    return;
  }
  if (region.elements.size() > kMaxElements) json.refuse(inner, "more than 4096 elements are not read");
  if (static_cast<int>(region.elements.size()) != region.group.order()) {
    json.refuse(inner, "has " + std::to_string(region.elements.size()) + " motions, but " + symbol + " has " +
                           std::to_string(region.group.order()) + " elements");
  }
  const ElementList elements(about_centre(region.elements, region, inner, diagonal, json), diagonal, kClosedToWithin);
  if (!elements.identity_first()) json.refuse(item_path(inner, 0), "must be the identity");
  if (const auto pair = elements.find_repeated()) {
    json.refuse(item_path(inner, pair->second), "repeats element " + std::to_string(pair->first));
  }
  if (const auto pair = elements.find_missing_product()) {
    json.refuse(inner, "is not closed: the product of elements " + std::to_string(pair->first) + " and " +
                           std::to_string(pair->second) + " is not in the list");
  }
  std::vector<Eigen::Matrix3d> linear;
  for (const Motion& element : region.elements) linear.push_back(element.linear);
  const auto formed = classify(linear);
  if (formed && formed->group != region.group) {
    json.refuse(key_path(where, "group"), "is " + symbol + ", but the elements form " + formed->group.symbol());
  }
}

void check_parents(std::vector<Region>& regions, const JsonReader& json) {
  for (std::size_t r = 0; r < regions.size(); ++r) {
    const auto same_id = [&](const Region& other) { return other.id == regions[r].id; };
    if (std::any_of(regions.begin(), regions.begin() + static_cast<std::ptrdiff_t>(r), same_id)) {
      json.refuse(item_path("regions", r) + ".id",
                  "is " + std::to_string(regions[r].id) + ", as that of an earlier region");
    }
  }
  const bool complete = std::ranges::all_of(regions, [&](const Region& region) {
    return !region.parent || std::ranges::find(regions, *region.parent, &Region::id) != regions.end();
  });
  if (!complete) return set_parents(regions);
  for (std::size_t r = 0; r < regions.size(); ++r) {
    std::optional<int> ancestor = regions[r].parent;
    for (std::size_t steps = 0; ancestor.has_value(); ++steps) {
      if (steps > regions.size()) json.refuse(item_path("regions", r) + ".parent", "leads back to the region itself");
      ancestor = std::ranges::find(regions, *ancestor, &Region::id)->parent;
    }
  }
}

}  // namespace orbifit
