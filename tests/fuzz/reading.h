#pragma once

#include <filesystem>
#include <string>

#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"

#include "bad_input/bad_input.h"

namespace orbifit {

/// What the files beside meshes are of: the cube of bad_input(), its symmetry under x -> -x, and their basis.
struct ReadingContext {
  Mesh mesh;
  SymmetryAnnotation annotation;
  std::string basis;  ///< the bytes of a basis file

  ReadingContext();
};

/// Hands the file to its reader.
/// \return "read: " and what was read, counted; or the message of the InputError, without the folders of the file's name
/// Any other exception, as of a defect, passes through.
std::string reading_of(BadInputKind kind, const std::filesystem::path& file, const ReadingContext& context);

/// A basis file's bytes with size and checksums that fit them, so that what these guard is looked at as well.
std::string with_right_checksums(std::string basis);

}  // namespace orbifit
