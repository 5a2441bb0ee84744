#include "geometry/face_cells.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include <Eigen/Geometry>

#include "geometry/cover_triangle.h"

namespace orbifit {

namespace {

using Eigen::Vector3d;

constexpr double kFacesInCell = 3;     // of the mean area
constexpr double kSidesInCell = 0.5;   // of the mean longest side, at least: what is thin has little area
constexpr double kMaxCells = 1 << 20;  // along the longest side of the box
constexpr std::uint64_t kMix = 0x9E3779B97F4A7C15ULL;  // Fibonacci hashing (Knuth 1998, section 6.4)

}  // namespace

FaceCells::FaceCells(std::size_t count, const std::function<std::array<Vector3d, 3>(std::size_t)>& corners_of) {
  if (count == 0) return;
  Eigen::AlignedBox3d box;
  double area = 0;
  double sides = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const auto [a, b, c] = corners_of(i);
    box.extend(a).extend(b).extend(c);
    area += 0.5 * (b - a).cross(c - a).norm();
    sides += std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
  }
  const auto faces = static_cast<double>(count);
  const double size = std::max(
      {std::sqrt(kFacesInCell * area / faces), kSidesInCell * sides / faces, box.sizes().maxCoeff() / kMaxCells});
  if (!(size > 0) || !std::isfinite(size)) return;
  low_ = box.min();
  per_unit_ = 1 / size;
  cells_.resize(1024);
  for (std::size_t i = 0; i < count; ++i) {
    const auto [a, b, c] = corners_of(i);
    const auto number = static_cast<std::int32_t>(i);
    const double longest = std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
    if (longest <= size * size) {
      add((a + b + c) / 3, number);
    } else {
      cover_triangle(a, b, c, size, [&](const Vector3d& point) { add(point, number); });
    }
  }
}

std::uint64_t FaceCells::key_of(const Vector3d& point) const {
  const Vector3d cell = per_unit_ * (point - low_);
  if (!(cell.minCoeff() >= 0 && cell.maxCoeff() <= kMaxCells)) return 0;
  const auto along = [&](int k) { return static_cast<std::uint64_t>(cell[k]); };
  return 1 + (along(0) | along(1) << 21U | along(2) << 42U);
}

std::size_t FaceCells::slot(std::uint64_t key) const {
  const std::size_t mask = cells_.size() - 1;
  // The product's highest bits: only they depend on all of the key's.
  auto at = static_cast<std::size_t>(key * kMix >> (64 - std::bit_width(mask)));
  while (cells_[at].key != 0 && cells_[at].key != key) at = (at + 1) & mask;
  return at;
}

void FaceCells::add(const Vector3d& point, std::int32_t face) {
  const std::uint64_t key = key_of(point);
  if (key == 0) return;
  Cell* cell = &cells_[slot(key)];
  if (cell->key == 0) {
    if (2 * ++used_ > cells_.size()) {
      grow();
      cell = &cells_[slot(key)];
    }
    cell->key = key;
  }
  for (std::int32_t& kept : cell->faces) {
    if (kept == face) return;
    if (kept >= 0) continue;
    kept = face;
    return;
  }
}

void FaceCells::grow() {
  std::vector<Cell> old(2 * cells_.size());
  std::swap(old, cells_);
  for (const Cell& cell : old) {
    if (cell.key != 0) cells_[slot(cell.key)] = cell;
  }
}

const FaceCells::Faces* FaceCells::at(const Vector3d& point) const {
  if (cells_.empty()) return nullptr;
  const std::uint64_t key = key_of(point);
  if (key == 0) return nullptr;
  const Cell& cell = cells_[slot(key)];
  return cell.key == 0 ? nullptr : &cell.faces;
}

}  // namespace orbifit
