#include "orbifit/detection/wider_subgroups.h"

#include <algorithm>
#include <bitset>
#include <cmath>
#include <functional>
#include <optional>
#include <unordered_map>
#include <utility>

#include "orbifit/model/point_group.h"

#include "line_region_search.h"
#include "subgroups_within.h"

namespace orbifit {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr std::size_t kMostElements = 160;
constexpr std::size_t kMostMasks = 24;
constexpr std::size_t kMostIndex = 4;  // smaller subgroups keep much by chance; planes and axes find those that matter
constexpr double kLeastMask = 0.01;    // of the samples, that the same elements keep
constexpr double kMaterial = 0.02;     // of the samples, by which a subgroup must keep more than a larger one
constexpr double kRelative = 0.05;     // of what it keeps, likewise
constexpr double kWholePiece = 0.9;    // of a piece's samples
constexpr double kWholeFlat = 0.97;    // of a flat piece's: a polygon keeps much of itself turned a little
constexpr double kSlides = 0.2;        // sine of the angle between a normal and the mirror's plane

using Mask = std::bitset<kMostElements>;

/// Which elements of a group keep which samples.
class Lattice {
 public:
  Lattice(const ScreenedSurface& surface, const GroupPlacement& placement, const RunContext& context)
      : surface_(surface), placement_(placement), linear_(elements(placement.group, placement.frame)) {
    const auto count = static_cast<std::size_t>(surface.samples.points.rows());
    masks_.resize(count);
    parallel_for(context, count, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) masks_[i] = mask_of(static_cast<Eigen::Index>(i));
    });
  }

  // Subgroups that keep materially more than any larger one, the largest first.
  std::vector<GroupPlacement> wider() const {
    std::vector<GroupPlacement> result;
    std::vector<std::pair<Mask, std::vector<char>>> found{{all(), kept_by(all())}};
    for (const std::vector<char>& members : subgroups_within(linear_, frequent_masks())) {
      Mask group;
      for (std::size_t g = 0; g < members.size(); ++g) group[g] = members[g] != 0;
      if (group.count() * kMostIndex < linear_.size()) break;
      if (group == all()) continue;
      std::vector<char> kept = kept_by(group);
      std::vector<char> known(kept.size(), 0);
      for (const auto& [larger, samples] : found) {
        if ((group & ~larger).any()) continue;
        for (std::size_t i = 0; i < known.size(); ++i) known[i] = known[i] != 0 || samples[i] != 0 ? 1 : 0;
      }
      if (material(kept, known, group)) {
        std::vector<Matrix3d> some;
        for (std::size_t g = 0; g < members.size(); ++g) {
          if (members[g] != 0) some.push_back(linear_[g]);
        }
        if (const std::optional<ClassifiedGroup> named = classify(some)) {
          result.push_back({named->group, named->frame, placement_.centre});
        }
      }
      found.emplace_back(group, std::move(kept));
    }
    return result;
  }

 private:
  Mask all() const {
    Mask mask;
    for (std::size_t g = 0; g < linear_.size(); ++g) mask.set(g);
    return mask;
  }

  Mask mask_of(Eigen::Index sample) const {
    Mask mask;
    mask.set(0);
    const Vector3d from = surface_.samples.points.row(sample).transpose() - placement_.centre;
    const Vector3d normal = surface_.samples.normals.row(sample);
    for (std::size_t g = 1; g < linear_.size(); ++g) {
      mask[g] = surface_.grid.holds(placement_.centre + linear_[g] * from, linear_[g] * normal);
    }
    return mask;
  }

  // The masks that most samples have.
  std::vector<std::vector<char>> frequent_masks() const {
    std::unordered_map<Mask, std::size_t> counts;
    for (const Mask& mask : masks_) ++counts[mask];
    std::vector<std::pair<std::size_t, std::size_t>> order;  // count, first sample
    for (std::size_t i = 0; i < masks_.size(); ++i) {
      auto at = counts.find(masks_[i]);
      if (at == counts.end()) continue;
      if (static_cast<double>(at->second) >= kLeastMask * static_cast<double>(masks_.size())) {
        order.emplace_back(at->second, i);
      }
      counts.erase(at);
    }
    std::ranges::stable_sort(order, std::greater<>(), &std::pair<std::size_t, std::size_t>::first);
    if (order.size() > kMostMasks) order.resize(kMostMasks);
    std::vector<std::vector<char>> result;
    for (const auto& [count, sample] : order) {
      std::vector<char> allowed(linear_.size(), 0);
      for (std::size_t g = 0; g < allowed.size(); ++g) allowed[g] = masks_[sample][g] ? 1 : 0;
      result.push_back(std::move(allowed));
    }
    return result;
  }

  std::vector<char> kept_by(const Mask& group) const {
    std::vector<char> kept(masks_.size(), 0);
    for (std::size_t i = 0; i < kept.size(); ++i) kept[i] = (group & ~masks_[i]).none() ? 1 : 0;
    return kept;
  }

  bool material(const std::vector<char>& kept, const std::vector<char>& known, const Mask& group) const {
    std::vector<int> of_piece(surface_.piece_areas.size(), 0);
    std::vector<int> kept_of_piece(surface_.piece_areas.size(), 0);
    int all_kept = 0;
    for (std::size_t i = 0; i < kept.size(); ++i) {
      const auto piece = static_cast<std::size_t>(surface_.piece_of_sample[i]);
      ++of_piece[piece];
      kept_of_piece[piece] += kept[i];
      all_kept += kept[i];
    }
    int more = 0;
    for (std::size_t i = 0; i < kept.size(); ++i) {
      if (kept[i] == 0 || known[i] != 0) continue;
      const auto piece = static_cast<std::size_t>(surface_.piece_of_sample[i]);
      const bool flat = surface_.piece_flat[piece] != 0;
      const bool whole = kept_of_piece[piece] >= (flat ? kWholeFlat : kWholePiece) * of_piece[piece];
      const bool speaks = !flat && !slides(i, group);
      if (whole || speaks) ++more;
    }
    return more >= kMaterial * static_cast<double>(kept.size()) && more >= kRelative * all_kept;
  }

  // Whether every element moves the surface along itself at the sample.
  bool slides(std::size_t sample, const Mask& group) const {
    const Vector3d point = surface_.samples.points.row(static_cast<Eigen::Index>(sample));
    const Vector3d normal = surface_.samples.normals.row(static_cast<Eigen::Index>(sample));
    for (std::size_t g = 1; g < linear_.size(); ++g) {
      if (!group[g]) continue;
      const AxisAngle turn = axis_angle(linear_[g]);
      if (turn.determinant < 0) {
        const Vector3d image = linear_[g] * (point - placement_.centre) + placement_.centre;
        const Vector3d apart = image - point;
        if (std::abs(apart.dot(normal)) > kSlides * apart.norm()) return false;
      } else if (!meets({placement_.centre, turn.axis}, point, normal)) {
        return false;
      }
    }
    return true;
  }

  const ScreenedSurface& surface_;
  const GroupPlacement& placement_;
  std::vector<Matrix3d> linear_;
  std::vector<Mask> masks_;  // by sample
};

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
    if (group.continuous() || group.order() < 4 || group.order() > static_cast<int>(kMostElements)) continue;
    for (GroupPlacement& placement : Lattice(surface, regions[r].placement, context).wider()) {
      wider.push_back(std::move(placement));
    }
  }
  search.settle_all<std::size_t>(0, [&](std::size_t& k) -> std::optional<LineRegionSearch::Candidate> {
    if (k == wider.size()) return std::nullopt;
    return LineRegionSearch::Candidate{"subgroups", wider[k++], false};
  });
  return search.take();
}

}  // namespace orbifit
