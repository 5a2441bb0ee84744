#include "orbifit/subspace/piece_moments.h"

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

std::vector<PieceMoments> moments_of_sets(const Mesh& mesh, const std::vector<int>& set_of_face, int sets,
                                          const Eigen::Vector3d& origin) {
  std::vector<PieceMoments> result(static_cast<std::size_t>(sets));
  for (Eigen::Index face = 0; face < mesh.faces.rows(); ++face) {
    Eigen::Matrix3d corners;  // columns
    for (int k = 0; k < 3; ++k) corners.col(k) = mesh.vertices.row(mesh.faces(face, k)).transpose() - origin;
    PieceMoments piece;
    piece.area = 0.5 * (corners.col(1) - corners.col(0)).cross(corners.col(2) - corners.col(0)).norm();
    const Eigen::Vector3d sum = corners.rowwise().sum();
    piece.first = piece.area / 3 * sum;
    piece.second = piece.area / 12 * (corners * corners.transpose() + sum * sum.transpose());
    result[static_cast<std::size_t>(set_of_face[static_cast<std::size_t>(face)])] += piece;
  }
  return result;
}

double mismatch(const PieceMoments& piece, const Motion& motion, const PieceMoments& other, double size) {
  constexpr double kSameArea = 0.03;
  constexpr double kNear = 0.5;  // of its width: closer than neighbours of its kind
  constexpr double kFar = std::numeric_limits<double>::infinity();
  if (!(piece.area > 0 && other.area > 0)) return kFar;
  if (std::abs(piece.area - other.area) > kSameArea * std::max(piece.area, other.area)) return kFar;
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
  if (distance > kNear * width) return kFar;
  return (distance + difference) / size;
}

}  // namespace orbifit
