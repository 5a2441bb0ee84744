#include "batch/bop.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include <nlohmann/json.hpp>

#include "orbifit/model/annotation_io.h"
#include "orbifit/model/errors.h"
#include "orbifit/model/mesh_io.h"

#include "batch/item_names.h"
#include "files/file.h"

namespace orbifit::batch {

namespace fs = std::filesystem;
using nlohmann::json;
using nlohmann::ordered_json;

namespace {

constexpr double kRotationTolerance = 1e-3;  // of entries that people have typed with four digits
constexpr double kTolerance = 0.005;         // of the annotation: detection's own
constexpr double kWhole = 0.999;             // share of the area from which on a region is all of the mesh

Motion motion_of(const json& numbers, const std::string& name) {
  if (!numbers.is_array() || numbers.size() != 16)
    throw InputError(name, "symmetries_discrete", "must be lists of 16 numbers");
  Motion motion;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) motion.linear(r, c) = numbers.at(static_cast<std::size_t>(4 * r + c)).get<double>();
    motion.translation[r] = numbers.at(static_cast<std::size_t>(4 * r + 3)).get<double>();
  }
  if (!(orthogonality_error(motion.linear) < kRotationTolerance) || motion.linear.determinant() < 0) {
    throw InputError(name, "symmetries_discrete", "has a matrix that is no rotation");
  }
  return motion;
}

Eigen::Vector3d vector_of(const json& numbers) {
  return {numbers.at(0).get<double>(), numbers.at(1).get<double>(), numbers.at(2).get<double>()};
}

std::vector<int> all_faces(const Mesh& mesh) {
  std::vector<int> faces(static_cast<std::size_t>(mesh.faces.rows()));
  std::iota(faces.begin(), faces.end(), 0);
  return faces;
}

Region discrete_region(const std::vector<Motion>& motions, const Mesh& mesh, const std::string& name) {
  std::vector<Eigen::Matrix3d> linear{Eigen::Matrix3d::Identity()};
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const Motion& motion : motions) {
    linear.push_back(motion.linear);
    centre += motion.translation;
  }
  // All elements together leave the mean of the images of any point where it is: of the origin.
  centre /= static_cast<double>(linear.size());
  const auto group = classify(linear, kRotationTolerance);
  if (!group) throw InputError(name, "symmetries_discrete", "do not form a group together with the identity");
  return make_region(group->group, centre, group->frame, all_faces(mesh), "whole");
}

Region continuous_region(const json& axes, const std::vector<Motion>& motions, const Mesh& mesh) {
  const Eigen::Vector3d axis = vector_of(axes.at(0).at("axis")).normalized();
  const Eigen::Vector3d offset = vector_of(axes.at(0).at("offset"));
  PointGroup group;
  const bool sphere = std::ranges::any_of(axes, [&](const json& other) {
    return vector_of(other.at("axis")).normalized().cross(axis).norm() > kRotationTolerance;
  });
  const bool flips =
      std::ranges::any_of(motions, [&](const Motion& motion) { return axis.dot(motion.linear * axis) < 0; });
  group.family = sphere ? PointGroup::Family::K : flips ? PointGroup::Family::Dinf : PointGroup::Family::Cinf;
  Eigen::Vector3d centre = offset;
  // What turns the axis round leaves one of its points where it is.
  for (const Motion& motion : motions) {
    if (axis.dot(motion.linear * axis) < 0) centre = offset + 0.5 * axis * axis.dot(motion(offset) - offset);
  }
  return make_region(group, centre, frame_about(axis), all_faces(mesh), "whole");
}

ordered_json matrix_json(const Motion& motion) {
  ordered_json numbers = ordered_json::array();
  const auto add = [&](double value) { numbers.push_back(value == 0 ? 0.0 : value); };
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) add(motion.linear(r, c));
    add(motion.translation[r]);
  }
  for (const double value : {0.0, 0.0, 0.0, 1.0}) add(value);
  return numbers;
}

ordered_json vector_json(const Eigen::Vector3d& vector) {
  return {vector.x(), vector.y(), vector.z()};
}

// The largest distance between two vertices. Those far from the middle first, until no pair that is left can be
// farther.
double diameter(const Points& points) {
  const Eigen::RowVector3d middle = points.colwise().mean();
  const Eigen::VectorXd reach = (points.rowwise() - middle).rowwise().norm();
  std::vector<Eigen::Index> order(static_cast<std::size_t>(points.rows()));
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::ranges::sort(order, std::ranges::greater{}, [&](Eigen::Index v) { return reach[v]; });
  double longest = 0;
  for (std::size_t i = 0; i < order.size() && 2 * reach[order[i]] > longest; ++i) {
    for (std::size_t j = i + 1; j < order.size() && reach[order[i]] + reach[order[j]] > longest; ++j) {
      longest = std::max(longest, (points.row(order[i]) - points.row(order[j])).norm());
    }
  }
  return longest;
}

