#include "orbifit/model/mesh_io.h"

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "orbifit/model/errors.h"

#include "files/file.h"
#include "mesh_samples.h"
#include "temporary_folder.h"

namespace orbifit {
namespace {

// Coordinates as the format stores them.
Points stored(const Points& points, bool single_precision) {
  if (!single_precision) return points;
  return points.cast<float>().cast<double>();
}

struct Format {
  std::string ending;
  bool single_precision;
  bool keeps_polygons;
};

class MeshFormat : public testing::TestWithParam<Format> {
 protected:
  TemporaryFolder folder_;
  std::filesystem::path file_ = folder_.file("mesh" + GetParam().ending);
};

TEST_P(MeshFormat, GivesBackEveryBitInOrder) {
  const Mesh mesh = ragged_mesh();
  write_mesh(file_, mesh);
  const Mesh read = read_mesh(file_);
  if (GetParam().ending == ".stl") {  // corners of their own for each triangle
    const std::vector<int> corners(mesh.faces.data(), mesh.faces.data() + mesh.faces.size());
    EXPECT_EQ(read.vertices, stored(mesh.vertices(corners, Eigen::all), true));
  } else {
    EXPECT_EQ(read.vertices, stored(mesh.vertices, GetParam().single_precision));
    EXPECT_TRUE(std::signbit(read.vertices(2, 2)));  // -0 stays -0
    EXPECT_EQ(read.faces, mesh.faces);
  }
  EXPECT_TRUE(read.polygon_of_face.empty());
}

TEST_P(MeshFormat, WritesTheSameBytesAgain) {
  write_mesh(file_, ragged_mesh());
  const std::string bytes = read_file(file_);
  write_mesh(file_, ragged_mesh());
  EXPECT_TRUE(read_file(file_) == bytes);
  EXPECT_EQ(folder_.listing().size(), 1U);
}

TEST_P(MeshFormat, KeepsPolygonsWhereItCan) {
  const Mesh mesh = polygon_mesh();
  write_mesh(file_, mesh);
  const Mesh read = read_mesh(file_);
  EXPECT_EQ(read.faces.rows(), mesh.faces.rows());
  if (!GetParam().keeps_polygons) return;
  EXPECT_EQ(read.faces, mesh.faces);
  EXPECT_EQ(read.polygon_of_face, mesh.polygon_of_face);
}

TEST_P(MeshFormat, RefusesCoordinatesItCannotHold) {
  Mesh mesh = polygon_mesh();
  mesh.vertices(3, 1) = 1e45;
  if (GetParam().single_precision) {
    EXPECT_THROW(write_mesh(file_, mesh), InputError);
    EXPECT_TRUE(folder_.listing().empty());
  } else {
    write_mesh(file_, mesh);
    EXPECT_EQ(read_mesh(file_).vertices, mesh.vertices);
  }
}

INSTANTIATE_TEST_SUITE_P(All, MeshFormat,
                         testing::Values(Format{".obj", false, true}, Format{".off", false, true},
                                         Format{".ply", false, true}, Format{".stl", true, false},
                                         Format{".glb", true, false}),
                         [](const auto& test) { return test.param.ending.substr(1); });

class PlyEncoding : public testing::TestWithParam<std::string> {
 protected:
  TemporaryFolder folder_;
};

TEST_P(PlyEncoding, ReadsDoubleExactly) {
  const Mesh mesh = ragged_mesh();
  const Mesh read = read_mesh(folder_.write("mesh.ply", ply_of<double>(mesh, GetParam())));
  EXPECT_EQ(read.vertices, mesh.vertices);
  EXPECT_EQ(read.faces, mesh.faces);
}

TEST_P(PlyEncoding, ReadsFloatExactly) {
  const Mesh mesh = ragged_mesh();
  const Mesh read = read_mesh(folder_.write("mesh.PLY", ply_of<float>(mesh, GetParam())));
  EXPECT_EQ(read.vertices, stored(mesh.vertices, true));
  EXPECT_EQ(read.faces, mesh.faces);
}

INSTANTIATE_TEST_SUITE_P(All, PlyEncoding, testing::Values("ascii", "binary_little_endian", "binary_big_endian"),
                         [](const auto& test) { return test.param; });

TEST(Ply, WritesColours) {
  const TemporaryFolder folder;
  const Mesh mesh = polygon_mesh();
  Points colours = Points::Constant(mesh.faces.rows(), 3, 0.5);
  colours.row(6).setConstant(1);  // within a polygon, which then falls apart
  write_mesh(folder.file("a.ply"), mesh, colours);
  const Mesh read = read_mesh(folder.file("a.ply"));
  EXPECT_EQ(read.faces, mesh.faces);
  EXPECT_GT(read.polygon_of_face.back(), mesh.polygon_of_face.back());
  EXPECT_NE(read_file(folder.file("a.ply")).find("property uchar red"), std::string::npos);
  EXPECT_THROW(write_mesh(folder.file("b.ply"), mesh, Points(Points::Zero(4, 3))), UsageError);
}

TEST(Ply, JoinsPolygonsOfManyCorners) {
  const TemporaryFolder folder;
  Mesh mesh;
  mesh.vertices = Points::Random(300, 3);
  mesh.faces.resize(298, 3);
  for (int f = 0; f < 298; ++f) mesh.faces.row(f) << 0, f + 1, f + 2;
  mesh.polygon_of_face.assign(298, 0);
  write_mesh(folder.file("a.ply"), mesh);
  const Mesh read = read_mesh(folder.file("a.ply"));
  EXPECT_EQ(read.faces, mesh.faces);
  EXPECT_EQ(read.polygon_of_face, mesh.polygon_of_face);
}

TEST(Obj, UnderstandsTheWaysOfWritingIt) {
  const TemporaryFolder folder;
  const Mesh read = read_mesh(folder.write("a.obj",
                                           "\xEF\xBB\xBF# comment with v 1 2 3\r\n"
                                           "mtllib x.mtl\r\n"
                                           "v 0 0 0 1.0\r\n"
                                           "v\t1e0\t+0.0\t0   # trailing f 1 2 3\r\n"
                                           "v 1. \\\r\n  1 0\r\n"
                                           "vn 0 0 1\r\nvt 0 0\r\n"
                                           "v .0 1 -0\r\n"
                                           "f 1/1/1 2//1 3/1\r\n"
                                           "f -4 -2 -1\r\n"
                                           "f 1 2 3 4\r\n"
                                           "f 1 5 6\r\n"
                                           "v 5 5 5\r\nv 6 6 1e-400"));
  Triangles faces(5, 3);
  faces << 0, 1, 2, 0, 2, 3, 0, 1, 2, 0, 2, 3, 0, 4, 5;
  EXPECT_EQ(read.faces, faces);
  EXPECT_EQ(read.polygon_of_face, (std::vector<int>{0, 1, 2, 2, 3}));
  EXPECT_EQ(read.vertices.row(2), Eigen::RowVector3d(1, 1, 0));
  EXPECT_EQ(read.vertices.row(5), Eigen::RowVector3d(6, 6, 0));
}

TEST(Off, UnderstandsTheWaysOfWritingIt) {
  const TemporaryFolder folder;
  for (const char* head : {"OFF\n3 1 0\n", "OFF 3 1 0\n", "OFF3 1 0\n", "# c\nCOFF\n\n3 1\n", "NOFF # n\n3 1 3\n"}) {
    const Mesh read = read_mesh(folder.write(
        "a.off", std::string(head) + "0 0 0 255 0 0\n1 0 0 0 0 1 # second\n\n0 1 0\n3 2 0 1 0.5 0.5 0.5\n"));
    EXPECT_EQ(read.vertices.rows(), 3) << head;
    EXPECT_EQ(read.faces.row(0), Eigen::RowVector3i(2, 0, 1)) << head;
  }
}

TEST(Stl, ReadsAscii) {
  const TemporaryFolder folder;
  const Mesh read = read_mesh(folder.write("a.stl",
                                           "solid a\nfacet normal 0 0 1\n outer loop\n  vertex 0 0 0\n  vertex 1 0 0\n"
                                           "  VERTEX 0 1.5 1e-3\n endloop\nendfacet\nendsolid a\n"));
  EXPECT_EQ(read.faces, Triangles(Eigen::RowVector3i(0, 1, 2)));
  EXPECT_EQ(read.vertices.row(2), Eigen::RowVector3d(0, 1.5, 1e-3));
}

TEST(Stl, BinaryMayBeginWithSolid) {
  const TemporaryFolder folder;
  write_mesh(folder.file("a.stl"), polygon_mesh());
  std::string bytes = read_file(folder.file("a.stl"));
  bytes.replace(0, 5, "solid");
  EXPECT_EQ(read_mesh(folder.write("b.stl", bytes)).faces.rows(), 8);
}

// A triangle under a parent that mirrors and a child that turns by 90 degrees about z and lifts by 5.
std::string gltf_text(const std::string& buffer) {
  return R"({"asset": {"version": "2.0"}, "scene": 1,
 "scenes": [{"nodes": []}, {"nodes": [1]}],
 "nodes": [{"mesh": 0, "rotation": [0, 0, 0.7071067811865476, 0.7071067811865476], "translation": [0, 0, 5]},
           {"children": [0], "scale": [-1, 1, 2]}, {"mesh": 0}],
 "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1},
                            {"attributes": {"POSITION": 0}, "mode": 1}]}],
 "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
               {"bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR"}],
 "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 6}],
 "buffers": [{"byteLength": 42, "uri": ")" +
         buffer + R"("}]})";
}

