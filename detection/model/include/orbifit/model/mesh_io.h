#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "orbifit/model/mesh.h"

namespace orbifit {

/// Reads OBJ, OFF, PLY (ascii, little and big endian, float and double), STL (ascii and binary), glTF, GLB and 3MF, by
/// the file's ending. Order of vertices and faces and double precision are kept; polygons are cut into fans from their
/// first corner. An STL's triangles have three vertices of their own each. glTF: the default scene's triangle
/// primitives with their nodes' transforms applied, in node order. 3MF: the build's items likewise.
/// \throw InputError with file, line or element and
/// reason: unreadable, empty, truncated, an index out of range, a
///        coordinate not finite or beyond 1e50, no vertices, no faces, an unknown ending
Mesh read_mesh(const std::filesystem::path& file);

/// Writes by the file's ending: OBJ and OFF with 17 digits, PLY binary little endian in double, STL binary (float),
/// GLB (float). Triangles of one polygon are written as that polygon again (OBJ, OFF, PLY). The file appears whole or
/// not at all: it is written under a temporary name and renamed.
/// \param colours optional #F or #V by 3 in [0, 1]; written by PLY only
/// \throw InputError when it cannot be written, UsageError for an unknown ending
void write_mesh(const std::filesystem::path& file, const Mesh& mesh,
                const std::optional<Points>& colours = std::nullopt);

/// Writes `edited`, which is the mesh of the file `source` with its vertices moved, and keeps of that file what the
/// edit does not touch, where both files are of one format (by their endings; glTF and GLB are two):
/// - OBJ: every line, in place; texture coordinates, groups, materials. PLY: every property and element; coordinates
///   become doubles where floats cannot hold them. OFF: colours. STL: header, attributes, kind. glTF, GLB: nodes,
///   materials, textures, skins, extensions; positions go back through the nodes' transforms, with their bounds, and
///   nodes that share a mesh get one each only where they must differ.
/// - Normals, where the file has them, turn as the faces around them do; so do tangents of glTF.
/// - A file whose vertices have not moved comes out byte for byte.
/// - Files that the mesh names (material libraries and their textures, buffers and images) are copied beside the output
///   where they are not there already; those outside of the source's folder are not.
/// Of another format the mesh is written with the look that both know (appearance.h).
/// \return what could not be kept or copied, a line each
/// \throw InputError when a file cannot be read or written, cannot hold a coordinate, or `source` has other counts
std::vector<std::string> write_edited_mesh(const std::filesystem::path& file, const std::filesystem::path& source,
                                           const Mesh& edited);

}  // namespace orbifit
