#include "support/found_region.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <utility>

#include "group/verification.h"
#include "primitives/featureless.h"
#include "support/region_growth.h"
#include "surface/thresholds.h"

namespace orbifit {

namespace {

constexpr double kSliver = 0.002;      // of the mesh's area
constexpr double kExact = 0.01;        // residual, tolerances, at most
constexpr double kFarFromExact = 0.2;  // residual, tolerances, at least

// A few faces tell most pairs of regions apart.
bool plainly_outside(const std::vector<int>& inner, const std::vector<int>& outer) {
  constexpr std::size_t kFacesSeen = 16;
  std::size_t outside = 0;
  for (std::size_t i = 0; i < kFacesSeen; ++i) {
    const int face = inner[i * inner.size() / kFacesSeen];
    if (!std::ranges::binary_search(outer, face)) ++outside;
  }
  return outside > kFacesSeen / 2;
}

// Area of the faces of `inner` that are neither in `outer` nor small ones that touch it: where a region ends within a
// smooth surface its border is uncertain by a triangle.
double area_apart(const PreparedMesh& prepared, const std::vector<int>& inner, const std::vector<int>& outer) {
  constexpr double kSmall = 1e-4;  // of the mesh's area
  std::vector<char> touched(prepared.weld.representative.size(), 0);
  const auto vertex = [&](int face, int k) -> char& {
    const auto corner = static_cast<std::size_t>(prepared.mesh.faces(face, k));
    return touched[static_cast<std::size_t>(prepared.weld.group_of_vertex[corner])];
  };
  for (const int face : outer) {
    for (int k = 0; k < 3; ++k) vertex(face, k) = 1;
  }
  double area = 0;
  std::vector<int> outside;
  std::ranges::set_difference(inner, outer, std::back_inserter(outside));
  for (const int face : outside) {
    const bool touches = vertex(face, 0) != 0 || vertex(face, 1) != 0 || vertex(face, 2) != 0;
    if (!touches || prepared.areas[face] > kSmall * prepared.area) area += prepared.areas[face];
  }
  return area;
}

// Whether what a far smaller group keeps beyond the outer region is no more than chance would give it. The whole, or
// nearly, is never left out.
bool more_by_chance(const PreparedMesh& prepared, const FoundRegion& outer, const FoundRegion& inner) {
  const double share = share_of_few(outer.placement.group, inner.placement.group);
  return share > 0 && inner.area < kNearlyWhole * prepared.area &&
         area_outside(prepared, inner.faces, outer.faces) <= share * inner.area;
}

// Root mean square distance of the region's images from it, its group placed there.
double largest_residual(const PreparedMesh& prepared, double tolerance, const FoundRegion& region,
                        const GroupPlacement& placement) {
  constexpr int kSamples = 250;
  constexpr std::size_t kQueries = 2500;
  const RunContext context;
  const SurfacePatch patch = make_patch(prepared, region.faces, kSamples, tolerance, context, "repeats");
  const std::vector<Motion> motions = judged_motions(placement.group, placement.frame, placement.centre);
  return measure_residual(patch, motions, context, kQueries).rms;
}

double largest_residual(const PreparedMesh& prepared, double tolerance, const FoundRegion& region) {
  return largest_residual(prepared, tolerance, region, region.placement);
}

// Where pieces of surface were added to components of the same group, whether these say as well where it stands: they
// may be exact, while what was fitted to pieces cut anywhere hardly is. The region then has their placement.
void take_placement(const PreparedMesh& prepared, double tolerance, FoundRegion& outer, const FoundRegion& inner) {
  constexpr double kHardly = 1.02;
  if (!outer.of_pieces || inner.of_pieces || outer.placement.group != inner.placement.group) return;
  if (largest_residual(prepared, tolerance, outer, inner.placement) >
      kHardly * largest_residual(prepared, tolerance, outer))
    return;
  outer.placement = inner.placement;
  outer.residual.reset();
}

// Whether pieces of surface were added to components at the cost of how well they turn or mirror.
bool less_exact_with_pieces(const PreparedMesh& prepared, double tolerance, const FoundRegion& outer,
                            const FoundRegion& inner) {
  constexpr double kFarLess = 3;
  constexpr double kLittle = 0.5;  // of a region of the same group: that is not about components that are less of it
  if (!outer.of_pieces || inner.of_pieces) return false;
  if (outer.placement.group == inner.placement.group && inner.area < kLittle * outer.area) return false;
  return largest_residual(prepared, tolerance, outer) > kFarLess * largest_residual(prepared, tolerance, inner);
}

// Whether components that are exact were taken into others that are far from it.
bool less_exact(const PreparedMesh& prepared, double tolerance, const FoundRegion& outer, const FoundRegion& inner) {
  return !outer.of_pieces && !inner.of_pieces &&
         largest_residual(prepared, tolerance, outer) > kFarFromExact * tolerance &&
         largest_residual(prepared, tolerance, inner) < kExact * tolerance;
}

bool same_faces(const PreparedMesh& prepared, const FoundRegion& a, const FoundRegion& b) {
  return covers(prepared, a, b) && covers(prepared, b, a);
}

// Whether regions of the same group are the same but for a little. Two mirrors of nearly the same parts make a larger
// group of them, which is named, or one of them is there by chance.
bool nearly_the_same(const PreparedMesh& prepared, const FoundRegion& a, const FoundRegion& b) {
  constexpr double kLittle = 0.03;
  if (a.placement.group != b.placement.group || std::abs(a.area - b.area) > kLittle * std::max(a.area, b.area)) {
    return false;
  }
  return area_outside(prepared, a.faces, b.faces) <= kLittle * a.area &&
         area_outside(prepared, b.faces, a.faces) <= kLittle * b.area;
}

void note_drop(Explanation* explanation, const std::string& stage, const FoundRegion& region,
               const std::string& reason) {
  if (explanation == nullptr) return;
  explanation->notes.push_back({stage, region.placement.group.symbol() + " on " + region.name, false, reason});
}

}  // namespace

double area_outside(const PreparedMesh& prepared, const std::vector<int>& inner, const std::vector<int>& outer) {
  double area = 0;
  auto at = outer.begin();
  for (const int face : inner) {
    while (at != outer.end() && *at < face) ++at;
    if (at == outer.end() || *at != face) area += prepared.areas[face];
  }
  return area;
}

double share_by_chance(double share, const PointGroup& larger, const PointGroup& smaller) {
  if (smaller.continuous()) return share;
  const double index = larger.continuous() ? 16 : static_cast<double>(larger.order()) / smaller.order();
  const double most = smaller.order() <= 2 ? 4 : (smaller.order() <= 4 ? 2 : 1);
  return share * std::clamp(std::log2(index), 1.0, most);
}

double share_of_few(const PointGroup& larger, const PointGroup& smaller) {
  constexpr double kByChance = 0.05;
  const double share = share_by_chance(kByChance, larger, smaller);
  return share >= 2 * kByChance ? share : 0;
}

bool covers(const PreparedMesh& prepared, const FoundRegion& outer, const FoundRegion& inner) {
  if (inner.area > 1.02 * outer.area || inner.faces.empty() || plainly_outside(inner.faces, outer.faces)) return false;
  constexpr double kMaxBorder = 0.1;  // of the inner region
  const double most = std::min(0.05 * inner.area, kSliver * prepared.area);
  const double outside = area_outside(prepared, inner.faces, outer.faces);
  if (outside <= most || outside > kMaxBorder * inner.area) return outside <= most;
  return area_apart(prepared, inner.faces, outer.faces) <= most;
}

bool says_nothing_new_beside(const PreparedMesh& prepared, std::span<const FoundRegion> others,
                             const FoundRegion& region, double tolerance, double outside) {
  std::optional<SurfaceMoments> moments;  // few ask
  return std::ranges::any_of(others, [&](const FoundRegion& other) {
    const double share = share_by_chance(outside, other.placement.group, region.placement.group);
    if (other.area < (1 - share) * region.area ||
        area_outside(prepared, region.faces, other.faces) > share * region.area) {
      return false;
    }
    if (!moments) moments = surface_moments(prepared, region.faces);
    const double reach = tolerance_of_part(tolerance, moments->diagonal);
    return contains_group(other.placement, region.placement, moments->centroid, moments->radius, 2 * reach);
  });
}

bool by_coincidence(double area, double residual, double area_around, double residual_around, double tolerance) {
  constexpr double kMax = 0.5;  // of what is around: the larger part of a shape is no coincidence
  return area < kMax * area_around && residual_around < kExact * tolerance && residual > kFarFromExact * tolerance;
}

void drop_repeats(const PreparedMesh& prepared, double tolerance, std::vector<FoundRegion>& regions,
                  Explanation* explanation) {
  std::vector<char> repeated(regions.size(), 0);
  for (std::size_t i = 0; i < regions.size(); ++i) {
    const FoundRegion& mine = regions[i];
    const SurfaceMoments moments = surface_moments(prepared, mine.faces);
    const double reach = tolerance_of_part(tolerance, moments.diagonal);
    bool repeats = false;
    for (std::size_t j = 0; j < regions.size() && !repeats; ++j) {
      if (i == j) continue;
      if (!contains_group(regions[j].placement, mine.placement, moments.centroid, moments.radius, reach)) continue;
      const bool covered = covers(prepared, regions[j], mine);
      if (!covered && !more_by_chance(prepared, regions[j], mine)) continue;
      const bool mutual = regions[j].placement.group == mine.placement.group && covers(prepared, mine, regions[j]);
      if (mutual && j > i) continue;
      repeats = !less_exact_with_pieces(prepared, tolerance, regions[j], mine) &&
                !(covered && less_exact(prepared, tolerance, regions[j], mine));
      if (!repeats) continue;
      take_placement(prepared, tolerance, regions[j], mine);
      note_drop(explanation, "repeats", mine, regions[j].placement.group.symbol() + " on " + regions[j].name);
    }
    repeated[i] = repeats ? 1 : 0;
  }
  std::size_t number = 0;
  std::erase_if(regions, [&](const FoundRegion&) { return repeated[number++] != 0; });
}

void drop_lesser_groups(const PreparedMesh& prepared, double tolerance, std::vector<FoundRegion>& regions,
                        Explanation* explanation) {
  const auto elements_of = [](const FoundRegion& region) {
    const PointGroup& group = region.placement.group;
    return group.continuous() ? std::numeric_limits<int>::max() : group.order();
  };
  std::vector<char> dropped(regions.size(), 0);
  for (std::size_t i = 0; i < regions.size(); ++i) {
    for (std::size_t j = i + 1; j < regions.size() && dropped[i] == 0; ++j) {
      FoundRegion& a = regions[i];
      FoundRegion& b = regions[j];
      if (dropped[j] != 0) continue;
      const bool same = same_faces(prepared, a, b);
      if (!same && !nearly_the_same(prepared, a, b)) continue;
      const int most = elements_of(a) - elements_of(b);
      bool first = most > 0;
      if (most == 0 && same)
        first = largest_residual(prepared, tolerance, a) <= largest_residual(prepared, tolerance, b);
      if (most == 0 && !same) first = a.area >= b.area;
      dropped[first ? j : i] = 1;
      const FoundRegion& stays = first ? a : b;
      note_drop(explanation, "same faces", first ? b : a, stays.placement.group.symbol() + " is more of a group there");
    }
  }
  std::vector<FoundRegion> kept;
  for (std::size_t i = 0; i < regions.size(); ++i) {
    if (dropped[i] == 0) kept.push_back(std::move(regions[i]));
  }
  regions = std::move(kept);
}

void drop_featureless(const PreparedMesh& prepared, const SurfaceIndex& whole, double tolerance,
                      const RunContext& context, std::vector<FoundRegion>& regions, Explanation* explanation) {
  constexpr int kSamples = 400;
  const SurfaceEnds ends(prepared, tolerance);
  std::erase_if(regions, [&](const FoundRegion& region) {
    if (region.area > 0.5 * prepared.area) return false;  // the whole is no piece of anything
    const SurfacePatch patch = make_patch(prepared, region.faces, kSamples, tolerance, context, "slip");
    const bool drop = featureless(patch, region.placement, whole, ends, tolerance, context);
    if (drop) note_drop(explanation, "featureless", region, "slides over the surface around it");
    return drop;
  });
}

}  // namespace orbifit
