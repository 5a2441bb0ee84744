#include "divided.h"

#include <map>
#include <utility>
#include <vector>

namespace orbifit {

namespace {

std::vector<int> in_four(const std::vector<int>& faces) {
  std::vector<int> result;
  for (const int face : faces) {
    for (int k = 0; k < 4; ++k) result.push_back(4 * face + k);
  }
  return result;
}

}  // namespace

AnnotatedMesh divided(const Mesh& mesh, const SymmetryAnnotation& annotation) {
  AnnotatedMesh result{{}, annotation};
  std::map<std::pair<int, int>, int> middles;
  std::vector<Eigen::Vector3d> added;
  const auto middle = [&](int a, int b) {
    const auto [entry, is_new] =
        middles.try_emplace(std::minmax(a, b), static_cast<int>(mesh.vertices.rows()) + static_cast<int>(added.size()));
    if (is_new) added.emplace_back((mesh.vertices.row(a) + mesh.vertices.row(b)).transpose() / 2);
    return entry->second;
  };
  result.mesh.faces.resize(4 * mesh.faces.rows(), 3);
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    const int a = mesh.faces(f, 0);
    const int b = mesh.faces(f, 1);
    const int c = mesh.faces(f, 2);
    const int ab = middle(a, b);
    const int bc = middle(b, c);
    const int ca = middle(c, a);
    result.mesh.faces.middleRows(4 * f, 4) << a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca;
  }
  result.mesh.vertices.resize(mesh.vertices.rows() + static_cast<Eigen::Index>(added.size()), 3);
  result.mesh.vertices.topRows(mesh.vertices.rows()) = mesh.vertices;
  for (std::size_t i = 0; i < added.size(); ++i) {
    result.mesh.vertices.row(mesh.vertices.rows() + static_cast<Eigen::Index>(i)) = added[i].transpose();
  }
  result.annotation.mesh_vertices = static_cast<int>(result.mesh.vertices.rows());
  result.annotation.mesh_faces = static_cast<int>(result.mesh.faces.rows());
  for (Region& region : result.annotation.regions) region.faces = in_four(region.faces);
  for (Pattern& pattern : result.annotation.patterns) {
    for (PatternInstance& instance : pattern.instances) instance.faces = in_four(instance.faces);
  }
  return result;
}

}  // namespace orbifit
