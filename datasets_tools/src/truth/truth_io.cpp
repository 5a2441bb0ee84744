#include <algorithm>
#include <cstdint>
#include <set>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "orbifit/datasets_tools/truth.h"
#include "orbifit/model/annotation_io.h"
#include "orbifit/model/errors.h"

#include "files/file.h"

namespace orbifit {

namespace {

using Json = nlohmann::ordered_json;

Json runs_of(const std::vector<int>& faces) {
  Json runs = Json::array();
  for (const int face : faces) {
    if (!runs.empty() && runs.back()[0].get<int>() + runs.back()[1].get<int>() == face) {
      runs.back()[1] = runs.back()[1].get<int>() + 1;
    } else {
      runs.push_back(Json::array({face, 1}));
    }
  }
  return runs;
}

// Items by their ids, the expected ones first.
template <typename Item>
void check_ids(const std::vector<Item>& expected, const std::vector<Item>& optional, const std::string& list) {
  std::set<int> ids;
  for (const auto* items : {&expected, &optional}) {
    for (const Item& item : *items) {
      if (!ids.insert(item.id).second) throw UsageError(list + ": id " + std::to_string(item.id) + " occurs twice");
    }
  }
}

std::vector<int> faces_of_runs(const Json& runs, const std::string& file, const std::string& where, int face_count) {
  if (!runs.is_array() || runs.empty()) throw InputError(file, where, "must be a list of runs [first, count]");
  std::set<int> faces;
  for (const Json& run : runs) {
    const bool pair = run.is_array() && run.size() == 2 && run[0].is_number_integer() && run[1].is_number_integer();
    if (!pair) throw InputError(file, where, "must hold runs [first, count]");
    const auto first = run[0].get<std::int64_t>();
    const auto count = run[1].get<std::int64_t>();
    if (first < 0 || count < 1 || first > face_count || count > face_count - first) {
      throw InputError(file, where,
                       "the run [" + std::to_string(first) + ", " + std::to_string(count) +
                           "] is outside the mesh, which has " + std::to_string(face_count) + " faces");
    }
    for (std::int64_t face = first; face < first + count; ++face) faces.insert(static_cast<int>(face));
  }
  return {faces.begin(), faces.end()};
}

void read_also_accepted(const Json& regions, const std::string& list, const std::string& file, DetectionTruth& truth) {
  for (std::size_t r = 0; r < regions.size(); ++r) {
    const auto sets = regions[r].find("also_accept");
    if (sets == regions[r].end()) continue;
    const std::string where = list + "[" + std::to_string(r) + "].also_accept";
    if (!sets->is_array()) throw InputError(file, where, "must be a list of face sets");
    auto& accepted = truth.also_accepted[regions[r].at("id").get<int>()];
    for (std::size_t k = 0; k < sets->size(); ++k) {
      const std::string inner = where + "[" + std::to_string(k) + "]";
      accepted.push_back(faces_of_runs((*sets)[k], file, inner, truth.expected.mesh_faces));
    }
    if (accepted.empty()) truth.also_accepted.erase(regions[r].at("id").get<int>());
  }
}

// A key's list, empty where it is absent.
Json optional_list(const Json& root, const std::string& key, const std::string& file) {
  const auto found = root.find(key);
  if (found == root.end()) return Json::array();
  if (!found->is_array()) throw InputError(file, key, "must be a list");
  return *found;
}

}  // namespace

std::string to_json(const DetectionTruth& truth) {
  check_ids(truth.expected.regions, truth.optional_regions, "regions");
  check_ids(truth.expected.patterns, truth.optional_patterns, "patterns");
  SymmetryAnnotation optional = truth.expected;
  optional.regions = truth.optional_regions;
  optional.patterns = truth.optional_patterns;
  Json root = Json::parse(to_json(truth.expected));
  Json further = Json::parse(to_json(optional));
  root["optional_regions"] = std::move(further["regions"]);
  root["optional_patterns"] = std::move(further["patterns"]);
  for (const auto& [id, sets] : truth.also_accepted) {
    bool found = false;
    for (const char* list : {"regions", "optional_regions"}) {
      for (Json& region : root[list]) {
        if (region["id"] != id) continue;
        found = true;
        for (const std::vector<int>& faces : sets) region["also_accept"].push_back(runs_of(faces));
      }
    }
    if (!found) throw UsageError("also_accepted: there is no region " + std::to_string(id));
  }
  // One item a line.
  std::string text = "{";
  for (const auto& [key, value] : root.items()) {
    text += text.size() > 1 ? ",\n\"" : "\n\"";
    text += key + "\": ";
    if (!value.is_array()) {
      text += value.dump();
      continue;
    }
    text += "[";
    for (std::size_t i = 0; i < value.size(); ++i) text += (i > 0 ? ",\n" : "\n") + value[i].dump();
    text += value.empty() ? "]" : "\n]";
  }
  return text + "\n}\n";
}

void write_truth(const std::filesystem::path& file, const DetectionTruth& truth) {
  write_file(file, to_json(truth));
}

DetectionTruth read_truth(const std::filesystem::path& file, const Mesh& mesh) {
  const std::string name = file.string();
  const std::string text = read_file(file);
  DetectionTruth truth;
  truth.expected = annotation_from_json(text, mesh, name);
  Json root = Json::parse(text);
  const Json regions = optional_list(root, "optional_regions", name);
  const Json patterns = optional_list(root, "optional_patterns", name);

  // The optional ones are read behind the expected ones, whom they may name as parents.
  Json together = root;
  together["regions"].insert(together["regions"].end(), regions.begin(), regions.end());
  together["patterns"].insert(together["patterns"].end(), patterns.begin(), patterns.end());
  const SymmetryAnnotation all =
      annotation_from_json(together.dump(), mesh, name + ", its optional items behind the expected ones");
  const auto rest = [](const auto& items, std::size_t first) {
    return std::decay_t<decltype(items)>(items.begin() + static_cast<std::ptrdiff_t>(first), items.end());
  };
  truth.optional_regions = rest(all.regions, truth.expected.regions.size());
  truth.optional_patterns = rest(all.patterns, truth.expected.patterns.size());
  read_also_accepted(root["regions"], "regions", name, truth);
  read_also_accepted(regions, "optional_regions", name, truth);
  return truth;
}

}  // namespace orbifit
