#pragma once

#include <vector>

#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/motion.h"
#include "orbifit/subspace/subspace.h"

#include "symmetric_images.h"

namespace orbifit::editor {

/// How well a region is kept, quickly: pairs of a vertex and a surface point that one of the region's motions takes it
/// to, compared by where they are. Where that point is a vertex, there is no error but the deformation's; elsewhere it
/// lies between vertices, and the tessellation adds its own.
class ResidualPairs {
 public:
  ResidualPairs() = default;
  /// Of each region some pairs, evenly.
  ResidualPairs(const Mesh& mesh, const SymmetryAnnotation& annotation, const SymmetricImages& images);

  struct Answer {
    Residual residual;        ///< fractions of the diagonal
    bool at_vertices = true;  ///< all images are vertices
  };

  /// How far a deformation is from symmetric: |y(g p) - g' y(p)| beyond the same at rest, g' being g carried along.
  /// \param vertices  moved, #V by 3 \param carried  the motion that carries each region's group
  std::vector<Answer> of_deformation(const Points& vertices, const std::vector<Motion>& carried) const;

  /// The same without symmetries: groups may be carried along by the translation that suits them best.
  std::vector<Answer> of_free_deformation(const Points& vertices) const;

  /// How far a shape is from symmetric: |y(g p) - g y(p)|.
  std::vector<Answer> of_shape(const Points& vertices) const;

 private:
  struct Pair {
    int vertex;
    std::array<int, 3> corners;  // of the face that the image lies in
    Eigen::Vector3d weights;
    int motion;              // in motions_
    Eigen::Vector3d offset;  // at rest, y(g p) - g y(p)
  };
  struct Part {
    std::size_t first = 0;         // of pairs_
    std::size_t first_motion = 0;  // of motions_
    bool at_vertices = true;
  };
  Eigen::Vector3d image(const Points& vertices, const Pair& pair) const;
  template <class Difference>
  std::vector<Answer> measure(const Difference& difference) const;

  double size_ = 1;
  std::vector<Motion> motions_;
  std::vector<Pair> pairs_;
  std::vector<Part> parts_;  // of each region, and the end
};

}  // namespace orbifit::editor
