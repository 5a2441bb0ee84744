#include "surface/surface_ends.h"

#include <algorithm>
#include <cstddef>

#include "geometry/topology.h"
#include "surface/thresholds.h"

namespace orbifit {

namespace {

// Whether nearly all of the surface hangs together.
bool nearly_one(const PreparedMesh& prepared) {
  const double most = kOneSurface * prepared.area;
  return std::ranges::any_of(prepared.components.faces,
                             [&](const std::vector<int>& faces) { return area_of(prepared, faces) > most; });
}

}  // namespace

std::shared_ptr<const SurfaceIndex> end_edges(const PreparedMesh& prepared) {
  std::vector<Edge> edges = welded_edges(prepared.mesh, prepared.weld);
  std::erase_if(edges, [](const Edge& edge) { return edge.faces.size() != 1; });
  if (edges.empty() || !nearly_one(prepared)) return nullptr;
  Mesh lines;
  lines.vertices = prepared.mesh.vertices;
  lines.faces.resize(static_cast<Eigen::Index>(edges.size()), 3);
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const auto end = [&](std::size_t k) {
      return prepared.weld.representative[static_cast<std::size_t>(edges[e].vertices[k])];
    };
    lines.faces.row(static_cast<Eigen::Index>(e)) << end(0), end(1), end(1);
  }
  return std::make_shared<const SurfaceIndex>(lines);
}

SurfaceEnds::SurfaceEnds(const PreparedMesh& prepared, double tolerance)
    : tolerance_(tolerance), edges_(prepared.ends) {}

bool SurfaceEnds::taken_near(const Eigen::Vector3d& point, const std::vector<Motion>& motions) const {
  return edges_ && std::ranges::any_of(motions, [&](const Motion& motion) { return near(motion(point)); });
}

bool SurfaceEnds::past_broken_end(const Eigen::Vector3d& point, const SurfaceIndex& whole,
                                  const std::vector<Motion>& motions) const {
  if (!edges_) return false;
  const SurfaceIndex::Nearest end = edges_->nearest(point, whole.nearest(point).distance + kWeldTolerance);
  return end.face >= 0 && std::ranges::any_of(motions, [&](const Motion& motion) { return !near(motion(end.point)); });
}

bool SurfaceEnds::near(const Eigen::Vector3d& point) const {
  return edges_->within(point, kAboutBorder * tolerance_);
}

}  // namespace orbifit
