#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace orbifit {

/// The whole file. \throw InputError when it is missing, not a regular file, unreadable or empty
std::string read_file(const std::filesystem::path& file);

/// Writes under a temporary name beside `file`, then renames: the file appears whole or not at all.
/// \throw InputError when the folder does not exist or the disk refuses
void write_file(const std::filesystem::path& file, std::string_view content);

/// The ending in lower case, with its dot; ".obj" for "A/B.OBJ".
std::string lower_extension(const std::filesystem::path& file);

}  // namespace orbifit
