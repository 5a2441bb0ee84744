#include "own_order.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <tuple>

#include <Eigen/Geometry>

namespace orbifit {

namespace {

using Eigen::Vector3d;

constexpr double kSame = 1e-9;  // diagonals: closer values are a symmetry's

bool before(const Eigen::RowVector3d& a, const Eigen::RowVector3d& b) {
  return std::tie(a[0], a[1], a[2]) < std::tie(b[0], b[1], b[2]);
}

// The face whose value is largest, of equals the one whose middle is first by its coordinates; -1 for none.
int largest(const Eigen::VectorXd& values, const Points& middles) {
  if (values.size() == 0) return -1;
  const double most = values.maxCoeff();
  int best = -1;
  for (Eigen::Index f = 0; f < values.size(); ++f) {
    if (!(values[f] >= most - kSame)) continue;
    if (best < 0 || before(middles.row(f), middles.row(best))) best = static_cast<int>(f);
  }
  return best;
}

// A direction that turns with the shape: in the frame of its centroid, the face farthest from it, and the face farthest
// from the line through the two. It lies along none of the frame's planes, so that few faces are level.
Vector3d own_direction(const Points& middles, const Vector3d& centroid) {
  Vector3d in_frame = Vector3d(0.5377, 0.3188, 0.7811).normalized();
  const Points from = middles.rowwise() - centroid.transpose();
  const int farthest = largest(from.rowwise().norm(), middles);
  if (farthest < 0 || !(from.row(farthest).norm() > kSame)) return in_frame;
  const Vector3d along = from.row(farthest).transpose().normalized();
  const Points beside = from - (from * along) * along.transpose();
  const int widest = largest(beside.rowwise().norm(), middles);
  const double width = beside.row(widest).norm();
  const Vector3d across = width > kSame ? Vector3d(beside.row(widest).transpose() / width) : along.unitOrthogonal();
  return in_frame[0] * along + in_frame[1] * across + in_frame[2] * along.cross(across);
}

std::vector<int> numbers_up_to(Eigen::Index count) {
  std::vector<int> numbers(static_cast<std::size_t>(count));
  std::iota(numbers.begin(), numbers.end(), 0);
  return numbers;
}

}  // namespace

OwnOrder in_own_order(const Mesh& mesh) {
  OwnOrder result{mesh, numbers_up_to(mesh.faces.rows())};
  const double size = diagonal(mesh.vertices);
  if (mesh.faces.rows() == 0 || !(size > 0) || !std::isfinite(size)) return result;
  const Points places = (mesh.vertices.rowwise() - bounding_box_centre(mesh.vertices).transpose()) / size;
  const Mesh normalised{places, mesh.faces, {}};
  const Points middles = face_centroids(normalised);
  const Eigen::VectorXd areas = face_areas(normalised);
  if (!(areas.sum() > 0)) return result;
  const Vector3d direction = own_direction(middles, middles.transpose() * areas / areas.sum());
  const Eigen::VectorXd heights = places * direction;
  const Eigen::VectorXd face_heights = middles * direction;
  if (!heights.allFinite() || !face_heights.allFinite()) return result;

  std::vector<int> vertices = numbers_up_to(places.rows());
  const auto place_of = [&](int v) { return std::make_tuple(heights[v], places(v, 0), places(v, 1), places(v, 2)); };
  std::ranges::stable_sort(vertices, {}, place_of);
  std::vector<int> number(vertices.size());
  std::vector<int> rank(vertices.size());  // the same for vertices at one place
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const auto v = static_cast<std::size_t>(vertices[i]);
    number[v] = static_cast<int>(i);
    const bool again = i > 0 && place_of(vertices[i]) == place_of(vertices[i - 1]);
    rank[v] = again ? rank[static_cast<std::size_t>(vertices[i - 1])] : number[v];
    result.mesh.vertices.row(static_cast<Eigen::Index>(i)) = mesh.vertices.row(vertices[i]);
  }

  struct Face {
    double height;
    std::array<int, 3> ranks, corners;
    int number;
  };
  std::vector<Face> faces;
  for (int f = 0; f < mesh.faces.rows(); ++f) {
    Face best{};
    for (int first = 0; first < 3; ++first) {
      Face turned{face_heights[f], {}, {}, f};
      for (int k = 0; k < 3; ++k) {
        const auto v = static_cast<std::size_t>(mesh.faces(f, (first + k) % 3));
        turned.ranks[static_cast<std::size_t>(k)] = rank[v];
        turned.corners[static_cast<std::size_t>(k)] = number[v];
      }
      if (first == 0 || turned.ranks < best.ranks) best = turned;
    }
    faces.push_back(best);
  }
  std::ranges::stable_sort(
      faces, [](const Face& a, const Face& b) { return std::tie(a.height, a.ranks) < std::tie(b.height, b.ranks); });
  for (std::size_t f = 0; f < faces.size(); ++f) {
    result.face[f] = faces[f].number;
    for (int k = 0; k < 3; ++k) {
      result.mesh.faces(static_cast<Eigen::Index>(f), k) = faces[f].corners[static_cast<std::size_t>(k)];
    }
  }
  return result;
}

}  // namespace orbifit
