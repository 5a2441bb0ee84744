#include "looser_groups.h"

#include <numeric>
#include <vector>

#include "orbifit/detection/own_group.h"

namespace orbifit {

std::vector<LooserGroup> looser_groups(const PreparedMesh& prepared, const std::optional<PointGroup>& has,
                                       double tolerance, const DirectionSet& screen, const RunContext& context) {
  constexpr int kSamples = 1500;
  constexpr double kMost = 0.02;  // of the diagonal: beyond, any shape has something
  std::vector<LooserGroup> result;
  std::optional<PointGroup> last = has;
  std::vector<int> all(static_cast<std::size_t>(prepared.mesh.faces.rows()));
  std::iota(all.begin(), all.end(), 0);
  for (const double looser : {2 * tolerance, 4 * tolerance}) {
    if (looser > kMost || (last && last->continuous())) break;
    const SurfacePatch patch = make_patch(prepared, all, kSamples, looser, context, "looser");
    const std::optional<OwnGroup> own = find_own_group(patch, &screen, {}, context);
    if (!own) continue;
    const PointGroup& group = own->placement.group;
    if (!group.continuous() && group.order() <= (last ? last->order() : 1)) continue;
    result.push_back({group, looser});
    last = group;
  }
  return result;
}

}  // namespace orbifit
