#include "primitives/balls.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>

#include <Eigen/Dense>
#include <Eigen/Geometry>

#include "group/verification.h"
#include "surface/face_points.h"

namespace orbifit {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// The sphere whose centre the faces' normals meet in, by least squares; nothing where they turn by so little that they
// would meet anywhere.
std::optional<Ball> fitted_ball(const PreparedMesh& prepared, const std::vector<int>& faces, double least_curved) {
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
  if (!(solver.eigenvalues()[0] > least_curved * ball.area)) return std::nullopt;
  ball.centre =
      solver.eigenvectors() * (solver.eigenvectors().transpose() * moment).cwiseQuotient(solver.eigenvalues());
  for (const int face : faces) {
    ball.radius += prepared.areas[face] / ball.area * (face_centroid(prepared, face) - ball.centre).norm();
  }
  return ball;
}

double off_ball(const PreparedMesh& prepared, const Ball& ball, int face) {
  return std::abs((face_centroid(prepared, face) - ball.centre).norm() - ball.radius);
}

/// A ball and its faces.
struct FacesOfBall {
  Ball ball;
  std::vector<int> faces;
};

// The ball that all of a piece lies on but for a little.
std::optional<FacesOfBall> ball_of_all(const PreparedMesh& prepared, const std::vector<int>& faces, double tolerance) {
  constexpr double kCurved = 0.05;  // mean of sin^2 of the angle to the mean normal: a cap of about 18 degrees
  constexpr double kOff = 0.03;     // of the area
  const std::optional<Ball> ball = fitted_ball(prepared, faces, kCurved);
  if (!ball) return std::nullopt;
  double off = 0;
  for (const int face : faces) {
    if (off_ball(prepared, *ball, face) > tolerance) off += prepared.areas[face];
  }
  if (off > kOff * ball->area) return std::nullopt;
  return FacesOfBall{*ball, faces};
}

// The sphere nearest to the centroids of faces that lie about one, of which more than a cap is there: the centre and
// radius that leave |x|^2 - 2 c x + c^2 - r^2 least, by least squares.
Ball sphere_through(const PreparedMesh& prepared, const std::vector<int>& faces) {
  Ball ball;
  Vector3d middle = Vector3d::Zero();
  for (const int face : faces) {
    ball.area += prepared.areas[face];
    middle += prepared.areas[face] * face_centroid(prepared, face);
  }
  middle /= ball.area;
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Zero();
  Eigen::Vector4d right = Eigen::Vector4d::Zero();
  for (const int face : faces) {
    const Vector3d arm = face_centroid(prepared, face) - middle;
    const Eigen::Vector4d row(2 * arm.x(), 2 * arm.y(), 2 * arm.z(), 1);
    matrix += prepared.areas[face] * row * row.transpose();
    right += prepared.areas[face] * arm.squaredNorm() * row;
  }
  const Eigen::Vector4d solved = matrix.ldlt().solve(right);
  ball.centre = middle + solved.head<3>();
  ball.radius = std::sqrt(std::max(0.0, solved[3] + solved.head<3>().squaredNorm()));
  return ball;
}

// Those that lie on a ball and face outward or inward there.
std::vector<int> faces_on(const PreparedMesh& prepared, const std::vector<int>& faces, const Ball& ball, double width) {
  constexpr double kOutward = 0.85;
  std::vector<int> result;
  std::ranges::copy_if(faces, std::back_inserter(result), [&](int face) {
    const Vector3d outward = (face_centroid(prepared, face) - ball.centre).normalized();
    return off_ball(prepared, ball, face) <= width && std::abs(outward.dot(prepared.normals.row(face))) >= kOutward;
  });
  return result;
}

// Some of the faces, each for as much of the area.
std::vector<int> spread(const PreparedMesh& prepared, const std::vector<int>& faces, int count) {
  const double step = area_of(prepared, faces) / count;
  std::vector<int> result;
  double area = 0.5 * step;
  for (const int face : faces) {
    area += prepared.areas[face];
    if (area < step) continue;
    result.push_back(face);
    area = std::fmod(area, step);
  }
  return result;
}

// The ball on which two faces lie, where their normals meet as far from one as from the other.
std::optional<Ball> ball_of_two(const PreparedMesh& prepared, int one, int other, double tolerance) {
  constexpr double kMinSine = 0.3;  // of the angle between the normals
  const Vector3d p = face_centroid(prepared, one);
  const Vector3d q = face_centroid(prepared, other);
  const Vector3d m = prepared.normals.row(one);
  const Vector3d n = prepared.normals.row(other);
  const Vector3d across = m.cross(n);
  const double sine = across.squaredNorm();
  if (sine < kMinSine * kMinSine) return std::nullopt;
  const double along = (q - p).cross(n).dot(across) / sine;
  const double along_other = (q - p).cross(m).dot(across) / sine;
  if (std::abs(along - along_other) > tolerance || (p + along * m - q - along_other * n).norm() > tolerance) {
    return std::nullopt;
  }
  return Ball{p + along * m, std::abs(along), 0};
}

// The ball that much of a piece lies on, where what stands on it goes over into it smoothly: that of two faces on which
// most others lie, then fitted to what lies on it, nearer and nearer.
std::optional<FacesOfBall> ball_of_much(const PreparedMesh& prepared, const std::vector<int>& faces, double tolerance) {
  constexpr double kMin = 0.2;     // of the mesh's area: what smaller ones keep by chance is little
  constexpr double kCurved = 0.3;  // as above; a cap of about 60 degrees
  constexpr double kMuch = 0.4;    // of the piece's area
  constexpr int kSeeds = 40;
  constexpr int kOthers = 150;
  constexpr double kLoose = 4;  // tolerances
  const double area = area_of(prepared, faces);
  if (area < kMin * prepared.area) return std::nullopt;
  const std::vector<int> seeds = spread(prepared, faces, kSeeds);
  const std::vector<int> looks = spread(prepared, faces, kOthers);
  std::optional<Ball> ball;
  std::size_t most = static_cast<std::size_t>(kMuch * static_cast<double>(looks.size()));
  for (std::size_t a = 0; a < seeds.size(); ++a) {
    for (std::size_t b = a + 1; b < seeds.size(); ++b) {
      const std::optional<Ball> two = ball_of_two(prepared, seeds[a], seeds[b], kLoose * tolerance);
      const std::size_t on = two ? faces_on(prepared, looks, *two, kLoose * tolerance).size() : 0;
      if (on <= most) continue;
      most = on;
      ball = two;
    }
  }
  FacesOfBall result;
  for (const double width : {kLoose, 2.0, 1.0, 1.0}) {
    if (!ball) return std::nullopt;
    result.faces = faces_on(prepared, faces, *ball, width * tolerance);
    if (area_of(prepared, result.faces) < std::max(kMuch * area, kMin * prepared.area) ||
        !fitted_ball(prepared, result.faces, kCurved)) {
      return std::nullopt;
    }
    ball = sphere_through(prepared, result.faces);
  }
  result.ball = *ball;
  return result;
}

}  // namespace

