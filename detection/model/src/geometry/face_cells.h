#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include <Eigen/Core>

namespace orbifit {

/// Some of the faces that pass through each cell of a cubic grid. That one of them is near a point tells at once what
/// a tree takes many times longer to find out; that none is says nothing.
class FaceCells {
 public:
  static constexpr std::size_t kMax = 4;         ///< faces that a cell keeps
  using Faces = std::array<std::int32_t, kMax>;  ///< -1 where there are fewer, at the end

  /// Without faces.
  FaceCells() = default;

  /// O(count), in time and memory, however thin the faces are.
  /// \param corners_of  of each face, finite
  FaceCells(std::size_t count, const std::function<std::array<Eigen::Vector3d, 3>(std::size_t)>& corners_of);

  /// Of the cell that holds the point, any point; null where none is kept. O(1)
  const Faces* at(const Eigen::Vector3d& point) const;

 private:
  struct Cell {
    std::uint64_t key = 0;  // 0: not in use
    Faces faces{-1, -1, -1, -1};
  };
  std::uint64_t key_of(const Eigen::Vector3d& point) const;  // 0 outside
  std::size_t slot(std::uint64_t key) const;                 // of the cell, or of a free place
  void add(const Eigen::Vector3d& point, std::int32_t face);
  void grow();

  Eigen::Vector3d low_ = Eigen::Vector3d::Zero();
  double per_unit_ = 0;
  std::vector<Cell> cells_;  // open addressing, a power of two
  std::size_t used_ = 0;
};

}  // namespace orbifit
