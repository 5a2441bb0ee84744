#include "surface_average.h"

#include "orbifit/subspace/orbit.h"

namespace orbifit {

namespace {

constexpr double kOneVertex = 1e-9;  // of the diagonal
// Cosine between the normals of a vertex and of a face: only the back of a thin part has less.
constexpr double kSameSide = -0.5;
constexpr int kMostPoints = 1000;

}  // namespace

SurfaceAverage::SurfaceAverage(const Mesh& mesh, const SymmetryAnnotation& annotation, double reach,
                               const RunContext& context)
    : regions_(mesh, annotation, context), reach_(reach), doublet_(kOneVertex * diagonal(mesh.vertices)) {
  for (const Region& region : annotation.regions) {
    surfaces_.emplace_back(mesh, region.faces);
    sizes_.push_back(region.faces.size());
  }
}

Eigen::Vector3d SurfaceAverage::operator()(const Eigen::Vector3d& point, const Eigen::Vector3d& normal,
                                           int face) const {
  ClosureOptions options;
  GroupWords words(regions_, false);
  options.doublet = doublet_;
  options.most_points = kMostPoints;
  const Orbit orbit = orbit_of(point, regions_.set_of_face(face), regions_, words, options);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  int count = 0;
  for (const OrbitPoint& image : orbit.points) {
    const std::vector<int>& places = regions_.set_places(image.set);
    if (places.empty()) continue;
    const Motion motion = words.motion(image.word) * inverse(orbit.turn);
    // The smallest region that holds the image: no other part can be mistaken for it.
    std::size_t smallest = static_cast<std::size_t>(places.front());
    for (const int region : places) {
      const auto number = static_cast<std::size_t>(region);
      if (sizes_[number] < sizes_[smallest]) smallest = number;
    }
    const SurfaceIndex& surface = surfaces_[smallest];
    SurfaceIndex::Nearest nearest;
    if (normal.squaredNorm() > 0) {
      nearest = surface.nearest_facing(image.position, motion.linear * normal, kSameSide, reach_);
    }
    if (nearest.face < 0) nearest = surface.nearest(image.position, reach_);
    if (nearest.face < 0) continue;
    sum += inverse(motion)(nearest.point);
    ++count;
  }
  return count > 0 ? Eigen::Vector3d(sum / count) : point;
}

}  // namespace orbifit
