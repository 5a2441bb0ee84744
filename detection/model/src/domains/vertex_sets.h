#pragma once

#include <vector>

#include "orbifit/model/mesh.h"

#include "domains/domain_map.h"
#include "domains/vertex_images.h"

namespace orbifit {

/// Of the diagonal: vertices nearer than this are one place.
inline constexpr double kDoublet = 1e-6;

/// The set of places of each vertex: of its point (DomainMap::points()), with what the motions of its places say of it:
/// where an image of a vertex is a vertex, the image of its set and the other's are one. Regions are drawn face by
/// face, and where one ends a face earlier than its image, the vertices of both are decided alike here, once for all of
/// an orbit.
/// \param images  of the mesh's vertices
std::vector<int> closed_sets_of_vertices(const Mesh& mesh, const DomainMap& domains, VertexImages& images,
                                         const RunContext& context);

}  // namespace orbifit