void add_continuous(ordered_json& entry, const Region& region) {
  using Family = PointGroup::Family;
  const Family family = region.group.family;
  const bool sphere = family == Family::K || family == Family::Kh;
  const Eigen::Vector3d axis = sphere ? Eigen::Vector3d::UnitZ() : region.axis;
  entry["symmetries_continuous"].push_back({{"axis", vector_json(axis)}, {"offset", vector_json(region.centre)}});
  // A sphere is told by two axes.
  if (sphere)
    entry["symmetries_continuous"].push_back({{"axis", {1.0, 0.0, 0.0}}, {"offset", vector_json(region.centre)}});
  if (family == Family::Dinf || family == Family::Dinfh) {
    const Eigen::Vector3d across = frame_about(axis).col(0);
    entry["symmetries_discrete"].push_back(matrix_json(Motion::rotation(across, std::acos(-1.0), region.centre)));
  }
}

// "obj_000012" gives 12; 0 where the id ends otherwise.
int object_number(const std::string& id) {
  const std::size_t at = id.rfind("obj_");
  if (at == std::string::npos || id.size() != at + 10) return 0;
  const std::string digits = id.substr(at + 4);
  return digits.find_first_not_of("0123456789") == std::string::npos ? std::stoi(digits) : 0;
}

}  // namespace

SymmetryAnnotation annotation_from_bop(const std::string& text, const Mesh& mesh, const std::string& name) {
  SymmetryAnnotation annotation = empty_annotation(mesh, kTolerance);
  try {
    const json entry = json::parse(text);
    std::vector<Motion> motions;
    for (const json& matrix : entry.value("symmetries_discrete", json::array()))
      motions.push_back(motion_of(matrix, name));
    const json axes = entry.value("symmetries_continuous", json::array());
    if (!axes.empty()) {
      annotation.regions.push_back(continuous_region(axes, motions, mesh));
    } else if (!motions.empty()) {
      annotation.regions.push_back(discrete_region(motions, mesh, name));
    }
  } catch (const json::exception& error) {
    throw InputError(name, "", std::string("is no entry of models_info.json: ") + error.what());
  }
  return annotation;
}

std::string annotation_to_bop(const SymmetryAnnotation& annotation, const Mesh& mesh) {
  const Eigen::Vector3d low = mesh.vertices.colwise().minCoeff(), high = mesh.vertices.colwise().maxCoeff();
  ordered_json entry{{"diameter", diameter(mesh.vertices)}};
  const char* const names[] = {"x", "y", "z"};
  for (int k = 0; k < 3; ++k) entry[std::string("min_") + names[k]] = low[k];
  for (int k = 0; k < 3; ++k) entry[std::string("size_") + names[k]] = high[k] - low[k];
  const Eigen::VectorXd areas = face_areas(mesh);
  for (const Region& region : annotation.regions) {
    double area = 0;
    for (const int face : region.faces) area += areas[face];
    if (area < kWhole * areas.sum()) continue;
    if (region.group.continuous()) {
      add_continuous(entry, region);
    } else {
      for (const Motion& motion : region.elements) {
        const bool identity = (motion.linear - Eigen::Matrix3d::Identity()).norm() < 1e-9;
        if (motion.linear.determinant() > 0 && !identity) entry["symmetries_discrete"].push_back(matrix_json(motion));
      }
    }
    break;
  }
  return entry.dump();
}

void add_bop_annotation(Item& item, const fs::path& folder) {
  const fs::path file = item.mesh.parent_path() / "models_info.json";
  if (!fs::exists(file)) return;
  const json all = json::parse(read_file(file), nullptr, false);
  if (!all.is_object()) throw InputError(file.string(), "", "is no JSON object");
  const std::string key = std::to_string(object_number(item.id));
  if (!all.contains(key)) return;
  const Mesh mesh = read_mesh(item.mesh);
  const SymmetryAnnotation annotation = annotation_from_bop(all.at(key).dump(), mesh, file.string() + ": " + key);
  if (annotation.regions.empty()) return;
  item.annotation = folder / place_of(item.id, ".json");
  std::error_code code;
  fs::create_directories(item.annotation.parent_path(), code);
  write_annotation(item.annotation, annotation);
}

void write_models_info(const Collection& collection, const fs::path& file) {
  std::map<int, std::string> entries;
  for (std::size_t i = 0; i < collection.size(); ++i) {
    const Record record = collection.record(i);
    const int number = object_number(record.id);
    const fs::path result = collection.folder() / place_of(record.id, ".json");
    if (number == 0 || record.status > Status::no_symmetry || !fs::exists(result)) continue;
    const Mesh mesh = read_mesh(json::parse(record.summary).at("mesh").at("file").get<std::string>());
    if (!entries.emplace(number, annotation_to_bop(read_annotation(result, mesh), mesh)).second) {
      throw InputError(file.string(), "",
                       "two items are object " + std::to_string(number) + "; export the data sets one by one");
    }
  }
  if (entries.empty()) throw InputError(file.string(), "", "no item's id ends in obj_NNNNNN");
  std::string text = "{\n";
  for (const auto& [number, entry] : entries) {
    text += (text.size() > 2 ? ",\n" : "") + std::string("  \"") + std::to_string(number) + "\": " + entry;
  }
  write_file(file, text + "\n}\n");
}

}  // namespace orbifit::batch
