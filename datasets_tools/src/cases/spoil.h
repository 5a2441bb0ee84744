#pragma once

#include <cstdint>
#include <vector>

#include "orbifit/datasets_tools/truth.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/motion.h"

namespace orbifit {

/// A mesh made from another one.
struct Derived {
  Mesh mesh;
  std::vector<int> source_face;  ///< #F of `mesh`: the face of the original that each came from
};

/// The same surface with edges of at most a length: the longest edge too long is halved with all faces at it, and so on
/// (Rivara 1984). Triangles that met along whole edges still do, also where vertices are doubled. Vertices keep their
/// numbers, new ones follow; faces are in the order of their source.
/// \param longest_edge  fraction of the mesh's diagonal, in [1e-3, 1]
/// \throw UsageError
Derived subdivided(const Mesh& mesh, double longest_edge);

/// Vertices moved along their normals by independent Gaussian lengths. Vertices within 1e-9 of the diagonal of one
/// another move together; where two sides lie back to back, along the normal of one of them.
/// \param sigma  standard deviation, fraction of the mesh's diagonal, in [0, 0.1]
/// \throw UsageError
Mesh noisy(const Mesh& mesh, double sigma, std::uint64_t seed);

/// The side of a plane to which the normal points.
struct HalfSpace {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();    ///< on the plane, mesh units
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< not zero
};

struct CutBall {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< mesh units
  double radius = 0;                                 ///< mesh units, > 0
};

/// The mesh without the faces whose centroids are inside, in their order. All vertices stay, also those that no face
/// uses any more, so that the box and the diagonal are what they were. No edges are added: the cut is ragged.
/// \throw UsageError for a zero normal or a radius that is not positive
/// \throw NoResultError when no face is left
Derived cut(const Mesh& mesh, const HalfSpace& removed);
Derived cut(const Mesh& mesh, const CutBall& removed);

/// How far a mesh may be put.
struct PoseRange {
  double smallest_scale = 0.1;  ///< > 0
  double largest_scale = 10;    ///< >= smallest_scale; scales are drawn evenly by their logarithm
  double offset = 3;            ///< of the new centre from the origin, in new diagonals, >= 0

  void validate() const;  ///< \throw UsageError
};

/// A random rotation (uniform), scale and place.
Similarity random_pose(const Mesh& mesh, const PoseRange& range, std::uint64_t seed);

Mesh transformed(const Mesh& mesh, const Similarity& similarity);

/// The model after the similarity: motions conjugated, residuals told in the diagonal of the new box.
TruthModel transformed(const TruthModel& model, const Similarity& similarity);

}  // namespace orbifit
