#include "orbifit/detection/balls.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/Dense>

#include "orbifit/detection/verification.h"

#include "face_points.h"

namespace orbifit {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

std::optional<Ball> ball_of(const PreparedMesh& prepared, const std::vector<int>& faces, double tolerance) {
  constexpr double kCurved = 0.05;  // mean of sin^2 of the angle to the mean normal: a cap of about 18 degrees
  constexpr double kOff = 0.03;     // of the area
  Matrix3d across = Matrix3d::Zero();
  Vector3d moment = Vector3d::Zero();
  Ball ball;
  for (const int face : faces) {
    const Vector3d normal = prepared.normals.row(face);
    const Matrix3d weight = prepared.areas[face] * (Matrix3d::Identity() - normal * normal.transpose());
    across += weight;
    moment += weight * face_centroid(prepared, face);
    ball.area += prepared.areas[face];
  }
  const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(across);
  if (!(solver.eigenvalues()[0] > kCurved * ball.area)) return std::nullopt;
  ball.centre =
      solver.eigenvectors() * (solver.eigenvectors().transpose() * moment).cwiseQuotient(solver.eigenvalues());
  const auto distance = [&](int face) { return (face_centroid(prepared, face) - ball.centre).norm(); };
  for (const int face : faces) ball.radius += prepared.areas[face] / ball.area * distance(face);
  double off = 0;
  for (const int face : faces) {
    if (std::abs(distance(face) - ball.radius) > tolerance) off += prepared.areas[face];
  }
  if (off > kOff * ball.area) return std::nullopt;
  return ball;
}

}  // namespace

Balls find_balls(const PreparedMesh& prepared, double tolerance) {
  constexpr double kLeast = 0.01;  // of the mesh's area
  constexpr double kSame = 2;      // tolerances
  Balls balls;
  for (const std::vector<int>& faces : prepared.components.faces) {
    balls.ball_of_piece.push_back(-1);
    if (area_of(prepared, faces) < kLeast * prepared.area) continue;
    const std::optional<Ball> ball = ball_of(prepared, faces, tolerance);
    if (!ball) continue;
    const auto same = std::ranges::find_if(balls.all, [&](const Ball& other) {
      return (other.centre - ball->centre).norm() < kSame * tolerance &&
             std::abs(other.radius - ball->radius) < kSame * tolerance;
    });
    balls.ball_of_piece.back() = static_cast<int>(same - balls.all.begin());
    if (same == balls.all.end()) {
      balls.all.push_back(*ball);
    } else {
      same->area += ball->area;
    }
  }
  return balls;
}

bool fixes(const GroupPlacement& placement, const Ball& ball, double tolerance) {
  constexpr double kFar = 2;  // tolerances
  return std::ranges::all_of(
      judged_motions(placement.group, placement.frame, placement.centre),
      [&](const Motion& motion) { return (motion(ball.centre) - ball.centre).norm() < kFar * tolerance; });
}

bool little_but_cut_balls(const PreparedMesh& prepared, const Balls& balls, const std::vector<int>& faces,
                          const GroupPlacement& placement, double tolerance) {
  constexpr double kAll = 0.98;   // of a ball
  constexpr double kLeast = 0.3;  // of the region, beside balls
  if (balls.all.empty()) return false;
  std::vector<double> inside(balls.all.size(), 0);
  double area = 0;
  for (const int face : faces) {
    area += prepared.areas[face];
    const auto piece = static_cast<std::size_t>(prepared.components.component_of_face[static_cast<std::size_t>(face)]);
    const int ball = balls.ball_of_piece[piece];
    if (ball >= 0) inside[static_cast<std::size_t>(ball)] += prepared.areas[face];
  }
  double rest = area;
  for (std::size_t b = 0; b < inside.size(); ++b) {
    const Ball& ball = balls.all[b];
    if (inside[b] > 0 && inside[b] < kAll * ball.area && fixes(placement, ball, tolerance)) rest -= inside[b];
  }
  return rest < kLeast * area;
}

}  // namespace orbifit
