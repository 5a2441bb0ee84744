#include "surface/near_cells.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "geometry/cover_triangle.h"

namespace orbifit {

namespace {

using Eigen::Vector3d;
using Eigen::Vector3i;

constexpr double kMaxAlong = 100;  // cells
constexpr double kHalfWay = 0.75;  // of the spacing: no point of a triangle is farther from those that cover it

// Steps to the cells that may hold what lies within `cells` of a point of the cell where they begin.
std::vector<Vector3i> steps_within(double cells) {
  const int most = static_cast<int>(std::ceil(cells));
  std::vector<Vector3i> result;
  for (int x = -most; x <= most; ++x) {
    for (int y = -most; y <= most; ++y) {
      for (int z = -most; z <= most; ++z) {
        const Eigen::Array3d between = (Eigen::Array3d(x, y, z).abs() - 1).max(0.0);
        if (between.matrix().norm() <= cells) result.emplace_back(x, y, z);
      }
    }
  }
  return result;
}

}  // namespace

NearCells::NearCells(const PreparedMesh& prepared, const std::vector<int>& faces, double reach) {
  const auto corner = [&](int face, int k) -> Vector3d {
    return prepared.mesh.vertices.row(prepared.mesh.faces(face, k));
  };
  Eigen::AlignedBox3d box;
  for (const int f : faces) box.extend(corner(f, 0)).extend(corner(f, 1)).extend(corner(f, 2));
  if (box.isEmpty()) return;
  const double size = std::max(reach, box.sizes().maxCoeff() / kMaxAlong);
  if (!(size > 0)) return;
  per_cell_ = 1 / size;
  const std::vector<Vector3i> steps = steps_within(reach / size + kHalfWay);
  const int margin = steps.back().maxCoeff() + 1;
  low_ = box.min() - Vector3d::Constant(margin * size);
  counts_ = (box.sizes() * per_cell_).array().ceil().cast<int>() + 2 * margin;
  marked_.assign(number(counts_ - Vector3i::Ones()) + 1, false);
  std::vector<bool> covered(marked_.size(), false);
  for (const int f : faces) {
    cover_triangle(corner(f, 0), corner(f, 1), corner(f, 2), size, [&](const Vector3d& point) {
      const Vector3i cell = ((point - low_) * per_cell_).cast<int>();
      const std::size_t at = number(cell);
      if (covered[at]) return;
      covered[at] = true;
      for (const Vector3i& step : steps) marked_[number(cell + step)] = true;
    });
  }
}

}  // namespace orbifit
