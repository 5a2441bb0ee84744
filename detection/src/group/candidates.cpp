#include "group/candidates.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include <Eigen/Geometry>

#include "base/dense.h"
#include "base/random.h"
#include "geometry/sampling.h"

namespace orbifit {

namespace {

using Eigen::Vector3d;

constexpr int kGridCells = 48;
constexpr int kGridPoints = 20000;
constexpr int kCandidateSamples = 220;
constexpr std::size_t kMaxMaxima = 24;
constexpr std::size_t kMaxCorners = 130;
constexpr std::size_t kMaxCornerAxes = 600;

// Lower envelope of parabolas (Felzenszwalb and Huttenlocher 2012): exact squared distances along one line.
void transform_line(std::vector<float>& line, std::vector<float>& out, std::vector<int>& apex,
                    std::vector<float>& border) {
  const int n = static_cast<int>(line.size());
  constexpr float kFar = std::numeric_limits<float>::max();
  int k = -1;
  for (int q = 0; q < n; ++q) {
    if (line[static_cast<std::size_t>(q)] == kFar) continue;
    const auto value = [&](int i) {
      return line[static_cast<std::size_t>(i)] + static_cast<float>(i) * static_cast<float>(i);
    };
    float cross = -kFar;
    while (k >= 0) {
      const int p = apex[static_cast<std::size_t>(k)];
      cross = (value(q) - value(p)) / static_cast<float>(2 * (q - p));
      if (cross > border[static_cast<std::size_t>(k)]) break;
      --k;
      cross = -kFar;
    }
    ++k;
    apex[static_cast<std::size_t>(k)] = q;
    border[static_cast<std::size_t>(k)] = cross;
  }
  if (k < 0) return;
  int at = 0;
  for (int q = 0; q < n; ++q) {
    while (at < k && border[static_cast<std::size_t>(at + 1)] < static_cast<float>(q)) ++at;
    const int p = apex[static_cast<std::size_t>(at)];
    out[static_cast<std::size_t>(q)] = line[static_cast<std::size_t>(p)] + static_cast<float>((q - p) * (q - p));
  }
  line = out;
}

// Share of the samples whose image comes near the surface, falling off linearly with the distance.
class Screen {
 public:
  Screen(const SurfacePatch& patch, const RunContext& context)
      : centre_(patch.moments.centroid),
        grid_(dense_points(patch, context), centre_, 1.05 * patch.moments.radius, kGridCells) {
    const Eigen::Index total = patch.samples.points.rows();
    const Eigen::Index count = std::min<Eigen::Index>(total, kCandidateSamples);
    for (Eigen::Index i = 0; i < count; ++i) {
      points_.emplace_back(patch.samples.points.row(i * total / count).transpose() - centre_);
    }
    width_ = 2.5 * grid_.cell();
  }

  double score(const Eigen::Matrix3d& linear) const {
    double sum = 0;
    for (const Vector3d& point : points_) {
      sum += std::max(0.0, 1 - static_cast<double>(grid_(centre_ + linear * point)) / width_);
    }
    return sum / static_cast<double>(points_.size());
  }

 private:
  static Points dense_points(const SurfacePatch& patch, const RunContext& context) {
    Random random(context.seed, "screen");
    std::vector<int> visible;
    for (const int f : patch.faces) {
      if (patch.prepared->areas[f] > 0) visible.push_back(f);
    }
    const PreparedMesh& prepared = *patch.prepared;
    return sample_surface(prepared.mesh, prepared.areas, prepared.normals, kGridPoints, random, visible).points;
  }

