#include "orbifit/fitting/landmarks.h"

#include <cmath>
#include <string>

#include <nlohmann/json.hpp>

#include "orbifit/model/errors.h"

#include "files/file.h"
#include "files/json_text.h"
#include "files/mesh_builder.h"

namespace orbifit {

std::vector<Landmark> read_landmarks(const std::filesystem::path& file, const Mesh& mesh) {
  const auto document = parse_json(file.string(), read_file(file));
  const auto fail = [&](const std::string& key, const std::string& reason) {
    throw InputError(file.string(), key, reason);
  };
  if (!document.is_object() || !document.contains("landmarks") || !document.at("landmarks").is_array()) {
    fail("landmarks", "must be a list");
  }
  std::vector<Landmark> landmarks;
  for (const auto& entry : document.at("landmarks")) {
    const std::string key = "landmarks[" + std::to_string(landmarks.size()) + "]";
    if (!entry.is_object() || !entry.contains("vertex") || !entry.contains("target")) {
      fail(key, "must have vertex and target");
    }
    const auto& vertex = entry.at("vertex");
    if (!vertex.is_number_integer() || vertex.get<long long>() < 0 || vertex.get<long long>() >= mesh.vertices.rows()) {
      fail(key + ".vertex",
           vertex.dump() + " is no vertex of the template, which has " + std::to_string(mesh.vertices.rows()));
    }
    const auto& target = entry.at("target");
    Landmark landmark;
    landmark.vertex = vertex.get<int>();
    if (!target.is_array() || target.size() != 3) fail(key + ".target", "must be three numbers");
    for (int k = 0; k < 3; ++k) {
      const auto& coordinate = target.at(static_cast<std::size_t>(k));
      if (!coordinate.is_number()) fail(key + ".target", "must be three numbers");
      landmark.target[k] = coordinate.get<double>();
      if (!(std::abs(landmark.target[k]) <= kLargestCoordinate)) {
        fail(key + ".target", "must be three numbers of at most 1e50 in size");
      }
    }
    for (std::size_t i = 0; i < landmarks.size(); ++i) {
      const std::string other = "landmarks[" + std::to_string(i) + "]";
      if (landmarks[i].vertex == landmark.vertex) fail(key + ".vertex", "is that of " + other + " too");
      if (landmarks[i].target == landmark.target) fail(key + ".target", "is that of " + other + " too");
    }
    landmarks.push_back(landmark);
  }
  if (landmarks.empty()) fail("landmarks", "is empty");
  return landmarks;
}

}  // namespace orbifit
