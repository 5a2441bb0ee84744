#pragma once

#include "orbifit/model/annotation.h"
#include "orbifit/model/run_context.h"

#include "consistency/region_shapes.h"

namespace orbifit {

/// Takes faces away from regions, and from instances of patterns, where vertices cannot follow all of them. Borders are
/// drawn face by face, each region's for itself: a vertex may lie in a region B and its image under a motion of
/// another, A, outside of B's image. Usually the image is counted in (closed_sets_of_vertices()); where it lies in yet
/// others that the vertex does not, both cannot be, and the vertex would follow one of two images that differ. Then A
/// or B loses the faces around the vertex. Where parts touch, A may hold a few faces of a part without images: a point
/// of it beside another's, whose image the one point there is; A loses those. Of all regions that may lose faces the
/// one that loses the least share of its own does so first. An annotation without such vertices stays as it is. Cost
/// O(V) for each element of each group, as often as faces are taken. \return whether any were
bool close_borders(const ShapeSurface& surface, SymmetryAnnotation& annotation, const RunContext& context);

}  // namespace orbifit
