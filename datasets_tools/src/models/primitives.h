#pragma once

#include <array>
#include <functional>
#include <vector>

#include <Eigen/Core>

#include "orbifit/model/mesh.h"
#include "orbifit/model/motion.h"

namespace orbifit {

// Closed parts with outward normals. Counts depend on the counts given, never on lengths. What is symmetric about the
// axes is so in every vertex, to rounding.

/// The corner of a profile in a half-plane: a radius and a height.
struct ProfilePoint {
  double radius = 0;
  double height = 0;
  double fillet = 0;  ///< radius of the arc that rounds the corner; 0 leaves it sharp
  int cells = 1;      ///< pieces into which the line to the next corner is cut
};

/// The corners with their fillets, lines and arcs cut into pieces.
/// \param fillet_cells pieces of each arc
/// \param closed whether the last corner is joined to the first
std::vector<Eigen::Vector2d> trace_profile(const std::vector<ProfilePoint>& corners, int fillet_cells, bool closed);

using Ring = std::vector<Eigen::Vector3d>;

/// Skin over rings of equally many points, closed by a fan about an apex at either end.
Mesh loft(const std::vector<Ring>& rings, const Eigen::Vector3d& first_apex, const Eigen::Vector3d& last_apex);

/// Skin over rings of which the last is joined to the first.
/// \param other_diagonal whether the quadrangle from point j of ring i to j + 1 of i + 1 is cut the other way; may be
/// empty
Mesh closed_loft(const std::vector<Ring>& rings, const std::function<bool(int ring, int point)>& other_diagonal = {});

/// Turned about z. The profile is a closed line, or begins and ends on the axis (radius 0).
/// \param facets of a circle; a facet's edge lies at angle 0
Mesh lathe(const std::vector<Eigen::Vector2d>& profile, int facets, bool closed);

/// A box about the origin, its edges and corners rounded by `bevel`.
/// \param half half the lengths
/// \param cells pieces along each axis, even numbers, without those of the bevel
/// \param bevel_cells pieces of each rounding; 0 for sharp edges (bevel is then 0)
Mesh box(const Eigen::Vector3d& half, const std::array<int, 3>& cells, double bevel, int bevel_cells);

/// A square leg about z, its edges rounded, that narrows from `thickness` at the upper end to the share `foot` of it.
Mesh tapered_leg(double thickness, double length, double foot, int detail);

/// A rod along a line that lies in a plane, mirror-symmetric about that plane; its bends are mitred.
/// \param normal unit normal of the plane
/// \param sides of the rod's section, even
Mesh rod(const std::vector<Eigen::Vector3d>& path, const Eigen::Vector3d& normal, double radius, int sides);

/// An asymmetric, chiral body inside the unit sphere.
Mesh chiral_blob(int subdivisions);

/// The image of a part, its faces turned round where the motion mirrors.
Mesh moved(const Mesh& part, const Motion& motion);

/// Six times the volume is what the sum of the faces' determinants gives; negative for a part turned inside out.
double signed_volume(const Mesh& part);

}  // namespace orbifit
