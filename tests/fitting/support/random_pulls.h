#pragma once

#include <ostream>
#include <vector>

#include "orbifit/datasets_tools/generate.h"
#include "orbifit/subspace/subspace.h"

#include "base/random.h"
#include "geometry/sampling.h"
#include "registration/correspondences.h"
#include "solver/pulls.h"

namespace orbifit {

/// A model and what may become of its groups.
struct ModelCase {
  const char* model;
  GroupMode mode;
};

inline std::ostream& operator<<(std::ostream& out, const ModelCase& each) {
  return out << each.model << "_" << to_string(each.mode);
}

/// Random points beside a template's surface, which pull it there, one of its vertices as well.
struct RandomPulls {
  Points points;
  std::vector<Correspondence> pairs;
  std::vector<Pull> pulls;

  RandomPulls(const Mesh& mesh, Random& random) {
    const double size = diagonal(mesh.vertices);
    const SurfaceSamples samples = sample_surface(mesh, 700, random);
    points = samples.points;
    for (Eigen::Index i = 0; i < points.rows(); ++i) {
      Correspondence pair;
      pair.scan_point = static_cast<int>(i);
      pair.face = samples.faces[static_cast<std::size_t>(i)];
      pair.barycentric = Eigen::Vector3d(random.uniform(), random.uniform(), random.uniform());
      pair.barycentric /= pair.barycentric.sum();
      pair.normal = random.direction();
      pair.weight = random.uniform();
      pairs.push_back(pair);
      points.row(i) += 0.05 * size * random.direction().transpose();
    }
    pulls.push_back({3, mesh.vertices.row(3).transpose() + 0.1 * size * random.direction(), 4});
  }
};

}  // namespace orbifit
