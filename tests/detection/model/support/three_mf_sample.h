#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "orbifit/model/mesh.h"

namespace orbifit {

/// A 3MF file that a test puts together and lib3mf writes.
struct ThreeMfSample {
  using Place = Eigen::Matrix<double, 3, 4>;

  struct Component {
    int object = 0;  ///< its number in `objects`, less than that of the object that has it
    Place place;
  };

  /// A mesh, or components.
  struct Object {
    std::string name;
    Mesh mesh;
    std::vector<Component> components;
  };

  std::vector<Object> objects;
  std::vector<Component> items;  ///< of the build
  int unit = 1;                  ///< as lib3mf counts them: 0 micrometre, millimetre, centimetre, inch, foot, 5 metre

  static Place at(double x, double y, double z);

  void write(const std::filesystem::path& file) const;
};

}  // namespace orbifit
