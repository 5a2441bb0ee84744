#include "evidence/cut_discs.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "evidence/chance_symmetry.h"
#include "support/own_group.h"
#include "surface/thresholds.h"

namespace orbifit {

namespace {

bool about_axis(const FoundRegion& region) {
  const PointGroup& group = region.placement.group;
  return group.has_axis() && (group.continuous() || group.order() > 2);
}

}  // namespace

CutDiscs::CutDiscs(const PreparedMesh& prepared, std::vector<std::array<FaceSide, 3>> sides)
    : prepared_(prepared), sides_(std::move(sides)), kinds_(sides_.size(), Kind::outside) {}

std::vector<int> CutDiscs::without(const FoundRegion& region) {
  constexpr double kMaxCut = 0.5;  // of a plane's border
  if (!about_axis(region)) return region.faces;
  const Eigen::Vector3d axis = region.placement.frame.col(2);
  const auto across = [&](int face) { return std::abs(prepared_.normals.row(face).dot(axis)) > kAlikeNormals; };
  const auto kind = [&](int face) -> Kind& { return kinds_[static_cast<std::size_t>(face)]; };
  for (const int face : region.faces) kind(face) = across(face) ? Kind::across : Kind::inside;
  std::vector<int> rest;
  std::ranges::copy_if(region.faces, std::back_inserter(rest), [&](int face) { return kind(face) == Kind::inside; });
  std::vector<int> seen;
  for (const int seed : region.faces) {
    if (kind(seed) != Kind::across) continue;
    // The whole plane, whether or not the region has it.
    std::vector<int> disc;
    std::vector<int> plane{seed};
    double border = 0;
    double cut = 0;
    const auto see = [&](int face) {
      if (kind(face) == Kind::across) disc.push_back(face);
      kind(face) = Kind::seen;
      seen.push_back(face);
    };
    see(seed);
    for (std::size_t i = 0; i < plane.size(); ++i) {
      for (const FaceSide& side : sides_[static_cast<std::size_t>(plane[i])]) {
        const int other = side.face;
        if (other < 0 || kind(other) == Kind::seen) continue;
        if (kind(other) == Kind::across || (kind(other) == Kind::outside && across(other))) {
          plane.push_back(other);
          see(other);
        } else {
          border += side.length;
          if (kind(other) == Kind::outside && !round(side, region.placement)) cut += side.length;
        }
      }
    }
    if (cut <= kMaxCut * border) rest.insert(rest.end(), disc.begin(), disc.end());
  }
  for (const int face : seen) kind(face) = Kind::outside;
  for (const int face : region.faces) kind(face) = Kind::outside;
  std::ranges::sort(rest);
  return rest == region.faces ? rest : without_specks(prepared_, sides_, rest);
}

bool CutDiscs::little_else(const FoundRegion& region, const std::vector<int>& rest) const {
  constexpr double kMin = 0.3;
  return region.placement.group.continuous() && area_of(prepared_, rest) < kMin * region.area;
}

// Whether the edge lies along a circle about the axis, as facets do.
bool CutDiscs::round(const FaceSide& side, const GroupPlacement& placement) const {
  constexpr double kOff = 0.1;  // of the edge's length: a chord of at most an eighth of a turn
  const auto radius = [&](const Eigen::Vector3d& point) {
    return (point - placement.centre).cross(placement.frame.col(2)).norm();
  };
  std::array<Eigen::Vector3d, 2> ends;
  for (std::size_t k = 0; k < 2; ++k) {
    ends[k] =
        prepared_.mesh.vertices.row(prepared_.weld.representative[static_cast<std::size_t>(side.ends[k])]).transpose();
  }
  const double middle = radius(0.5 * (ends[0] + ends[1]));
  return std::ranges::all_of(
      ends, [&](const Eigen::Vector3d& end) { return std::abs(radius(end) - middle) < kOff * side.length; });
}

void drop_cut_discs(const PreparedMesh& prepared, double tolerance, const RunContext& context,
                    std::vector<FoundRegion>& regions, Explanation* explanation) {
  constexpr double kMinKept = 0.8;  // of its samples: it was verified with the discs, and is not to fail for borders
  constexpr double kMaxOfFinite = 0.5;  // with less beside the discs, a region of a finite group is about the rest
  constexpr int kDiscSamples = 1000;
  if (std::ranges::none_of(regions, about_axis)) return;
  CutDiscs discs(prepared);
  std::erase_if(regions, [&](FoundRegion& region) {
    std::vector<int> faces = discs.without(region);
    if (faces.size() == region.faces.size()) return false;
    const bool turned = region.placement.group.continuous();
    const double area = area_of(prepared, faces);
    const double share = area / region.area;
    bool drop = discs.little_else(region, faces);
    if (!drop) {
      if (!turned && (share > kMaxOfFinite || area < kLeastArea * prepared.area)) return false;
      const SurfacePatch patch = make_patch(prepared, faces, kDiscSamples, tolerance, context, "discs");
      const Verification rest = verify_group(patch, region.placement, context);
      if (!turned && !passes(rest)) return false;
      drop = rest.joint < kMinKept || fades(patch, region.placement, context);
    }
    if (explanation != nullptr) {
      explanation->notes.push_back({"discs", region.placement.group.symbol() + " on " + region.name, !drop,
                                    drop ? "little but discs that end within planes" : "without its discs in planes"});
    }
    region.faces = std::move(faces);
    region.area = area;
    return drop;
  });
}

}  // namespace orbifit
