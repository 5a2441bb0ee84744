#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "surface/surface_patch.h"

namespace orbifit {

/// Answers in a few nanoseconds whether a point lies on a surface with a certain normal, roughly: a sparse grid whose
/// cells know the directions of the surface's normals within reach. For screening; what passes is to be verified.
/// Points within a fifth of `reach` of the surface whose normal is within 15 degrees of the surface's, whichever way it
/// faces, are always held; none is beyond 1.75 times `reach` or 50 degrees. Building costs O(A / reach^2) for the area
/// A, and so does memory.
class SurfaceGrid {
 public:
  /// \param faces those that make up the surface, of the normalised mesh; ones without area are skipped
  /// \param reach a length; raised to 1/400 of the mesh's diagonal where it is less
  SurfaceGrid(const PreparedMesh& prepared, const std::vector<int>& faces, double reach);

  /// Whether a face whose normal is like that lies near. \param normal unit
  bool holds(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) const {
    return (mask(point) >> direction(normal) & 1U) != 0;
  }

  /// Whether any face lies near.
  bool covers(const Eigen::Vector3d& point) const { return mask(point) != 0; }

 private:
  static constexpr double kMax = 4096;
  static constexpr int kPlaces = 4;       // within a cell, along each edge
  static constexpr int kDirections = 64;  // on a half-sphere
  static constexpr int kTable = 24;       // of directions: cells along an edge of a cube's face

  // Of the place in an array, the last index running fastest.
  static std::size_t number(const Eigen::Vector3i& at, int second, int third) {
    const auto size = [](int value) { return static_cast<std::size_t>(value); };
    return (size(at[0]) * size(second) + size(at[1])) * size(third) + size(at[2]);
  }
  unsigned direction(const Eigen::Vector3d& normal) const;

  // The directions of the normals of what lies near.
  std::uint64_t mask(const Eigen::Vector3d& point) const {
    const Eigen::Vector3d cell = (point - origin_) * per_cell_;
    if (!(cell.minCoeff() >= 0) || !(cell.maxCoeff() < kMax)) return 0;
    const Eigen::Vector3i at = cell.cast<int>();
    if ((at.array() >= cells_.array()).any()) return 0;
    const int block = blocks_[number({at[0] >> 3, at[1] >> 3, at[2] >> 3}, counts_[1], counts_[2])];
    if (block < 0) return 0;
    const auto inside = static_cast<std::size_t>(((at[0] & 7) << 6) | ((at[1] & 7) << 3) | (at[2] & 7));
    if (numbers_.empty()) return masks_[static_cast<std::size_t>(block)][inside];
    return distinct_[numbers_[static_cast<std::size_t>(block)][inside]];
  }

  void make_directions();
  void make_stencils();
  void add(const Eigen::Vector3d& point, std::uint64_t mask);
  void number_masks();

  Eigen::Vector3d origin_ = Eigen::Vector3d::Zero();
  double per_cell_ = 1;
  double reach_ = 0;
  Eigen::Vector3i cells_ = Eigen::Vector3i::Zero();
  Eigen::Vector3i counts_ = Eigen::Vector3i::Zero();     // of blocks
  std::vector<int> blocks_;                              // -1 for empty
  std::vector<std::array<std::uint64_t, 512>> masks_;    // of the cells; empty where they have numbers
  std::vector<std::array<std::uint16_t, 512>> numbers_;  // of their masks among the distinct ones: fits in a cache
  std::vector<std::uint64_t> distinct_;
  std::vector<std::vector<Eigen::Vector3i>> stencils_;  // steps to cells within reach, by the place in a cell
  Eigen::Matrix<double, kDirections, 3> directions_;
  std::vector<unsigned char> nearest_;  // direction by the place on a cube's surface
};

}  // namespace orbifit
