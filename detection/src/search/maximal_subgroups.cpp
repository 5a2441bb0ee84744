#include "search/maximal_subgroups.h"

#include <algorithm>
#include <functional>
#include <optional>
#include <unordered_map>
#include <utility>

#include "orbifit/model/point_group.h"

#include "group/subgroups_within.h"
#include "search/line_region_search.h"
#include "support/kept_samples.h"

namespace orbifit {

namespace {

using Elements = KeptSamples::Elements;

constexpr std::size_t kMaxMasks = 24;
constexpr std::size_t kMaxIndex = 4;  // smaller subgroups keep much by chance; planes and axes find those that matter
constexpr double kMinMask = 0.01;     // of the samples, that the same elements keep

// The sets of elements that keep most samples, as masks.
std::vector<std::vector<char>> frequent_masks(const KeptSamples& samples) {
  const std::vector<Elements>& of_sample = samples.elements_of_sample();
  std::unordered_map<Elements, std::size_t> counts;
  for (const Elements& elements : of_sample) ++counts[elements];
  std::vector<std::pair<std::size_t, std::size_t>> order;  // count, first sample
  for (std::size_t i = 0; i < of_sample.size(); ++i) {
    auto at = counts.find(of_sample[i]);
    if (at == counts.end()) continue;
    if (static_cast<double>(at->second) >= kMinMask * static_cast<double>(of_sample.size())) {
      order.emplace_back(at->second, i);
    }
    counts.erase(at);
  }
  std::ranges::stable_sort(order, std::greater<>(), &std::pair<std::size_t, std::size_t>::first);
  if (order.size() > kMaxMasks) order.resize(kMaxMasks);
  std::vector<std::vector<char>> result;
  for (const auto& [count, sample] : order) {
    std::vector<char> allowed(samples.linear().size(), 0);
    for (std::size_t g = 0; g < allowed.size(); ++g) allowed[g] = of_sample[sample][g] ? 1 : 0;
    result.push_back(std::move(allowed));
  }
  return result;
}

// Subgroups that keep materially more than any larger one, the largest first.
std::vector<GroupPlacement> maximal_subgroups(const GroupPlacement& placement, const KeptSamples& samples) {
  const std::vector<Eigen::Matrix3d>& linear = samples.linear();
  std::vector<GroupPlacement> result;
  std::vector<std::pair<Elements, std::vector<char>>> found{{samples.all(), samples.kept_by(samples.all())}};
  for (const std::vector<char>& members : subgroups_within(linear, frequent_masks(samples))) {
    Elements group;
    for (std::size_t g = 0; g < members.size(); ++g) group[g] = members[g] != 0;
    if (group.count() * kMaxIndex < linear.size()) break;
    if (group == samples.all()) continue;
    std::vector<char> kept = samples.kept_by(group);
    std::vector<char> known(kept.size(), 0);
    for (const auto& [larger, keeps] : found) {
      if ((group & ~larger).any()) continue;
      for (std::size_t i = 0; i < known.size(); ++i) known[i] = known[i] != 0 || keeps[i] != 0 ? 1 : 0;
    }
    if (samples.material(kept, known, group)) {
      std::vector<Eigen::Matrix3d> some;
      for (std::size_t g = 0; g < members.size(); ++g) {
        if (members[g] != 0) some.push_back(linear[g]);
      }
      if (const std::optional<ClassifiedGroup> named = classify(some)) {
        result.push_back({named->group, named->frame, placement.centre});
      }
    }
    found.emplace_back(group, std::move(kept));
  }
  return result;
}

}  // namespace

std::vector<FoundRegion> find_wider_subgroups(const ScreenedSurface& surface, const SurfaceIndex& whole,
                                              const std::vector<FoundRegion>& regions, const std::vector<Line>& turning,
                                              const std::vector<FoundRegion>& known, const LineRegionOptions& options,
                                              const RunContext& context) {
  LineRegionSearch search(surface, whole, known, options, context);
  for (const Line& axis : turning) search.add_turning_axis(axis);
  std::vector<GroupPlacement> wider;
  for (std::size_t r = 0; r < regions.size() && !(options.late && options.late()); ++r) {
    context.check();
    const PointGroup& group = regions[r].placement.group;
    if (group.continuous() || group.order() < 4 || group.order() > static_cast<int>(KeptSamples::kMaxElements)) {
      continue;
    }
    const KeptSamples samples(surface, regions[r].placement, context);
    for (GroupPlacement& placement : maximal_subgroups(regions[r].placement, samples)) {
      wider.push_back(std::move(placement));
    }
  }
  search.consider_all<std::size_t>(0, [&](std::size_t& k) -> std::optional<LineRegionSearch::Candidate> {
    if (k == wider.size()) return std::nullopt;
    return LineRegionSearch::Candidate{"subgroups", wider[k++], false};
  });
  return search.take();
}

}  // namespace orbifit
