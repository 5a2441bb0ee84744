#include "evidence/noise_check.h"

#include <algorithm>
#include <cmath>

#include "base/random.h"
#include "group/verification.h"

namespace orbifit {

namespace {

using Eigen::Vector3d;

constexpr int kNoiseSamples = 1500;

// The mesh with its vertices moved along their normals at random; copies of a vertex move together.
Mesh with_noise(const PreparedMesh& clean, double sigma, const RunContext& context) {
  Random random(context.seed, "noise");
  std::vector<Vector3d> moves;
  moves.reserve(clean.faces_of_vertex.size());
  for (const std::vector<int>& faces : clean.faces_of_vertex) {
    Vector3d normal = Vector3d::Zero();
    for (const int f : faces) normal += clean.areas[f] * clean.normals.row(f).transpose();
    moves.emplace_back(sigma * random.normal() * normal.stableNormalized());
  }
  Mesh noisy = clean.mesh;
  for (Eigen::Index v = 0; v < noisy.vertices.rows(); ++v) {
    const int group = clean.weld.group_of_vertex[static_cast<std::size_t>(v)];
    noisy.vertices.row(v) += moves[static_cast<std::size_t>(group)].transpose();
  }
  return noisy;
}

}  // namespace

NoiseCheck::NoiseCheck(const PreparedMesh& given, const PreparedMesh& clean, double sigma, double tolerance,
                       const RunContext& context)
    : given_(given),
      tolerance_(tolerance),
      context_(context),
      noisy_(std::make_shared<const SurfaceIndex>(with_noise(clean, sigma, context))) {}

NoiseCheck::Share NoiseCheck::share(const FoundRegion& region) const {
  const GroupPlacement& placement = region.placement;
  const std::vector<Motion> motions = judged_motions(placement.group, placement.frame, placement.centre);
  SurfacePatch patch = make_patch(given_, region.faces, kNoiseSamples, tolerance_, context_, "given");
  const double kept = verify(patch, motions, patch.tolerance, 0, 0, context_).joint;
  patch.index = noisy_;
  const double one = kept_share(patch, Motion{}, patch.tolerance, 0);
  return {kept, std::pow(one, static_cast<double>(motions.size()))};
}

bool NoiseCheck::holds(const FoundRegion& region) const {
  constexpr double kValid = 0.95;
  constexpr double kOfExpected = 0.97;
  const Share found = share(region);
  return found.kept >= std::min(kValid, kOfExpected * found.expected);
}

}  // namespace orbifit
