#pragma once

#include <vector>

#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/motion.h"
#include "orbifit/model/run_context.h"

#include "symmetric_images.h"
#include "symmetry/moving_surface.h"

namespace orbifit::editor {

/// How far shapes and fields that know of no symmetries are from symmetric: of each region some pairs of a vertex p and
/// one of the region's motions g, evenly. Residuals are fractions of the diagonal, in the annotation's order.
class ResidualPairs {
 public:
  /// \param mesh  at rest, kept by reference
  ResidualPairs(const Mesh& mesh, const SymmetryAnnotation& annotation, const SymmetricImages& images);
  ResidualPairs(const ResidualPairs&) = delete;
  ResidualPairs& operator=(const ResidualPairs&) = delete;

  /// The images g p of all pairs at rest, #P by 3.
  const Points& images() const { return images_; }

  /// How far a displacement y is from symmetric: |y(g p) - g' y(p)| less the same at rest, g' being g carried along by
  /// the translation that suits the region best.
  /// \param vertices  moved, #V by 3 \param displacements  at images(), #P by 3
  std::vector<Residual> of_displacement(const Points& vertices, const Points& displacements) const;

  /// How far a shape is from symmetric: distances of g p from the region's surface.
  /// \param vertices  of the shape, #V by 3
  std::vector<Residual> of_shape(const Points& vertices, const RunContext& context);

 private:
  struct Pair {
    int vertex;
    int motion;  // in motions_
  };
  template <class Distance>
  std::vector<Residual> measure(const Distance& distance) const;

  const Mesh& rest_;
  Mesh shape_;
  double size_ = 1;
  std::vector<Motion> motions_;
  std::vector<Pair> pairs_;
  std::vector<std::size_t> first_;  // pair of each region, and their number
  Points images_;
  std::vector<std::vector<int>> faces_;  // of the regions
  std::vector<MovingSurface> surfaces_;  // of the regions, made when a shape is measured first
};

}  // namespace orbifit::editor
