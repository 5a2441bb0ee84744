#pragma once

#include <memory>
#include <optional>

#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"

#include "symmetric_images.h"

namespace orbifit::editor {

/// The first point of a moving mesh along a ray.
class Picker {
 public:
  explicit Picker(const Mesh& mesh);
  ~Picker();
  Picker(Picker&&) noexcept;

  void move(const Points& vertices, const RunContext& context);  ///< mesh units
  /// \return `point` is where the ray meets the surface as it is
  std::optional<SurfacePoint> pick(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace orbifit::editor
