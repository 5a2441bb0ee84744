#pragma once

#include <vector>

#include <Eigen/Core>

#include "group/refinement.h"
#include "surface/surface_patch.h"

namespace orbifit {

/// A sphere that pieces of the surface, or much of them, lie on. Every rotation about its centre and every mirror
/// through it keeps what there is of it, but where other things cut holes: it says nothing of the groups that fix the
/// centre.
struct Ball {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double radius = 0;
  double area = 0;  ///< of what lies on it; all in the frame of the normalised mesh
};

struct Balls {
  std::vector<Ball> all;
  std::vector<int> ball_of_face;  ///< -1 for faces of none
};

/// The spheres that the mesh's components lie on, large enough to matter. The centre is where the faces' normals meet,
/// by least squares; of a piece all but a few percent must be as far from it, or two fifths that are more than a cap
/// and a fifth of the mesh, where what stands on a ball goes over into it without a crease. O(F + P B) for P pieces and
/// B balls.
/// \param prepared with pieces of surface between creases for components \param tolerance a length
Balls find_balls(const PreparedMesh& prepared, double tolerance);

/// Whether all elements of the group leave the ball where it is, to within twice the tolerance.
bool fixes(const GroupPlacement& placement, const Ball& ball, double tolerance);

/// Whether there is little to a region but balls that its group fixes and of which it has not all: other groups that
/// fix them keep others of their parts. \param prepared that the balls were found in
bool little_but_cut_balls(const PreparedMesh& prepared, const Balls& balls, const std::vector<int>& faces,
                          const GroupPlacement& placement, double tolerance);

}  // namespace orbifit
