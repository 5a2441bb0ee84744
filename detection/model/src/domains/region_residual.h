#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/motion.h"
#include "orbifit/model/point_group.h"
#include "orbifit/model/run_context.h"

#include "geometry/surface_index.h"

namespace orbifit {

/// The motions on which a group is judged: all elements but the identity of a finite group; for a continuous one a
/// fixed set of rotations by irrational fractions of a turn, combined with the representatives of its cosets.
std::vector<Motion> judged_motions(const PointGroup& group, const GroupFrame& frame, const Eigen::Vector3d& centre);

/// The same of a region, in the order of its elements.
std::vector<Motion> judged_motions(const Region& region);

/// The points at which faces are looked at: corners, each once, and the middle of each face; of a face with an edge
/// longer than a fiftieth of the diagonal those of a lattice of at most ten steps along an edge.
struct FacePoints {
  Points points;                ///< #P by 3
  std::vector<int> face;        ///< #P: the face in which the point is, or the first of those that meet there
  std::vector<double> weights;  ///< #P: area that the point stands for
  std::vector<int> first;       ///< #P + 1: where the point's faces begin in `faces`
  std::vector<int> faces;       ///< for each point all faces that have it
};

/// \param diagonal the mesh's, mesh units
FacePoints face_points(const Mesh& mesh, const std::vector<int>& faces, double diagonal);

/// How far a point of a region's surface S is from S after a motion of its group.
///
/// Two things that are no asymmetry do not count. Facets of a surface of revolution lie inside the circles through
/// their corners by up to their sagitta, and no rotation but the tessellation's own takes them onto one another: under
/// a continuous group distances count less the sagitta, across the surface, at the point or at the point nearest to its
/// image, whichever is more. And where other parts stand on S, as blades on a hub that are one surface with it, S has
/// holes: an image within the solid, below a face that is not of the region, is hidden by them. Of a mesh whose faces
/// do not enclose it nothing is hidden.
class RegionDistance {
 public:
  /// All arguments are kept by reference. \param whole index of all faces \param surface of those that images should
  /// lie on \param own faces that hide nothing, ascending \param region whose sagitta counts; null: none
  RegionDistance(const Mesh& mesh, const SurfaceIndex& whole, const SurfaceIndex& surface, const std::vector<int>& own,
                 const Region* region);

  /// The distance of motion(point) from S, mesh units; nothing where it is hidden. What is within `visible` is not
  /// asked whether it is hidden. \param face that has the point
  std::optional<double> operator()(const Eigen::Vector3d& point, int face, const Motion& motion, double visible) const;

  /// Whether that is at most `limit`, or hidden, for several times less.
  bool within(const Eigen::Vector3d& point, int face, const Motion& motion, double limit) const;

 private:
  double sagitta(const Eigen::Vector3d& point, int face) const;
  double less_sagitta(const Eigen::Vector3d& point, int face, const SurfaceIndex::Nearest& nearest) const;
  bool hidden(const Eigen::Vector3d& image, const Eigen::Vector3d& normal) const;

  const Mesh& mesh_;
  const SurfaceIndex& whole_;
  const SurfaceIndex& surface_;
  const std::vector<int>& own_;
  const Region* region_;  // null but for continuous groups
};

/// What an annotation says of a region: the distances between g(S) and S over the points of S (FacePoints) and the
/// motions g (judged_motions), see RegionDistance, as fractions of the diagonal. Of more than 16 000 pairs of a point
/// and a motion as many, spread evenly. \param whole index of all faces \param diagonal the mesh's
Residual region_residual(const Mesh& mesh, const SurfaceIndex& whole, const Region& region, double tolerance,
                         double diagonal, const RunContext& context);

/// The same between a pattern's first instance and each other one, in both directions.
Residual pattern_residual(const Mesh& mesh, const SurfaceIndex& whole, const Pattern& pattern, double tolerance,
                          double diagonal, const RunContext& context);

}  // namespace orbifit
