#include "deformation/surface_detail.h"

#include <utility>

#include "basis/subspace_parts.h"

namespace orbifit {

namespace {

constexpr double kAsNear = 1e-9;  // of the diagonal: many times rounding, and far below what a shape has of its own

}  // namespace

SurfaceVectors::SurfaceVectors(const Mesh& mesh)
    : surface_(mesh), faces_(mesh.faces), alike_(kAsNear * diagonal(mesh.vertices)) {}

void SurfaceVectors::parts_at(const Eigen::Vector3d& point, std::vector<Part>& parts) const {
  parts.clear();
  const double nearest = surface_.nearest(point).distance;
  const std::vector<SurfaceIndex::Nearest> faces = surface_.all_within(point, nearest + alike_);
  for (const SurfaceIndex::Nearest& each : faces) {
    for (int k = 0; k < 3; ++k) {
      const double weight = each.barycentric[k] / static_cast<double>(faces.size());
      if (weight != 0) parts.push_back({faces_(each.face, k), weight});
    }
  }
}

DetailMap detail_map(const Subspace& subspace, const SubspaceState& state, const SurfaceVectors& surface,
                     const Points& directions, const RunContext& context) {
  const VertexOrbits& orbits = subspace->orbits;
  const std::vector<Transport>& words = basis_of(subspace, state).transports.words;
  const auto count = static_cast<std::size_t>(orbits.representatives());
  std::vector<std::vector<DetailMap::Part>> found(count);
  parallel_for(context, count, [&](std::size_t begin, std::size_t end) {
    std::vector<SurfaceVectors::Part> parts;
    for (std::size_t r = begin; r < end; ++r) {
      if (r % 256 == 0) context.check();
      const Eigen::Vector3d start = orbits.positions.row(static_cast<Eigen::Index>(r)).transpose();
      const double share = 1 / static_cast<double>(orbits.first_point[r + 1] - orbits.first_point[r]);
      for (auto k = orbits.first_point[r]; k < orbits.first_point[r + 1]; ++k) {
        const int word = orbits.point_words[static_cast<std::size_t>(k)];
        const Eigen::Matrix3d back = words[static_cast<std::size_t>(word)].frame.transpose();
        surface.parts_at(subspace->words->motion(word)(start), parts);
        for (const auto& [vertex, weight] : parts) {
          found[r].push_back({orbits.followers[static_cast<std::size_t>(vertex)].representative,
                              share * weight * (back * directions.row(vertex).transpose())});
        }
      }
    }
  });
  DetailMap map;
  map.first.push_back(0);
  for (const std::vector<DetailMap::Part>& parts : found) {
    map.parts.insert(map.parts.end(), parts.begin(), parts.end());
    map.first.push_back(static_cast<std::int64_t>(map.parts.size()));
  }
  return map;
}

std::shared_ptr<const SurfaceDetail> surface_detail(const Subspace& subspace,
                                                    std::shared_ptr<const SurfaceVectors> surface, const DetailMap& map,
                                                    const Points& directions, const Eigen::VectorXd& heights) {
  SurfaceDetail detail{std::move(surface), directions, Points::Zero(heights.size(), 3)};
  for (Eigen::Index v = 0; v < directions.rows(); ++v) {
    detail.vectors.row(v) *= heights[subspace->orbits.followers[static_cast<std::size_t>(v)].representative];
  }
  for (std::size_t r = 0; r + 1 < map.first.size(); ++r) {
    for (auto k = map.first[r]; k < map.first[r + 1]; ++k) {
      const DetailMap::Part& part = map.parts[static_cast<std::size_t>(k)];
      detail.of_representatives.row(static_cast<Eigen::Index>(r)) +=
          heights[part.representative] * part.direction.transpose();
    }
  }
  return std::make_shared<const SurfaceDetail>(std::move(detail));
}

}  // namespace orbifit
