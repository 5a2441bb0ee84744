#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "orbifit/model/mesh.h"

namespace orbifit {

/// Finds the vertices within a small distance of a place, by hashing cells a few times as wide.
class VertexGrid {
 public:
  VertexGrid(const Points& vertices, double tolerance)
      : vertices_(vertices),
        tolerance_(tolerance),
        origin_(vertices.rows() > 0 ? Eigen::Vector3d(vertices.row(0)) : Eigen::Vector3d(0, 0, 0)) {
    const double extent = vertices.rows() > 0 ? (vertices.rowwise() - vertices.row(0)).cwiseAbs().maxCoeff() : 0;
    width_ = std::max(8 * tolerance, extent / kMaxCells);
    std::size_t size = 16;
    while (size < 2 * static_cast<std::size_t>(vertices.rows())) size *= 2;
    heads_.assign(size, -1);
    next_.assign(static_cast<std::size_t>(vertices.rows()), -1);
    for (auto v = static_cast<int>(vertices.rows()) - 1; v >= 0; --v) {
      const Eigen::Vector3d scaled = (vertices.row(v).transpose() - origin_) / width_;
      int& head = heads_[slot(floor(scaled))];
      next_[static_cast<std::size_t>(v)] = head;
      head = v;
    }
  }

  /// Calls visit(vertex) for each vertex within the tolerance of `place`.
  template <class Visit>
  void visit(const Eigen::Vector3d& place, const Visit& visit) const {
    const Eigen::Vector3d scaled = (place - origin_) / width_;
    if (!(scaled.cwiseAbs().maxCoeff() <= 2 * kMaxCells)) return;  // farther than any vertex
    const double margin = tolerance_ / width_;
    const Eigen::Vector3d low = (scaled.array() - margin).floor();
    const Eigen::Vector3d high = (scaled.array() + margin).floor();
    std::size_t seen[8];
    int count = 0;
    for (double x = low[0]; x <= high[0]; ++x) {
      for (double y = low[1]; y <= high[1]; ++y) {
        for (double z = low[2]; z <= high[2]; ++z) {
          const std::size_t at = slot({x, y, z});
          bool again = false;
          for (int i = 0; i < count; ++i) again = again || seen[i] == at;
          if (again) continue;
          seen[count++] = at;
          for (int v = heads_[at]; v >= 0; v = next_[static_cast<std::size_t>(v)]) {
            if ((vertices_.row(v).transpose() - place).squaredNorm() <= tolerance_ * tolerance_) visit(v);
          }
        }
      }
    }
  }

 private:
  // To each side: numbers of cells up to twice that are whole, and the next one is another number.
  static constexpr double kMaxCells = 0x1p50;

  static Eigen::Vector3d floor(const Eigen::Vector3d& point) { return point.array().floor(); }

  std::size_t slot(const Eigen::Vector3d& cell) const {
    std::uint64_t value = 0;
    for (int k = 0; k < 3; ++k) {
      value = (value ^ static_cast<std::uint64_t>(static_cast<std::int64_t>(cell[k]))) * 0x9e3779b97f4a7c15ULL;
      value ^= value >> 31U;
    }
    return value & (heads_.size() - 1);
  }

  const Points& vertices_;
  double tolerance_;
  double width_ = 0;
  Eigen::Vector3d origin_;
  std::vector<int> heads_, next_;
};

}  // namespace orbifit
