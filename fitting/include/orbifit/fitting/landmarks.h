#pragma once

#include <filesystem>
#include <vector>

#include "orbifit/model/mesh.h"

namespace orbifit {

/// A vertex of the template and the place in the scan's frame where it belongs.
struct Landmark {
  int vertex = 0;
  Eigen::Vector3d target = Eigen::Vector3d::Zero();
};

/// Reads {"landmarks": [{"vertex": 12, "target": [x, y, z]}]}.
/// \throw InputError naming the file and the key, also where two have one vertex or one target
std::vector<Landmark> read_landmarks(const std::filesystem::path& file, const Mesh& mesh);

}  // namespace orbifit
