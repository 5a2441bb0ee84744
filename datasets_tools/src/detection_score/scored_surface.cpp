#include "detection_score/scored_surface.h"

#include <algorithm>

#include "detection_score/crease_index.h"

namespace orbifit::scoring {

namespace {

using Eigen::Vector3d;

constexpr std::size_t kSharePerThread = 256;  // samples
constexpr int kInstanceSamples = 300;

double longest_edge(const Mesh& mesh, int face) {
  double longest = 0;
  for (int k = 0; k < 3; ++k) {
    const auto edge = mesh.vertices.row(mesh.faces(face, (k + 1) % 3)) - mesh.vertices.row(mesh.faces(face, k));
    longest = std::max(longest, edge.norm());
  }
  return longest;
}

}  // namespace

ScoredSurface::ScoredSurface(const MeasuredMesh& measured, const std::vector<int>& faces, double tolerance)
    : measured_(&measured), tolerance_(tolerance) {
  for (const int face : faces) {
    if (measured.areas[face] > 0) faces_.push_back(face);
  }
  if (!faces_.empty()) index_.emplace(measured.mesh, faces_);
}

ScoreSamples ScoredSurface::sample(int count, Random& random, const RunContext& context) const {
  ScoreSamples samples{sample_surface(measured_->mesh, count, random, faces_), {}};
  const CreaseIndex creases(measured_->mesh, measured_->normals, faces_);
  samples.at_crease.resize(samples.surface.faces.size());
  parallel_for(
      context, samples.at_crease.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t s = begin; s < end; ++s) {
          const auto row = static_cast<Eigen::Index>(s);
          const double length = longest_edge(measured_->mesh, samples.surface.faces[s]);
          const double reach = std::clamp(length, tolerance_, 3 * tolerance_);
          samples.at_crease[s] = creases.turned_away(samples.surface.points.row(row), samples.surface.normals.row(row),
                                                     kNormalCosine, reach)
                                     ? 1
                                     : 0;
        }
      },
      kSharePerThread);
  return samples;
}

bool ScoredSurface::holds(const Vector3d& point, const Vector3d& normal, bool free) const {
  if (!index_) return false;
  const auto nearest = free ? index_->nearest(point, tolerance_)
                            : index_->nearest_facing(point, normal, kNormalCosine, tolerance_, true);
  return nearest.face >= 0;
}

double ScoredSurface::fit(const ScoreSamples& samples, const Motion& motion, const RunContext& context) const {
  return fit_under_all(samples, {motion}, context);
}

double ScoredSurface::fit_under_all(const ScoreSamples& samples, const std::vector<Motion>& motions,
                                    const RunContext& context) const {
  const std::size_t count = samples.at_crease.size();
  std::vector<char> kept(count);
  parallel_for(
      context, count,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t s = begin; s < end; ++s) {
          const Vector3d point = samples.surface.points.row(static_cast<Eigen::Index>(s));
          const Vector3d normal = samples.surface.normals.row(static_cast<Eigen::Index>(s));
          kept[s] = std::ranges::all_of(motions, [&](const Motion& motion) {
            return holds(motion(point), motion.linear * normal, samples.at_crease[s] != 0);
          });
        }
      },
      kSharePerThread);
  return count == 0 ? 0 : static_cast<double>(std::ranges::count(kept, 1)) / static_cast<double>(count);
}

double instance_fit(const MeasuredMesh& measured, const Motion& motion, const std::vector<int>& a,
                    const std::vector<int>& b, Random& random, const RunContext& context) {
  const double tolerance = measured.tolerance_of(a);
  const ScoredSurface from(measured, a, tolerance);
  const ScoredSurface onto(measured, b, tolerance);
  if (from.empty() || onto.empty()) return 0;
  return onto.fit(from.sample(kInstanceSamples, random, context), motion, context);
}

}  // namespace orbifit::scoring
