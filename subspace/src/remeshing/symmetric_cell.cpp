#include "remeshing/symmetric_cell.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "orbifit/model/errors.h"

#include "geometry/surface_index.h"
#include "remeshing/clipped_surface.h"
#include "remeshing/fundamental_domain.h"
#include "remeshing/seams.h"

namespace orbifit {

namespace {

using Eigen::Vector3d;

constexpr double kRounding = 1e-10;     // of the diagonal
constexpr double kSameDistance = 0.01;  // of the reach: domains whose images are as near as that are equally good
constexpr std::size_t kMeasuredPoints = 4000;  // images of a domain's points, by which domains are compared

struct SewnDomain {
  ClippedSurface surface;
  Seams seams;
  int faults = std::numeric_limits<int>::max();
  double distance = std::numeric_limits<double>::infinity();  // rms of images to the surface, in kSameDistance

  // Of equally good ones that of fewest triangles: fans and strips are cut into the fewest slivers.
  bool operator<(const SewnDomain& other) const {
    const auto key = [](const SewnDomain& one) {
      return std::tuple(one.faults, std::floor(one.distance), one.surface.triangles.size());
    };
    return key(*this) < key(other);
  }
};

Mesh mesh_of(const CellSurface& cell) {
  Mesh mesh;
  mesh.vertices.resize(static_cast<Eigen::Index>(cell.points.size()), 3);
  mesh.faces.resize(static_cast<Eigen::Index>(cell.triangles.size()), 3);
  for (std::size_t v = 0; v < cell.points.size(); ++v) {
    mesh.vertices.row(static_cast<Eigen::Index>(v)) = cell.points[v].transpose();
  }
  for (std::size_t t = 0; t < cell.triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      mesh.faces(static_cast<Eigen::Index>(t), k) = cell.triangles[t][static_cast<std::size_t>(k)];
    }
  }
  return mesh;
}

double image_distance(const ClippedSurface& surface, const FiniteGroup& group, const SurfaceIndex& index) {
  std::vector<char> used(surface.points.size(), 0);
  for (const auto& corners : surface.triangles) {
    for (const int corner : corners) used[static_cast<std::size_t>(corner)] = 1;
  }
  std::vector<Vector3d> points;
  for (std::size_t v = 0; v < used.size(); ++v) {
    if (used[v] != 0) points.push_back(surface.points[v]);
  }
  const std::size_t all = points.size() * group.elements.size();
  const std::size_t step = all / kMeasuredPoints + 1;
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < all; i += step) {
    const Vector3d image = group.elements[i % group.elements.size()](points[i / group.elements.size()]);
    const double distance = index.nearest(image).distance;
    sum += distance * distance;
    ++count;
  }
  return count == 0 ? std::numeric_limits<double>::infinity() : std::sqrt(sum / static_cast<double>(count));
}

}  // namespace

GluedImages symmetric_cell(const CellSurface& cell, const FiniteGroup& group, const CellCut& cut,
                           const RunContext& context) {
  ClippedSurface whole{cell.points,
                       std::vector<std::uint64_t>(cell.points.size(), 0),
                       std::vector<char>(cell.points.size(), 0),
                       cell.triangles,
                       cell.sources,
                       {}};
  const SurfaceIndex index(mesh_of(cell));
  SewnDomain best;
  const std::vector<FundamentalDomain> domains = candidate_domains(group);
  for (std::size_t d = 0; d < domains.size(); ++d) {
    context.progress("domains", static_cast<double>(d) / static_cast<double>(domains.size()));
    if (domains[d].walls.size() >= kMaxWalls) continue;
    SewnDomain sewn;
    sewn.surface = whole;
    clip(sewn.surface, domains[d], {cut.snap, cut.reach / 2, kRounding * cut.diagonal});
    if (sewn.surface.triangles.empty()) continue;
    sewn.seams = sew(sewn.surface, group, domains[d], cut.snap, cut.reach);
    sewn.faults = sewn.seams.unmatched + glued_images(sewn.surface, group, sewn.seams, cut.reach).contradictions;
    if (sewn.faults > best.faults) continue;
    sewn.distance = image_distance(sewn.surface, group, index) / (kSameDistance * cut.reach);
    if (sewn < best) best = std::move(sewn);
  }
  if (best.faults > 0) {
    throw NoResultError("the surface's sides cannot be welded: " +
                        (best.surface.triangles.empty() ? std::string("no part of it is in a domain of the group")
                                                        : std::to_string(best.faults) + " curves have no counterpart"));
  }
  return glued_images(best.surface, group, best.seams, cut.reach);
}

}  // namespace orbifit