  Vector3d centre_;
  DistanceGrid grid_;
  std::vector<Vector3d> points_;
  double width_ = 0;
};

std::vector<Vector3d> local_maxima(const DirectionSet& set, const std::vector<double>& scores) {
  std::vector<std::pair<double, int>> maxima;
  const double best = *std::ranges::max_element(scores);
  for (std::size_t i = 0; i < scores.size(); ++i) {
    if (scores[i] < 0.5 * best) continue;
    const bool highest = std::ranges::all_of(set.neighbours[i], [&](int j) {
      const double other = scores[static_cast<std::size_t>(j)];
      return other < scores[i] || (other == scores[i] && static_cast<std::size_t>(j) > i);
    });
    if (highest) maxima.emplace_back(-scores[i], static_cast<int>(i));
  }
  std::ranges::sort(maxima);
  if (maxima.size() > kMaxMaxima) maxima.resize(kMaxMaxima);
  std::vector<Vector3d> result;
  for (const auto& [score, i] : maxima) result.push_back(set.directions[static_cast<std::size_t>(i)]);
  return result;
}

// The welded vertices farthest from the centroid; none where they are too many to tell apart.
std::vector<Vector3d> farthest_vertices(const SurfacePatch& patch) {
  const PreparedMesh& prepared = *patch.prepared;
  std::vector<int> groups;
  for (const int f : patch.faces) {
    for (int k = 0; k < 3; ++k) {
      const int vertex = prepared.mesh.faces(f, k);
      const double radius = (prepared.mesh.vertices.row(vertex).transpose() - patch.moments.centroid).norm();
      if (radius < patch.moments.radius - 0.5 * patch.tolerance) continue;
      groups.push_back(prepared.weld.group_of_vertex[static_cast<std::size_t>(vertex)]);
    }
  }
  std::ranges::sort(groups);
  groups.erase(std::unique(groups.begin(), groups.end()), groups.end());
  if (groups.size() > kMaxCorners) return {};
  std::vector<Vector3d> result;
  for (const int g : groups) {
    const int vertex = prepared.weld.representative[static_cast<std::size_t>(g)];
    result.emplace_back(prepared.mesh.vertices.row(vertex).transpose() - patch.moments.centroid);
  }
  return result;
}

void add_corner_directions(const SurfacePatch& patch, CandidateDirections& result) {
  const std::vector<Vector3d> corners = farthest_vertices(patch);
  const double least = 0.05 * patch.moments.radius;
  const auto add = [&](std::vector<Vector3d>& list, const Vector3d& v) {
    if (v.norm() < least) return;
    const Vector3d unit = v.normalized();
    const bool known =
        std::ranges::any_of(list, [&](const Vector3d& other) { return other.cross(unit).norm() < 0.01; });
    if (!known) list.push_back(unit);
  };
  // An element moves a corner or leaves it in place; two anchors meet both cases.
  for (std::size_t a = 0; a < corners.size() && a < 2; ++a) {
    add(result.corner_axes, corners[a]);
    for (std::size_t b = 0; b < corners.size(); ++b) {
      add(result.corner_mirrors, corners[a] - corners[b]);
      if (a != b) add(result.corner_axes, corners[a] + corners[b]);
    }
    for (std::size_t b = 0; b < corners.size(); ++b) {
      for (std::size_t c = 0; c < corners.size() && result.corner_axes.size() < kMaxCornerAxes; ++c) {
        const double first = (corners[b] - corners[a]).norm();
        const double second = (corners[c] - corners[b]).norm();
        if (a == b || b == c || a == c || std::abs(first - second) > patch.tolerance) continue;
        add(result.corner_axes, (corners[b] - corners[a]).cross(corners[c] - corners[b]) / patch.moments.radius);
      }
    }
  }
}

}  // namespace

DistanceGrid::DistanceGrid(const Points& points, const Vector3d& centre, double reach, int cells)
    : cells_(cells), cell_(2 * reach / cells), corner_(centre - Vector3d::Constant(reach)) {
  const auto n = static_cast<std::size_t>(cells);
  constexpr float kFar = std::numeric_limits<float>::max();
  distance_.assign(n * n * n, kFar);
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    std::array<std::size_t, 3> at{};
    for (int k = 0; k < 3; ++k) {
      const int cell = static_cast<int>((points(i, k) - corner_[k]) / cell_);
      at[static_cast<std::size_t>(k)] = static_cast<std::size_t>(std::clamp(cell, 0, cells - 1));
    }
    distance_[(at[0] * n + at[1]) * n + at[2]] = 0;
  }
  std::vector<float> line(n);
  std::vector<float> out(n, kFar);
  std::vector<int> apex(n);
  std::vector<float> border(n);
  const std::array<std::size_t, 3> strides{n * n, n, 1};
  for (int axis = 0; axis < 3; ++axis) {
    const std::size_t stride = strides[static_cast<std::size_t>(axis)];
    const std::size_t u = strides[static_cast<std::size_t>((axis + 1) % 3)];
    const std::size_t v = strides[static_cast<std::size_t>((axis + 2) % 3)];
    for (std::size_t a = 0; a < n; ++a) {
      for (std::size_t b = 0; b < n; ++b) {
        const std::size_t start = a * u + b * v;
        for (std::size_t i = 0; i < n; ++i) line[i] = distance_[start + i * stride];
        transform_line(line, out, apex, border);
        for (std::size_t i = 0; i < n; ++i) distance_[start + i * stride] = line[i];
      }
    }
  }
  for (float& square : distance_) square = std::sqrt(square) * static_cast<float>(cell_);
}

