#include "measures/region_surface.h"

#include <algorithm>
#include <cmath>

#include "geometry/surface_index.h"

namespace orbifit {

namespace {

// A point whose nearest face looks this much the other way is taken to be on the wrong side of a thin part.
constexpr double kOtherSide = -0.2;
constexpr double kSameSide = 0.2;
// Vertices that are nearer to one another than this share of the reach are at one place, and their normals tell them
// apart; else the nearer one is meant.
constexpr double kOnePlace = 1e-3;
// How much further away, as a multiple of the reach, the side that faces the right way may be.
constexpr double kThinness = 1e4;

}  // namespace

Eigen::Vector3d SurfacePlace::operator()(const Mesh& mesh) const {
  if (vertex >= 0) return mesh.vertices.row(vertex);
  return (1 - weights.sum()) * mesh.vertices.row(mesh.faces(face, 0)) +
         weights[0] * mesh.vertices.row(mesh.faces(face, 1)) + weights[1] * mesh.vertices.row(mesh.faces(face, 2));
}

RegionSurface::RegionSurface(const Mesh& mesh, const std::vector<int>& faces, double reach)
    : mesh_(mesh),
      faces_(faces),
      reach_(reach),
      patch_(submesh(mesh, faces, &vertices_)),
      normals_(vertex_normals(patch_)),
      finder_(patch_.vertices, reach) {
  finder_.prepare_walks();
}

int RegionSurface::vertex_at(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) const {
  const int lone = finder_.at(point);
  if (lone != VertexFinder::kSeveral) return lone;
  struct Candidate {
    int vertex;
    double distance;
  };
  std::vector<Candidate> near;
  double least = reach_;
  finder_.grid().visit(point, [&](int vertex) {
    const double distance = (patch_.vertices.row(vertex).transpose() - point).norm();
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
