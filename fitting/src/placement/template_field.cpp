#include "placement/template_field.h"

#include <cmath>
#include <limits>

namespace orbifit {

TemplateField::TemplateField(const Mesh& mesh, const SurfaceIndex& surface, int cells, const RunContext& context) {
  constexpr double kMargin = 0.2;  // of the diagonal
  const double margin = kMargin * diagonal(mesh.vertices);
  corner_ = mesh.vertices.colwise().minCoeff().transpose().array() - margin;
  const Eigen::Vector3d size = mesh.vertices.colwise().maxCoeff().transpose().array() + margin - corner_.array();
  const double cell = size.maxCoeff() / cells;
  inverse_cell_ = 1 / cell;
  count_ = (size.array() * inverse_cell_).ceil().cast<int>().max(1);
  const Points normals = face_normals(mesh);
  values_.resize(static_cast<std::size_t>(count_.prod()));
  const auto plane = static_cast<std::size_t>(count_[1] * count_[2]);
  parallel_for(context, static_cast<std::size_t>(count_[0]), [&](std::size_t begin, std::size_t end) {
    int likely = -1;  // the one before lies beside
    for (std::size_t i = begin * plane; i < end * plane; ++i) {
      const auto rest = static_cast<int>(i % plane);
      const Eigen::Array3d at(static_cast<double>(i / plane), rest / count_[2], rest % count_[2]);
      constexpr double kAnywhere = std::numeric_limits<double>::infinity();
      const Eigen::Vector3d centre = corner_ + (cell * (at + 0.5)).matrix();
      const auto nearest = surface.nearest(centre, kAnywhere, likely);
      likely = nearest.place;
      values_[i] = {static_cast<float>(nearest.distance), normals.row(nearest.face).transpose().cast<float>()};
    }
  });
}

}  // namespace orbifit
