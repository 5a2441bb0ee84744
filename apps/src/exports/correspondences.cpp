#include "correspondences.h"

#include <map>

#include "base/disjoint_sets.h"
#include "files/text.h"
#include "geometry/point_index.h"
#include "npz.h"

namespace orbifit {

Correspondences correspondences(const Mesh& mesh, const Region& region, const std::vector<int>& elements, double reach,
                                const RunContext& context) {
  Correspondences result;
  result.vertices = vertices_of_faces(mesh, region.faces);
  result.elements = elements;
  for (int e = 0; elements.empty() && e < static_cast<int>(region.elements.size()); ++e) result.elements.push_back(e);
  const Points points = mesh.vertices(result.vertices, Eigen::all);
  const PointIndex index(points);
  const std::size_t count = result.vertices.size();
  DisjointSets sets(count);
  for (std::size_t k = 0; k < result.elements.size(); ++k) {
    context.progress("images", static_cast<double>(k) / static_cast<double>(result.elements.size()));
    const Motion& element = region.elements[static_cast<std::size_t>(result.elements[k])];
    result.images.emplace_back(count, -1);
    result.distances.emplace_back(count, 0);
    for (std::size_t v = 0; v < count; ++v) {
      const Eigen::Vector3d image = element(points.row(static_cast<Eigen::Index>(v)).transpose());
      const auto near = index.nearest(image, 1).front();
      result.distances.back()[v] = (points.row(near.index).transpose() - image).norm();
      if (result.distances.back()[v] > reach) {
        ++result.unmatched;
        continue;
      }
      result.images.back()[v] = result.vertices[static_cast<std::size_t>(near.index)];
      sets.unite(static_cast<int>(v), static_cast<int>(near.index));
    }
  }
  std::map<int, int> labels;
  for (std::size_t v = 0; v < count; ++v) {
    result.orbits.push_back(
        labels.try_emplace(sets.root(static_cast<int>(v)), static_cast<int>(labels.size())).first->second);
  }
  return result;
}

std::string to_csv(const Correspondences& correspondences) {
  std::string text = "element,vertex,image,distance\n";
  for (std::size_t e = 0; e < correspondences.elements.size(); ++e) {
    for (std::size_t v = 0; v < correspondences.vertices.size(); ++v) {
      text += std::to_string(correspondences.elements[e]) + ',' + std::to_string(correspondences.vertices[v]) + ',' +
              std::to_string(correspondences.images[e][v]) + ',';
      append_number(text, correspondences.distances[e][v]);
      text += '\n';
    }
  }
  return text;
}

std::string orbits_csv(const Correspondences& correspondences) {
  std::string text = "vertex,orbit\n";
  for (std::size_t v = 0; v < correspondences.vertices.size(); ++v) {
    text += std::to_string(correspondences.vertices[v]) + ',' + std::to_string(correspondences.orbits[v]) + '\n';
  }
  return text;
}

std::string to_npz(const Correspondences& correspondences, const Region& region) {
  const std::size_t vertices = correspondences.vertices.size();
  const std::size_t elements = correspondences.elements.size();
  std::vector<std::int32_t> images;
  std::vector<double> distances;
  std::vector<double> motions;
  for (std::size_t e = 0; e < elements; ++e) {
    images.insert(images.end(), correspondences.images[e].begin(), correspondences.images[e].end());
    distances.insert(distances.end(), correspondences.distances[e].begin(), correspondences.distances[e].end());
    const Motion& motion = region.elements[static_cast<std::size_t>(correspondences.elements[e])];
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) motions.push_back(motion.linear(row, column));
      motions.push_back(motion.translation[row]);
    }
  }
  NpzArchive archive;
  archive.add("vertices", {vertices}, correspondences.vertices);
  archive.add("orbits", {vertices}, correspondences.orbits);
  archive.add("elements", {elements}, correspondences.elements);
  archive.add("motions", {elements, 3, 4}, motions);
  archive.add("images", {elements, vertices}, images);
  archive.add("distances", {elements, vertices}, distances);
  return archive.bytes();
}

}  // namespace orbifit
