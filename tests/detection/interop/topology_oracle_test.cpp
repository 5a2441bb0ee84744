// OpenMesh counts boundaries, components and holes by its own half-edges; topology.h must come to the same.
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <OpenMesh/Core/Mesh/DefaultTriMesh.hh>
#include <OpenMesh/Tools/Utils/MeshCheckerT.hh>
#include <gtest/gtest.h>

#include "orbifit/datasets_tools/generate.h"
#include "orbifit/interop/openmesh.h"

#include "geometry/topology.h"

namespace orbifit {
namespace {

using TriMesh = OpenMesh::TriMesh;

struct Counts {
  int edges = 0, boundary_edges = 0, components = 0;
};

Counts counted(const TriMesh& mesh) {
  Counts counts;
  counts.edges = static_cast<int>(mesh.n_edges());
  for (const auto edge : mesh.edges()) counts.boundary_edges += mesh.is_boundary(edge) ? 1 : 0;
  std::vector<char> seen(mesh.n_faces(), 0);
  for (const auto face : mesh.faces()) {
    if (seen[static_cast<std::size_t>(face.idx())] != 0) continue;
    ++counts.components;
    std::vector<OpenMesh::FaceHandle> front{face};
    seen[static_cast<std::size_t>(face.idx())] = 1;
    while (!front.empty()) {
      const OpenMesh::FaceHandle here = front.back();
      front.pop_back();
      for (const auto next : mesh.ff_range(here)) {
        char& reached = seen[static_cast<std::size_t>(next.idx())];
        if (reached == 0) front.push_back(next);
        reached = 1;
      }
    }
  }
  return counts;
}

// One vertex at each place, so that both see the same connectivity.
Mesh welded(const Mesh& mesh) {
  const Weld weld = weld_vertices(mesh.vertices);
  Mesh result;
  result.vertices = mesh.vertices(weld.representative, Eigen::all);
  result.faces = mesh.faces;
  for (int& vertex : result.faces.reshaped()) vertex = weld.group_of_vertex[static_cast<std::size_t>(vertex)];
  return result;
}

Mesh without(const Mesh& mesh, int every) {
  std::vector<int> kept;
  for (int f = 0; f < mesh.faces.rows(); ++f) {
    if (f % every != 0) kept.push_back(f);
  }
  return submesh(mesh, kept);
}

// Whether half-edges can hold the mesh.
bool compare(const Mesh& mesh, const std::string& name) {
  if (!openmesh_obstacles(mesh).empty()) return false;
  const TriMesh half_edges = to_openmesh<TriMesh>(mesh);
  std::ostringstream complaints;
  EXPECT_TRUE(OpenMesh::Utils::MeshCheckerT<TriMesh>(half_edges)
                  .check(OpenMesh::Utils::MeshCheckerT<TriMesh>::CHECK_ALL, complaints))
      << name << ": " << complaints.str();
  const Counts theirs = counted(half_edges);
  const MeshReport ours = inspect(mesh);
  EXPECT_EQ(welded_edges(mesh, weld_vertices(mesh.vertices)).size(), static_cast<std::size_t>(theirs.edges)) << name;
  EXPECT_EQ(ours.boundary_edges, theirs.boundary_edges) << name;
  EXPECT_EQ(ours.components, theirs.components) << name;
  EXPECT_EQ(ours.non_manifold_edges, 0) << name;
  EXPECT_EQ(ours.inconsistent_edges, 0) << name;
  EXPECT_EQ(ours.watertight, theirs.boundary_edges == 0) << name;
  return true;
}

TEST(TopologyOracle, CountsOfGeneratedModelsAndOfWhatCutsLeave) {
  int compared = 0;
  for (const char* name : {"bar", "chair", "fan", "stool", "table", "wheel"}) {
    const Mesh mesh = welded(generate(name).mesh);
    compared += compare(mesh, name) ? 1 : 0;
    for (const int every : {2, 3, 7}) {
      compared += compare(without(mesh, every), name + std::string(" cut ") + std::to_string(every)) ? 1 : 0;
    }
  }
  EXPECT_GE(compared, 12);
}

// A mesh that inspect() finds fault with is one that half-edges cannot hold, and the other way round but for vertices.
TEST(TopologyOracle, NonManifoldAndInconsistentEdgesAreObstacles) {
  Mesh mesh = welded(generate("bar").mesh);
  const Mesh good = mesh;
  ASSERT_TRUE(openmesh_obstacles(mesh).empty());
  std::swap(mesh.faces(5, 0), mesh.faces(5, 1));
  EXPECT_EQ(inspect(mesh).inconsistent_edges, 3);
  EXPECT_EQ(openmesh_obstacles(mesh).size(), 3U);
  mesh = good;
  mesh.faces.conservativeResize(mesh.faces.rows() + 1, 3);
  mesh.faces.bottomRows(1) = good.faces.row(5);
  EXPECT_EQ(inspect(mesh).non_manifold_edges, 3);
  EXPECT_EQ(openmesh_obstacles(mesh).size(), 3U);
}

}  // namespace
}  // namespace orbifit
