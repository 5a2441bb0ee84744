#pragma once

#include <vector>

#include "orbifit/model/mesh.h"

#include "base/random.h"

namespace orbifit {

/// Points on a surface: each with its face and that face's normal.
struct SurfaceSamples {
  Points points;           ///< #S by 3
  Points normals;          ///< #S by 3, unit
  std::vector<int> faces;  ///< #S
};

/// `count` points uniform by area over the given faces (empty: all), stratified along the faces' order.
/// \throw InputError when those faces have no area
SurfaceSamples sample_surface(const Mesh& mesh, int count, Random& random, const std::vector<int>& faces = {});

/// The same where the areas and unit normals of all faces are known: costs as many steps as there are given faces.
SurfaceSamples sample_surface(const Mesh& mesh, const Eigen::VectorXd& areas, const Points& normals, int count,
                              Random& random, const std::vector<int>& faces = {});

}  // namespace orbifit
