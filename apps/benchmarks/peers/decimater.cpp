#include "decimater.h"

#include <OpenMesh/Core/Mesh/DefaultTriMesh.hh>
#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModNormalFlippingT.hh>
#include <OpenMesh/Tools/Decimater/ModQuadricT.hh>

#include "orbifit/interop/openmesh.h"

#include "geometry/topology.h"

namespace orbifit::benchmarks {

namespace {

// With one vertex at each place where half-edges can hold the mesh like that, otherwise with its own vertices: parts
// that touch are apart then, and so are the triangles of a soup.
Mesh for_half_edges(const Mesh& mesh) {
  const Weld weld = weld_vertices(mesh.vertices);
  Mesh welded{mesh.vertices(weld.representative, Eigen::all), mesh.faces, {}};
  for (int& vertex : welded.faces.reshaped()) vertex = weld.group_of_vertex[static_cast<std::size_t>(vertex)];
  return openmesh_obstacles(welded).empty() ? welded : mesh;
}

}  // namespace

Mesh decimated(const Mesh& mesh, int faces) {
  using TriMesh = OpenMesh::TriMesh;
  TriMesh half_edges = to_openmesh<TriMesh>(for_half_edges(mesh));
  half_edges.request_face_normals();  // which collapses are compared with
  half_edges.update_face_normals();
  OpenMesh::Decimater::DecimaterT<TriMesh> decimater(half_edges);
  OpenMesh::Decimater::ModQuadricT<TriMesh>::Handle quadrics;
  OpenMesh::Decimater::ModNormalFlippingT<TriMesh>::Handle flipping;
  decimater.add(quadrics);
  decimater.add(flipping);
  decimater.module(quadrics).unset_max_err();  // the module that ranks
  decimater.module(flipping).set_max_normal_deviation(90);
  decimater.initialize();
  decimater.decimate_to_faces(0, static_cast<std::size_t>(faces));
  half_edges.garbage_collection();
  return from_openmesh(half_edges);
}

}  // namespace orbifit::benchmarks
