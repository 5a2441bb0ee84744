#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace orbifit {

/// Whether the name stands for standard input or output: "-", or "-" and an ending that tells the format ("-.obj").
/// A file of that name is "./-".
bool is_standard_stream(const std::filesystem::path& file);

/// The whole file, or all of standard input. \throw InputError when it is missing, not a regular file, unreadable or
/// empty
std::string read_file(const std::filesystem::path& file);

/// Writes under a temporary name beside `file`, then renames: the file appears whole or not at all. To standard output
/// it writes at once.
/// \throw InputError when the folder does not exist or the disk refuses
void write_file(const std::filesystem::path& file, std::string_view content);

/// The ending in lower case, with its dot; ".obj" for "A/B.OBJ" and for "-.obj".
std::string lower_extension(const std::filesystem::path& file);

}  // namespace orbifit
