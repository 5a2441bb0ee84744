#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "batch/manifest.h"

namespace orbifit::batch {

/// A data set as it is published: which of its files are meshes, and what their ids are.
struct Layout {
  const char* name;     ///< "shapenet"
  const char* dataset;  ///< "ShapeNetCore v1 and v2"
  const char* files;    ///< "SYNSET/MODEL/models/model_normalized.obj"
};
const std::vector<Layout>& known_layouts();

/// Calls the function with every mesh of the data set, in the order of the ids, paths below the folder. Lists each
/// folder once. \throw UsageError for an unknown layout, InputError when nothing there fits it
void for_each_item(const std::string& layout, const std::filesystem::path& folder,
                   const std::function<void(const Item&)>& body);

}  // namespace orbifit::batch
