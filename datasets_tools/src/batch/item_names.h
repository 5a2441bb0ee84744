#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "batch/shard.h"

namespace orbifit::batch {

/// Where the files of an item lie within a folder of results: "chair/a.json" for "chair/a". Different ids have
/// different places, no file's place is another's folder, and none leaves the folder, whatever the id holds: all but
/// letters, digits, '.', '_' and '-' is written as %XX, and so are the dots of folders and those at the beginning; a
/// part of more than 120 bytes is cut and ends in the hash of the whole. \param id  not empty \param kind  ".json", or
/// "+" and a name of an output, such as "+fitted.ply"
std::filesystem::path place_of(std::string_view id, std::string_view kind);

/// The id that a file of a folder gets: its path below the folder, bytes that are no UTF-8 as %XX.
std::string id_of_path(const std::filesystem::path& below);

/// Whether all of the text is UTF-8, as JSON needs it.
bool is_utf8(std::string_view text);

}  // namespace orbifit::batch
