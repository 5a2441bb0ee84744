#include "remeshing/remesh.h"

#include <array>
#include <cmath>
#include <string>

#include "orbifit/model/errors.h"

#include "base/random.h"
#include "geometry/surface_index.h"
#include "remeshing/closed_parts.h"
#include "remeshing/dual_contour.h"
#include "remeshing/surface_fit.h"
#include "remeshing/union_scan.h"

namespace orbifit {

namespace {

using Eigen::Index;
using Eigen::Vector3d;

// Cosine between a new face and the old one that it stands for; where there is none, the nearest counts.
constexpr double kSameWay = 0.8;
constexpr double kSimilarWay = 0.3;

// A frame in which the grid's nodes are at whole numbers.
struct GridFrame {
  Eigen::Matrix3d rotation;
  Vector3d corner;
  double cell;
  std::array<int, 3> nodes;

  Points to_grid(const Points& world) const {
    return ((world * rotation.transpose()).rowwise() - corner.transpose()) / cell;
  }
  Points to_world(const Points& grid) const { return ((cell * grid).rowwise() + corner.transpose()) * rotation; }
};

GridFrame random_grid(const Points& vertices, double cell, std::uint64_t seed) {
  Random random(seed, "remesh");
  GridFrame frame{random.rotation(), Vector3d::Zero(), cell, {}};
  const Points turned = vertices * frame.rotation.transpose();
  const Vector3d low = turned.colwise().minCoeff();
  const Vector3d high = turned.colwise().maxCoeff();
  for (Index k = 0; k < 3; ++k) {
    // A layer of outer cells all around.
    frame.corner[k] = low[k] - cell * random.uniform(1.1, 2.1);
    frame.nodes[static_cast<std::size_t>(k)] = static_cast<int>(std::ceil((high[k] - frame.corner[k]) / cell)) + 3;
  }
  return frame;
}

std::vector<int> nearest_faces(const Mesh& mesh, const SurfaceIndex& target, RunContext& context) {
  const Points normals = face_normals(mesh);
  std::vector<int> result(static_cast<std::size_t>(mesh.faces.rows()));
  parallel_for(context, result.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      const auto row = static_cast<Index>(f);
      const Vector3d middle = (mesh.vertices.row(mesh.faces(row, 0)) + mesh.vertices.row(mesh.faces(row, 1)) +
                               mesh.vertices.row(mesh.faces(row, 2))) /
                              3;
      const Vector3d normal = normals.row(row);
      SurfaceIndex::Nearest nearest = target.nearest_facing(middle, normal, kSameWay, 1);
      if (nearest.face < 0) nearest = target.nearest_facing(middle, normal, kSimilarWay, 2);
      if (nearest.face < 0) nearest = target.nearest(middle);
      result[f] = nearest.face;
    }
  });
  return result;
}

}  // namespace

void RemeshOptions::validate() const {
  if (!(cell >= 1.0 / 600 && cell <= 0.1)) {
    throw UsageError("remesh: cell is " + std::to_string(cell) + "; it must be in [1/600, 1/10] of the diagonal");
  }
  if (fitting_passes < 0 || fitting_passes > 20) {
    throw UsageError("remesh: fitting_passes is " + std::to_string(fitting_passes) + "; it must be in [0, 20]");
  }
}

Remeshed remesh(const Mesh& mesh, const RemeshOptions& options, RunContext& context) {
  options.validate();
  ClosedParts parts = closed_parts(mesh);
  const GridFrame frame = random_grid(parts.mesh.vertices, options.cell * diagonal(mesh.vertices), context.seed);
  parts.mesh.vertices = frame.to_grid(parts.mesh.vertices);
  const UnionScan scan(parts, parts.mesh.vertices, frame.nodes, context);

  std::vector<int> outer;
  for (int f = 0; f < parts.mesh.faces.rows(); ++f) {
    if (scan.turned()[static_cast<std::size_t>(f)]) std::swap(parts.mesh.faces(f, 1), parts.mesh.faces(f, 2));
    if (!scan.hidden()[static_cast<std::size_t>(f)]) outer.push_back(f);
  }
  const SurfaceIndex target(parts.mesh, outer);
  const Points normals = face_normals(parts.mesh);

  Remeshed result;
  const DualSurface surface = dual_contour(scan, normals, context);
  if (surface.quads.empty()) throw NoResultError("remesh: every part is thinner than a cell");
  result.mesh = fitted_triangles(surface, target, normals, options.fitting_passes, context);
  result.source_face = nearest_faces(result.mesh, target, context);
  for (int& face : result.source_face) face = parts.source_face[static_cast<std::size_t>(face)];
  result.mesh.vertices = frame.to_world(result.mesh.vertices);
  return result;
}

}  // namespace orbifit
