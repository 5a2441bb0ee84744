#include "orbifit/model/mesh.h"

#include <algorithm>

#include <Eigen/Geometry>

namespace orbifit {

namespace {

Eigen::Vector3d area_vector(const Mesh& mesh, Eigen::Index face) {
  const Eigen::Vector3d a = mesh.vertices.row(mesh.faces(face, 0));
  const Eigen::Vector3d b = mesh.vertices.row(mesh.faces(face, 1));
  const Eigen::Vector3d c = mesh.vertices.row(mesh.faces(face, 2));
  return 0.5 * (b - a).cross(c - a);
}

}  // namespace

double diagonal(const Points& points) {
  if (points.rows() == 0) return 0;
  return (points.colwise().maxCoeff() - points.colwise().minCoeff()).norm();
}

Eigen::Vector3d bounding_box_centre(const Points& points) {
  if (points.rows() == 0) return Eigen::Vector3d::Zero();
  return 0.5 * (points.colwise().maxCoeff() + points.colwise().minCoeff()).transpose();
}

Eigen::Vector3d face_normal(const Mesh& mesh, Eigen::Index face) {
  const Eigen::Vector3d vector = area_vector(mesh, face);
  const double length = vector.stableNorm();
  return length > 0 ? Eigen::Vector3d(vector / length) : Eigen::Vector3d::Zero();
}

Points face_normals(const Mesh& mesh) {
  Points normals(mesh.faces.rows(), 3);
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) normals.row(f) = face_normal(mesh, f);
  return normals;
}

Eigen::VectorXd face_areas(const Mesh& mesh) {
  Eigen::VectorXd areas(mesh.faces.rows());
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) areas[f] = area_vector(mesh, f).norm();
  return areas;
}

Points face_centroids(const Mesh& mesh) {
  Points result(mesh.faces.rows(), 3);
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    result.row(f) = (mesh.vertices.row(mesh.faces(f, 0)) + mesh.vertices.row(mesh.faces(f, 1)) +
                     mesh.vertices.row(mesh.faces(f, 2))) /
                    3;
  }
  return result;
}

Points vertex_normals(const Mesh& mesh) {
  Points normals = Points::Zero(mesh.vertices.rows(), 3);
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    const Eigen::Vector3d vector = area_vector(mesh, f);
    for (int k = 0; k < 3; ++k) normals.row(mesh.faces(f, k)) += vector;
  }
  for (Eigen::Index v = 0; v < normals.rows(); ++v) {
    const double length = normals.row(v).stableNorm();
    if (length > 0) normals.row(v) /= length;
  }
  return normals;
}

namespace {

// Whether to look through all vertices costs more than to sort those of so many faces.
bool few_faces(const Mesh& mesh, const std::vector<int>& faces) {
  constexpr std::size_t kMarks = 32;  // read in the time in which one number is sorted
  return kMarks * 3 * faces.size() < static_cast<std::size_t>(mesh.vertices.rows());
}

}  // namespace

std::vector<int> vertices_of_faces(const Mesh& mesh, const std::vector<int>& faces) {
  std::vector<int> result;
  if (few_faces(mesh, faces)) {
    result.reserve(3 * faces.size());
    for (const int face : faces) {
      for (int k = 0; k < 3; ++k) result.push_back(mesh.faces(face, k));
    }
    std::ranges::sort(result);
    result.erase(std::unique(result.begin(), result.end()), result.end());
    return result;
  }
  std::vector<char> met(static_cast<std::size_t>(mesh.vertices.rows()), 0);
  for (const int face : faces) {
    for (int k = 0; k < 3; ++k) met[static_cast<std::size_t>(mesh.faces(face, k))] = 1;
  }
  for (std::size_t v = 0; v < met.size(); ++v) {
    if (met[v] != 0) result.push_back(static_cast<int>(v));
  }
  return result;
}

Mesh submesh(const Mesh& mesh, const std::vector<int>& faces, std::vector<int>* vertex_of) {
  std::vector<int> kept = vertices_of_faces(mesh, faces);
  std::vector<int> number;  // of each vertex, where many are looked up
  if (!few_faces(mesh, faces)) {
    number.resize(static_cast<std::size_t>(mesh.vertices.rows()));
    for (std::size_t i = 0; i < kept.size(); ++i) number[static_cast<std::size_t>(kept[i])] = static_cast<int>(i);
  }
  const auto number_of = [&](int vertex) {
    if (!number.empty()) return number[static_cast<std::size_t>(vertex)];
    return static_cast<int>(std::ranges::lower_bound(kept, vertex) - kept.begin());
  };
  Mesh result;
  result.vertices = mesh.vertices(kept, Eigen::all);
  result.faces.resize(static_cast<Eigen::Index>(faces.size()), 3);
  for (std::size_t f = 0; f < faces.size(); ++f) {
    for (int k = 0; k < 3; ++k) result.faces(static_cast<Eigen::Index>(f), k) = number_of(mesh.faces(faces[f], k));
  }
  if (vertex_of != nullptr) *vertex_of = std::move(kept);
  return result;
}

}  // namespace orbifit