float DistanceGrid::operator()(const Vector3d& point) const {
  std::size_t at = 0;
  for (int k = 0; k < 3; ++k) {
    const int cell = static_cast<int>((point[k] - corner_[k]) / cell_);
    at = at * static_cast<std::size_t>(cells_) + static_cast<std::size_t>(std::clamp(cell, 0, cells_ - 1));
  }
  return distance_[at];
}

DirectionSet hemisphere_directions(int count) {
  DirectionSet result;
  for (int i = 0; i < count; ++i) {  // a Fibonacci spiral
    const double z = (i + 0.5) / count;
    const double angle = 2 * std::numbers::pi * i / std::numbers::phi;
    const double radius = std::sqrt(1 - z * z);
    result.directions.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
  }
  result.spacing = std::sqrt(2 * std::numbers::pi / count);
  const double cosine = std::cos(1.7 * result.spacing);
  result.neighbours.resize(result.directions.size());
  for (std::size_t i = 0; i < result.directions.size(); ++i) {
    for (std::size_t j = 0; j < result.directions.size(); ++j) {
      if (i != j && std::abs(result.directions[i].dot(result.directions[j])) > cosine) {
        result.neighbours[i].push_back(static_cast<int>(j));
      }
    }
  }
  return result;
}

CandidateDirections find_candidates(const SurfacePatch& patch, const DirectionSet* screen, const RunContext& context) {
  CandidateDirections result;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(patch.moments.covariance);
  const Vector3d values = solver.eigenvalues();
  // The eigenvalue farthest from its neighbours belongs to the main axis of an axial group.
  std::array<int, 3> order{0, 2, 1};
  if (values[2] - values[1] > values[1] - values[0]) order = {2, 0, 1};
  for (const int i : order) {
    result.principal.emplace_back(solver.eigenvectors().col(i));
    result.variances.push_back(values[i]);
  }
  if (screen == nullptr) return result;

  add_corner_directions(patch, result);
  const Screen rough(patch, context);
  const std::size_t count = screen->directions.size();
  std::array<std::vector<double>, 3> scores;
  for (std::vector<double>& list : scores) list.resize(count);
  parallel_for(context, count, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Vector3d& d = screen->directions[i];
      const Eigen::Matrix3d outer = d * d.transpose();
      scores[0][i] = rough.score(Eigen::Matrix3d::Identity() - 2 * outer);
      scores[1][i] = rough.score(2 * outer - Eigen::Matrix3d::Identity());
      scores[2][i] = rough.score(axis_rotation(d, 2 * std::numbers::pi / 3));
    }
  });
  result.mirrors = local_maxima(*screen, scores[0]);
  result.twofold = local_maxima(*screen, scores[1]);
  result.threefold = local_maxima(*screen, scores[2]);
  return result;
}

}  // namespace orbifit
