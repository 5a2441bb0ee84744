#include "solver/silhouette_pulls.h"

#include <algorithm>

#include "base/random.h"
#include "geometry/surface_index.h"

namespace orbifit {

namespace {

constexpr int kSilhouetteSamples = 1500;
constexpr double kSeenReach = 0.012;     // of the diagonal: nearer to a point of the scan a sample is seen
constexpr double kFarthest = 0.15;       // of the diagonal: what is pulled
constexpr double kMinSeenRobust = 0.03;  // of the diagonal: what was seen through may be far from anything
constexpr double kWeight = 2;            // there are fewer samples than points of the scan

}  // namespace

SilhouettePulls::SilhouettePulls(const Mesh& mesh, const PointCloud& cloud, const PreparedScan& scan,
                                 const RunContext& context)
    : size_(diagonal(mesh.vertices)), spacing_(scan.spacing), seen_(cloud, scan.points) {
  Random random(context.seed, "silhouette");
  const SurfaceSamples samples = sample_surface(mesh, kSilhouetteSamples, random);
  faces_ = samples.faces;
  for (Eigen::Index i = 0; i < samples.points.rows(); ++i) {
    const auto corner = [&](int k) -> Eigen::Vector3d {
      return mesh.vertices.row(mesh.faces(faces_[static_cast<std::size_t>(i)], k));
    };
    barycentric_.push_back(nearest_on_triangle(samples.points.row(i), corner(0), corner(1), corner(2)));
  }
}

SurfaceSamples SilhouettePulls::samples_on(const Mesh& deformed, const MovingSurface& surface) const {
  SurfaceSamples samples;
  samples.points.resize(static_cast<Eigen::Index>(faces_.size()), 3);
  samples.normals.resize(samples.points.rows(), 3);
  samples.faces = faces_;
  for (Eigen::Index i = 0; i < samples.points.rows(); ++i) {
    const auto s = static_cast<std::size_t>(i);
    samples.points.row(i) = barycentric_[s].transpose() * deformed.vertices(deformed.faces.row(faces_[s]), Eigen::all);
    samples.normals.row(i) = surface.normal(faces_[s]).transpose();
  }
  return samples;
}

SeenSurface::Look SilhouettePulls::look(const SurfaceSamples& samples, const MovingSurface& surface,
                                        const Similarity& pose, const RunContext& context) const {
  const double reach = std::max(kSeenReach * size_ * pose.scale, 1.5 * spacing_);
  return seen_.look(samples, surface, pose, reach, context);
}

bool SilhouettePulls::cut_off(const Mesh& deformed, const MovingSurface& surface, const Similarity& pose,
                              const RunContext& context) const {
  const SeenSurface::Look found = look(samples_on(deformed, surface), surface, pose, context);
  const auto nothing = std::ranges::count(found.missed, false, &SeenSurface::Missed::through);
  return static_cast<double>(nothing) > SeenSurface::kCutOff * found.seen;
}

double SilhouettePulls::add(const Mesh& deformed, const MovingSurface& surface, const Points& points,
                            const Similarity& pose, double robust, std::vector<Correspondence>& pairs,
                            const RunContext& context) const {
  const SurfaceSamples samples = samples_on(deformed, surface);
  const double scale = std::max(robust, kMinSeenRobust * size_);
  double error = 0;
  for (const SeenSurface::Missed& each : look(samples, surface, pose, context).missed) {
    const auto s = static_cast<std::size_t>(each.sample);
    const Eigen::Vector3d offset = (points.row(each.point) - samples.points.row(each.sample)).transpose();
    const double distance = offset.norm();
    if (!(distance > 0) || distance > kFarthest * size_) continue;
    Correspondence pair;
    pair.scan_point = each.point;
    pair.face = faces_[s];
    pair.barycentric = barycentric_[s];
    pair.normal = offset / distance;
    pair.distance = distance;
    pair.weight = kWeight * robust_weight(distance, scale);
    pairs.push_back(pair);
    error += kWeight * robust_error(distance, scale);
  }
  return error;
}

}  // namespace orbifit
