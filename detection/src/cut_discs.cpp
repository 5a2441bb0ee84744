#include "cut_discs.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "orbifit/detection/own_group.h"
#include "orbifit/model/topology.h"

#include "thresholds.h"

namespace orbifit {

namespace {

bool about_axis(const FoundRegion& region) {
  const PointGroup& group = region.placement.group;
  return group.has_axis() && (group.continuous() || group.order() > 2);
}

}  // namespace

CutDiscs::CutDiscs(const PreparedMesh& prepared)
    : prepared_(prepared),
      sides_(static_cast<std::size_t>(prepared.mesh.faces.rows())),
      kinds_(sides_.size(), Kind::outside) {
  const auto point = [&](int group) -> Eigen::Vector3d {
    return prepared.mesh.vertices.row(prepared.weld.representative[static_cast<std::size_t>(group)]);
  };
  const auto add = [&](int face, int other, double length) {
    auto& sides = sides_[static_cast<std::size_t>(face)];
    const auto free = std::ranges::find(sides, -1, &Side::face);
    if (free != sides.end()) *free = {other, length};
  };
  for (const Edge& edge : welded_edges(prepared.mesh, prepared.weld)) {
    if (edge.faces.size() != 2) continue;
    const double length = (point(edge.vertices[0]) - point(edge.vertices[1])).norm();
    add(edge.faces[0], edge.faces[1], length);
    add(edge.faces[1], edge.faces[0], length);
  }
}

std::vector<int> CutDiscs::without(const FoundRegion& region) {
  constexpr double kMostCut = 0.5;  // of a disc's border
  if (!about_axis(region)) return region.faces;
  const Eigen::Vector3d axis = region.placement.frame.col(2);
  const auto across = [&](int face) { return std::abs(prepared_.normals.row(face).dot(axis)) > kAlikeNormals; };
  const auto kind = [&](int face) -> Kind& { return kinds_[static_cast<std::size_t>(face)]; };
  for (const int face : region.faces) kind(face) = across(face) ? Kind::across : Kind::inside;
  std::vector<int> rest;
  std::ranges::copy_if(region.faces, std::back_inserter(rest), [&](int face) { return kind(face) == Kind::inside; });
  for (const int seed : region.faces) {
    if (kind(seed) != Kind::across) continue;
    kind(seed) = Kind::inside;  // seen
    std::vector<int> disc{seed};
    double border = 0;
    double cut = 0;
    for (std::size_t i = 0; i < disc.size(); ++i) {
      for (const auto& [other, length] : sides_[static_cast<std::size_t>(disc[i])]) {
        if (other < 0) continue;
        if (kind(other) == Kind::across) {
          kind(other) = Kind::inside;
          disc.push_back(other);
        } else if (kind(other) == Kind::outside || !across(other)) {
          border += length;
          if (kind(other) == Kind::outside) cut += length;
        }
      }
    }
    if (cut <= kMostCut * border) rest.insert(rest.end(), disc.begin(), disc.end());
  }
  for (const int face : region.faces) kind(face) = Kind::outside;
  std::ranges::sort(rest);
  return rest;
}

void drop_cut_discs(const PreparedMesh& prepared, double tolerance, const RunContext& context,
                    std::vector<FoundRegion>& regions, Explanation* explanation) {
  constexpr double kLeast = 0.3;      // of a turned region
  constexpr double kLeastKept = 0.8;  // of its samples: it was verified with the discs, and is not to fail for borders
  constexpr double kMostOfFinite = 0.5;  // with less beside the discs, a region of a finite group is about the rest
  constexpr int kDiscSamples = 1000;
  if (std::ranges::none_of(regions, about_axis)) return;
  CutDiscs discs(prepared);
  std::erase_if(regions, [&](FoundRegion& region) {
    std::vector<int> faces = discs.without(region);
    if (faces.size() == region.faces.size()) return false;
    const bool turned = region.placement.group.continuous();
    const double area = area_of(prepared, faces);
    const double share = area / region.area;
    bool drop = turned && share < kLeast;
    if (!drop) {
      if (!turned && (share > kMostOfFinite || faces.empty())) return false;
      const SurfacePatch patch = make_patch(prepared, faces, kDiscSamples, tolerance, context, "discs");
      const Verification rest = verify_group(patch, region.placement, context);
      if (!turned && !passes(rest)) return false;
      drop = rest.joint < kLeastKept;
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
