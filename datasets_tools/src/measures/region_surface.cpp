#include "measures/region_surface.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "geometry/surface_index.h"

namespace orbifit {

namespace {

// A point whose nearest face looks this much the other way is taken to be on the wrong side of a thin part.
constexpr double kOtherSide = -0.2;
constexpr double kSameSide = 0.2;
// Width of the cells in which vertices are looked for, in reaches: most points have all that is in reach in one of
// them.
constexpr double kCell = 32;
// Vertices that are nearer to one another than this share of the reach are at one place, and their normals tell them
// apart; else the nearer one is meant.
constexpr double kOnePlace = 1e-3;
// How much further away, as a multiple of the reach, the side that faces the right way may be.
constexpr double kThinness = 1e4;

std::uint64_t mixed(std::int64_t key) {
  std::uint64_t value = static_cast<std::uint64_t>(key) * 0x9E3779B97F4A7C15ULL;
  value ^= value >> 29;
  value *= 0xBF58476D1CE4E5B9ULL;
  return value ^ (value >> 32);
}

}  // namespace

Eigen::Vector3d SurfacePlace::operator()(const Mesh& mesh) const {
  if (vertex >= 0) return mesh.vertices.row(vertex);
  return (1 - weights.sum()) * mesh.vertices.row(mesh.faces(face, 0)) +
         weights[0] * mesh.vertices.row(mesh.faces(face, 1)) + weights[1] * mesh.vertices.row(mesh.faces(face, 2));
}

RegionSurface::RegionSurface(const Mesh& mesh, const std::vector<int>& faces, double reach)
    : mesh_(mesh), faces_(faces), reach_(reach), cell_size_(kCell * reach) {
  patch_ = submesh(mesh, faces, &vertices_);
  normals_ = vertex_normals(patch_);
  origin_ = bounding_box_centre(patch_.vertices);
  const std::size_t count = vertices_.size();
  std::size_t slots = 16;
  while (slots < 2 * count) slots *= 2;
  std::vector<std::int64_t> keys(count);
  first_of_slot_.assign(slots + 1, 0);
  const auto slot_of = [&](std::int64_t key) { return mixed(key) & (slots - 1); };
  for (std::size_t v = 0; v < count; ++v) {
    const Eigen::Vector3d point = patch_.vertices.row(static_cast<Eigen::Index>(v));
    keys[v] = key_of(((point - origin_) / cell_size_).array().floor().matrix());
    ++first_of_slot_[slot_of(keys[v]) + 1];
  }
  for (std::size_t s = 0; s < slots; ++s) first_of_slot_[s + 1] += first_of_slot_[s];
  std::vector<int> next(first_of_slot_.begin(), first_of_slot_.end() - 1);
  cells_.resize(count);
  for (std::size_t v = 0; v < count; ++v) {
    cells_[static_cast<std::size_t>(next[slot_of(keys[v])]++)] = {keys[v], static_cast<int>(v)};
  }
}

std::int64_t RegionSurface::key_of(const Eigen::Vector3d& cell) const {
  // 21 bits a coordinate: cells of 3.2e-5 diagonals about the middle need 15.
  const auto bits = [](double value) { return static_cast<std::int64_t>(value) & 0x1FFFFF; };
  return bits(cell.x()) | (bits(cell.y()) << 21) | (bits(cell.z()) << 42);
}

// Calls visit(vertex, distance) for each vertex within reach.
template <class Visit>
void RegionSurface::visit_near(const Eigen::Vector3d& point, const Visit& visit) const {
  const Eigen::Vector3d low = ((point - origin_).array() - reach_) / cell_size_;
  const Eigen::Vector3d high = ((point - origin_).array() + reach_) / cell_size_;
  const Eigen::Vector3d first = low.array().floor();
  const Eigen::Vector3d last = high.array().floor();
  const std::size_t slots = first_of_slot_.size() - 1;
  for (double x = first.x(); x <= last.x(); ++x) {
    for (double y = first.y(); y <= last.y(); ++y) {
      for (double z = first.z(); z <= last.z(); ++z) {
        const std::int64_t key = key_of({x, y, z});
        const std::size_t slot = mixed(key) & (slots - 1);
        for (int i = first_of_slot_[slot]; i < first_of_slot_[slot + 1]; ++i) {
          const Cell& cell = cells_[static_cast<std::size_t>(i)];
          if (cell.key != key) continue;
          const double distance = (patch_.vertices.row(cell.vertex).transpose() - point).norm();
          if (!(distance > reach_)) visit(cell.vertex, distance);
        }
      }
    }
  }
}

int RegionSurface::lone_vertex_at(const Eigen::Vector3d& point) const {
  int result = kNone;
  visit_near(point, [&](int vertex, double) { result = result == kNone ? vertex : kSeveral; });
  return result;
}

int RegionSurface::vertex_at(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) const {
  const int lone = lone_vertex_at(point);
  if (lone != kSeveral) return lone;
  struct Candidate {
    int vertex;
    double distance;
  };
  std::vector<Candidate> near;
  double least = reach_;
  visit_near(point, [&](int vertex, double distance) {
    near.push_back({vertex, distance});
    least = std::min(least, distance);
  });
  int best = -1;
  double best_agreement = 0;
  double best_distance = 0;
  for (const Candidate& candidate : near) {
    if (candidate.distance > least + kOnePlace * reach_) continue;
    const double agreement = normals_.row(candidate.vertex).dot(normal);
    const bool tie = best >= 0 && std::abs(agreement - best_agreement) < 1e-9;
    const bool better =
        tie ? candidate.distance < best_distance || (candidate.distance == best_distance && candidate.vertex < best)
            : best < 0 || agreement > best_agreement;
    if (!better) continue;
    best = candidate.vertex;
    best_agreement = agreement;
    best_distance = candidate.distance;
  }
  return best;
}

std::vector<SurfacePlace> RegionSurface::places(const Points& points, const Points& normals,
                                                const RunContext& context) const {
  const std::size_t count = static_cast<std::size_t>(points.rows());
  std::vector<SurfacePlace> result(count);
  parallel_for(context, count, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Eigen::Index row = static_cast<Eigen::Index>(i);
      const int vertex = vertex_at(points.row(row), normals.row(row));
      if (vertex >= 0) result[i].vertex = vertices_[static_cast<std::size_t>(vertex)];
    }
  });
  std::vector<std::size_t> missed;
  for (std::size_t i = 0; i < count; ++i) {
    if (result[i].vertex < 0) missed.push_back(i);
  }
  if (missed.empty()) return result;
  const SurfaceIndex surface(patch_);
  const Points facing_of = face_normals(patch_);
  parallel_for(context, missed.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Eigen::Index row = static_cast<Eigen::Index>(missed[i]);
      const Eigen::Vector3d point = points.row(row);
      const Eigen::Vector3d normal = normals.row(row);
      SurfaceIndex::Nearest nearest = surface.nearest(point);
      if (facing_of.row(nearest.face).dot(normal) < kOtherSide) {
        const SurfaceIndex::Nearest facing =
            surface.nearest_facing(point, normal, kSameSide, nearest.distance + kThinness * reach_);
        if (facing.face >= 0) nearest = facing;
      }
      result[missed[i]] = {-1, faces_[static_cast<std::size_t>(nearest.face)], nearest.barycentric.tail<2>()};
    }
  });
  return result;
}

Eigen::Vector3d RegionSurface::normal_at(const SurfacePlace& place) const {
  if (place.vertex < 0) return face_normal(mesh_, place.face);
  return normals_.row(std::ranges::lower_bound(vertices_, place.vertex) - vertices_.begin());
}

}  // namespace orbifit
