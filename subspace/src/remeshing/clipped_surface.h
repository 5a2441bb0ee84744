#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "remeshing/fundamental_domain.h"

namespace orbifit {

/// What of a surface lies in a fundamental domain: triangles cut along its walls, with vertices exactly on them.
struct ClippedSurface {
  std::vector<Eigen::Vector3d> points;
  std::vector<std::uint64_t> walls;  ///< of each point: the walls it lies on, a bit each; bit 32 + w: wall w's middle
  std::vector<char> cut;             ///< of each point: 1 where it was put in, so that it is on the surface by a chord
  std::vector<std::array<int, 3>> triangles;
  std::vector<int> sources;  ///< of each triangle: the number it had before
  /// Of edges, by their ends in ascending order: the walls beyond which the surface goes on there. However many
  /// triangles of the domain meet at such an edge, it has to be welded; an edge that only touches a wall has not.
  std::map<std::pair<int, int>, std::uint64_t> continued;
};

inline constexpr int kMaxWalls = 32;
constexpr std::uint64_t wall_bit(std::size_t wall) {
  return std::uint64_t{1} << wall;
}
constexpr std::uint64_t middle_bit(std::size_t wall) {
  return std::uint64_t{1} << (wall + kMaxWalls);
}

/// How a surface is cut. What lies in a wall belongs to one side: in a mirror, and in the first of a pair of walls, to
/// the domain, else to its neighbour. A vertex that is nearer to the cut, along an edge, than `snap` of that edge is
/// moved onto it along the edge, so that no slivers arise, where this moves no face at it by more than `reach` out of
/// its plane and turns none over.
struct Cut {
  double snap = 0.2;
  double reach = 0;     ///< mesh units
  double rounding = 0;  ///< mesh units: a vertex as near as this is on the plane
};

void clip(ClippedSurface& surface, const FundamentalDomain& domain, const Cut& cut);

}  // namespace orbifit
