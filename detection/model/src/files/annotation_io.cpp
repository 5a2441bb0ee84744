#include "orbifit/model/annotation_io.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <set>

#include <nlohmann/json.hpp>

#include "orbifit/model/errors.h"

#include "files/file.h"
#include "files/json_text.h"
#include "files/mesh_builder.h"
#include "files/text.h"
#include "groups/element_list.h"

namespace orbifit {

namespace {

using Json = nlohmann::json;

constexpr double kOrthogonal = 1e-6;
constexpr double kClosed = 1e-5;      // of linear parts, and of translations as a fraction of the diagonal
constexpr double kUnitLength = 1e-5;  // of an axis
constexpr std::size_t kMaxElements = 4096;

std::string number_text(double number) {
  std::string text;
  append_number(text, number);
  return text;
}

std::string item(const std::string& list, std::size_t index) {
  return list + "[" + std::to_string(index) + "]";
}

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
      : file_(std::move(file)), mesh_(mesh), diagonal_(diagonal(mesh.vertices)) {}

  SymmetryAnnotation read(const std::string& text) {
    const Json root = parse_json(file_, text);
    if (!(diagonal_ > 0)) throw InputError("", "mesh", "has no extent: all its vertices are at one place");
    if (!root.is_object()) refuse("", "must hold a JSON object");
    if (string(root, "format", "") != "symmetry-annotation") {
      refuse("format", "is " + in_quotes(string(root, "format", "")) + ", not 'symmetry-annotation'");
    }
    if (const std::int64_t version = integer(root, "version", ""); version != 1) {
      refuse("version", "is " + std::to_string(version) + ": only version 1 is read");
    }
    SymmetryAnnotation annotation;
    read_mesh_counts(member(root, "mesh", ""), annotation);
    annotation.tolerance = number(root, "tolerance", "");
    if (annotation.tolerance < 0) refuse("tolerance", "must not be negative");
    if (root.contains("up")) annotation.up = direction(root["up"], "up");
    const Json& regions = list(root, "regions", "");
    for (std::size_t r = 0; r < regions.size(); ++r)
      annotation.regions.push_back(region(regions[r], item("regions", r)));
    check_parents(annotation.regions);
    const Json& patterns = list(root, "patterns", "");
    for (std::size_t p = 0; p < patterns.size(); ++p) {
      annotation.patterns.push_back(pattern(patterns[p], item("patterns", p)));
    }
    return annotation;
  }

 private:
  [[noreturn]] void refuse(const std::string& where, const std::string& reason) const {
    throw InputError(file_, where, reason);
  }

  static std::string path(const std::string& where, const char* key) { return where.empty() ? key : where + "." + key; }

  const Json& member(const Json& object, const char* key, const std::string& where) const {
    if (!object.is_object()) refuse(where, "must be an object");
    const auto found = object.find(key);
    if (found == object.end()) refuse(path(where, key), "is missing");
    return *found;
  }

  std::string string(const Json& object, const char* key, const std::string& where) const {
    const Json& value = member(object, key, where);
    if (!value.is_string()) refuse(path(where, key), "must be a string");
    return value.get<std::string>();
  }

  double number(const Json& object, const char* key, const std::string& where) const {
    return finite(member(object, key, where), path(where, key));
  }

  double finite(const Json& value, const std::string& where) const {
    if (!value.is_number()) refuse(where, "must be a number");
    const auto result = value.get<double>();
    if (!(std::abs(result) <= kLargestCoordinate)) refuse(where, "must be a number of at most 1e50 in size");
    return result;
  }

  std::int64_t whole(const Json& value, const std::string& where) const {
    if (!value.is_number_integer() || (value.is_number_unsigned() && value.get<std::uint64_t>() > INT64_MAX)) {
      refuse(where, "must be an integer");
    }
    return value.get<std::int64_t>();
  }

  std::int64_t integer(const Json& object, const char* key, const std::string& where) const {
    return whole(member(object, key, where), path(where, key));
  }

  int identifier(const Json& object, const char* key, const std::string& where) const {
    const std::int64_t value = integer(object, key, where);
    if (value < 0 || value > std::numeric_limits<int>::max())
      refuse(path(where, key), "must be an integer, at least 0");
    return static_cast<int>(value);
  }

  const Json& list(const Json& object, const char* key, const std::string& where) const {
    const Json& value = member(object, key, where);
    if (!value.is_array()) refuse(path(where, key), "must be a list");
    return value;
  }

  Eigen::Vector3d vector(const Json& value, const std::string& where) const {
    if (!value.is_array() || value.size() != 3) refuse(where, "must be a list of three numbers");
    Eigen::Vector3d result;
    for (std::size_t k = 0; k < 3; ++k) result[static_cast<Eigen::Index>(k)] = finite(value[k], item(where, k));
    return result;
  }

  Eigen::Vector3d direction(const Json& value, const std::string& where) const {
    const Eigen::Vector3d result = vector(value, where);
    const double length = result.stableNorm();
    if (!(length > 0)) refuse(where, "must not be all 0");
    return result / length;
  }

