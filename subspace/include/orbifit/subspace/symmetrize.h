#pragma once

#include <string>
#include <vector>

#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"

namespace orbifit {

/// What symmetrized() did. Lengths are fractions of the mesh's diagonal.
struct SymmetrizeReport {
  double largest_movement = 0;  ///< of a vertex
  double rms_movement = 0;      ///< over the vertices that lie in regions
  int in_regions = 0;           ///< vertices that lie in regions
  int mapped = 0;               ///< of these: all images are vertices, the result is exactly symmetric there
  int unclosed = 0;             ///< of these: groups disagree about where they belong, not all could be followed
  int held = 0;                 ///< of these: left as they are, since a region would be worse if they moved
  int iterations = 0;           ///< over the vertices whose images are surface points between vertices
  struct RegionChange {
    int id = 0;
    std::string name;
    std::string group;       ///< Schoenflies symbol; for a continuous group that which its tessellation has, or ""
    int places = 0;          ///< of the region's vertices, those at one place counted once
    int mapped = 0;          ///< of these: all images under all regions are vertices
    Residual before, after;  ///< distances of the vertices' images from the region's surface
  };
  std::vector<RegionChange> regions;  ///< in the annotation's order
};

/// The nearest exactly symmetric rest shape (docs/method.md 5): every vertex moves to the average over its orbit.
/// Where a region's group maps vertices near vertices one to one, orbits are made of vertices: the first takes the mean
/// of all, each taken back to it, moved to where its stabiliser leaves it, and the others are its exact images, under
/// all regions at once, nested and overlapping ones too. Where images lie between vertices, vertices and the surface
/// that their images meet go towards each other by least squares: such parts become symmetric up to their tessellation.
/// The parts of continuous groups become surfaces of revolution: vertices of about the same distance from the axis and
/// height take the same, at regular angles where the tessellation has them. Patterns are left as they are.
/// Connectivity, order and number of vertices stay; vertices at one place stay at one place.
/// No region is worse than before, neither at its worst vertex nor on average: vertices whose movement would make one
/// so stay where they are. Where groups miss one another no shape has all of them: the annotation's first regions are
/// made exact there, and later ones as nearly as they agree with those.
/// \param annotation its tolerance says how far an image may lie from its vertex: twice that
/// \param report may be null
/// \return the moved mesh; cost: |G| nearest points of every vertex of every region a few times, and some tens of
///         times where images lie between vertices
/// \throw NoResultError when a region's largest or root mean square residual would be larger than before by more than
///        1e-12
Mesh symmetrized(const Mesh& mesh, const SymmetryAnnotation& annotation, const RunContext& context,
                 SymmetrizeReport* report = nullptr);

}  // namespace orbifit
