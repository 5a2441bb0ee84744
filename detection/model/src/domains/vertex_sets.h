#pragma once

#include <vector>

#include "orbifit/model/mesh.h"

#include "domains/domain_map.h"
#include "domains/vertex_images.h"

namespace orbifit {

/// Of the diagonal: vertices nearer than this are one place.
inline constexpr double kDoublet = 1e-6;

/// Of each vertex, the smallest index of a vertex at the same position.
std::vector<int> welded_vertices(const Points& vertices);

/// The set of places of each vertex: those of all faces around it, also of those that share its position and an edge
/// with them without sharing vertices, as in soups. Parts that merely touch keep places of their own.
std::vector<int> sets_of_vertices(const Mesh& mesh, const DomainMap& domains);

/// As sets_of_vertices(), with what the motions of its places say of each vertex: where an image of a vertex is a
/// vertex, the image of its set and the other's are one. Regions are drawn face by face, and where one ends a face
/// earlier than its image, the vertices of both are decided alike here, once for all of an orbit.
/// \param images  of the mesh's vertices
std::vector<int> closed_sets_of_vertices(const Mesh& mesh, const DomainMap& domains, VertexImages& images,
                                         const RunContext& context);

}  // namespace orbifit
