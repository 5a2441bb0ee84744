#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "geometry/grid_cell.h"

namespace orbifit {

/// Points that come one by one, and the first of them near a point: O(1) each, about, while few lie near one another.
class NearPoints {
 public:
  /// \param reach  of what is near, in the points' unit
  explicit NearPoints(double reach) : reach_(reach) {}

  std::size_t size() const { return points_.size(); }
  const Eigen::Vector3d& operator[](std::size_t number) const { return points_[number]; }

  void add(const Eigen::Vector3d& point);
  /// Of the points within reach the one that came first; -1: none.
  int first_near(const Eigen::Vector3d& point) const;

 private:
  // A point's neighbours are looked for in the eight cells of twice the reach that lie about it.
  std::size_t head_of(std::int64_t x, std::int64_t y, std::int64_t z) const;
  void enter(std::size_t number);
  void grow();
  bool near(const Eigen::Vector3d& a, const Eigen::Vector3d& b) const {
    return (a - b).squaredNorm() <= reach_ * reach_;
  }

  double reach_;
  std::vector<Eigen::Vector3d> points_;
  std::vector<int> heads_;   // by cell, modulo their number, a power of two: its last point; -1: none. Empty for few
  std::vector<int> before_;  // by point: the one before it there
};

}  // namespace orbifit
