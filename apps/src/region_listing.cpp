#include "region_listing.h"

#include <string>
#include <vector>

#include "orbifit/apps/report.h"

#include "command.h"

namespace orbifit {

namespace {

double area_fraction(const Eigen::VectorXd& areas, const std::vector<int>& faces) {
  double area = 0;
  for (const int face : faces) area += areas[face];
  return areas.sum() > 0 ? area / areas.sum() : 0;
}

}  // namespace

nlohmann::ordered_json listing_json(const SymmetryAnnotation& found, const Mesh& mesh) {
  const Eigen::VectorXd areas = face_areas(mesh);
  nlohmann::ordered_json regions = nlohmann::ordered_json::array();
  for (const Region& region : found.regions) {
    regions.push_back({{"id", region.id},
                       {"name", region.name},
                       {"group", region.group.symbol()},
                       {"faces", region.faces.size()},
                       {"area_fraction", area_fraction(areas, region.faces)},
                       {"parent", region.parent ? nlohmann::ordered_json(*region.parent) : nullptr},
                       {"residual", {{"rms", region.residual.rms}, {"max", region.residual.max}}}});
  }
  nlohmann::ordered_json patterns = nlohmann::ordered_json::array();
  for (const Pattern& pattern : found.patterns) {
    patterns.push_back({{"id", pattern.id},
                        {"name", pattern.name},
                        {"kind", to_string(pattern.kind)},
                        {"instances", pattern.instances.size()},
                        {"residual", {{"rms", pattern.residual.rms}, {"max", pattern.residual.max}}}});
  }
  return {{"tolerance", found.tolerance}, {"regions", regions}, {"patterns", patterns}};
}

std::string listing(const SymmetryAnnotation& found, const Mesh& mesh) {
  if (found.regions.empty() && found.patterns.empty()) {
    return "No symmetry within " + short_number(100 * found.tolerance) + " % of the diagonal.\n";
  }
  const Eigen::VectorXd areas = face_areas(mesh);
  // What is left by rounding is no news here; `check` shows every digit.
  const auto percent = [](double fraction) { return short_number(fraction < 1e-12 ? 0 : 100 * fraction, 3); };
  std::string text;
  if (!found.regions.empty()) {
    TextTable table({"region", "group", "area %", "faces", "parent", "residual max %", "name"});
    for (const Region& region : found.regions) {
      table.add({std::to_string(region.id), region.group.symbol(), percent(area_fraction(areas, region.faces)),
                 std::to_string(region.faces.size()), region.parent ? std::to_string(*region.parent) : "-",
                 percent(region.residual.max), region.name});
    }
    text += table.text();
  }
  if (!found.patterns.empty()) {
    TextTable table({"pattern", "kind", "instances", "residual max %", "name"});
    for (const Pattern& pattern : found.patterns) {
      table.add({std::to_string(pattern.id), to_string(pattern.kind), std::to_string(pattern.instances.size()),
                 percent(pattern.residual.max), pattern.name});
    }
    text += (text.empty() ? "" : "\n") + table.text();
  }
  return text + "Residuals are in percent of the diagonal, " + short_number(diagonal(mesh.vertices), 6) + ".\n";
}

nlohmann::ordered_json point_listing_json(const SymmetryAnnotation& found) {
  nlohmann::ordered_json regions = nlohmann::ordered_json::array();
  for (const Region& region : found.regions) {
    regions.push_back({{"id", region.id},
                       {"name", region.name},
                       {"group", region.group.symbol()},
                       {"points", region.faces.size()},
                       {"point_fraction", static_cast<double>(region.faces.size()) / found.mesh_faces},
                       {"parent", region.parent ? nlohmann::ordered_json(*region.parent) : nullptr},
                       {"residual", {{"rms", region.residual.rms}, {"max", region.residual.max}}}});
  }
  return {{"points", found.mesh_faces}, {"tolerance", found.tolerance}, {"regions", regions}};
}

std::string point_listing(const SymmetryAnnotation& found) {
  const std::string tolerance = short_number(100 * found.tolerance) + " % of the diagonal.\n";
  if (found.regions.empty()) return "No symmetry within " + tolerance;
  TextTable table({"region", "group", "points", "points %", "parent", "residual rms %", "name"});
  for (const Region& region : found.regions) {
    table.add({std::to_string(region.id), region.group.symbol(), std::to_string(region.faces.size()),
               short_number(100.0 * static_cast<double>(region.faces.size()) / found.mesh_faces, 3),
               region.parent ? std::to_string(*region.parent) : "-", short_number(100 * region.residual.rms, 3),
               region.name});
  }
  return table.text() + "Judged within " + tolerance;
}

}  // namespace orbifit
