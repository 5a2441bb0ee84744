#include "region_listing.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "orbifit/apps/report.h"
#include "orbifit/model/annotation_io.h"

#include "base/plural.h"
#include "command.h"

namespace orbifit {

namespace {

double area_fraction(const Eigen::VectorXd& areas, const std::vector<int>& faces) {
  double area = 0;
  for (const int face : faces) area += areas[face];
  return areas.sum() > 0 ? area / areas.sum() : 0;
}

nlohmann::ordered_json importance(const std::optional<double>& value) {
  return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json();
}

// What is left by rounding is no news here; `check` shows every digit.
std::string percent(double fraction) {
  return short_number(fraction < 1e-12 ? 0 : 100 * fraction, 3);
}

std::string percent(const std::optional<double>& fraction) {
  return fraction ? percent(*fraction) : "-";
}

// How many regions from this one on are images of one another: they have the importance of all in common.
std::size_t family_size(const std::vector<Region>& regions, std::size_t first) {
  const auto end =
      std::find_if(regions.begin() + static_cast<std::ptrdiff_t>(first) + 1, regions.end(), [&](const Region& region) {
        return !region.importance || region.importance != regions[first].importance ||
               region.group != regions[first].group;
      });
  return static_cast<std::size_t>(end - regions.begin()) - first;
}

// "4 rods" of "rod 1 of 4, upper left", "2 groups of 6 parts" of "group of 6 parts 1 of 2".
std::string family_name(const Region& first, std::size_t count) {
  const std::size_t end = first.name.find(" 1 of " + std::to_string(count));
  if (count == 1 || end == std::string::npos) return first.name;
  return std::to_string(count) + " " + plural(first.name.substr(0, end));
}

// One line for each set of regions that are images of one another.
std::string region_table(const SymmetryAnnotation& found, const Eigen::VectorXd& areas) {
  TextTable table({"region", "group", "area %", "saves %", "parent", "residual max %", "name"});
  for (std::size_t i = 0; i < found.regions.size();) {
    const Region& region = found.regions[i];
    const std::size_t count = family_size(found.regions, i);
    double area = 0;
    double residual = 0;
    for (std::size_t k = i; k < i + count; ++k) {
      area += area_fraction(areas, found.regions[k].faces);
      residual = std::max(residual, found.regions[k].residual.max);
    }
    const std::string last = count > 1 ? "-" + std::to_string(found.regions[i + count - 1].id) : "";
    table.add({std::to_string(region.id) + last, region.group.symbol(), percent(area), percent(region.importance),
               region.parent ? std::to_string(*region.parent) : "-", percent(residual), family_name(region, count)});
    i += count;
  }
  return table.text();
}

std::string pattern_table(const SymmetryAnnotation& found) {
  TextTable table({"pattern", "kind", "instances", "saves %", "residual max %", "name"});
  for (const Pattern& pattern : found.patterns) {
    table.add({std::to_string(pattern.id), to_string(pattern.kind), std::to_string(pattern.instances.size()),
               percent(pattern.importance), percent(pattern.residual.max), pattern.name});
  }
  return table.text();
}

std::string broken_text(const std::vector<BrokenByColours>& all) {
  std::string text;
  for (const BrokenByColours& broken : all) {
    text += "Broken by colours: " + broken.group + " of " + broken.name + ", of which " +
            (broken.kept_as.empty() ? "nothing" : broken.kept_as) + " is left; up to " + percent(broken.differing) +
            " % of its surface would change colour.\n";
  }
  return text;
}

nlohmann::ordered_json broken_json(const std::vector<BrokenByColours>& all) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const BrokenByColours& broken : all) {
    list.push_back(
        {{"name", broken.name},
         {"group", broken.group},
         {"kept_as", broken.kept_as.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(broken.kept_as)},
         {"differing", broken.differing}});
  }
  return list;
}

}  // namespace

nlohmann::ordered_json listing_json(const SymmetryAnnotation& found, const std::vector<BrokenByColours>& broken,
                                    const Mesh& mesh) {
  const Eigen::VectorXd areas = face_areas(mesh);
  nlohmann::ordered_json regions = nlohmann::ordered_json::array();
  for (const Region& region : found.regions) {
    regions.push_back({{"id", region.id},
                       {"name", region.name},
                       {"group", region.group.symbol()},
                       {"faces", region.faces.size()},
                       {"area_fraction", area_fraction(areas, region.faces)},
                       {"importance", importance(region.importance)},
                       {"parent", region.parent ? nlohmann::ordered_json(*region.parent) : nullptr},
                       {"residual", {{"rms", region.residual.rms}, {"max", region.residual.max}}}});
  }
  nlohmann::ordered_json patterns = nlohmann::ordered_json::array();
  for (const Pattern& pattern : found.patterns) {
    patterns.push_back({{"id", pattern.id},
                        {"name", pattern.name},
                        {"kind", to_string(pattern.kind)},
                        {"instances", pattern.instances.size()},
                        {"importance", importance(pattern.importance)},
                        {"residual", {{"rms", pattern.residual.rms}, {"max", pattern.residual.max}}}});
  }
  nlohmann::ordered_json result{{"tolerance", found.tolerance}, {"regions", regions}, {"patterns", patterns}};
  if (!broken.empty()) result["broken_by_colours"] = broken_json(broken);
  return result;
}

std::string annotation_text(const SymmetryAnnotation& found, const std::vector<BrokenByColours>& broken) {
  std::string text = to_json(found);
  if (broken.empty()) return text;
  text.erase(text.rfind('}'));
  text.erase(text.find_last_not_of(" \n") + 1);
  return text + ",\n  \"broken_by_colours\": " +
         broken_json(broken).dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n}\n";
}

std::string listing(const SymmetryAnnotation& found, const std::vector<BrokenByColours>& broken, const Mesh& mesh) {
  if (found.regions.empty() && found.patterns.empty()) {
    return "No symmetry within " + short_number(100 * found.tolerance) + " % of the diagonal" +
           (broken.empty() ? "" : " that colours keep") + ".\n" + broken_text(broken);
  }
  std::string text = found.regions.empty() ? "" : region_table(found, face_areas(mesh));
  if (!found.patterns.empty()) text += (text.empty() ? "" : "\n") + pattern_table(found);
  return text + "Saves: of the surface that does not follow from the lines before. Residuals are in percent of the\n" +
         "diagonal, " + short_number(diagonal(mesh.vertices), 6) + ".\n" + broken_text(broken);
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
