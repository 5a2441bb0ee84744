#include "domains/piece_moments.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

namespace orbifit {

PieceMoments& PieceMoments::operator+=(const PieceMoments& other) {
  area += other.area;
  first += other.first;
  second += other.second;
  return *this;
}

namespace {

PieceMoments moments_of_face(const Mesh& mesh, Eigen::Index face, const Eigen::Vector3d& origin) {
  Eigen::Matrix3d corners;  // columns
  for (int k = 0; k < 3; ++k) corners.col(k) = mesh.vertices.row(mesh.faces(face, k)).transpose() - origin;
  PieceMoments piece;
  piece.area = 0.5 * (corners.col(1) - corners.col(0)).cross(corners.col(2) - corners.col(0)).norm();
  const Eigen::Vector3d sum = corners.rowwise().sum();
  piece.first = piece.area / 3 * sum;
  piece.second = piece.area / 12 * (corners * corners.transpose() + sum * sum.transpose());
  return piece;
}

}  // namespace

PieceMoments moments_of_faces(const Mesh& mesh, const std::vector<int>& faces, const Eigen::Vector3d& origin) {
  PieceMoments result;
  for (const int face : faces) result += moments_of_face(mesh, face, origin);
  return result;
}

std::vector<PieceMoments> moments_of_sets(const Mesh& mesh, const std::vector<int>& set_of_face, int sets,
                                          const Eigen::Vector3d& origin) {
  std::vector<PieceMoments> result(static_cast<std::size_t>(sets));
  for (Eigen::Index face = 0; face < mesh.faces.rows(); ++face) {
    const int set = set_of_face[static_cast<std::size_t>(face)];
    result[static_cast<std::size_t>(set)] += moments_of_face(mesh, face, origin);
  }
  return result;
}

double separation(const PieceMoments& piece, const Motion& motion, const PieceMoments& other, double size) {
  if (!(piece.area > 0 && other.area > 0)) return std::numeric_limits<double>::infinity();
  const auto spread = [](const PieceMoments& moments) {
    const Eigen::Vector3d mean = moments.first / moments.area;
    return Eigen::Matrix3d(moments.second / moments.area - mean * mean.transpose());
  };
  const Eigen::Vector3d mean = motion(Eigen::Vector3d(piece.first / piece.area));
  const double distance = (mean - other.first / other.area).norm();
  const Eigen::Matrix3d turned = motion.linear * spread(piece) * motion.linear.transpose();
  // A difference of squares, as a length.
  const double width = std::sqrt(std::max(turned.trace(), spread(other).trace()));
  const double difference = width > 0 ? (turned - spread(other)).norm() / width : 0;
  return (distance + difference + std::abs(std::sqrt(piece.area) - std::sqrt(other.area))) / size;
}

}  // namespace orbifit