std::string triangle_buffer() {
  std::string bytes;
  for (const float number : {1.F, 0.F, 0.F, 2.F, 0.F, 0.F, 1.F, 3.F, 0.F}) append_bytes(bytes, number);
  for (const std::uint16_t number : {0, 1, 2}) append_bytes(bytes, number);
  return bytes;
}

void expect_moved_triangle(const Mesh& mesh) {
  Points expected(3, 3);
  expected << 0, 1, 10, 0, 2, 10, 3, 1, 10;
  ASSERT_EQ(mesh.vertices.rows(), 3);
  EXPECT_LT((mesh.vertices - expected).cwiseAbs().maxCoeff(), 1e-14);
  EXPECT_EQ(mesh.faces, Triangles(Eigen::RowVector3i(0, 2, 1)));  // turned over by the mirror
}

TEST(Gltf, AppliesTransformsOfTheSceneAndReadsFilesBeside) {
  const TemporaryFolder folder;
  folder.write("the data.bin", triangle_buffer());
  expect_moved_triangle(read_mesh(folder.write("a.gltf", gltf_text("the%20data.bin"))));
}

TEST(Gltf, ReadsDataWithinTheText) {
  const TemporaryFolder folder;
  const std::string base64 = "AACAPwAAAAAAAAAAAAAAQAAAAAAAAAAAAACAPwAAQEAAAAAAAAABAAIA";
  expect_moved_triangle(read_mesh(folder.write("a.gltf", gltf_text("data:application/octet-stream;base64," + base64))));
}

