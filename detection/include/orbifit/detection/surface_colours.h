#pragma once

#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "orbifit/model/appearance.h"
#include "orbifit/model/mesh.h"

namespace orbifit {

/// The colour that a mesh shows at each of its points: its material's base colour times the texture there times the
/// colour of its corners, interpolated; what is not there is white. As the file has them, taken as sRGB. Textures
/// repeat beyond their borders; opacity counts for nothing.
class SurfaceColours {
 public:
  /// Decodes the textures. \pre `look` is of `mesh`
  SurfaceColours(const Mesh& mesh, const Appearance& look);
  ~SurfaceColours();
  SurfaceColours(SurfaceColours&&) noexcept;
  SurfaceColours& operator=(SurfaceColours&&) noexcept;

  /// Whether all of the mesh has one colour, so that colours tell nothing.
  bool uniform() const;

  /// Red, green and blue in [0, 1] at a point of a face.
  Eigen::Vector3d at(int face, const Eigen::Vector3d& barycentric) const;

  /// What of the look could not be read, a line each.
  const std::vector<std::string>& problems() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// What the colours of a surface leave of a symmetry that its shape has.
struct BrokenByColours {
  std::string name;
  std::string group;     ///< of the shape: a Schoenflies symbol, or a pattern's kind
  std::string kept_as;   ///< what keeps the colours, as above; "" for nothing
  double differing = 0;  ///< largest share of its surface that shows another colour under one of its motions, in [0, 1]
};

}  // namespace orbifit
