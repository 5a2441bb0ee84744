#include "orbifit/model/annotation_io.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <set>

#include <nlohmann/json.hpp>

#include "orbifit/model/errors.h"

#include "files/annotation_checks.h"
#include "files/file.h"
#include "files/json_reader.h"
#include "files/json_text.h"
#include "files/text.h"

namespace orbifit {

namespace {

using Json = nlohmann::json;

constexpr double kUnitLength = 1e-5;  // of an axis

// An STL's triangles have corners of their own; other programs count the places where these meet.
bool unconnected(const Mesh& mesh) {
  if (mesh.vertices.rows() != 3 * mesh.faces.rows()) return false;
  for (Eigen::Index i = 0; i < mesh.faces.size(); ++i) {
    if (mesh.faces.data()[i] != i) return false;
  }
  return true;
}

int distinct_vertices(const Mesh& mesh) {
  std::set<std::array<double, 3>> places;
  for (const auto& row : mesh.vertices.rowwise()) places.insert({row[0], row[1], row[2]});
  return static_cast<int>(places.size());
}

class AnnotationReader {
 public:
  AnnotationReader(std::string file, const Mesh& mesh)
      : file_(file), json_(std::move(file)), mesh_(mesh), diagonal_(diagonal(mesh.vertices)) {}

  SymmetryAnnotation read(const std::string& text) {
    const Json root = parse_json(file_, text);
    if (!(diagonal_ > 0)) json_.refuse("mesh", "has no extent: all its vertices are at one place");
    if (!root.is_object()) json_.refuse("", "must hold a JSON object");
    if (json_.string(root, "format", "") != "symmetry-annotation") {
      json_.refuse("format", "is " + in_quotes(json_.string(root, "format", "")) + ", not 'symmetry-annotation'");
    }
    if (const std::int64_t version = json_.integer(root, "version", ""); version != 1) {
      json_.refuse("version", "is " + std::to_string(version) + ": only version 1 is read");
    }
    SymmetryAnnotation annotation;
    read_mesh_counts(json_.member(root, "mesh", ""), annotation);
    annotation.tolerance = json_.number(root, "tolerance", "");
    if (annotation.tolerance < 0) json_.refuse("tolerance", "must not be negative");
    if (root.contains("up")) annotation.up = json_.direction(root["up"], "up");
    const Json& regions = json_.list(root, "regions", "");
    for (std::size_t r = 0; r < regions.size(); ++r)
      annotation.regions.push_back(region(regions[r], item_path("regions", r)));
    check_parents(annotation.regions, json_);
    const Json& patterns = json_.list(root, "patterns", "");
    for (std::size_t p = 0; p < patterns.size(); ++p) {
      annotation.patterns.push_back(pattern(patterns[p], item_path("patterns", p)));
    }
    return annotation;
  }

 private:
  Residual residual(const Json& object, const std::string& where) const {
    const Json& value = json_.member(object, "residual", where);
    const std::string inner = key_path(where, "residual");
    const Residual result{json_.number(value, "rms", inner), json_.number(value, "max", inner)};
    if (result.rms < 0 || result.max < 0) json_.refuse(inner, "must not be negative");
    return result;
  }

  std::optional<double> importance(const Json& object, const std::string& where) const {
    if (!object.contains("importance")) return std::nullopt;
    const double result = json_.number(object, "importance", where);
    if (!(result >= 0 && result <= 1)) json_.refuse(key_path(where, "importance"), "must be from 0 to 1");
    return result;
  }

  // Runs that people wrote out of order or touching mean the same set; only runs outside the mesh mean nothing.
  std::vector<int> faces(const Json& object, const std::string& where) const {
    const Json& runs = json_.list(object, "faces", where);
    const std::string inner = key_path(where, "faces");
    std::vector<std::pair<std::int64_t, std::int64_t>> ranges;
    for (std::size_t r = 0; r < runs.size(); ++r) {
      if (!runs[r].is_array() || runs[r].size() != 2) json_.refuse(item_path(inner, r), "must be a run [first, count]");
      const std::int64_t first = json_.whole(runs[r][0], item_path(inner, r));
      const std::int64_t count = json_.whole(runs[r][1], item_path(inner, r));
      if (first < 0 || count < 1 || first > mesh_.faces.rows() || count > mesh_.faces.rows() - first) {
        json_.refuse(item_path(inner, r), "the run [" + std::to_string(first) + ", " + std::to_string(count) +
                                              "] is outside the mesh, which has " + std::to_string(mesh_.faces.rows()) +
                                              " faces");
      }
      ranges.emplace_back(first, first + count);
    }
    if (ranges.empty()) json_.refuse(inner, "must name at least one face");
    std::ranges::sort(ranges);
    std::vector<int> result;
    std::int64_t next = 0;
    for (const auto& [first, end] : ranges) {
      for (next = std::max(next, first); next < end; ++next) result.push_back(static_cast<int>(next));
    }
    return result;
  }

