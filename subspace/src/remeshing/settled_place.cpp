#include "remeshing/settled_place.h"

#include <array>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "remeshing/indices.h"

namespace orbifit {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Of the largest moment: directions whose moments differ by less are not told apart, and nothing turns about them.
constexpr double kSameMoment = 0.02;

struct Moments {
  double area = 0;
  Vector3d centroid = Vector3d::Zero();
  Matrix3d second = Matrix3d::Zero();  // about the centroid
};

Moments moments(const CellSurface& cell) {
  Moments result;
  Matrix3d about_origin = Matrix3d::Zero();
  for (const auto& corners : cell.triangles) {
    const Vector3d& a = cell.points[at(corners[0])];
    const Vector3d& b = cell.points[at(corners[1])];
    const Vector3d& c = cell.points[at(corners[2])];
    const double area = (b - a).cross(c - a).norm() / 2;
    const Vector3d sum = a + b + c;
    result.area += area;
    result.centroid += area / 3 * sum;
    // Exact for a triangle: the mean of p p^T is (sum of v v^T + s s^T) / 12, s the sum of its corners.
    about_origin += area / 12 * (a * a.transpose() + b * b.transpose() + c * c.transpose() + sum * sum.transpose());
  }
  if (!(result.area > 0)) return result;
  result.centroid /= result.area;
  result.second = about_origin / result.area - result.centroid * result.centroid.transpose();
  return result;
}

Matrix3d cross_matrix(const Vector3d& v) {
  Matrix3d result;
  result << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return result;
}

// The rotation w, as axis times angle, for which w x M - M w x is nearest to the difference of the tensors, by least
// squares; about directions that nothing tells apart it is zero.
Vector3d turn_between(const Matrix3d& from, const Matrix3d& to) {
  const Matrix3d difference = to - from;
  std::array<Matrix3d, 3> changes;
  for (int k = 0; k < 3; ++k) {
    const Matrix3d spin = cross_matrix(Vector3d::Unit(k));
    changes[static_cast<std::size_t>(k)] = spin * from - from * spin;
  }
  Matrix3d normal;
  Vector3d right;
  for (int i = 0; i < 3; ++i) {
    const Matrix3d& change = changes[static_cast<std::size_t>(i)];
    right[i] = change.cwiseProduct(difference).sum();
    for (int j = 0; j < 3; ++j) normal(i, j) = change.cwiseProduct(changes[static_cast<std::size_t>(j)]).sum();
  }
  const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(normal);
  Vector3d turn = Vector3d::Zero();
  for (int k = 0; k < 3; ++k) {
    const double value = solver.eigenvalues()[k];
    if (!(value > kSameMoment * kSameMoment * from.squaredNorm())) continue;
    const Vector3d direction = solver.eigenvectors().col(k);
    turn += direction.dot(right) / value * direction;
  }
  return turn;
}

}  // namespace

Motion settled_place(const CellSurface& cell, const FiniteGroup& group) {
  const Moments own = moments(cell);
  if (!(own.area > 0) || group.order() == 1) return {};
  Vector3d centroid = Vector3d::Zero();
  Matrix3d second = Matrix3d::Zero();
  for (const Motion& element : group.elements) {
    centroid += element(own.centroid) / group.order();
    second += element.linear * own.second * element.linear.transpose() / group.order();
  }
  const Vector3d turn = turn_between(own.second, second);
  const Matrix3d rotation =
      turn.norm() > 0 ? axis_rotation(turn.normalized(), turn.norm()) : Matrix3d(Matrix3d::Identity());
  return {rotation, centroid - rotation * own.centroid};
}

}  // namespace orbifit
