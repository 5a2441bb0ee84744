#include "rewrite/turned_normals.h"

#include <Eigen/Geometry>

namespace orbifit {

void NormalTurn::add(const Eigen::Vector3d& rest, const Eigen::Vector3d& edited) {
  rest_ += rest;
  edited_ += edited;
}

Eigen::Vector3d NormalTurn::apply(const Eigen::Vector3d& normal) const {
  if (rest_ == edited_ || !(rest_.norm() > 0) || !(edited_.norm() > 0)) return normal;
  return Eigen::Quaterniond::FromTwoVectors(rest_, edited_) * normal;
}

Points face_area_vectors(const Mesh& mesh) {
  Points result(mesh.faces.rows(), 3);
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    const Eigen::Vector3d a = mesh.vertices.row(mesh.faces(f, 0));
    const Eigen::Vector3d b = mesh.vertices.row(mesh.faces(f, 1));
    const Eigen::Vector3d c = mesh.vertices.row(mesh.faces(f, 2));
    result.row(f) = (b - a).cross(c - a);
  }
  return result;
}

std::vector<NormalTurn> vertex_normal_turns(const Mesh& rest, const Mesh& edited) {
  const Points before = face_area_vectors(rest);
  const Points after = face_area_vectors(edited);
  std::vector<NormalTurn> turns(static_cast<std::size_t>(rest.vertices.rows()));
  for (Eigen::Index f = 0; f < rest.faces.rows(); ++f) {
    for (const int vertex : rest.faces.row(f)) {
      turns[static_cast<std::size_t>(vertex)].add(before.row(f), after.row(f));
    }
  }
  return turns;
}

}  // namespace orbifit
