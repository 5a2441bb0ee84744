#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "orbifit/model/mesh.h"

#include "bad_input/bad_input.h"

namespace orbifit {

/// "3 vertices".
std::string counted(long long count, const std::string& what);

/// "read: " and what `read` returns; or the message of its InputError, without the folders of the file's name. Any
/// other exception, as of a defect, passes through.
std::string read_or_refused(const std::filesystem::path& file, const std::function<std::string()>& read);

/// Hands the file to its reader and counts what was read. \pre a kind that model reads: mesh, scan, annotation
std::string model_reading(BadInputKind kind, const std::filesystem::path& file, const Mesh& mesh_of_annotation);

}  // namespace orbifit
