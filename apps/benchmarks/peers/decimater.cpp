#include "decimater.h"

#include <OpenMesh/Core/Mesh/DefaultTriMesh.hh>
#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModNormalFlippingT.hh>
#include <OpenMesh/Tools/Decimater/ModQuadricT.hh>

#include "orbifit/interop/openmesh.h"

namespace orbifit::benchmarks {

Mesh decimated(const Mesh& mesh, int faces) {
  using TriMesh = OpenMesh::TriMesh;
  TriMesh half_edges = to_openmesh<TriMesh>(mesh);
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
