#pragma once

#include <vector>

#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"

#include "geometry/surface_index.h"

namespace orbifit {

/// How far the surface is from the points of a box around it, and its normal there: looked up in a grid, to half a
/// cell.
class TemplateField {
 public:
  /// \param cells along the longest side of the box, which reaches a fifth of the diagonal beyond the mesh
  TemplateField(const Mesh& mesh, const SurfaceIndex& surface, int cells, const RunContext& context);

  struct Value {
    float distance;
    Eigen::Vector3f normal;  ///< unit, of the nearest face; either sign
  };

  /// Null outside of the box.
  const Value* at(const Eigen::Vector3d& point) const {
    const Eigen::Array3d cell = (point - corner_).array() * inverse_cell_;
    if ((cell < 0).any() || (cell >= count_.cast<double>()).any()) return nullptr;
    const Eigen::Array3i c = cell.cast<int>();
    return &values_[(static_cast<std::size_t>(c[0]) * static_cast<std::size_t>(count_[1]) +
                     static_cast<std::size_t>(c[1])) *
                        static_cast<std::size_t>(count_[2]) +
                    static_cast<std::size_t>(c[2])];
  }

 private:
  Eigen::Vector3d corner_;
  double inverse_cell_;
  Eigen::Array3i count_;
  std::vector<Value> values_;
};

}  // namespace orbifit