Balls find_balls(const PreparedMesh& prepared, double tolerance) {
  constexpr double kMin = 0.01;  // of the mesh's area
  constexpr double kSame = 2;    // tolerances
  Balls balls;
  balls.ball_of_face.assign(static_cast<std::size_t>(prepared.mesh.faces.rows()), -1);
  for (const std::vector<int>& piece : prepared.components.faces) {
    if (area_of(prepared, piece) < kMin * prepared.area) continue;
    std::optional<FacesOfBall> found = ball_of_all(prepared, piece, tolerance);
    if (!found) found = ball_of_much(prepared, piece, tolerance);
    if (!found) continue;
    const Ball& ball = found->ball;
    const auto same = std::ranges::find_if(balls.all, [&](const Ball& other) {
      return (other.centre - ball.centre).norm() < kSame * tolerance &&
             std::abs(other.radius - ball.radius) < kSame * tolerance;
    });
    for (const int face : found->faces) {
      balls.ball_of_face[static_cast<std::size_t>(face)] = static_cast<int>(same - balls.all.begin());
    }
    if (same == balls.all.end()) {
      balls.all.push_back(ball);
    } else {
      same->area += ball.area;
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
  constexpr double kAll = 0.98;  // of a ball
  constexpr double kMin = 0.3;   // of the region, beside balls
  if (balls.all.empty()) return false;
  std::vector<double> inside(balls.all.size(), 0);
  double area = 0;
  for (const int face : faces) {
    area += prepared.areas[face];
    const int ball = balls.ball_of_face[static_cast<std::size_t>(face)];
    if (ball >= 0) inside[static_cast<std::size_t>(ball)] += prepared.areas[face];
  }
  double rest = area;
  for (std::size_t b = 0; b < inside.size(); ++b) {
    const Ball& ball = balls.all[b];
    if (inside[b] > 0 && inside[b] < kAll * ball.area && fixes(placement, ball, tolerance)) rest -= inside[b];
  }
  return rest < kMin * area;
}

}  // namespace orbifit
