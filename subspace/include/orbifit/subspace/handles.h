#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "orbifit/model/mesh.h"
#include "orbifit/model/motion.h"

namespace orbifit {

/// A part of the surface that the user holds or moves.
struct Handle {
  std::string name;
  std::vector<int> vertices;  ///< ascending, without repetition, not empty
  Motion motion;              ///< where it shall go, scaled where that is asked for; the identity holds it in place
};

/// What a file of handles asks for (docs/formats.md).
struct HandleSet {
  double alpha = 100;   ///< weight of the handles against the Laplace energy (paper, equation 3), > 0
  int iterations = 10;  ///< of the co-rotated solve, >= 1
  std::vector<Handle> handles;
};

/// Reads handles of `mesh`: of each either `centre` and `radius` (the vertices within) or `vertices`, and optionally
/// `scale` (about the handle's centroid), `rotation` {axis, degrees, about} (about: the centroid where not given) and
/// `translation`, which are done in this order.
/// \throw InputError naming the file and the key: not JSON, no handles, a handle on no vertex, a vertex outside the
///        mesh, a number out of range
HandleSet read_handles(const std::filesystem::path& file, const Mesh& mesh);

}  // namespace orbifit
