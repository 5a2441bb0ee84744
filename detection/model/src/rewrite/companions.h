#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace orbifit {

/// The files that a mesh file names: material libraries of OBJ with their textures, external buffers and images of
/// glTF. As they are written there, without repetition.
std::vector<std::string> companions(const std::filesystem::path& source, std::string_view content);

/// Copies them beside `file`, where they lie as they did beside `source`; those that are there already stay.
/// \return what could not be copied, a line each
std::vector<std::string> copy_companions(const std::filesystem::path& file, const std::filesystem::path& source,
                                         std::string_view content);

}  // namespace orbifit
