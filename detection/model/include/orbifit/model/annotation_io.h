#pragma once

#include <filesystem>
#include <string>

#include "orbifit/model/annotation.h"

namespace orbifit {

/// Reads an annotation of `mesh`.
/// \throw InputError naming the file and the key: not JSON, another format or version, a missing or ill-typed key, a
///        matrix that is not orthogonal to 1e-6, a face run outside the mesh, counts that differ from the mesh's, an
///        unknown group, a list of elements of the wrong length or not closed to 1e-5. Unknown keys are ignored. Where
///        a region's parent is not in the file, as when it was deleted by hand, all parents are found anew.
SymmetryAnnotation read_annotation(const std::filesystem::path& file, const Mesh& mesh);

/// The same from a file's text.
/// \param name of the file, for messages
SymmetryAnnotation annotation_from_json(const std::string& text, const Mesh& mesh, const std::string& name);

/// The file's text: keys in the format's order, 17 digits, one region a block; the same annotation gives the same
/// bytes.
std::string to_json(const SymmetryAnnotation& annotation);

/// Whole or not at all.
void write_annotation(const std::filesystem::path& file, const SymmetryAnnotation& annotation);

}  // namespace orbifit
