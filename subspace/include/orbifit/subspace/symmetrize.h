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
  int unclosed = 0;             ///< of these: their orbit does not close, they were left as they are
  int iterations = 0;           ///< over the vertices whose images are surface points between vertices
  struct RegionChange {
    int id = 0;
    std::string name;
    std::string group;       ///< Schoenflies symbol; for a continuous group that which its tessellation has, or ""
    int places = 0;          ///< of the region's vertices, those at one place counted once
    int mapped = 0;          ///< of these: all images under all regions are vertices
    Residual before, after;  ///< distances of the vertices' images from the region's surface; vertices are thinned out
                             ///< to about 200 000 pairs of vertex and element
  };
  std::vector<RegionChange> regions;  ///< in the annotation's order
};

/// The nearest exactly symmetric rest shape (method notes 2.5): every vertex moves to the average over its orbit.
/// Where a region's group maps vertices near vertices one to one, orbits are made of vertices: the first takes the mean
/// of all, each taken back to it, moved to where its stabiliser leaves it, and the others are its exact images, under
/// all regions at once, nested and overlapping ones too. Where an image lies between vertices the mean goes over the
/// nearest points of the region's surface, M_k^-1(nearest(M_k p)), and is repeated until it stops moving: such parts
/// become symmetric up to their tessellation. The parts of continuous groups become turned ones: vertices of about the
/// same distance from the axis and height take the same, at regular angles where the tessellation has them. Patterns
/// are left as they are. Connectivity, order and number of vertices stay; vertices at one place stay at one place.
/// Detected groups that miss one another by less than 1e-4 of the diagonal cannot all be exact: then the annotation's
/// first region is, and later ones as nearly as they agree with it.
/// \param annotation its tolerance says how far an image may lie from its vertex: twice that
/// \param report may be null
/// \return the moved mesh; cost O(sum over regions of V log V), and |G| nearest points a vertex where images lie
///         between vertices
Mesh symmetrized(const Mesh& mesh, const SymmetryAnnotation& annotation, const RunContext& context,
                 SymmetrizeReport* report = nullptr);

}  // namespace orbifit
