#include "batch/shape_invariants.h"

#include <cmath>

#include <Eigen/Eigenvalues>

namespace orbifit::batch {

namespace {

// D. A. Dunavant, High degree efficient symmetrical Gaussian quadrature rules for the triangle (1985), degree 6.
struct Node {
  double weight;
  Eigen::Vector3d barycentric;
};

std::array<Node, 12> degree_six() {
  std::array<Node, 12> nodes;
  std::size_t next = 0;
  const auto add_three = [&](double weight, double far, double near) {
    nodes[next++] = {weight, {far, near, near}};
    nodes[next++] = {weight, {near, far, near}};
    nodes[next++] = {weight, {near, near, far}};
  };
  add_three(0.116786275726379, 0.501426509658179, 0.249286745170910);
  add_three(0.050844906370207, 0.873821971016996, 0.063089014491502);
  const double a = 0.053145049844817, b = 0.310352451033784, c = 1 - a - b;
  for (const Eigen::Vector3d& corner : {Eigen::Vector3d(a, b, c), Eigen::Vector3d(b, c, a), Eigen::Vector3d(c, a, b),
                                        Eigen::Vector3d(a, c, b), Eigen::Vector3d(c, b, a), Eigen::Vector3d(b, a, c)}) {
    nodes[next++] = {0.082851075618374, corner};
  }
  return nodes;
}

}  // namespace

ShapeInvariants shape_invariants(const Mesh& mesh) {
  ShapeInvariants result;
  const Eigen::VectorXd areas = face_areas(mesh);
  const double area = areas.sum();
  if (!(area > 0)) return result;
  result.centroid = (areas.transpose() * face_centroids(mesh)).transpose() / area;

  static const std::array<Node, 12> nodes = degree_six();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
  double fourth = 0, sixth = 0;
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    Eigen::Matrix3d corners;
    for (int k = 0; k < 3; ++k) corners.col(k) = mesh.vertices.row(mesh.faces(f, k)).transpose() - result.centroid;
    for (const Node& node : nodes) {
      const Eigen::Vector3d point = corners * node.barycentric;
      const double share = areas[f] * node.weight;
      const double square = point.squaredNorm();
      second += share * point * point.transpose();
      fourth += share * square * square;
      sixth += share * square * square * square;
    }
  }
  const double square = second.trace() / area;
  if (!(square > 0)) return result;
  result.size = std::sqrt(square);
  const Eigen::Vector3d eigenvalues =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(second / (area * square), Eigen::EigenvaluesOnly).eigenvalues();
  result.values = {eigenvalues[2], eigenvalues[1], area / square, fourth / (area * square * square),
                   sixth / (area * square * square * square)};
  return result;
}

}  // namespace orbifit::batch
