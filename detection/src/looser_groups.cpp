#include "looser_groups.h"

#include <numeric>
#include <vector>

#include "orbifit/detection/own_group.h"

namespace orbifit {

std::vector<LooserGroup> looser_groups(const PreparedMesh& prepared, const std::optional<PointGroup>& has,
                                       double tolerance, const DirectionSet& screen, const RunContext& context) {
  constexpr int kSamples = 1500;
  constexpr double kMost = 0.02;  // of the diagonal: beyond, any shape has something
  std::vector<int> all(static_cast<std::size_t>(prepared.mesh.faces.rows()));
  std::iota(all.begin(), all.end(), 0);
  const auto larger = [&](double looser, const std::optional<PointGroup>& than) -> std::optional<LooserGroup> {
    if (looser > kMost || (than && than->continuous())) return std::nullopt;
    const SurfacePatch patch = make_patch(prepared, all, kSamples, looser, context, "looser");
    const std::optional<OwnGroup> own = find_own_group(patch, &screen, {}, context);
    if (!own) return std::nullopt;
    const PointGroup& group = own->placement.group;
    if (!group.continuous() && group.order() <= (than ? than->order() : 1)) return std::nullopt;
    return LooserGroup{group, looser};
  };
  const auto more_than = [](const PointGroup& a, const PointGroup& b) {
    return a.continuous() ? !b.continuous() : !b.continuous() && a.order() > b.order();
  };
  // What holds at twice the tolerance holds at four times.
  const std::optional<LooserGroup> at_four = larger(4 * tolerance, has);
  if (!at_four && 4 * tolerance <= kMost) return {};
  const std::optional<LooserGroup> at_two = larger(2 * tolerance, has);
  std::vector<LooserGroup> result;
  if (at_two) result.push_back(*at_two);
  if (at_four && (!at_two || more_than(at_four->group, at_two->group))) result.push_back(*at_four);
  return result;
}

}  // namespace orbifit
