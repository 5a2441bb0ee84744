#include "evidence/near_points.h"

#include <array>

namespace orbifit {

namespace {

constexpr std::size_t kFew = 16;  // points that are asked one after another sooner

}  // namespace

std::size_t NearPoints::head_of(std::int64_t x, std::int64_t y, std::int64_t z) const {
  const auto mixed = static_cast<std::uint64_t>(x) * 0x9E3779B97F4A7C15U +
                     static_cast<std::uint64_t>(y) * 0xC2B2AE3D27D4EB4FU +
                     static_cast<std::uint64_t>(z) * 0x165667B19E3779F9U;
  return static_cast<std::size_t>((mixed ^ (mixed >> 29U)) & (heads_.size() - 1));
}

void NearPoints::enter(std::size_t number) {
  const std::array<std::int64_t, 3> cell = grid_cell(points_[number], 2 * reach_);
  int& head = heads_[head_of(cell[0], cell[1], cell[2])];
  before_[number] = head;
  head = static_cast<int>(number);
}

void NearPoints::grow() {
  std::size_t count = 4 * kFew;
  while (count < 4 * points_.size()) count *= 2;
  heads_.assign(count, -1);
  before_.resize(points_.size());
  for (std::size_t i = 0; i < points_.size(); ++i) enter(i);
}

void NearPoints::add(const Eigen::Vector3d& point) {
  points_.push_back(point);
  if (points_.size() <= kFew) return;
  if (2 * points_.size() > heads_.size()) {
    grow();
    return;
  }
  before_.push_back(-1);
  enter(points_.size() - 1);
}

int NearPoints::first_near(const Eigen::Vector3d& point) const {
  if (heads_.empty()) {
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (near(points_[i], point)) return static_cast<int>(i);
    }
    return -1;
  }
  int first = -1;
  const Eigen::Vector3d corner = point - Eigen::Vector3d::Constant(reach_);
  const auto [x, y, z] = grid_cell(corner, 2 * reach_);
  for (int k = 0; k < 8; ++k) {
    for (int i = heads_[head_of(x + (k & 1), y + ((k >> 1) & 1), z + ((k >> 2) & 1))]; i >= 0;
         i = before_[static_cast<std::size_t>(i)]) {
      if ((first < 0 || i < first) && near(points_[static_cast<std::size_t>(i)], point)) first = i;
    }
  }
  return first;
}

}  // namespace orbifit
