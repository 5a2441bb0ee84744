#include "display_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>

namespace orbifit::editor {

namespace {

// Faces that meet at a larger angle look like an edge.
constexpr double kCreaseDegrees = 40;

// Vertices at one place have one number, so that triangles that share no vertices look smooth too.
std::vector<std::uint32_t> places(const Points& vertices) {
  std::vector<std::uint32_t> order(static_cast<std::size_t>(vertices.rows()));
  std::iota(order.begin(), order.end(), 0U);
  const auto position = [&](std::uint32_t v) { return std::array{vertices(v, 0), vertices(v, 1), vertices(v, 2)}; };
  std::sort(order.begin(), order.end(), [&](auto a, auto b) { return position(a) < position(b); });
  std::vector<std::uint32_t> result(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && position(order[i]) == position(order[i - 1]);
    result[order[i]] = same ? result[order[i - 1]] : order[i];
  }
  return result;
}

struct Spoke {
  std::uint32_t centre, other;  // places
  std::uint32_t corner;         // 3 face + k

  bool operator<(const Spoke& spoke) const {
    return std::array{centre, other, corner} < std::array{spoke.centre, spoke.other, spoke.corner};
  }
};

std::uint32_t root_of(std::vector<std::uint32_t>& parents, std::uint32_t corner) {
  while (parents[corner] != corner) corner = parents[corner] = parents[parents[corner]];
  return corner;
}

// For each corner 3 f + k the first corner of those around the same place that look smooth with it.
std::vector<std::uint32_t> smooth_corners(const Mesh& mesh) {
  const std::vector<std::uint32_t> place = places(mesh.vertices);
  const Points normals = face_normals(mesh);
  const auto corners = static_cast<std::uint32_t>(3 * mesh.faces.rows());
  std::vector<Spoke> spokes;
  spokes.reserve(2 * static_cast<std::size_t>(corners));
  const auto place_of = [&](std::uint32_t corner) {
    return place[static_cast<std::size_t>(mesh.faces(corner / 3, corner % 3))];
  };
  for (std::uint32_t corner = 0; corner < corners; ++corner) {
    const std::uint32_t first = corner - corner % 3;
    spokes.push_back({place_of(corner), place_of(first + (corner + 1) % 3), corner});
    spokes.push_back({place_of(corner), place_of(first + (corner + 2) % 3), corner});
  }
  std::sort(spokes.begin(), spokes.end());
  std::vector<std::uint32_t> parents(corners);
  std::iota(parents.begin(), parents.end(), 0U);
  const double smooth = std::cos(kCreaseDegrees * std::numbers::pi / 180);
  for (std::size_t i = 1; i < spokes.size(); ++i) {
    const Spoke& a = spokes[i - 1];
    const Spoke& b = spokes[i];
    if (a.centre != b.centre || a.other != b.other) continue;
    if (normals.row(a.corner / 3).dot(normals.row(b.corner / 3)) < smooth) continue;
    const auto [low, high] = std::minmax({root_of(parents, a.corner), root_of(parents, b.corner)});
    parents[high] = low;
  }
  for (std::uint32_t corner = 0; corner < corners; ++corner) parents[corner] = root_of(parents, corner);
  return parents;
}

}  // namespace

DisplayMesh::DisplayMesh(const Mesh& mesh) : centre_(bounding_box_centre(mesh.vertices)) {
  const double size = diagonal(mesh.vertices);
  if (size > 0) scale_ = size;
  const std::vector<std::uint32_t> smooth = smooth_corners(mesh);
  triangles_.resize(smooth.size());
  constexpr auto kNone = static_cast<std::uint32_t>(-1);
  std::vector<std::uint32_t> shown(smooth.size(), kNone);
  for (std::size_t corner = 0; corner < smooth.size(); ++corner) {
    std::uint32_t& number = shown[smooth[corner]];
    if (number == kNone) {
      number = static_cast<std::uint32_t>(sources_.size());
      sources_.push_back(static_cast<std::uint32_t>(
          mesh.faces(static_cast<Eigen::Index>(corner / 3), static_cast<Eigen::Index>(corner % 3))));
    }
    triangles_[corner] = number;
  }
  positions_.resize(3 * sources_.size());
  normals_.resize(3 * sources_.size());
  move(mesh.vertices);
}

void DisplayMesh::move(const Points& vertices) {
  const double factor = 1 / scale_;
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    const double* vertex = vertices.data() + 3 * static_cast<std::size_t>(sources_[i]);
    for (std::size_t k = 0; k < 3; ++k) {
      positions_[3 * i + k] = static_cast<float>((vertex[k] - centre_[static_cast<Eigen::Index>(k)]) * factor);
    }
  }
  std::fill(normals_.begin(), normals_.end(), 0.0F);
  for (std::size_t i = 0; i + 2 < triangles_.size(); i += 3) {
    const float* a = positions_.data() + 3 * static_cast<std::size_t>(triangles_[i]);
    const float* b = positions_.data() + 3 * static_cast<std::size_t>(triangles_[i + 1]);
    const float* c = positions_.data() + 3 * static_cast<std::size_t>(triangles_[i + 2]);
    const float ux = b[0] - a[0], uy = b[1] - a[1], uz = b[2] - a[2];
    const float vx = c[0] - a[0], vy = c[1] - a[1], vz = c[2] - a[2];
    const float x = uy * vz - uz * vy, y = uz * vx - ux * vz, z = ux * vy - uy * vx;
    for (std::size_t k = 0; k < 3; ++k) {
      float* normal = normals_.data() + 3 * static_cast<std::size_t>(triangles_[i + k]);
      normal[0] += x;
      normal[1] += y;
      normal[2] += z;
    }
  }
}

}  // namespace orbifit::editor
