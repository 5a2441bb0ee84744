#include "orbifit/subspace/vertex_orbits.h"

#include <cstddef>

#include "orbifit/model/point_index.h"

namespace orbifit {

VertexOrbits vertex_orbits(const Mesh& mesh, const RegionMap& regions, double tolerance) {
  VertexOrbits orbits;
  for (int region = 0; region < regions.count(); ++region) {
    if (!regions.whole(region)) continue;
    if (orbits.region < 0 || regions.elements(region).size() > regions.elements(orbits.region).size()) {
      orbits.region = region;
    }
  }
  if (orbits.region < 0) return orbits;
  const auto count = static_cast<std::size_t>(mesh.vertices.rows());
  const std::vector<Motion>& elements = regions.elements(orbits.region);
  const PointIndex index(mesh.vertices);
  orbits.source.assign(count, -1);
  orbits.element.assign(count, 0);
  for (std::size_t v = 0; v < count; ++v) {
    if (orbits.source[v] >= 0) continue;
    const int vertex = static_cast<int>(v);
    const Eigen::Vector3d position = mesh.vertices.row(vertex);
    VertexOrbits::Stabiliser stabiliser{vertex, {}};
    for (std::size_t e = 0; e < elements.size(); ++e) {
      for (const auto& [image, distance] : index.within(elements[e](position), tolerance)) {
        const auto w = static_cast<std::size_t>(image);
        if (image == vertex) stabiliser.elements.push_back(static_cast<int>(e));
        if (orbits.source[w] >= 0) continue;
        orbits.source[w] = vertex;
        orbits.element[w] = static_cast<int>(e);
      }
    }
    if (stabiliser.elements.size() > 1) orbits.stabilisers.push_back(std::move(stabiliser));
  }
  return orbits;
}

void symmetrise(const VertexOrbits& orbits, const RegionMap& regions, const Eigen::Vector3d& translation,
                Points& displacements) {
  if (orbits.region < 0) return;
  const std::vector<Motion>& elements = regions.elements(orbits.region);
  const auto image = [&](int element, const Eigen::Vector3d& u) -> Eigen::Vector3d {
    return elements[static_cast<std::size_t>(element)].linear * (u - translation) + translation;
  };
  for (const auto& [vertex, stabiliser] : orbits.stabilisers) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const int element : stabiliser) sum += image(element, displacements.row(vertex).transpose());
    displacements.row(vertex) = sum / static_cast<double>(stabiliser.size());
  }
  for (std::size_t v = 0; v < orbits.source.size(); ++v) {
    const int source = orbits.source[v];
    if (static_cast<std::size_t>(source) == v) continue;
    displacements.row(static_cast<Eigen::Index>(v)) = image(orbits.element[v], displacements.row(source).transpose());
  }
}

}  // namespace orbifit