  void read_mesh_counts(const Json& object, SymmetryAnnotation& annotation) const {
    const std::int64_t vertices = json_.integer(object, "vertices", "mesh");
    const std::int64_t face_count = json_.integer(object, "faces", "mesh");
    const auto differ = [&](const char* what, std::int64_t given, std::int64_t actual) {
      json_.refuse(std::string("mesh.") + what, "the annotation is of a mesh with " + std::to_string(given) + " " +
                                                    what + ", this one has " + std::to_string(actual));
    };
    if (face_count != mesh_.faces.rows()) differ("faces", face_count, mesh_.faces.rows());
    if (vertices != mesh_.vertices.rows() && !(unconnected(mesh_) && vertices == distinct_vertices(mesh_))) {
      differ("vertices", vertices, mesh_.vertices.rows());
    }
    annotation.mesh_vertices = static_cast<int>(mesh_.vertices.rows());
    annotation.mesh_faces = static_cast<int>(face_count);
    annotation.mesh_diagonal = json_.number(object, "diagonal", "mesh");
  }

  PointGroup group(const Json& object, const std::string& where) const {
    const std::string symbol = json_.string(object, "group", where);
    const auto result = PointGroup::parse(symbol);
    if (!result || result->family == PointGroup::Family::C1) {
      json_.refuse(key_path(where, "group"),
                   in_quotes(symbol) + " is no symbol of a point group such as Cs, C4v, D2h, Oh or Dinfh");
    }
    return *result;
  }

  Region region(const Json& object, const std::string& where) const {
    Region result;
    result.id = json_.identifier(object, "id", where);
    result.name = json_.string(object, "name", where);
    result.group = group(object, where);
    result.centre = json_.vector(json_.member(object, "centre", where), key_path(where, "centre"));
    if (result.group.has_axis()) {
      result.axis = json_.vector(json_.member(object, "axis", where), key_path(where, "axis"));
      const double length = result.axis.norm();
      if (!(std::abs(length - 1) <= kUnitLength)) {
        json_.refuse(key_path(where, "axis"), "must be a unit vector, its length is " + number_text(length));
      }
      if (std::abs(length - 1) > 1e-15) result.axis /= length;
    }
    result.generators = json_.motions(object, "generators", where);
    result.elements = json_.motions(object, "elements", where);
    result.faces = faces(object, where);
    if (const Json& parent = json_.member(object, "parent", where); !parent.is_null()) {
      result.parent = json_.identifier(object, "parent", where);
    }
    result.residual = residual(object, where);
    result.importance = importance(object, where);
    check_group(result, where, diagonal_, json_);
    return result;
  }

  Pattern pattern(const Json& object, const std::string& where) const {
    Pattern result;
    result.id = json_.identifier(object, "id", where);
    result.name = json_.string(object, "name", where);
    const std::string name = json_.string(object, "kind", where);
    const auto kind = parse_pattern_kind(name);
    if (!kind) json_.refuse(key_path(where, "kind"), in_quotes(name) + " is no kind of pattern");
    result.kind = *kind;
    result.generators = json_.motions(object, "generators", where);
    if (static_cast<int>(result.generators.size()) != generator_count(*kind)) {
      json_.refuse(key_path(where, "generators"), "has " + std::to_string(result.generators.size()) + " motions, but " +
                                                      name + " needs " + std::to_string(generator_count(*kind)));
    }
    const Json& instances = json_.list(object, "instances", where);
    if (instances.size() < 2) json_.refuse(key_path(where, "instances"), "must hold at least two");
    for (std::size_t i = 0; i < instances.size(); ++i) {
      const std::string inner = item_path(key_path(where, "instances"), i);
      const Motion placed = json_.motion(json_.member(instances[i], "motion", inner), key_path(inner, "motion"));
      result.instances.push_back({placed, faces(instances[i], inner)});
    }
    const double reach = std::max(diagonal_, mesh_.vertices.cwiseAbs().maxCoeff());
    if (motion_distance(result.instances.front().motion, {}, Eigen::Vector3d::Zero(), diagonal_) >
        kClosedToWithin * reach) {
      json_.refuse(key_path(where, "instances") + "[0].motion", "must be the identity");
    }
    result.residual = residual(object, where);
    result.importance = importance(object, where);
    return result;
  }

  std::string file_;
  JsonReader json_;
  const Mesh& mesh_;
  double diagonal_;
};

}  // namespace

SymmetryAnnotation read_annotation(const std::filesystem::path& file, const Mesh& mesh) {
  return annotation_from_json(read_file(file), mesh, file.string());
}

SymmetryAnnotation annotation_from_json(const std::string& text, const Mesh& mesh, const std::string& name) {
  return AnnotationReader(name, mesh).read(text);
}

}  // namespace orbifit
