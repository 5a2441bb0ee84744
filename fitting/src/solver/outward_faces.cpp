#include "solver/outward_faces.h"

#include "base/random.h"
#include "geometry/sampling.h"

namespace orbifit {

bool faces_outwards(const Mesh& mesh, const MovingSurface& surface, const RunContext& context) {
  constexpr int kFacesTried = 400;
  constexpr double kNearlyAll = 0.85;
  Random random(context.seed, "outwards");
  const SurfaceSamples samples = sample_surface(mesh, kFacesTried, random);
  const double start = 1e-5 * diagonal(mesh.vertices);
  int outwards = 0;
  for (Eigen::Index i = 0; i < samples.points.rows(); ++i) {
    const Eigen::Vector3d inwards = -samples.normals.row(i);
    const int face = surface.first_hit(samples.points.row(i), inwards, start);
    if (face >= 0 && surface.normal(face).dot(inwards) > 0) ++outwards;
  }
  return outwards >= kNearlyAll * static_cast<double>(samples.points.rows());
}

}  // namespace orbifit
