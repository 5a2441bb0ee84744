#pragma once

#include <algorithm>

namespace orbifit {

/// Cosines of the angles within which the normals of a surface and of its image agree. Beyond the first is a crease.
inline constexpr double kAlikeNormals = 0.90630778703665;  ///< 25 degrees: where a symmetry is verified
inline constexpr double kNearNormals = 0.8;                ///< 37 degrees: the motion may be a little off yet
inline constexpr double kOfWhole = 0.999;                  ///< of the mesh's area: the whole but for specks
inline constexpr double kFacetNormals = 0.64;              ///< 50 degrees: between facets of small round parts

/// Parts smaller than a quarter of the mesh have smaller tolerances: within that of the mesh small ones have any group.
/// \param tolerance of the mesh \param diagonal of the part; lengths of the normalised mesh
inline double tolerance_of_part(double tolerance, double diagonal) {
  constexpr double kFull = 4;
  return tolerance * std::min(1.0, kFull * diagonal);
}

/// Of the standard deviation of noise, at most: what is left of it in vertices from which it was taken out.
inline constexpr double kLeftOfNoise = 0.5;

/// Tolerances within which a point is next to a crease: its image may lie on either side.
inline constexpr double kCreaseReach = 3;

/// Radians between directions below which two lines, or the normals of two planes, are taken for one before a fit.
inline constexpr double kSameDirection = 0.03;

/// Of the mesh's area: smaller regions and patterns say little.
inline constexpr double kLeastArea = 0.002;

/// The highest order of a finite rotation that is looked for; beyond it a shape counts as turned.
inline constexpr int kHighestOrder = 72;

/// Of the mesh's area: what keeps more of it may be rough, and is not asked whether it is chance.
inline constexpr double kNearlyWhole = 0.9;

/// Of the area, in one component: then the mesh is one surface, not a scene of parts.
inline constexpr double kOneSurface = 0.8;

/// Tolerances about a region's border within which it is looked at: borders are ragged by a face or so.
inline constexpr double kAboutBorder = 4;

}  // namespace orbifit
