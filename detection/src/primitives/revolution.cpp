#include "primitives/revolution.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "base/dense.h"

namespace orbifit {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr int kIterations = 12;
constexpr double kSmall = 2e-3;  // eigenvalues of unit-scaled points below this share are zero

Matrix3d pseudo_inverse(const Matrix3d& matrix, int& rank) {
  const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(matrix);
  const double largest = solver.eigenvalues()[2];
  Matrix3d inverse = Matrix3d::Zero();
  rank = 0;
  for (int k = 0; k < 3; ++k) {
    if (solver.eigenvalues()[k] <= kSmall * largest) continue;
    const Vector3d v = solver.eigenvectors().col(k);
    inverse += v * v.transpose() / solver.eigenvalues()[k];
    ++rank;
  }
  return inverse;
}

struct Moments {
  Matrix3d turns = Matrix3d::Zero();   // sum w (p x n)(p x n)^T
  Matrix3d mixed = Matrix3d::Zero();   // sum w n (p x n)^T
  Matrix3d shifts = Matrix3d::Zero();  // sum w n n^T
};

Moments accumulate(const Points& points, const Points& normals, const Eigen::VectorXd& weights) {
  Moments result;
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    if (weights[i] <= 0) continue;
    const Vector3d n = normals.row(i);
    const Vector3d moment = Vector3d(points.row(i)).cross(n);
    result.turns += weights[i] * moment * moment.transpose();
    result.mixed += weights[i] * n * moment.transpose();
    result.shifts += weights[i] * n * n.transpose();
  }
  return result;
}

}  // namespace

bool meets(const Line& axis, const Eigen::Vector3d& point, const Eigen::Vector3d& normal, double near) {
  constexpr double kSine = 0.2;
  const Eigen::Vector3d around = axis.direction.cross(point - axis.point);
  const double radius = around.norm();
  return radius < near || std::abs(around.dot(normal)) <= kSine * radius;
}

std::optional<RevolutionFit> fit_axis_of_revolution(const Points& points, const Points& normals,
                                                    const Eigen::VectorXd& given, double angle) {
  const Eigen::Index count = points.rows();
  if (count < 6) return std::nullopt;
  const Eigen::VectorXd start = given.size() == count ? given : Eigen::VectorXd::Ones(count);
  const double total = start.sum();
  if (!(total > 0)) return std::nullopt;
  const Vector3d centre = points.transpose() * start / total;
  Points local = points.rowwise() - centre.transpose();
  const double size = std::sqrt((local.rowwise().squaredNorm().array() * start.array()).sum() / total);
  if (!(size > 0)) return std::nullopt;
  local /= size;

  RevolutionFit result;
  Eigen::VectorXd weights = start;
  Vector3d w = Vector3d::UnitZ();
  Vector3d v = Vector3d::Zero();
  const double reach = 2 * std::sin(angle);
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    const Moments moments = accumulate(local, normals, weights);
    int rank = 0;
    const Matrix3d inverse = pseudo_inverse(moments.shifts, rank);
    const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(moments.turns -
                                                         moments.mixed.transpose() * inverse * moments.mixed);
    w = solver.eigenvectors().col(0);
    v = -inverse * moments.mixed * w;
    v -= w * w.dot(v);  // without pitch
    if (iteration == 0) {
      result.planar = rank == 1;
      result.spherical = solver.eigenvalues()[2] <= kSmall * std::max(moments.turns.trace(), 1e-300);
    }
    if (result.planar) {
      w = Eigen::SelfAdjointEigenSolver<Matrix3d>(moments.shifts).eigenvectors().col(2);
      v.setZero();
      break;
    }
    for (Eigen::Index i = 0; i < count; ++i) {
      const Vector3d p = local.row(i);
      const Vector3d speed = v + w.cross(p);
      const double norm = std::max(speed.norm(), 0.02);
      const double sine = std::abs(speed.dot(normals.row(i))) / norm;
      const double ratio = sine / reach;
      weights[i] = ratio < 1 ? start[i] * (1 - ratio * ratio) * (1 - ratio * ratio) / (norm * norm) : 0;
    }
  }
  double inside = 0;
  for (Eigen::Index i = 0; i < count; ++i) {
    const Vector3d p = local.row(i);
    const Vector3d speed = v + w.cross(p);
    if (std::abs(speed.dot(normals.row(i))) <= std::sin(angle) * std::max(speed.norm(), 0.02)) inside += start[i];
  }
  result.inliers = inside / total;
  if (result.inliers < 0.5) return std::nullopt;
  // The axis is where the speed v + w x p vanishes: p = w x v.
  result.axis = {centre + size * w.cross(v), w};
  return result;
}

}  // namespace orbifit