TEST(Gltf, RefusesWhatItCannotRead) {
  const TemporaryFolder folder;
  folder.write("a.bin", triangle_buffer());
  const auto expect = [&](const std::string& from, const std::string& to, const std::string& message) {
    std::string text = gltf_text("a.bin");
    text.replace(text.find(from), from.size(), to);
    try {
      read_mesh(folder.write("a.gltf", text));
      ADD_FAILURE() << message;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(message), std::string::npos) << error.what();
    }
  };
  expect(R"("indices": 1})", R"("indices": 1, "extensions": {"KHR_draco_mesh_compression": {}}})",
         "names no attributes");
  expect(R"("byteLength": 36)", R"("byteLength": 36, "extensions": {"EXT_meshopt_compression": {}})", "meshopt");
  expect(R"("children": [0])", R"("children": [1])", "must form a tree");
  expect(R"("children": [0])", R"("children": [7])", "names nodes[7], but there are 3");
  expect(R"("count": 3, "type": "VEC3")", R"("count": 4, "type": "VEC3")",
         "accessors[0]: reaches beyond its bufferView");
  expect(R"("count": 3, "type": "VEC3")", R"("count": 4000000000, "type": "VEC3")", "reaches beyond");
  expect(R"("count": 3, "type": "VEC3")", R"("count": 2, "type": "VEC3")", "vertex index 2 is out of range");
  expect(R"("byteOffset": 36)", R"("byteOffset": 37)", "reaches beyond its buffer");
  expect("a.bin", "b.bin", "b.bin: no such file");
  expect("a.bin", "http://a/b.bin", "only files are read");
  expect(R"("version": "2.0")", R"("version": "1.0")", "only glTF 2 is read");
}

TEST(WriteMesh, RefusesEndingsAndFoldersThatDoNotExist) {
  const TemporaryFolder folder;
  EXPECT_THROW(write_mesh(folder.file("a.xyz"), ragged_mesh()), UsageError);
  EXPECT_THROW(write_mesh(folder.file("a"), ragged_mesh()), UsageError);
  EXPECT_THROW(write_mesh(folder.file("none/a.obj"), ragged_mesh()), InputError);
  std::filesystem::create_directory(folder.file("b.obj"));
  EXPECT_THROW(write_mesh(folder.file("b.obj"), ragged_mesh()), InputError);
  EXPECT_EQ(folder.listing(), std::set<std::string>{"b.obj"});
}

TEST(WriteFile, FollowsALinkAndReplacesWhatItPointsTo) {
  const TemporaryFolder folder;
  folder.write("real.txt", "old");
  std::filesystem::create_symlink("real.txt", folder.file("link.txt"));
  write_file(folder.file("link.txt"), "new");
  EXPECT_EQ(read_file(folder.file("real.txt")), "new");
  EXPECT_TRUE(std::filesystem::is_symlink(folder.file("link.txt")));
}

}  // namespace
}  // namespace orbifit
