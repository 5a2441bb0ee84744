#include "batch/layouts.h"

#include <algorithm>
#include <array>
#include <map>
#include <regex>
#include <set>
#include <string_view>

#include "orbifit/model/errors.h"

#include "batch/item_names.h"

namespace orbifit::batch {

namespace fs = std::filesystem;

namespace {

// Where several files are one model, `best` of them is taken: the first of these patterns that has one. The id is what
// the pattern's groups have caught, joined by '/'.
struct Pattern {
  const char* layout;
  const char* path;  // ECMAScript, of the whole path below the folder
};

constexpr std::array kPatterns{
    // https://shapenet.org: v2 has models/model_normalized.obj, v1 model.obj.
    Pattern{"shapenet", R"((\d{8})/([^/]+)/models/model_normalized\.obj)"},
    Pattern{"shapenet", R"((\d{8})/([^/]+)/model\.obj)"},
    // https://modelnet.cs.princeton.edu: ModelNet40/chair/train/chair_0001.off
    Pattern{"modelnet", R"((?:ModelNet\d+/)?([^/]+)/(train|test)/([^/]+)\.off)"},
    // https://partnet.cs.stanford.edu: data_v0/ANNO/objs/PART.obj, each a part of its own.
    Pattern{"partnet", R"((?:data_v0/)?(\d+)/objs/([^/]+)\.obj)"},
    // https://deep-geometry.github.io/abc-dataset: 00000002/00000002_HASH_trimesh_000.obj, in chunks or not.
    Pattern{"abc", R"((?:[^/]+/)*(\d{8})/\d{8}_[0-9a-f]+_trimesh_(\d+)\.obj)"},
    // https://ten-thousand-models.appspot.com: Thingi10K/raw_meshes/32770.stl
    Pattern{"thingi10k", R"((?:[^/]+/)?raw_meshes/(\d+)\.(?:stl|obj|off|ply))"},
    // https://objaverse.allenai.org: glbs/000-023/UID.glb
    Pattern{"objaverse", R"((?:[^/]+/)*(\d{3}-\d{3})/([0-9a-f]{32})\.glb)"},
    // https://bop.felk.cvut.cz: DATASET/models/obj_000001.ply; other sets of models are not taken.
    Pattern{"bop", R"((?:([^/]+)/)?models/(obj_\d{6})\.ply)"},
    // https://www.ycbbenchmarks.com: 003_cracker_box/google_16k/nontextured.ply, or another scan of the object.
    Pattern{"ycb", R"((\d{3}(?:-[a-z])?_[^/]+)/google_64k/nontextured\.(?:ply|stl))"},
    Pattern{"ycb", R"((\d{3}(?:-[a-z])?_[^/]+)/google_16k/nontextured\.(?:ply|stl))"},
    Pattern{"ycb", R"((\d{3}(?:-[a-z])?_[^/]+)/google_512k/nontextured\.(?:ply|stl))"},
    Pattern{"ycb", R"((\d{3}(?:-[a-z])?_[^/]+)/poisson/nontextured\.(?:ply|stl))"},
    Pattern{"ycb", R"((\d{3}(?:-[a-z])?_[^/]+)/tsdf/nontextured\.(?:ply|stl))"},
    // https://research.google/resources/datasets/scanned-objects-google-research: NAME/meshes/model.obj
    Pattern{"gso", R"(([^/]+)/meshes/model\.obj)"},
};

std::string id_of_match(const std::cmatch& match) {
  std::string id;
  for (std::size_t g = 1; g < match.size(); ++g) {
    if (match[g].matched) id += (id.empty() ? "" : "/") + id_of_path(match[g].str());
  }
  return id;
}

}  // namespace

const std::vector<Layout>& known_layouts() {
  static const std::vector<Layout> layouts{
      {"shapenet", "ShapeNetCore v1, v2", "SYNSET/MODEL/models/model_normalized.obj, SYNSET/MODEL/model.obj"},
      {"modelnet", "ModelNet10, ModelNet40", "CLASS/train|test/NAME.off"},
      {"partnet", "PartNet", "data_v0/ANNO/objs/PART.obj"},
      {"abc", "ABC", "ID/ID_HASH_trimesh_N.obj"},
      {"thingi10k", "Thingi10K", "raw_meshes/ID.stl"},
      {"objaverse", "Objaverse", "glbs/000-023/UID.glb"},
      {"bop", "BOP", "DATASET/models/obj_000001.ply, models_info.json"},
      {"ycb", "YCB", "003_NAME/google_64k/nontextured.ply, or google_16k, google_512k, poisson, tsdf"},
      {"gso", "Google Scanned Objects", "NAME/meshes/model.obj"}};
  return layouts;
}

void for_each_item(const std::string& layout, const fs::path& folder, const std::function<void(const Item&)>& body) {
  std::vector<std::regex> patterns;
  for (const Pattern& pattern : kPatterns) {
    if (pattern.layout == layout) patterns.emplace_back(pattern.path, std::regex::optimize);
  }
  if (patterns.empty()) {
    std::string names;
    for (const Layout& known : known_layouts()) names += (names.empty() ? "" : ", ") + std::string(known.name);
    throw UsageError("the layout '" + layout + "' is unknown; known are " + names);
  }
  // Of the files of one id the one of the earlier pattern, or the earlier name.
  std::map<std::string, std::pair<std::size_t, std::string>> files;
  try {
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
      const std::string below = entry.path().lexically_relative(folder).generic_string();
      std::cmatch match;
      for (std::size_t p = 0; p < patterns.size(); ++p) {
        if (!std::regex_match(below.c_str(), match, patterns[p])) continue;
        const std::pair<std::size_t, std::string> file{p, below};
        const auto [place, added] = files.try_emplace(id_of_match(match), file);
        if (!added) place->second = std::min(place->second, file);
        break;
      }
    }
  } catch (const fs::filesystem_error& error) {
    throw InputError(folder.string(), "", "cannot be listed: " + error.code().message());
  }
  if (files.empty()) throw InputError(folder.string(), "", "holds no file of the layout '" + layout + "'");
  for (const auto& [id, file] : files) {
    Item item;
    item.id = id;
    item.mesh = folder / file.second;
    body(item);
  }
}

}  // namespace orbifit::batch
