#include "geometry/sampling.h"

#include <cmath>
#include <numeric>

#include "orbifit/model/errors.h"

namespace orbifit {

SurfaceSamples sample_surface(const Mesh& mesh, const Eigen::VectorXd& areas, const Points& normals, int count,
                              Random& random, const std::vector<int>& faces) {
  std::vector<int> chosen = faces;
  if (faces.empty()) {
    chosen.resize(static_cast<std::size_t>(mesh.faces.rows()));
    std::iota(chosen.begin(), chosen.end(), 0);
  }
  std::erase_if(chosen, [&](int face) { return !(areas[face] > 0); });
  double total = 0;
  for (const int face : chosen) total += areas[face];
  if (!(total > 0)) throw InputError("", "", "the surface to sample has no area");

  SurfaceSamples samples;
  samples.points.resize(std::max(count, 0), 3);
  samples.normals.resize(std::max(count, 0), 3);
  samples.faces.reserve(static_cast<std::size_t>(std::max(count, 0)));
  std::size_t current = 0;
  double end_of_current = areas[chosen[0]];
  for (int i = 0; i < count; ++i) {
    // Sample i lies in the i-th of `count` equal parts of the area.
    const double place = (i + random.uniform()) / count * total;
    while (place >= end_of_current && current + 1 < chosen.size()) end_of_current += areas[chosen[++current]];
    const int face = chosen[current];
    const Eigen::RowVector3d a = mesh.vertices.row(mesh.faces(face, 0));
    const Eigen::RowVector3d b = mesh.vertices.row(mesh.faces(face, 1));
    const Eigen::RowVector3d c = mesh.vertices.row(mesh.faces(face, 2));
    const double root = std::sqrt(random.uniform());
    const double along = random.uniform();
    samples.points.row(i) = a + root * (1 - along) * (b - a) + root * along * (c - a);
    samples.normals.row(i) = normals.row(face);
    samples.faces.push_back(face);
  }
  return samples;
}

SurfaceSamples sample_surface(const Mesh& mesh, int count, Random& random, const std::vector<int>& faces) {
  if (faces.empty()) return sample_surface(mesh, face_areas(mesh), face_normals(mesh), count, random);
  // Areas and normals of these alone: small places of large meshes are sampled one by one.
  SurfaceSamples samples = sample_surface(submesh(mesh, faces), count, random);
  for (int& face : samples.faces) face = faces[static_cast<std::size_t>(face)];
  return samples;
}

}  // namespace orbifit
