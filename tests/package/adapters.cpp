// A mesh and a scan, once through OpenMesh and PCL.
#include <cstdio>

#include <OpenMesh/Core/Mesh/DefaultTriMesh.hh>

#include "orbifit/interop/openmesh.h"
#include "orbifit/interop/pcl.h"

int main() {
  orbifit::Mesh mesh;
  mesh.vertices.resize(3, 3);
  mesh.vertices << 0, 0, 0, 1, 0, 0, 0, 1, 0;
  mesh.faces.resize(1, 3);
  mesh.faces << 0, 1, 2;
  const orbifit::Mesh same = orbifit::from_openmesh(orbifit::to_openmesh<OpenMesh::TriMesh>(mesh));
  orbifit::PointCloud scan;
  scan.points = mesh.vertices;
  const orbifit::PointCloud seen = orbifit::from_pcl(orbifit::to_pcl<pcl::PointXYZ>(scan));
  const bool kept = same.vertices == mesh.vertices && same.faces == mesh.faces && seen.points == scan.points;
  std::printf("adapters: %s\n", kept ? "kept" : "changed");
  return kept ? 0 : 1;
}
