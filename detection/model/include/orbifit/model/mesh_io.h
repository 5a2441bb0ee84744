#pragma once

#include <filesystem>
#include <optional>

#include "orbifit/model/mesh.h"

namespace orbifit {

/// Reads OBJ, OFF, PLY (ascii, little and big endian, float and double), STL (ascii and binary), glTF and GLB, by the
/// file's ending. Order of vertices and faces and double precision are kept; polygons are cut into fans from their
/// first corner. An STL's triangles have three vertices of their own each. glTF: the default scene's triangle
/// primitives with their nodes' transforms applied, in node order.
/// \throw InputError with file, line or element and
/// reason: unreadable, empty, truncated, an index out of range, a
///        coordinate not finite or beyond 1e100, no vertices, no faces, an unknown ending
Mesh read_mesh(const std::filesystem::path& file);

/// Writes by the file's ending: OBJ and OFF with 17 digits, PLY binary little endian in double, STL binary (float),
/// GLB (float). Triangles of one polygon are written as that polygon again (OBJ, OFF, PLY). The file appears whole or
/// not at all: it is written under a temporary name and renamed.
/// \param colours optional #F or #V by 3 in [0, 1]; written by PLY only
/// \throw InputError when it cannot be written, UsageError for an unknown ending
void write_mesh(const std::filesystem::path& file, const Mesh& mesh,
                const std::optional<Points>& colours = std::nullopt);

}  // namespace orbifit
