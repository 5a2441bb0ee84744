#include "orbifit/model/annotation.h"

#include <algorithm>
#include <array>
#include <utility>

namespace orbifit {

namespace {

struct KindName {
  Pattern::Kind kind;
  std::string_view name;
  int generators;
};

constexpr std::array<KindName, 6> kKinds{{{Pattern::Kind::translation_1d, "translation-1d", 1},
                                          {Pattern::Kind::translation_2d, "translation-2d", 2},
                                          {Pattern::Kind::translation_3d, "translation-3d", 3},
                                          {Pattern::Kind::rotation, "rotation", 1},
                                          {Pattern::Kind::screw, "screw", 1},
                                          {Pattern::Kind::congruent, "congruent", 0}}};

const KindName& find_kind(Pattern::Kind kind) {
  return *std::ranges::find(kKinds, kind, &KindName::kind);
}

}  // namespace

std::string to_string(Pattern::Kind kind) {
  return std::string(find_kind(kind).name);
}

std::optional<Pattern::Kind> parse_pattern_kind(std::string_view text) {
  const auto* found = std::ranges::find(kKinds, text, &KindName::name);
  if (found == kKinds.end()) return std::nullopt;
  return found->kind;
}

int generator_count(Pattern::Kind kind) {
  return find_kind(kind).generators;
}

SymmetryAnnotation empty_annotation(const Mesh& mesh, double tolerance) {
  SymmetryAnnotation result;
  result.mesh_vertices = static_cast<int>(mesh.vertices.rows());
  result.mesh_faces = static_cast<int>(mesh.faces.rows());
  result.mesh_diagonal = diagonal(mesh.vertices);
  result.tolerance = tolerance;
  return result;
}

Region make_region(const PointGroup& group, const Eigen::Vector3d& centre, const GroupFrame& frame,
                   std::vector<int> faces, std::string name) {
  Region region;
  region.name = std::move(name);
  region.group = group;
  region.centre = centre;
  if (group.has_axis()) region.axis = frame.col(2);
  for (const Eigen::Matrix3d& linear : generators(group, frame)) {
    region.generators.push_back(Motion::about(linear, centre));
  }
  if (!group.continuous()) {
    for (const Eigen::Matrix3d& linear : elements(group, frame)) {
      region.elements.push_back(Motion::about(linear, centre));
    }
    region.elements.front() = Motion{};
  }
  std::ranges::sort(faces);
  region.faces = std::move(faces);
  return region;
}

void set_parents(std::vector<Region>& regions) {
  for (Region& region : regions) {
    region.parent.reset();
    const Region* smallest = nullptr;
    for (const Region& other : regions) {
      if (other.faces.size() <= region.faces.size()) continue;
      if (smallest != nullptr && other.faces.size() >= smallest->faces.size()) continue;
      if (std::ranges::includes(other.faces, region.faces)) smallest = &other;
    }
    if (smallest != nullptr) region.parent = smallest->id;
  }
}

SymmetryAnnotation without_regions(SymmetryAnnotation annotation, const std::vector<int>& ids) {
  std::erase_if(annotation.regions,
                [&](const Region& region) { return std::ranges::find(ids, region.id) != ids.end(); });
  set_parents(annotation.regions);
  return annotation;
}

SymmetryAnnotation transformed(const SymmetryAnnotation& annotation, const Similarity& similarity) {
  SymmetryAnnotation result = annotation;
  result.mesh_diagonal *= similarity.scale;  // the diagonal of a turned box may differ; callers that know it set it
  const auto move = [&](Motion& motion) { motion = conjugate(similarity, motion); };
  if (result.up) result.up = similarity.linear * *result.up;
  for (Region& region : result.regions) {
    region.centre = similarity(region.centre);
    region.axis = similarity.linear * region.axis;
    std::ranges::for_each(region.generators, move);
    std::ranges::for_each(region.elements, move);
  }
  for (Pattern& pattern : result.patterns) {
    std::ranges::for_each(pattern.generators, move);
    for (PatternInstance& instance : pattern.instances) move(instance.motion);
  }
  return result;
}

}  // namespace orbifit
