#include "orbifit/interop/openmesh.h"

#include <limits>
#include <string>

#include <OpenMesh/Core/Mesh/DefaultTriMesh.hh>
#include <gtest/gtest.h>

#include "orbifit/datasets_tools/generate.h"

namespace orbifit {
namespace {

using TriMesh = OpenMesh::TriMesh;

struct EigenTraits : OpenMesh::DefaultTraits {
  using Point = OpenMesh::Vec3d;
  using Normal = OpenMesh::Vec3d;
  VertexAttributes(OpenMesh::Attributes::Status);
  FaceAttributes(OpenMesh::Attributes::Status);
  EdgeAttributes(OpenMesh::Attributes::Status);
};
using StatusMesh = OpenMesh::TriMesh_ArrayKernelT<EigenTraits>;

Mesh of_faces(int vertices, const Triangles& faces) {
  Mesh mesh;
  mesh.vertices.resize(vertices, 3);
  for (int v = 0; v < vertices; ++v) mesh.vertices.row(v) << v, v * v, 1.0 / (3 + v);
  mesh.faces = faces;
  return mesh;
}

std::string refusal(const Mesh& mesh) {
  try {
    to_openmesh<TriMesh>(mesh);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(OpenMesh, KeepsVerticesAndFacesToTheLastBit) {
  for (const char* name : {"chair", "fan"}) {
    const Mesh mesh = generate(name).mesh;
    const TriMesh half_edges = to_openmesh<TriMesh>(mesh);
    const Mesh back = from_openmesh(half_edges);
    EXPECT_EQ(back.vertices, mesh.vertices);
    EXPECT_EQ(back.faces, mesh.faces);
    EXPECT_EQ(back.polygon_of_face, mesh.polygon_of_face);
  }
}

TEST(OpenMesh, KeepsPolygonsUntilFacesAreAdded) {
  Mesh mesh = of_faces(6, Triangles{{0, 1, 2}, {0, 2, 3}, {4, 5, 3}});
  mesh.polygon_of_face = {0, 0, 1};
  TriMesh half_edges = to_openmesh<TriMesh>(mesh);
  EXPECT_EQ(from_openmesh(half_edges).polygon_of_face, mesh.polygon_of_face);
  half_edges.add_face(OpenMesh::VertexHandle(1), OpenMesh::VertexHandle(0), OpenMesh::VertexHandle(5));
  EXPECT_TRUE(from_openmesh(half_edges).polygon_of_face.empty());
}

TEST(OpenMesh, HoldsUnusedVerticesOpenFansAndTwoFacesBackToBack) {
  for (const Mesh& mesh : {of_faces(4, Triangles{{0, 1, 3}}), of_faces(5, Triangles{{0, 1, 2}, {0, 3, 4}}),
                           of_faces(3, Triangles{{0, 1, 2}, {0, 2, 1}})}) {
    EXPECT_TRUE(openmesh_obstacles(mesh).empty());
    const Mesh back = from_openmesh(to_openmesh<TriMesh>(mesh));
    EXPECT_EQ(back.vertices, mesh.vertices);
    EXPECT_EQ(back.faces, mesh.faces);
  }
}

TEST(OpenMesh, NamesTheFacesOfAnEdgeOfThree) {
  EXPECT_EQ(refusal(of_faces(5, Triangles{{0, 1, 2}, {1, 0, 3}, {0, 1, 4}})),
            "mesh: OpenMesh cannot hold it: faces 0, 1, 2 meet at the edge of vertices 0 and 1, which has two faces at "
            "most");
}

TEST(OpenMesh, NamesFacesThatAreOrientedAgainstEachOther) {
  EXPECT_EQ(
      refusal(of_faces(4, Triangles{{2, 0, 1}, {0, 1, 3}})),
      "mesh: OpenMesh cannot hold it: faces 0, 1 are oriented against each other at the edge of vertices 0 and 1");
}

TEST(OpenMesh, NamesAFaceWithAVertexTwice) {
  EXPECT_EQ(refusal(of_faces(3, Triangles{{0, 1, 2}, {2, 1, 2}})),
            "mesh: OpenMesh cannot hold it: face 1 has a vertex twice");
}

TEST(OpenMesh, NamesTheFacesAtAVertexThatOthersSurround) {
  // A tetrahedron and a triangle that touch in vertex 0, in either order: OpenMesh takes the second one, and would then
  // show vertex 0 with some of its faces only.
  const Triangles surface{{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}};
  for (const bool first : {false, true}) {
    Triangles faces(5, 3);
    const Eigen::RowVector3i more(0, 4, 5);
    if (first) {
      faces << more, surface;
    } else {
      faces << surface, more;
    }
    EXPECT_EQ(refusal(of_faces(6, faces)),
              std::string("mesh: OpenMesh cannot hold it: faces ") + (first ? "0, 1, 2, 3" : "0, 1, 2, 4") +
                  " touch in vertex 0 alone: no other face may be at a vertex that faces surround");
  }
}

TEST(OpenMesh, NamesTenObstaclesAndCountsTheOthers) {
  Triangles faces(36, 3);
  for (int i = 0; i < 12; ++i) {
    for (int k = 0; k < 3; ++k)
      faces.row(3 * i + k) << 5 * i + (k == 1 ? 1 : 0), 5 * i + (k == 1 ? 0 : 1), 5 * i + 2 + k;
  }
  const Mesh mesh = of_faces(60, faces);
  EXPECT_EQ(openmesh_obstacles(mesh).size(), 12U);
  const std::string text = refusal(mesh);
  EXPECT_NE(text.find("faces 27, 28, 29 meet"), std::string::npos) << text;
  EXPECT_EQ(text.find("faces 30, 31, 32"), std::string::npos) << text;
  EXPECT_NE(text.find("and 2 more"), std::string::npos) << text;
}

TEST(OpenMesh, LeavesOutWhatIsDeleted) {
  const Mesh mesh = of_faces(6, Triangles{{0, 1, 2}, {2, 1, 3}, {3, 4, 5}});
  StatusMesh half_edges = to_openmesh<StatusMesh>(mesh);
  half_edges.delete_face(OpenMesh::FaceHandle(0), true);  // with vertex 0, which no other face has
  const Mesh back = from_openmesh(half_edges);
  EXPECT_EQ(back.faces, (Triangles{{1, 0, 2}, {2, 3, 4}}));
  EXPECT_EQ(back.vertices, mesh.vertices.bottomRows(5));
  Mesh moved = back;
  moved.vertices.array() += 1;
  move_vertices(half_edges, moved.vertices);
  EXPECT_EQ(from_openmesh(half_edges).vertices, moved.vertices);
  EXPECT_THROW(move_vertices(half_edges, mesh.vertices), UsageError);
}

TEST(OpenMesh, RefusesVerticesThatAreNotFinite) {
  TriMesh half_edges = to_openmesh<TriMesh>(of_faces(3, Triangles{{0, 1, 2}}));
  half_edges.point(OpenMesh::VertexHandle(1))[2] = std::numeric_limits<double>::infinity();
  EXPECT_THROW(from_openmesh(half_edges), InputError);
}

}  // namespace
}  // namespace orbifit
