#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "orbifit/model/mesh.h"

#include "geometry/grid_cell.h"

namespace orbifit {

/// Finds the vertices within a small distance of a place, by hashing cells a few times as wide.
class VertexGrid {
 public:
  VertexGrid(const Points& vertices, double tolerance)
      : tolerance_(tolerance),
        origin_(vertices.rows() > 0 ? Eigen::Vector3d(vertices.row(0)) : Eigen::Vector3d(0, 0, 0)) {
    const double extent = vertices.rows() > 0 ? (vertices.rowwise() - vertices.row(0)).cwiseAbs().maxCoeff() : 0;
    width_ = std::max(8 * tolerance, extent / kMaxCells);
    const auto count = static_cast<std::size_t>(vertices.rows());
    std::size_t size = 16;
    while (size < 2 * count) size *= 2;
    // Those of one slot follow one another, ascending.
    std::vector<std::size_t> slots;
    slots.reserve(count);
    first_.assign(size + 1, 0);
    for (Eigen::Index v = 0; v < vertices.rows(); ++v) {
      const Eigen::Vector3d scaled = (vertices.row(v).transpose() - origin_) / width_;
      slots.push_back(slot(size, {whole(scaled[0]), whole(scaled[1]), whole(scaled[2])}));
      ++first_[slots.back() + 1];
    }
    for (std::size_t k = 0; k < size; ++k) first_[k + 1] += first_[k];
    std::vector<int> next(first_.begin(), first_.end() - 1);
    entries_.resize(count);
    for (std::size_t v = 0; v < count; ++v) {
      const auto at = static_cast<std::size_t>(next[slots[v]]++);
      entries_[at] = {vertices.row(static_cast<Eigen::Index>(v)).transpose(), static_cast<int>(v)};
    }
  }

  double tolerance() const { return tolerance_; }

  /// Calls visit(vertex) for each vertex within the tolerance of `place`.
  template <class Visit>
  void visit(const Eigen::Vector3d& place, const Visit& visit) const {
    visit_within(place, tolerance_, visit);
  }

  /// Likewise within another distance, at most four tolerances.
  template <class Visit>
  void visit_within(const Eigen::Vector3d& place, double distance, const Visit& visit) const {
    const Eigen::Vector3d scaled = (place - origin_) / width_;
    if (!(scaled.cwiseAbs().maxCoeff() <= 2 * kMaxCells)) return;  // farther than any vertex
    const double margin = distance / width_;
    Cell low, high;
    for (std::size_t k = 0; k < 3; ++k) {
      low[k] = whole(scaled[static_cast<Eigen::Index>(k)] - margin);
      high[k] = whole(scaled[static_cast<Eigen::Index>(k)] + margin);
    }
    if (low == high) {  // as most are: cells are wide
      visit_slot(slot(first_.size() - 1, low), place, distance, visit);
      return;
    }
    std::size_t seen[8];
    int count = 0;
    for (std::int64_t x = low[0]; x <= high[0]; ++x) {
      for (std::int64_t y = low[1]; y <= high[1]; ++y) {
        for (std::int64_t z = low[2]; z <= high[2]; ++z) {
          const std::size_t at = slot(first_.size() - 1, {x, y, z});
          bool again = false;
          for (int i = 0; i < count; ++i) again = again || seen[i] == at;
          if (again) continue;
          seen[count++] = at;
          visit_slot(at, place, distance, visit);
        }
      }
    }
  }

 private:
  using Cell = std::array<std::int64_t, 3>;
  struct Entry {
    Eigen::Vector3d place;
    int vertex;
  };

  // To each side: numbers of cells up to twice that are whole, and the next one is another number.
  static constexpr double kMaxCells = 0x1p50;

  // The number rounded down; std::floor() is a call.
  static std::int64_t whole(double number) {
    const auto towards_zero = static_cast<std::int64_t>(number);
    return towards_zero - (static_cast<double>(towards_zero) > number ? 1 : 0);
  }

  template <class Visit>
  void visit_slot(std::size_t at, const Eigen::Vector3d& place, double distance, const Visit& visit) const {
    const Entry* const end = entries_.data() + first_[at + 1];
    for (const Entry* entry = entries_.data() + first_[at]; entry != end; ++entry) {
      if ((entry->place - place).squaredNorm() <= distance * distance) visit(entry->vertex);
    }
  }

  static std::size_t slot(std::size_t slots, const Cell& cell) { return CellHash{}(cell) & (slots - 1); }

  double tolerance_;
  double width_ = 0;
  Eigen::Vector3d origin_;
  std::vector<int> first_;  // entry of each slot, and their number at the end
  std::vector<Entry> entries_;
};

}  // namespace orbifit
