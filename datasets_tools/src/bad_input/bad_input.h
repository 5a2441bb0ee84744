#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace orbifit {

/// Which reader a file is for.
enum class BadInputKind { mesh, scan, annotation, handles, landmarks, radius_field, basis, manifest };

/// A file as strangers send them: damaged, false, or true but hard. Its ending names the format.
struct BadInput {
  std::string name;  ///< of a file, unique, without folders; also in the file system's sense
  BadInputKind kind = BadInputKind::mesh;
  std::string content;
};

/// Every file but the bases, in a fixed order with fixed bytes. What is right of each is for the tests to say
/// (tests/robustness/outcomes.tsv). Annotations, handles and landmarks are of the mesh `bad_input_cube()`.
std::vector<BadInput> bad_input();

/// The cube, an OBJ file, that the files beside meshes are of: 8 vertices, 12 triangles, symmetric under x -> -x.
std::string bad_input_cube();

/// Damaged copies of a basis: cut at and about every word of its header, in every section, and with bits flipped.
/// \param whole the file's bytes as `orbifit subspace -o` writes them
std::vector<BadInput> damaged_bases(std::string_view whole);

}  // namespace orbifit