  Motion motion(const Json& value, const std::string& where) const {
    const bool rows = value.is_array() && value.size() == 3 &&
                      std::ranges::all_of(value, [](const Json& row) { return row.is_array() && row.size() == 4; });
    if (!rows) refuse(where, "must be a 3x4 matrix: three rows of four numbers");
    Motion result;
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 4; ++j) {
        const double entry = finite(value[i][j], item(item(where, i), j));
        const auto row = static_cast<Eigen::Index>(i);
        (j < 3 ? result.linear(row, static_cast<Eigen::Index>(j)) : result.translation[row]) = entry;
      }
    }
    const double error = orthogonality_error(result.linear);
    if (!(error <= kOrthogonal)) {
      refuse(where, "is not orthogonal: |R R^T - 1| is " + number_text(error) + ", at most 1e-6 is allowed");
    }
    return result;
  }

  std::vector<Motion> motions(const Json& object, const char* key, const std::string& where) const {
    const Json& values = list(object, key, where);
    std::vector<Motion> result;
    for (std::size_t i = 0; i < values.size(); ++i) result.push_back(motion(values[i], item(path(where, key), i)));
    return result;
  }

  Residual residual(const Json& object, const std::string& where) const {
    const Json& value = member(object, "residual", where);
    const std::string inner = path(where, "residual");
    const Residual result{number(value, "rms", inner), number(value, "max", inner)};
    if (result.rms < 0 || result.max < 0) refuse(inner, "must not be negative");
    return result;
  }

  // Runs that people wrote out of order or touching mean the same set; only runs outside the mesh mean nothing.
  std::vector<int> faces(const Json& object, const std::string& where) const {
    const Json& runs = list(object, "faces", where);
    const std::string inner = path(where, "faces");
    std::vector<std::pair<std::int64_t, std::int64_t>> ranges;
    for (std::size_t r = 0; r < runs.size(); ++r) {
      if (!runs[r].is_array() || runs[r].size() != 2) refuse(item(inner, r), "must be a run [first, count]");
      const std::int64_t first = whole(runs[r][0], item(inner, r));
      const std::int64_t count = whole(runs[r][1], item(inner, r));
      if (first < 0 || count < 1 || first > mesh_.faces.rows() || count > mesh_.faces.rows() - first) {
        refuse(item(inner, r), "the run [" + std::to_string(first) + ", " + std::to_string(count) +
                                   "] is outside the mesh, which has " + std::to_string(mesh_.faces.rows()) + " faces");
      }
      ranges.emplace_back(first, first + count);
    }
    if (ranges.empty()) refuse(inner, "must name at least one face");
    std::ranges::sort(ranges);
    std::vector<int> result;
    std::int64_t next = 0;
    for (const auto& [first, end] : ranges) {
      for (next = std::max(next, first); next < end; ++next) result.push_back(static_cast<int>(next));
    }
    return result;
  }

  void read_mesh_counts(const Json& object, SymmetryAnnotation& annotation) const {
    const std::int64_t vertices = integer(object, "vertices", "mesh");
    const std::int64_t face_count = integer(object, "faces", "mesh");
    const auto differ = [&](const char* what, std::int64_t given, std::int64_t actual) {
      refuse(std::string("mesh.") + what, "the annotation is of a mesh with " + std::to_string(given) + " " + what +
                                              ", this one has " + std::to_string(actual));
    };
    if (face_count != mesh_.faces.rows()) differ("faces", face_count, mesh_.faces.rows());
    if (vertices != mesh_.vertices.rows() && !(unconnected(mesh_) && vertices == distinct_vertices(mesh_))) {
      differ("vertices", vertices, mesh_.vertices.rows());
    }
    annotation.mesh_vertices = static_cast<int>(mesh_.vertices.rows());
    annotation.mesh_faces = static_cast<int>(face_count);
    annotation.mesh_diagonal = number(object, "diagonal", "mesh");
  }

  PointGroup group(const Json& object, const std::string& where) const {
    const std::string symbol = string(object, "group", where);
    const auto result = PointGroup::parse(symbol);
    if (!result || result->family == PointGroup::Family::C1) {
      refuse(path(where, "group"),
             in_quotes(symbol) + " is no symbol of a point group such as Cs, C4v, D2h, Oh or Dinfh");
    }
    return *result;
  }

  Region region(const Json& object, const std::string& where) const {
    Region result;
    result.id = identifier(object, "id", where);
    result.name = string(object, "name", where);
    result.group = group(object, where);
    result.centre = vector(member(object, "centre", where), path(where, "centre"));
    if (result.group.has_axis()) {
      result.axis = vector(member(object, "axis", where), path(where, "axis"));
      const double length = result.axis.norm();
      if (!(std::abs(length - 1) <= kUnitLength)) {
        refuse(path(where, "axis"), "must be a unit vector, its length is " + number_text(length));
      }
      if (std::abs(length - 1) > 1e-15) result.axis /= length;
    }
    result.generators = motions(object, "generators", where);
    result.elements = motions(object, "elements", where);
    result.faces = faces(object, where);
    if (const Json& parent = member(object, "parent", where); !parent.is_null()) {
      result.parent = identifier(object, "parent", where);
    }
    result.residual = residual(object, where);
    check_group(result, where);
    return result;
  }

  // Seen from the region's centre: far from the origin the translations alone would have lost their digits.
  std::vector<Motion> about_centre(const std::vector<Motion>& given, const Region& region,
                                   const std::string& where) const {
    std::vector<Motion> result;
    for (std::size_t i = 0; i < given.size(); ++i) {
      const Motion local{given[i].linear, given[i](region.centre) - region.centre};
      const double moved = local.translation.norm() / diagonal_;
      if (!(moved <= kClosed)) {
        refuse(item(where, i), "moves the region's centre by " + number_text(moved) + " of the mesh's diagonal");
      }
      result.push_back(local);
    }
    return result;
  }

  void check_group(const Region& region, const std::string& where) const {
    const std::string symbol = region.group.symbol();
    const std::string inner = path(where, "elements");
    about_centre(region.generators, region, path(where, "generators"));
    if (region.group.continuous()) {
      if (!region.elements.empty()) refuse(inner, "must be [] for the continuous group " + symbol);
      return;
    }
    if (region.elements.size() > kMaxElements) refuse(inner, "more than 4096 elements are not read");
    if (static_cast<int>(region.elements.size()) != region.group.order()) {
      refuse(inner, "has " + std::to_string(region.elements.size()) + " motions, but " + symbol + " has " +
                        std::to_string(region.group.order()) + " elements");
    }
    const ElementList elements(about_centre(region.elements, region, inner), diagonal_, kClosed);
    if (!elements.identity_first()) refuse(item(inner, 0), "must be the identity");
    if (const auto pair = elements.find_repeated()) {
      refuse(item(inner, pair->second), "repeats element " + std::to_string(pair->first));
    }
    if (const auto pair = elements.find_missing_product()) {
      refuse(inner, "is not closed: the product of elements " + std::to_string(pair->first) + " and " +
                        std::to_string(pair->second) + " is not in the list");
    }
    std::vector<Eigen::Matrix3d> linear;
    for (const Motion& element : region.elements) linear.push_back(element.linear);
    const auto formed = classify(linear);
    if (formed && formed->group != region.group) {
      refuse(path(where, "group"), "is " + symbol + ", but the elements form " + formed->group.symbol());
    }
  }

  // Where a parent has been taken out of the file by hand, all parents are found anew.
  void check_parents(std::vector<Region>& regions) const {
    for (std::size_t r = 0; r < regions.size(); ++r) {
      const auto same_id = [&](const Region& other) { return other.id == regions[r].id; };
      if (std::any_of(regions.begin(), regions.begin() + static_cast<std::ptrdiff_t>(r), same_id)) {
        refuse(item("regions", r) + ".id", "is " + std::to_string(regions[r].id) + ", as that of an earlier region");
      }
    }
    const bool complete = std::ranges::all_of(regions, [&](const Region& region) {
      return !region.parent || std::ranges::find(regions, *region.parent, &Region::id) != regions.end();
    });
    if (!complete) return set_parents(regions);
    for (std::size_t r = 0; r < regions.size(); ++r) {
      std::optional<int> ancestor = regions[r].parent;
      for (std::size_t steps = 0; ancestor.has_value(); ++steps) {
        if (steps > regions.size()) refuse(item("regions", r) + ".parent", "leads back to the region itself");
        ancestor = std::ranges::find(regions, *ancestor, &Region::id)->parent;
      }
    }
  }

  Pattern pattern(const Json& object, const std::string& where) const {
    Pattern result;
    result.id = identifier(object, "id", where);
    result.name = string(object, "name", where);
    const std::string name = string(object, "kind", where);
    const auto kind = parse_pattern_kind(name);
    if (!kind) refuse(path(where, "kind"), in_quotes(name) + " is no kind of pattern");
    result.kind = *kind;
    result.generators = motions(object, "generators", where);
    if (static_cast<int>(result.generators.size()) != generator_count(*kind)) {
      refuse(path(where, "generators"), "has " + std::to_string(result.generators.size()) + " motions, but " + name +
                                            " needs " + std::to_string(generator_count(*kind)));
    }
    const Json& instances = list(object, "instances", where);
    if (instances.size() < 2) refuse(path(where, "instances"), "must hold at least two");
    for (std::size_t i = 0; i < instances.size(); ++i) {
      const std::string inner = item(path(where, "instances"), i);
      const Motion placed = motion(member(instances[i], "motion", inner), path(inner, "motion"));
      result.instances.push_back({placed, faces(instances[i], inner)});
    }
    const double reach = std::max(diagonal_, mesh_.vertices.cwiseAbs().maxCoeff());
    if (motion_distance(result.instances.front().motion, {}, Eigen::Vector3d::Zero(), diagonal_) > kClosed * reach) {
      refuse(path(where, "instances") + "[0].motion", "must be the identity");
    }
    result.residual = residual(object, where);
    return result;
  }

  std::string file_;
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
