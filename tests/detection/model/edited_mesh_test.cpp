#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "orbifit/model/errors.h"
#include "orbifit/model/mesh_io.h"

#include "files/file.h"
#include "temporary_folder.h"

namespace orbifit {
namespace {

using Json = nlohmann::json;

// A roof: two squares that meet at a right angle along an edge, with one normal each and texture coordinates.
const std::string kObj =
    "# a comment that stays\r\n"
    "mtllib roof.mtl\n"
    "o roof\n"
    "v 0 0 0\nv 1.0 0 0\nv 1 1e0 0 \nv 0 1 0\n"
    "v 0.500 -1 -1 0.2 0.4 0.6\nv 1.5 -1 -1\n"
    "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
    "vn 0 0 1\nvn 0 -0.70710678 0.70710678\n"
    "g top\nusemtl red\ns 1\n"
    "f 1/1/1 2/2/1 \\\n  3/3/1 4/4/1\n"
    "g side\nusemtl blue\n"
    "f 1/1/-1 5/2/-1 6/3/-1 2/4/-1\n"
    "l 1 2\n";

std::string binary_ply(bool big) {
  std::string bytes = "ply\nformat binary_" + std::string(big ? "big" : "little") +
                      "_endian 1.0\ncomment kept\nelement vertex 4\nproperty uchar red\nproperty float x\n"
                      "property float y\nproperty float z\nproperty list uchar short tags\nproperty float nx\n"
                      "property float ny\nproperty float nz\nelement face 2\nproperty list uchar int vertex_indices\n"
                      "property float quality\nend_header\n";
  const auto put = [&](auto number) {
    std::string text(sizeof(number), '\0');
    std::memcpy(text.data(), &number, sizeof(number));
    if (big) std::reverse(text.begin(), text.end());
    bytes += text;
  };
  for (int v = 0; v < 4; ++v) {
    put(static_cast<std::uint8_t>(200 + v));
    put(static_cast<float>(v % 2));
    put(static_cast<float>(v / 2));
    put(0.0F);
    put(static_cast<std::uint8_t>(v));
    for (int t = 0; t < v; ++t) put(static_cast<std::int16_t>(-t));
    for (const float normal : {0.0F, 0.0F, 1.0F}) put(normal);
  }
  for (const auto& face : {std::vector<int>{0, 1, 3}, std::vector<int>{0, 3, 2}}) {
    put(std::uint8_t{3});
    for (const int corner : face) put(static_cast<std::int32_t>(corner));
    put(0.25F);
  }
  return bytes;
}

const std::string kAsciiPly =
    "ply\nformat ascii 1.0\nobj_info kept\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    "property float nx\nproperty float ny\nproperty float nz\nproperty uchar red\nelement face 2\n"
    "property list uchar int vertex_indices\nend_header\n"
    "0 0 0  0 0 1  10\n1 0 0.0  0 0 1 11\n0 1 0 0 0 1 12\n1 1 0 0 0 1 13\n3 0 1 3\n3 0 3 2\n";

const std::string kOff =
    "NCOFF\n# colours\n4 2 0\n0 0 0 0 0 1 255 0 0 255\n1 0 0 0 0 1 0 255 0 255 # last\n0 1 0 0 0 1 1 1 1 1\n"
    "1 1 0 0 0 1 2 2 2 2\n3 0 1 3 0.5 0.5 0.5\n3 0 3 2\n";

const std::string kAsciiStl =
    "solid roof of tin\n  facet normal 0 0 1\n    outer loop\n      vertex 0 0 0\n      vertex 1 0 0\n      vertex 1 1 "
    "0\n"
    "    endloop\n  endfacet\nendsolid roof of tin\n";

std::string binary_stl() {
  std::string bytes = "made by hand";
  bytes.resize(80, '.');
  const auto put = [&](auto number) {
    const auto* raw = reinterpret_cast<const char*>(&number);
    bytes.append(raw, sizeof(number));
  };
  put(std::uint32_t{1});
  for (const float number : {0.F, 0.F, 1.F, 0.F, 0.F, 0.F, 1.F, 0.F, 0.F, 1.F, 1.F, 0.F}) put(number);
  put(std::uint16_t{0x7FFF});
  return bytes;
}

struct Sample {
  std::string name, ending, content;
};

void PrintTo(const Sample& sample, std::ostream* out) {
  *out << sample.name;
}

class EditedMesh : public testing::TestWithParam<Sample> {
 protected:
  void SetUp() override { write_file(source_, GetParam().content); }

  Mesh turned() const {
    Mesh mesh = read_mesh(source_);
    const Eigen::AngleAxisd turn(0.3, Eigen::Vector3d(1, 2, 3).normalized());
    mesh.vertices = (mesh.vertices * turn.toRotationMatrix().transpose()).eval();
    return mesh;
  }

