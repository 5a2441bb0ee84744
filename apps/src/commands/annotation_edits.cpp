#include "annotation_edits.h"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "orbifit/model/errors.h"

#include "../command.h"
#include "../residual_json.h"

namespace orbifit {

namespace {

double share_of_area(const std::vector<int>& faces, const Eigen::VectorXd& areas) {
  double area = 0;
  for (const int face : faces) area += areas[face];
  return areas.sum() > 0 ? area / areas.sum() : 0;
}

Region& region_of(int id, const std::string& option, SymmetryAnnotation& annotation) {
  require_region(option, id, annotation);
  return *std::ranges::find(annotation.regions, id, &Region::id);
}

}  // namespace

std::vector<std::string> apply_edits(const AnnotationEdits& edits, SymmetryAnnotation& annotation) {
  std::vector<std::string> changes;
  for (const auto& [id, name] : edits.rename) {
    Region& region = region_of(id, "--rename", annotation);
    changes.push_back("region " + std::to_string(id) + " (" + region.group.symbol() + "): \"" + region.name +
                      "\" is now \"" + name + "\"");
    region.name = name;
  }
  for (const int id : edits.remove) {
    const Region& region = region_of(id, "--remove", annotation);
    changes.push_back("region " + std::to_string(id) + " (" + region.group.symbol() + ", \"" + region.name +
                      "\") removed");
  }
  if (!edits.remove.empty()) annotation = without_regions(std::move(annotation), edits.remove);
  return changes;
}

std::string annotation_table(const SymmetryAnnotation& annotation, const Mesh& mesh) {
  if (annotation.regions.empty() && annotation.patterns.empty()) {
    return "The annotation holds no regions and no patterns.\n";
  }
  const Eigen::VectorXd areas = face_areas(mesh);
  std::string text;
  if (!annotation.regions.empty()) {
    TextTable table({"region", "group", "area %", "faces", "parent", "residual max %", "name"});
    for (const Region& region : annotation.regions) {
      table.add({std::to_string(region.id), region.group.symbol(),
                 short_number(100 * share_of_area(region.faces, areas), 3), std::to_string(region.faces.size()),
                 region.parent ? std::to_string(*region.parent) : "-", short_number(100 * region.residual.max, 3),
                 region.name});
    }
    text += table.text();
  }
  if (!annotation.patterns.empty()) {
    TextTable table({"pattern", "kind", "instances", "residual max %", "name"});
    for (const Pattern& pattern : annotation.patterns) {
      table.add({std::to_string(pattern.id), to_string(pattern.kind), std::to_string(pattern.instances.size()),
                 short_number(100 * pattern.residual.max, 3), pattern.name});
    }
    text += table.text();
  }
  return text + "Residuals are in percent of the diagonal.\n";
}

nlohmann::ordered_json annotation_list(const SymmetryAnnotation& annotation, const Mesh& mesh) {
  const Eigen::VectorXd areas = face_areas(mesh);
  nlohmann::ordered_json regions = nlohmann::ordered_json::array();
  for (const Region& region : annotation.regions) {
    regions.push_back({{"id", region.id},
                       {"name", region.name},
                       {"group", region.group.symbol()},
                       {"area_fraction", share_of_area(region.faces, areas)},
                       {"faces", region.faces.size()},
                       {"parent", region.parent ? nlohmann::ordered_json(*region.parent) : nullptr},
                       {"residual", to_json(region.residual)}});
  }
  nlohmann::ordered_json patterns = nlohmann::ordered_json::array();
  for (const Pattern& pattern : annotation.patterns) {
    patterns.push_back({{"id", pattern.id},
                        {"name", pattern.name},
                        {"kind", to_string(pattern.kind)},
                        {"instances", pattern.instances.size()},
                        {"residual", to_json(pattern.residual)}});
  }
  return {{"regions", regions}, {"patterns", patterns}};
}

}  // namespace orbifit
