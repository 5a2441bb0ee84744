#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"

namespace CLI {
class App;
}

namespace orbifit {

/// Adds --up, which takes x, y, z, -x, -y or -z, or three numbers. \param values  empty where it is not given
void add_up_option(CLI::App& app, std::vector<double>& values, const std::string& meaning);

/// What --up says, or else the annotation, or else the format of the mesh's file, or else a guess (upright.h).
/// \throw UsageError as to_direction
Eigen::Vector3d picture_up(const std::vector<double>& option, const Mesh& mesh, const std::string& file,
                           const SymmetryAnnotation* annotation = nullptr);

/// The words of a command line with "--up y" as "--up 0 1 0", which the parser can read.
std::vector<std::string> with_up_in_numbers(const std::vector<std::string>& words);

}  // namespace orbifit
