#pragma once

#include <vector>

#include <Eigen/Core>

#include "surface/surface_patch.h"

namespace orbifit {

/// Tells in a few nanoseconds of most points far from some faces that they are far: cells as large as the reach, of
/// which those that anything within reach of the faces may lie in are marked. Nothing beyond six times the reach is in
/// one. Building costs O(A / reach^2) for the area A, memory one bit a cell of the faces' box.
class NearCells {
 public:
  /// \param faces those of the normalised mesh that count \param reach a length; cells are a hundredth of the
  ///              faces' box at least, along its longest side
  NearCells(const PreparedMesh& prepared, const std::vector<int>& faces, double reach);

  /// Whether a face may lie within reach of the point: false only where none does.
  bool may_reach(const Eigen::Vector3d& point) const {
    const Eigen::Vector3d cell = (point - low_) * per_cell_;
    if (!(cell.minCoeff() >= 0)) return false;
    if (!(cell.array() < counts_.cast<double>().array()).all()) return false;
    return marked_[number(cell.cast<int>())];
  }

 private:
  std::size_t number(const Eigen::Vector3i& cell) const {
    const auto size = [](int value) { return static_cast<std::size_t>(value); };
    return (size(cell[0]) * size(counts_[1]) + size(cell[1])) * size(counts_[2]) + size(cell[2]);
  }

  Eigen::Vector3d low_ = Eigen::Vector3d::Zero();
  double per_cell_ = 1;
  Eigen::Vector3i counts_ = Eigen::Vector3i::Zero();
  std::vector<bool> marked_;
};

}  // namespace orbifit
