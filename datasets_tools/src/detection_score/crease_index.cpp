#include "detection_score/crease_index.h"

#include <algorithm>
#include <numeric>

#include "geometry/surface_index.h"

namespace orbifit::scoring {

namespace {

using Eigen::Vector3d;

constexpr int kLeaf = 4;  // faces

}  // namespace

CreaseIndex::CreaseIndex(const Mesh& mesh, const Points& normals, std::vector<int> faces)
    : mesh_(mesh), normals_(normals), faces_(std::move(faces)) {
  middles_.reserve(faces_.size());
  for (const int face : faces_) {
    middles_.emplace_back((mesh.vertices.row(mesh.faces(face, 0)) + mesh.vertices.row(mesh.faces(face, 1)) +
                           mesh.vertices.row(mesh.faces(face, 2)))
                              .transpose() /
                          3);
  }
  // Sorted are places in the list, so that the middles stay where they are.
  std::vector<int> given = std::move(faces_);
  faces_.resize(given.size());
  std::iota(faces_.begin(), faces_.end(), 0);
  if (!given.empty()) build(0, static_cast<int>(given.size()));
  for (int& place : faces_) place = given[static_cast<std::size_t>(place)];
  for (Node& node : nodes_) {
    if (node.second_child >= 0) continue;
    for (int i = node.first; i < node.end; ++i) {
      const int face = faces_[static_cast<std::size_t>(i)];
      for (int k = 0; k < 3; ++k) node.box.extend(mesh.vertices.row(mesh.faces(face, k)).transpose());
    }
  }
  // Children stand behind their parents.
  for (std::size_t n = nodes_.size(); n-- > 0;) {
    if (nodes_[n].second_child < 0) continue;
    nodes_[n].box = nodes_[n + 1].box.merged(nodes_[static_cast<std::size_t>(nodes_[n].second_child)].box);
  }
}

void CreaseIndex::build(int first, int end) {
  const std::size_t number = nodes_.size();
  nodes_.push_back({{}, first, end, -1});
  if (end - first <= kLeaf) return;
  Eigen::AlignedBox3d middles;
  for (int i = first; i < end; ++i) {
    middles.extend(middles_[static_cast<std::size_t>(faces_[static_cast<std::size_t>(i)])]);
  }
  Eigen::Index axis = 0;
  middles.sizes().maxCoeff(&axis);
  const int half = first + (end - first) / 2;
  std::nth_element(faces_.begin() + first, faces_.begin() + half, faces_.begin() + end, [&](int a, int b) {
    const double left = middles_[static_cast<std::size_t>(a)][axis];
    const double right = middles_[static_cast<std::size_t>(b)][axis];
    return left < right || (left == right && a < b);
  });
  build(first, half);
  nodes_[number].second_child = static_cast<int>(nodes_.size());
  build(half, end);
}

bool CreaseIndex::turned_away(const Vector3d& point, const Vector3d& normal, double cosine, double reach) const {
  if (nodes_.empty()) return false;
  std::vector<std::size_t> open{0};
  while (!open.empty()) {
    const std::size_t number = open.back();
    open.pop_back();
    const Node& node = nodes_[number];
    if (node.box.squaredExteriorDistance(point) > reach * reach) continue;
    if (node.second_child >= 0) {
      open.push_back(static_cast<std::size_t>(node.second_child));
      open.push_back(number + 1);
      continue;
    }
    for (int i = node.first; i < node.end; ++i) {
      const int face = faces_[static_cast<std::size_t>(i)];
      if (std::abs(normals_.row(face).dot(normal.transpose())) > cosine) continue;
      const Vector3d a = mesh_.vertices.row(mesh_.faces(face, 0));
      const Vector3d b = mesh_.vertices.row(mesh_.faces(face, 1));
      const Vector3d c = mesh_.vertices.row(mesh_.faces(face, 2));
      const Vector3d weights = nearest_on_triangle(point, a, b, c);
      if ((weights[0] * a + weights[1] * b + weights[2] * c - point).norm() <= reach) return true;
    }
  }
  return false;
}

}  // namespace orbifit::scoring
