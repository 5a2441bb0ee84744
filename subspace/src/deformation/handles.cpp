#include "orbifit/subspace/handles.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>

#include <nlohmann/json.hpp>

#include "orbifit/model/errors.h"

#include "files/file.h"
#include "files/json_text.h"
#include "files/mesh_builder.h"

namespace orbifit {

namespace {

using Json = nlohmann::json;

// A place where vertices may be as well.
bool within_reach(const Json& number) {
  return std::abs(number.get<double>()) <= kLargestCoordinate;
}

// Reads values of one file, with the file's name and the key in every message.
class HandleReader {
 public:
  explicit HandleReader(std::filesystem::path file) : file_(std::move(file)) {}

  [[noreturn]] void fail(const std::string& key, const std::string& reason) const {
    throw InputError(file_.string(), key, reason);
  }

  double number(const Json& object, const std::string& name, const std::string& key, double fallback) const {
    if (!object.contains(name)) return fallback;
    const Json& value = object.at(name);
    if (!value.is_number() || !within_reach(value)) fail(key + name, "must be a number of at most 1e50 in size");
    return value.get<double>();
  }

  Eigen::Vector3d vector(const Json& object, const std::string& name, const std::string& key) const {
    const Json& value = object.at(name);
    const bool three = value.is_array() && value.size() == 3 &&
                       std::ranges::all_of(value, [](const Json& v) { return v.is_number(); });
    if (!three) fail(key + name, "must be three numbers");
    if (!std::ranges::all_of(value, within_reach)) fail(key + name, "must be three numbers of at most 1e50 in size");
    return {value[0].get<double>(), value[1].get<double>(), value[2].get<double>()};
  }

 private:
  std::filesystem::path file_;
};

std::vector<int> vertices_within(const Mesh& mesh, const Eigen::Vector3d& centre, double radius) {
  std::vector<int> result;
  for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) {
    if ((mesh.vertices.row(v).transpose() - centre).norm() <= radius) result.push_back(static_cast<int>(v));
  }
  return result;
}

std::vector<int> listed_vertices(const HandleReader& reader, const Json& list, const std::string& key,
                                 const Mesh& mesh) {
  if (!list.is_array()) reader.fail(key, "must be a list of vertex numbers");
  std::vector<int> result;
  for (const Json& entry : list) {
    if (!entry.is_number_integer() || entry.get<long long>() < 0 || entry.get<long long>() >= mesh.vertices.rows()) {
      reader.fail(key, entry.dump() + " is no vertex of the mesh, which has " + std::to_string(mesh.vertices.rows()));
    }
    result.push_back(entry.get<int>());
  }
  std::ranges::sort(result);
  result.erase(std::unique(result.begin(), result.end()), result.end());
  return result;
}

Motion read_motion(const HandleReader& reader, const Json& object, const std::string& key,
                   const Eigen::Vector3d& centroid) {
  Motion motion;
  if (object.contains("scale")) {
    const double factor = reader.number(object, "scale", key, 1);
    if (!(factor > 0)) reader.fail(key + "scale", "must be positive");
    motion = Motion::about(factor * Eigen::Matrix3d::Identity(), centroid);
  }
  if (object.contains("rotation")) {
    const Json& rotation = object.at("rotation");
    const std::string place = key + "rotation.";
    if (!rotation.is_object() || !rotation.contains("axis") || !rotation.contains("degrees")) {
      reader.fail(key + "rotation", "must have axis and degrees");
    }
    const Eigen::Vector3d axis = reader.vector(rotation, "axis", place);
    if (!(axis.norm() > 1e-12)) reader.fail(place + "axis", "must not be zero");
    const Eigen::Vector3d about = rotation.contains("about") ? reader.vector(rotation, "about", place) : centroid;
    const double radians = reader.number(rotation, "degrees", place, 0) * std::numbers::pi / 180;
    motion = Motion::rotation(axis.normalized(), radians, about) * motion;
  }
  if (object.contains("translation")) motion.translation += reader.vector(object, "translation", key);
  return motion;
}

std::string nothing_within(const Mesh& mesh, const Eigen::Vector3d& centre, double radius) {
  Eigen::Index nearest = 0;
  const double distance =
      std::sqrt((mesh.vertices.rowwise() - centre.transpose()).rowwise().squaredNorm().minCoeff(&nearest));
  std::array<char, 160> text{};
  std::snprintf(text.data(), text.size(),
                "takes no vertex of the mesh: the nearest, %lld at %.4g %.4g %.4g, is %.4g from the centre, the radius "
                "is %.4g",
                static_cast<long long>(nearest), mesh.vertices(nearest, 0), mesh.vertices(nearest, 1),
                mesh.vertices(nearest, 2), distance, radius);
  return text.data();
}

Handle read_handle(const HandleReader& reader, const Json& object, const std::string& key, const Mesh& mesh) {
  if (!object.is_object()) reader.fail(key, "must be an object");
  const std::string inside = key + ".";
  Handle handle;
  handle.name = key;
  if (object.contains("name")) {
    if (!object.at("name").is_string()) reader.fail(inside + "name", "must be a text");
    handle.name = object.at("name").get<std::string>();
  }
  if (object.contains("vertices")) {
    handle.vertices = listed_vertices(reader, object.at("vertices"), inside + "vertices", mesh);
  } else {
    if (!object.contains("centre") || !object.contains("radius")) {
      reader.fail(key, "needs centre and radius, or vertices");
    }
    const double radius = reader.number(object, "radius", inside, 0);
    if (!(radius > 0)) reader.fail(inside + "radius", "must be positive");
    const Eigen::Vector3d centre = reader.vector(object, "centre", inside);
    handle.vertices = vertices_within(mesh, centre, radius);
    if (handle.vertices.empty()) reader.fail(key + " \"" + handle.name + "\"", nothing_within(mesh, centre, radius));
  }
  if (handle.vertices.empty()) reader.fail(key + " \"" + handle.name + "\"", "takes no vertex of the mesh");
  const Eigen::Vector3d centroid = mesh.vertices(handle.vertices, Eigen::all).colwise().mean();
  handle.motion = read_motion(reader, object, inside, centroid);
  return handle;
}

}  // namespace

HandleSet read_handles(const std::filesystem::path& file, const Mesh& mesh) {
  const HandleReader reader(file);
  const Json document = parse_json(file.string(), read_file(file));
  if (!document.is_object() || !document.contains("handles") || !document.at("handles").is_array()) {
    reader.fail("handles", "must be a list");
  }
  HandleSet set;
  set.alpha = reader.number(document, "alpha", "", set.alpha);
  if (!(set.alpha > 0)) reader.fail("alpha", "must be positive");
  const double iterations = reader.number(document, "iterations", "", set.iterations);
  if (!(iterations >= 1 && iterations <= 100000) || iterations != std::floor(iterations)) {
    reader.fail("iterations", "must be a whole number from 1 to 100000");
  }
  set.iterations = static_cast<int>(iterations);
  int number = 0;
  for (const Json& entry : document.at("handles")) {
    set.handles.push_back(read_handle(reader, entry, "handles[" + std::to_string(number++) + "]", mesh));
  }
  if (set.handles.empty()) reader.fail("handles", "is empty");
  return set;
}

}  // namespace orbifit
