#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "orbifit/model/errors.h"
#include "orbifit/model/mesh_io.h"

#include "base/random.h"
#include "files/file.h"
#include "mesh_samples.h"
#include "temporary_folder.h"

namespace orbifit {
namespace {

struct BrokenMesh {
  std::string name;  // of the test
  std::string file;
  std::string content;
  std::string message;  // what the error must say after the file's name
};

const std::string kPlyHead =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n";

std::string with(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

std::string truncated_ply() {
  const std::string bytes = ply_of<double>(polygon_mesh(), "binary_little_endian");
  return bytes.substr(0, bytes.size() - 5);
}

std::string ply_with_nan() {
  Mesh mesh = polygon_mesh();
  mesh.vertices(4, 2) = std::numeric_limits<double>::quiet_NaN();
  return ply_of<double>(mesh, "binary_big_endian");
}

std::string ply_with_bad_corner() {
  Mesh mesh = polygon_mesh();
  mesh.faces(5, 1) = 9;
  return ply_of<double>(mesh, "binary_little_endian");
}

std::string short_stl() {
  std::string bytes(80, ' ');
  append_bytes(bytes, std::uint32_t{4000000000U});
  return bytes + std::string(120, '\0');
}

std::vector<BrokenMesh> broken_meshes() {
  const std::string triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  const std::string points = "0 0 0\n1 0 0\n0 1 0\n";
  return {
      {"Empty", "a.obj", "", "is empty"},
      {"UnknownEnding", "a.step", "x", "unknown ending '.step'"},
      {"ObjWithoutVertices", "a.obj", "# nothing\n", "has no vertices"},
      {"ObjWithoutFaces", "a.obj", triangle, "has no faces"},
      {"ObjNan", "a.obj", "v 0 0 0\nv nan 0 0\n", "line 2: coordinate x is nan: not a finite number"},
      {"ObjInfinite", "a.obj", "v 0 -inf 0\n", "line 1: coordinate y is -inf"},
      {"ObjOverflow", "a.obj", "v 0 0 1e999\n", "line 1: coordinate z is inf"},
      {"ObjHuge", "a.obj", "v 0 0 2e100\n", "line 1: coordinate z is 2e+100: beyond 1e50"},
      {"ObjWord", "a.obj", "v 0 0 zero\n", "line 1: 'zero' is not a number"},
      {"ObjTwoCoordinates", "a.obj", "v 0 0\n", "line 1: a vertex needs three coordinates"},
      {"ObjIndexTooLarge", "a.obj", triangle + "f 1 2 4\n", "line 4: vertex index 3 (counted from 0) is out of range"},
      {"ObjIndexZero", "a.obj", triangle + "f 0 1 2\n", "line 4: '0' names vertex 0: vertices count from 1"},
      {"ObjIndexNegative", "a.obj", triangle + "f -4 1 2\n", "line 4: '-4' is out of range"},
      {"ObjIndexHuge", "a.obj", triangle + "f 1 2 4000000000\n", "line 4: vertex index 3999999999"},
      {"ObjIndexWord", "a.obj", triangle + "f 1 2 x/3\n", "line 4: 'x/3' is not a corner of a face"},
      {"ObjTwoCorners", "a.obj", triangle + "f 1 2\n", "line 4: a face with 2 corners: at least 3 are needed"},
      {"OffWithoutKeyword", "a.off", "3 1 0\n" + points, "line 1: not an OFF file"},
      {"OffFourDimensions", "a.off", "4OFF\n3 1 0\n", "only three-dimensional"},
      {"OffBinary", "a.off", "OFF BINARY\nx", "binary OFF files are not read"},
      {"OffCounts", "a.off", "OFF\n3 x\n", "line 2: the counts"},
      {"OffFewVertices", "a.off", "OFF\n4000000000 1 0\n" + points, "the file ends after 3 of 4000000000 vertices"},
      {"OffFewFaces", "a.off", "OFF\n3 2 0\n" + points + "3 0 1 2\n", "the file ends after 1 of 2 faces"},
      {"OffMoreLines", "a.off", "OFF\n3 1 0\n" + points + "3 0 1 2\n3 0 1 2\n", "line 7: more lines than"},
      {"OffFewCorners", "a.off", "OFF\n3 1 0\n" + points + "4000000000 0 1 2\n", "but names 3"},
      {"OffIndex", "a.off", "OFF\n3 1 0\n" + points + "3 0 1 3\n", "line 6: vertex index 3"},
      {"OffNoFaces", "a.off", "OFF\n3 0 0\n" + points, "has no faces"},
      {"PlyNoPly", "a.ply", "plx\n", "line 1: not a PLY file"},
      {"PlyHeaderEnds", "a.ply", "ply\nformat ascii 1.0\n", "line 2: the file ends within the header"},
      {"PlyFormat", "a.ply", "ply\nformat utf8 1.0\n", "line 2: unknown format 'utf8'"},
      {"PlyType", "a.ply", with(kPlyHead, "float x", "real x"), "line 4: unknown type 'real'"},
      {"PlyNoX", "a.ply", with(kPlyHead, "float x", "float a") + points + "3 0 1 2\n", "has no property 'x'"},
      {"PlyCount", "a.ply", with(kPlyHead, "vertex 3", "vertex -3"), "line 3: the count of element 'vertex' is '-3'"},
      {"PlyAsciiFewRows", "a.ply", kPlyHead + points, "the file ends after 0 of 1 rows of element 'face'"},
      {"PlyAsciiShortRow", "a.ply", kPlyHead + "0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "line 10: the line has fewer numbers"},
      {"PlyAsciiHugeCount", "a.ply", with(kPlyHead, "vertex 3", "vertex 4000000000") + points,
       "rows of element 'vertex'"},
      {"PlyAsciiHugeList", "a.ply", kPlyHead + points + "4000000000 0 1 2\n", "line 13: the line has fewer numbers"},
      {"PlyAsciiIndex", "a.ply", kPlyHead + points + "3 0 1 -1\n", "line 13: vertex index -1"},
      {"PlyAsciiFraction", "a.ply", kPlyHead + points + "3 0 1 1.5\n", "line 13: a vertex index is not an integer"},
      {"PlyAsciiTwoCorners", "a.ply", kPlyHead + points + "2 0 1\n", "line 13: a face with 2 corners"},
      {"PlyTruncated", "a.ply", truncated_ply(),
       "face 7: the file is truncated: its header announces 8 of element 'face'"},
      {"PlyBinaryHugeCount", "a.ply",
       with(ply_of<float>(polygon_mesh(), "binary_little_endian"), "vertex 9", "vertex 4000000000"),
       "the file is truncated: its header announces 4000000000 of element 'vertex'"},
      {"PlyBinaryNan", "a.ply", ply_with_nan(), "vertex 4: coordinate z is nan"},
      {"PlyBinaryIndex", "a.ply", ply_with_bad_corner(),
       "face 5: vertex index 9 (counted from 0) is out of range: the file has 9 vertices"},
      {"StlTruncated", "a.stl", short_stl(),
       "face 2: the file is truncated: its header announces 4000000000 triangles, it holds 2"},
      {"StlTiny", "a.stl", "abc", "not even an STL header fits"},
      {"StlTwoVertices", "a.stl", "solid\nfacet\nvertex 0 0 0\nvertex 0 0 1\nendfacet\n",
       "line 5: a facet with 2 vertices"},
      {"StlOpen", "a.stl", "solid\nfacet\nvertex 0 0 0\n", "the file ends within a facet"},
      {"StlEmpty", "a.stl", "solid\nendsolid\n", "has no vertices"},
      {"GltfNoJson", "a.gltf", "hello", "line 1: is not JSON: syntax error"},
      {"GlbTruncated", "a.glb", "glTF\x02", "truncated"},
  };
}

class BrokenMeshFile : public testing::TestWithParam<BrokenMesh> {};

TEST_P(BrokenMeshFile, IsRefusedWithFilePlaceAndReason) {
  const TemporaryFolder folder;
  const auto file = folder.write(GetParam().file, GetParam().content);
  try {
    read_mesh(file);
    ADD_FAILURE() << "was read";
  } catch (const InputError& error) {
    const std::string message = error.what();
    EXPECT_TRUE(message.starts_with(file.string() + ": ")) << message;
    EXPECT_NE(message.find(GetParam().message), std::string::npos) << message;
  }
}

INSTANTIATE_TEST_SUITE_P(Table, BrokenMeshFile, testing::ValuesIn(broken_meshes()),
                         [](const auto& test) { return test.param.name; });

TEST(BrokenMesh, MissingFilesAndFolders) {
  const TemporaryFolder folder;
  const auto expect = [](const std::filesystem::path& file, const std::string& reason) {
    try {
      read_mesh(file);
      ADD_FAILURE() << file;
    } catch (const InputError& error) {
      EXPECT_EQ(error.what(), file.string() + ": " + reason);
    }
  };
  expect(folder.file("none.obj"), "no such file");
  expect(folder.path(), "is a folder, not a file");
}

// Valid files of every format, then damaged: whatever happens, it is a mesh or an InputError.
class Damage : public testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    const Mesh mesh = polygon_mesh();
    if (GetParam().starts_with("ply_")) {
      content_ = ply_of<double>(mesh, GetParam().substr(4));
      file_ = folder_.file("a.ply");
    } else {
      file_ = folder_.file("a." + GetParam());
      write_mesh(file_, mesh);
      content_ = read_file(file_);
    }
  }

  void read(const std::string& content) {
    folder_.write(file_.filename().string(), content);
    try {
      const Mesh mesh = read_mesh(file_);
      ASSERT_GT(mesh.faces.rows(), 0);
      ASSERT_GE(mesh.faces.minCoeff(), 0);
      ASSERT_LT(mesh.faces.maxCoeff(), mesh.vertices.rows());
      ASSERT_TRUE(mesh.vertices.allFinite());
      ++meshes_;
    } catch (const InputError&) {
      ++errors_;
    }
  }

  TemporaryFolder folder_;
  std::filesystem::path file_;
  std::string content_;
  int meshes_ = 0;
  int errors_ = 0;
};

TEST_P(Damage, TruncationGivesAMeshOrAnError) {
  for (std::size_t length = 0; length < content_.size(); ++length) read(content_.substr(0, length));
  EXPECT_GT(errors_, 0);
}

TEST_P(Damage, FlippedBytesGiveAMeshOrAnError) {
  Random random(11, GetParam());
  for (int round = 0; round < 2000; ++round) {
    std::string content = content_;
    for (std::uint64_t flips = 1 + random.below(4); flips > 0; --flips) {
      content[random.below(content.size())] = static_cast<char>(random.below(256));
    }
    read(content);
  }
  EXPECT_GT(errors_, 0);
  EXPECT_GT(meshes_, 0);
}

INSTANTIATE_TEST_SUITE_P(Formats, Damage,
                         testing::Values("obj", "off", "stl", "glb", "ply_ascii", "ply_binary_little_endian",
                                         "ply_binary_big_endian"),
                         [](const auto& test) { return test.param; });

}  // namespace
}  // namespace orbifit
