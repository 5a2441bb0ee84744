#include "search/groups_at_larger_tolerance.h"

#include <numeric>
#include <vector>

#include "support/own_group.h"

namespace orbifit {

std::vector<LargerToleranceGroup> groups_at_larger_tolerance(const PreparedMesh& prepared,
                                                             const std::optional<PointGroup>& has, double tolerance,
                                                             const DirectionSet& screen, const RunContext& context) {
  constexpr int kSamples = 1500;
  constexpr double kMax = 0.02;  // of the diagonal: beyond, any shape has something
  std::vector<int> all(static_cast<std::size_t>(prepared.mesh.faces.rows()));
  std::iota(all.begin(), all.end(), 0);
  const auto group_at = [&](double at) -> std::optional<PointGroup> {
    if (at > kMax) return std::nullopt;
    const SurfacePatch patch = make_patch(prepared, all, kSamples, at, context, "larger tolerance");
    const std::optional<OwnGroup> own = find_own_group(patch, &screen, {}, context);
    return own ? std::optional(own->placement.group) : std::nullopt;
  };
  const auto more = [](const std::optional<PointGroup>& a, const std::optional<PointGroup>& b) {
    if (!a || (b && b->continuous())) return false;
    return a->continuous() || a->order() > (b ? b->order() : 1);
  };
  if (has && has->continuous()) return {};
  // What holds at twice the tolerance holds at four times.
  const std::optional<PointGroup> at_four = group_at(4 * tolerance);
  if (!more(at_four, has) && 4 * tolerance <= kMax) return {};
  const std::optional<PointGroup> at_two = group_at(2 * tolerance);
  std::vector<LargerToleranceGroup> result;
  if (more(at_two, has)) result.push_back({*at_two, 2 * tolerance});
  if (more(at_four, result.empty() ? has : at_two)) result.push_back({*at_four, 4 * tolerance});
  return result;
}

}  // namespace orbifit