  TemporaryFolder folder_;
  std::filesystem::path source_ = folder_.file("source" + GetParam().ending);
  std::filesystem::path result_ = folder_.file("result" + GetParam().ending);
};

TEST_P(EditedMesh, WithoutAnEditIsTheFileByteForByte) {
  write_edited_mesh(result_, source_, read_mesh(source_));
  EXPECT_EQ(read_file(result_), GetParam().content);
}

TEST_P(EditedMesh, HasTheNewPositionsInTheOldOrder) {
  const Mesh edited = turned();
  write_edited_mesh(result_, source_, edited);
  const Mesh read = read_mesh(result_);
  EXPECT_EQ(read.faces, edited.faces);
  const double precision = GetParam().ending == ".stl" && GetParam().name != "AsciiStl" ? 1e-7 : 0;
  EXPECT_LE((read.vertices - edited.vertices).cwiseAbs().maxCoeff(), precision);
}

TEST_P(EditedMesh, GivesBackTheFileWhenTheEditIsTakenBack) {
  const Mesh rest = read_mesh(source_);
  write_edited_mesh(result_, source_, turned());
  write_edited_mesh(folder_.file("back" + GetParam().ending), result_, rest);
  const Mesh back = read_mesh(folder_.file("back" + GetParam().ending));
  EXPECT_EQ(back.vertices, rest.vertices);
}

INSTANTIATE_TEST_SUITE_P(Formats, EditedMesh,
                         testing::Values(Sample{"Obj", ".obj", kObj}, Sample{"AsciiPly", ".ply", kAsciiPly},
                                         Sample{"LittlePly", ".ply", binary_ply(false)},
                                         Sample{"BigPly", ".ply", binary_ply(true)}, Sample{"Off", ".off", kOff},
                                         Sample{"AsciiStl", ".stl", kAsciiStl},
                                         Sample{"BinaryStl", ".stl", binary_stl()}),
                         [](const auto& sample) { return sample.param.name; });

class EditedFile : public testing::Test {
 protected:
  std::string edited(const std::string& name, const std::string& content, const std::function<void(Mesh&)>& edit) {
    write_file(folder_.file(name), content);
    Mesh mesh = read_mesh(folder_.file(name));
    edit(mesh);
    write_edited_mesh(folder_.file("edited-" + name), folder_.file(name), mesh);
    return read_file(folder_.file("edited-" + name));
  }

