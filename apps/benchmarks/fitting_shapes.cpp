#include "fitting_shapes.h"

#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "orbifit/subspace/deformer.h"
#include "orbifit/subspace/subspace.h"

#include "base/random.h"

namespace orbifit::benchmarks {

namespace {

using Eigen::Vector3d;

// A ball of the surface that is moved. Distances are fractions of the diagonal.
struct Change {
  double radius, shift, degrees, least_scale, largest_scale;
};
constexpr Change kEnd{0.1, 0.05, 15, 0.7, 1.4};  // what lies between bends, tapers and swells
constexpr Change kBulge{0.04, 0.03, 0, 1, 1.5};
constexpr int kEnds = 4, kBulges = 4;

std::vector<int> vertices_within(const Points& vertices, Eigen::Index centre, double radius) {
  std::vector<int> result;
  for (Eigen::Index v = 0; v < vertices.rows(); ++v) {
    if ((vertices.row(v) - vertices.row(centre)).norm() <= radius) result.push_back(static_cast<int>(v));
  }
  return result;
}

Handle changed(const Points& vertices, Eigen::Index at, const Change& change, double size, Random& random) {
  Handle handle;
  handle.vertices = vertices_within(vertices, at, change.radius * size);
  const Vector3d centre = vertices.row(at).transpose();
  const double scale = random.uniform(change.least_scale, change.largest_scale);
  const double angle = random.uniform(-1, 1) * change.degrees * std::numbers::pi / 180;
  handle.motion.linear = scale * Eigen::AngleAxisd(angle, random.direction()).toRotationMatrix();
  handle.motion.translation = centre + change.shift * size * random.direction() - handle.motion.linear * centre;
  return handle;
}

}  // namespace

std::vector<int> spread_vertices(const Points& vertices, int count) {
  Eigen::VectorXd nearest = (vertices.rowwise() - vertices.colwise().mean()).rowwise().squaredNorm();
  std::vector<int> result;
  while (static_cast<int>(result.size()) < count) {
    Eigen::Index at = 0;
    nearest.maxCoeff(&at);
    if (result.empty()) nearest.setConstant(std::numeric_limits<double>::infinity());
    nearest = nearest.cwiseMin((vertices.rowwise() - vertices.row(at)).rowwise().squaredNorm());
    result.push_back(static_cast<int>(at));
  }
  return result;
}

Points reshaped(const GeneratedModel& model, RunContext& context) {
  constexpr int kSamples = 1200;  // finer than what is fitted
  constexpr double kAlpha = 10;
  constexpr int kIterations = 10;
  const Points& rest = model.mesh.vertices;
  const double size = diagonal(rest);
  Random random(context.seed, "another shape");
  SubspaceOptions options;
  options.mode = GroupMode::fixed;
  options.samples = kSamples;
  const Subspace subspace = build_subspace(model.mesh, model.truth, options, context);
  std::vector<Handle> handles;
  std::vector<Motion> motions;
  for (const int at : spread_vertices(rest, kEnds + kBulges)) {
    const bool end = static_cast<int>(handles.size()) < kEnds;
    handles.push_back(changed(rest, at, end ? kEnd : kBulge, size, random));
    motions.push_back(handles.back().motion);
  }
  Deformer deformer(subspace, model.mesh, {}, context);
  deformer.set_handles(handles, kAlpha);
  return rest + vertex_displacements(subspace, deformer.solve(motions, kIterations).state, context);
}

}  // namespace orbifit::benchmarks
