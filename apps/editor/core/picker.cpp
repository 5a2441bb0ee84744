#include "picker.h"

#include <Eigen/Geometry>

#include "geometry/surface_index.h"
#include "symmetry/moving_surface.h"

namespace orbifit::editor {

struct Picker::Implementation {
  Mesh mesh;
  MovingSurface surface;

  explicit Implementation(const Mesh& the_mesh) : mesh(the_mesh), surface(mesh) {}
};

Picker::Picker(const Mesh& mesh) : implementation_(std::make_unique<Implementation>(mesh)) {}
Picker::~Picker() = default;
Picker::Picker(Picker&&) noexcept = default;

void Picker::move(const Points& vertices, const RunContext& context) {
  implementation_->mesh.vertices = vertices;
  implementation_->surface.move(implementation_->mesh, context);
}

std::optional<SurfacePoint> Picker::pick(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const {
  const Mesh& mesh = implementation_->mesh;
  const int face = implementation_->surface.first_hit(origin, direction, 0);
  if (face < 0) return std::nullopt;
  const auto corner = [&](int k) -> Eigen::Vector3d { return mesh.vertices.row(mesh.faces(face, k)); };
  const Eigen::Vector3d normal = (corner(1) - corner(0)).cross(corner(2) - corner(0));
  const double along = normal.dot(direction);
  Eigen::Vector3d point = corner(0);
  if (along != 0) point = origin + normal.dot(corner(0) - origin) / along * direction;
  SurfacePoint result;
  result.face = face;
  result.barycentric = nearest_on_triangle(point, corner(0), corner(1), corner(2));
  result.point =
      result.barycentric[0] * corner(0) + result.barycentric[1] * corner(1) + result.barycentric[2] * corner(2);
  return result;
}

}  // namespace orbifit::editor