  TemporaryFolder folder_;
};

TEST_F(EditedFile, ObjKeepsLinesAndNumbersThatDoNotChange) {
  const std::string text = edited("a.obj", kObj, [](Mesh& mesh) { mesh.vertices(3, 2) = 0.25; });
  EXPECT_NE(text.find("# a comment that stays\r\nmtllib roof.mtl\no roof\nv 0 0 0\nv 1.0 0 0\nv 1 1e0 0 \nv 0 1 0.25\n"
                      "v 0.500 -1 -1 0.2 0.4 0.6\n"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("g side\nusemtl blue\n"), std::string::npos) << text;
}

TEST_F(EditedFile, ObjSplitsANormalWhereItsVerticesTurnApart) {
  // Two triangles far from one another share a normal; one of them is turned by a quarter about x.
  const std::string content =
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 5 0 0\nv 6 0 0\nv 5 1 0\nvn 0 0 2\nf 1//1 2//1 3//1\nf 4//-1 5//-1 6//-1\nvn 0 1 "
      "0\n"
      "f 1//2 2//2 3//-1\n";
  const std::string text = edited("a.obj", content, [](Mesh& mesh) { mesh.vertices.row(5) << 5, 0, 1; });
  EXPECT_NE(text.find("f 1//1 2//1 3//1\nvn "), std::string::npos)
      << text;  // the first keeps it, the second gets its own
  EXPECT_NE(text.find("vn 0 1 0\n"), std::string::npos) << text;
  EXPECT_NE(text.find("f 1//5 2//5 3//-1\n"), std::string::npos) << text;  // the numbers behind move on by three
  const std::size_t added = text.find("vn ", text.find("f 1//1"));
  double x = 0, y = 0, z = 0;
  ASSERT_EQ(std::sscanf(text.c_str() + added, "vn %lf %lf %lf", &x, &y, &z), 3);
  EXPECT_NEAR(x, 0, 1e-12);
  EXPECT_NEAR(y, -2, 1e-12);
  EXPECT_NEAR(z, 0, 1e-12);
}

TEST_F(EditedFile, RefusesAFileThatHasChangedMeanwhile) {
  write_file(folder_.file("a.off"), kOff);
  Mesh mesh = read_mesh(folder_.file("a.off"));
  mesh.vertices.conservativeResize(3, 3);
  EXPECT_THROW(write_edited_mesh(folder_.file("b.off"), folder_.file("a.off"), mesh), InputError);
  EXPECT_FALSE(std::filesystem::exists(folder_.file("b.off")));
}

TEST_F(EditedFile, BringsTheMaterialsAlongToAnotherFolder) {
  write_file(folder_.file("roof.mtl"), "newmtl red\nmap_Kd -s 1 1 1 tiles.png\nnewmtl blue\nmap_Kd ../secret.png\n");
  write_file(folder_.file("tiles.png"), "picture");
  write_file(folder_.file("a.obj"), kObj);
  std::filesystem::create_directory(folder_.file("out"));
  const std::vector<std::string> problems =
      write_edited_mesh(folder_.file("out") / "b.obj", folder_.file("a.obj"), read_mesh(folder_.file("a.obj")));
  EXPECT_EQ(read_file(folder_.file("out") / "tiles.png"), "picture");
  EXPECT_TRUE(std::filesystem::exists(folder_.file("out") / "roof.mtl"));
  ASSERT_EQ(problems.size(), 1U);
  EXPECT_NE(problems[0].find("secret.png"), std::string::npos) << problems[0];
}

// Two nodes that share one mesh, the second mirrored and moved; base64 data of one triangle with normals.
std::string shared_gltf() {
  std::string data;
  const auto put = [&](float number) { data.append(reinterpret_cast<const char*>(&number), 4); };
  for (const float number : {0.F, 0.F, 0.F, 1.F, 0.F, 0.F, 0.F, 1.F, 0.F}) put(number);
  for (int v = 0; v < 3; ++v) {
    for (const float number : {0.F, 0.F, 1.F}) put(number);
  }
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < data.size(); i += 3) {
    const auto bits = (static_cast<unsigned>(static_cast<unsigned char>(data[i])) << 16U) |
                      (static_cast<unsigned>(static_cast<unsigned char>(data[i + 1])) << 8U) |
                      static_cast<unsigned char>(data[i + 2]);
    for (unsigned k = 0; k < 4; ++k) text += digits[(bits >> (18U - 6U * k)) & 63U];
  }
  Json root = Json::parse(R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0,1]}],
    "nodes":[{"mesh":0,"name":"left"},{"mesh":0,"name":"right","scale":[-1,1,1],"translation":[5,0,0]}],
    "meshes":[{"name":"leaf","primitives":[{"attributes":{"POSITION":0,"NORMAL":1},"material":0}]}],
    "materials":[{"name":"green","extras":{"kept":true}}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]},
                 {"bufferView":1,"componentType":5126,"count":3,"type":"VEC3"}],
    "bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":36}],
    "buffers":[{"byteLength":72}]})");
  root["buffers"][0]["uri"] = "data:application/octet-stream;base64," + text;
  return root.dump();
}

TEST_F(EditedFile, GltfNodesThatMoveAlikeStayInstances) {
  const std::string content = shared_gltf();
  const std::string text = edited("a.gltf", content, [](Mesh& mesh) {
    mesh.vertices(0, 2) += 0.5;  // of the one, and of the other
    mesh.vertices(3, 2) += 0.5;
  });
  const Json root = Json::parse(text);
  EXPECT_EQ(root["meshes"].size(), 1U);
  EXPECT_EQ(root["accessors"].size(), 2U);
  EXPECT_EQ(root["materials"], Json::parse(content)["materials"]);
  EXPECT_EQ(root["accessors"][0]["max"][2], 0.5);
}

TEST_F(EditedFile, GltfNodesThatMoveApartGetMeshesOfTheirOwn) {
  Mesh wanted;
  const std::string text = edited("a.gltf", shared_gltf(), [&](Mesh& mesh) {
    mesh.vertices(3, 0) += 0.5;
    mesh.vertices(1, 1) -= 0.25;
    wanted = mesh;
  });
  const Json root = Json::parse(text);
  EXPECT_EQ(root["meshes"].size(), 2U);
  EXPECT_EQ(root["nodes"][0]["mesh"], 0);
  EXPECT_EQ(root["nodes"][1]["mesh"], 1);
  EXPECT_EQ(root["meshes"][1]["primitives"][0]["material"], 0);
  const Mesh read = read_mesh(folder_.file("edited-a.gltf"));
  EXPECT_LE((read.vertices - wanted.vertices).cwiseAbs().maxCoeff(), 1e-7);
}

TEST_F(EditedFile, GltfDataOutsideOfTheFolderIsRefused) {
  std::string content = shared_gltf();
  Json root = Json::parse(content);
  root["buffers"][0]["uri"] = "../other.bin";
  write_file(folder_.file("a.gltf"), root.dump());
  try {
    read_mesh(folder_.file("a.gltf"));
    FAIL() << "read";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("leaves the file's folder"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace orbifit
