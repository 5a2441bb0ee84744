#include "surface/surface_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <unordered_map>

#include "geometry/cover_triangle.h"

namespace orbifit {

namespace {

using Eigen::Vector3d;

constexpr double kMinReach = 1.0 / 400;  // smaller cells take too much memory
constexpr double kCellsInReach = 2;
constexpr double kSpacing = 1.6;  // of the points that stand for a face, cells

}  // namespace

SurfaceGrid::SurfaceGrid(const PreparedMesh& prepared, const std::vector<int>& faces, double reach)
    : reach_(std::max(reach, kMinReach)) {
  make_directions();
  per_cell_ = kCellsInReach / reach_;
  Vector3d low = Vector3d::Constant(1e300);
  Vector3d high = Vector3d::Constant(-1e300);
  for (const int f : faces) {
    for (int k = 0; k < 3; ++k) {
      const Vector3d v = prepared.mesh.vertices.row(prepared.mesh.faces(f, k));
      low = low.cwiseMin(v);
      high = high.cwiseMax(v);
    }
  }
  if (faces.empty()) return;
  origin_ = low - Vector3d::Constant(2 * reach_);
  counts_ = (((high - low).array() + 4 * reach_) * per_cell_ / 8).ceil().cast<int>().max(1);
  cells_ = 8 * counts_;
  blocks_.assign(static_cast<std::size_t>(counts_.prod()), -1);
  make_stencils();
  const double cosine = std::cos(33 * std::numbers::pi / 180);
  for (const int f : faces) {
    if (prepared.areas[f] <= 0) continue;
    const Vector3d normal = prepared.normals.row(f);
    std::uint64_t mask = 0;
    for (int d = 0; d < kDirections; ++d) {
      if (std::abs(directions_.row(d).dot(normal)) >= cosine) mask |= std::uint64_t{1} << d;
    }
    const auto corner = [&](int k) -> Vector3d { return prepared.mesh.vertices.row(prepared.mesh.faces(f, k)); };
    cover_triangle(corner(0), corner(1), corner(2), kSpacing / per_cell_,
                   [&](const Vector3d& point) { add(point, mask); });
  }
  number_masks();
}

// Most cells share their mask with many others.
void SurfaceGrid::number_masks() {
  std::unordered_map<std::uint64_t, std::uint16_t> known;
  numbers_.resize(masks_.size());
  for (std::size_t block = 0; block < masks_.size(); ++block) {
    for (std::size_t cell = 0; cell < masks_[block].size(); ++cell) {
      const std::uint64_t mask = masks_[block][cell];
      const auto [entry, added] = known.try_emplace(mask, static_cast<std::uint16_t>(distinct_.size()));
      if (added) distinct_.push_back(mask);
      if (distinct_.size() > std::numeric_limits<std::uint16_t>::max()) {
        numbers_.clear();
        return;
      }
      numbers_[block][cell] = entry->second;
    }
  }
  masks_ = {};
}

// The cells whose centres are within reach of a point, for each place of it within its own cell.
void SurfaceGrid::make_stencils() {
  constexpr double kWithin = 1.15 * kCellsInReach;
  constexpr int kAround = static_cast<int>(kWithin) + 1;
  stencils_.resize(number({kPlaces - 1, kPlaces - 1, kPlaces - 1}, kPlaces, kPlaces) + 1);
  for (std::size_t place = 0; place < stencils_.size(); ++place) {
    const auto rest = static_cast<int>(place);
    const Eigen::Vector3i inside(rest / (kPlaces * kPlaces), rest / kPlaces % kPlaces, rest % kPlaces);
    const Vector3d point = (inside.cast<double>().array() + 0.5) / kPlaces;
    for (int x = -kAround; x <= kAround; ++x) {
      for (int y = -kAround; y <= kAround; ++y) {
        for (int z = -kAround; z <= kAround; ++z) {
          const Vector3d centre(x + 0.5, y + 0.5, z + 0.5);
          if ((centre - point).squaredNorm() <= kWithin * kWithin) stencils_[place].emplace_back(x, y, z);
        }
      }
    }
  }
}

void SurfaceGrid::add(const Vector3d& point, std::uint64_t mask) {
  const Vector3d at = (point - origin_) * per_cell_;
  const Eigen::Vector3i own = at.cast<int>();
  const Eigen::Vector3i place = ((at - own.cast<double>()) * kPlaces).cast<int>();
  for (const Eigen::Vector3i& step : stencils_[number(place, kPlaces, kPlaces)]) {
    const Eigen::Vector3i cell = own + step;
    int& block = blocks_[number({cell[0] >> 3, cell[1] >> 3, cell[2] >> 3}, counts_[1], counts_[2])];
    if (block < 0) {
      block = static_cast<int>(masks_.size());
      masks_.emplace_back();
    }
    masks_[static_cast<std::size_t>(block)]
          [static_cast<std::size_t>(((cell[0] & 7) << 6) | ((cell[1] & 7) << 3) | (cell[2] & 7))] |= mask;
  }
}

// A spiral over the half-sphere, and a table of the nearest for each place on a cube around it.
void SurfaceGrid::make_directions() {
  for (int d = 0; d < kDirections; ++d) {
    const double z = (d + 0.5) / kDirections;
    const double angle = 2 * std::numbers::pi * d / std::numbers::phi;
    const double radius = std::sqrt(1 - z * z);
    directions_.row(d) << radius * std::cos(angle), radius * std::sin(angle), z;
  }
  nearest_.resize(number({2, kTable - 1, kTable - 1}, kTable, kTable) + 1);
  for (int axis = 0; axis < 3; ++axis) {
    for (int i = 0; i < kTable; ++i) {
      for (int j = 0; j < kTable; ++j) {
        Vector3d at;
        at[axis] = 1;
        at[(axis + 1) % 3] = 2 * (i + 0.5) / kTable - 1;
        at[(axis + 2) % 3] = 2 * (j + 0.5) / kTable - 1;
        int best = 0;
        (directions_ * at).cwiseAbs().maxCoeff(&best);
        nearest_[number({axis, i, j}, kTable, kTable)] = static_cast<unsigned char>(best);
      }
    }
  }
}

unsigned SurfaceGrid::direction(const Vector3d& normal) const {
  const double x = std::abs(normal[0]);
  const double y = std::abs(normal[1]);
  const double z = std::abs(normal[2]);
  const int axis = x >= y ? (x >= z ? 0 : 2) : (y >= z ? 1 : 2);
  const double length = normal[axis];
  if (length == 0) return 0;
  const auto place = [&](double value) {
    return std::clamp(static_cast<int>((value / length + 1) * (kTable / 2.0)), 0, kTable - 1);
  };
  const int i = place(normal[(axis + 1) % 3]);
  const int j = place(normal[(axis + 2) % 3]);
  return nearest_[number({axis, i, j}, kTable, kTable)];
}

}  // namespace orbifit
