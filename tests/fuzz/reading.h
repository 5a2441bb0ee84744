#pragma once

#include <filesystem>
#include <string>

#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"
#include "orbifit/subspace/subspace.h"

#include "bad_input/bad_input.h"

namespace orbifit {

/// What the files beside meshes are of.
struct ReadingContext {
  Mesh mesh;
  SymmetryAnnotation annotation;
  std::string basis;  ///< the bytes of a basis file

  ReadingContext();                 ///< the cube of bad_input() and its symmetry under x -> -x, in mode floating
  static ReadingContext columns();  ///< two round columns (Cinfv), images of one another (Cs), in mode moving

 private:
  ReadingContext(Mesh shape, SymmetryAnnotation symmetry, const SubspaceOptions& options);
};

/// Hands the file to its reader.
/// \return "read: " and what was read, counted; or the message of the InputError, without the folders of the file's name
/// Any other exception, as of a defect, passes through.
std::string reading_of(BadInputKind kind, const std::filesystem::path& file, const ReadingContext& context);

/// A basis file's bytes with size and checksums that fit them, so that what these guard is looked at as well.
std::string with_right_checksums(std::string basis);

}  // namespace orbifit
