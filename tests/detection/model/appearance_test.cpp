#include "orbifit/model/appearance.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <string>

#include <gtest/gtest.h>

#include "orbifit/model/errors.h"
#include "orbifit/model/mesh_io.h"

#include "temporary_folder.h"

namespace orbifit {
namespace {

namespace fs = std::filesystem;

// Two triangles of one quad with UVs, normals and a material with a texture; one without any.
constexpr const char* kLookingObj =
    "mtllib look.mtl\n"
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\n"
    "vt 0 0\nvt 1 0\nvt 1 0.75\nvt 0.25 1\nvn 0 0 1\nvn 0 0 2\n"
    "usemtl wood, oiled\nf 1/1/1 2/2/1 3/3/2 4/4/1\n"
    "usemtl plain\nf 1 2 5\n";
constexpr const char* kLookLibrary =
    "newmtl plain\nKd 0.5 0.25 1\nd 0.5\n"
    "newmtl wood, oiled\nKd 0.1 0.2 0.3\nmap_Kd grain fine.png\n"
    "newmtl unused\nKd 1 0 0\n";
// Enough of a PNG to be told as one; pictures are copied, never decoded.
const std::string kLookImage = std::string("\x89PNG\r\n\x1a\n") + "bytes of a picture";

class AppearanceOfFiles : public testing::Test {
 protected:
  void SetUp() override {
    folder_.write("look.mtl", kLookLibrary);
    folder_.write("grain fine.png", kLookImage);
    folder_.write("look.obj", kLookingObj);
  }

  Appearance read(const std::string& name) const {
    return read_appearance(folder_.file(name), read_mesh(folder_.file(name)));
  }

  // Writes a file's mesh and look under another name, in a folder of its own.
  std::vector<std::string> convert(const std::string& from, const std::string& to) const {
    fs::create_directories(folder_.file(to).parent_path());
    const Mesh mesh = read_mesh(folder_.file(from));
    return write_mesh(folder_.file(to), mesh, read_appearance(folder_.file(from), mesh));
  }

  std::string content(const std::string& name) const {
    std::ifstream stream(folder_.file(name), std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }

  TemporaryFolder folder_;
};

void expect_same_look(const Appearance& a, const Appearance& b, bool every_corner) {
  ASSERT_EQ(a.uvs.rows(), b.uvs.rows());
  for (Eigen::Index c = 0; c < a.uvs.rows(); ++c) {
    if (!every_corner && !a.uvs.row(c).allFinite()) continue;
    EXPECT_LT((a.uvs.row(c) - b.uvs.row(c)).norm(), 1e-6) << c;
  }
  ASSERT_EQ(a.material_of_face.size(), b.material_of_face.size());
  for (std::size_t f = 0; f < a.material_of_face.size(); ++f) {
    const Material& of_a = a.materials[static_cast<std::size_t>(a.material_of_face[f])];
    const Material& of_b = b.materials[static_cast<std::size_t>(b.material_of_face[f])];
    EXPECT_EQ(of_a.name, of_b.name);
    EXPECT_EQ(of_a.base_colour, of_b.base_colour);
    EXPECT_EQ(of_a.texture, of_b.texture);
    EXPECT_EQ(of_a.image, of_b.image);
  }
}

TEST_F(AppearanceOfFiles, OfAnObjIsReadWithItsLibrary) {
  const Appearance look = read("look.obj");
  EXPECT_TRUE(look.warnings.empty());
  ASSERT_EQ(look.material_of_face, (std::vector<int>{0, 0, 1}));
  EXPECT_EQ(look.materials[0].name, "wood, oiled");
  EXPECT_EQ(look.materials[0].texture, "grain fine.png");
  EXPECT_EQ(look.materials[0].image, kLookImage);
  EXPECT_EQ(look.materials[1].base_colour, (std::array<double, 4>{0.5, 0.25, 1, 0.5}));
  ASSERT_EQ(look.uvs.rows(), 9);
  EXPECT_EQ(look.uvs.row(2), Eigen::RowVector2d(1, 0.75));
  EXPECT_EQ(look.uvs.row(5), Eigen::RowVector2d(0.25, 1));
  EXPECT_FALSE(look.uvs.row(6).allFinite());
  EXPECT_EQ(look.normals.row(2), Eigen::RowVector3d(0, 0, 1));
}

TEST_F(AppearanceOfFiles, GoesFromObjToGlbAndBack) {
  EXPECT_TRUE(convert("look.obj", "glb/look.glb").empty());
  const Appearance glb = read("glb/look.glb");
  expect_same_look(read("look.obj"), glb, false);
  EXPECT_TRUE(convert("glb/look.glb", "obj/look.obj").empty());
  expect_same_look(glb, read("obj/look.obj"), true);
  EXPECT_EQ(content("obj/grain fine.png"), kLookImage);
  EXPECT_TRUE(convert("obj/look.obj", "glb/again.glb").empty());
  EXPECT_EQ(content("glb/look.glb"), content("glb/again.glb"));
}

TEST_F(AppearanceOfFiles, OfAPlyGoesToObjAndGlb) {
  folder_.write("colours.ply",
                "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
                "property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 1\n"
                "property list uchar int vertex_indices\nend_header\n"
                "0 0 0 255 0 0\n1 0 0 0 255 51\n0 1 0 0 0 255\n3 0 1 2\n");
  const Appearance look = read("colours.ply");
  ASSERT_EQ(look.colours.rows(), 3);
  EXPECT_LT((look.colours.row(1) - Eigen::RowVector4d(0, 1, 0.2, 1)).norm(), 1e-12);
  for (const char* name : {"a.obj", "a.glb", "a.ply"}) {
    EXPECT_TRUE(convert("colours.ply", name).empty()) << name;
    const Appearance again = read(name);
    ASSERT_EQ(again.colours.rows(), 3) << name;
    EXPECT_LT((again.colours - look.colours).cwiseAbs().maxCoeff(), 1e-6) << name;
  }
}

TEST_F(AppearanceOfFiles, StaysWithAnEditInAnotherFormat) {
  Mesh turned = read_mesh(folder_.file("look.obj"));
  turned.vertices.col(1).swap(turned.vertices.col(2));
  turned.vertices.col(2) *= -1;  // about x, so that z becomes y
  EXPECT_TRUE(write_edited_mesh(folder_.file("edited.glb"), folder_.file("look.obj"), turned).empty());
  const Appearance look = read("edited.glb");
  expect_same_look(read("look.obj"), look, false);
  EXPECT_LT((look.normals.row(5) - Eigen::RowVector3d(0, 1, 0)).norm(), 1e-6) << look.normals.row(5);
  folder_.write("bad.obj", std::string(kLookingObj) + "f 1/9 2/9 3/9\n");
  const Mesh bad = read_mesh(folder_.file("bad.obj"));
  EXPECT_EQ(write_edited_mesh(folder_.file("bad.glb"), folder_.file("bad.obj"), bad).size(), 1U);
  EXPECT_EQ(read_mesh(folder_.file("bad.glb")).faces.rows(), bad.faces.rows());
}

TEST_F(AppearanceOfFiles, OfPolygonsLeavesThemPolygons) {
  EXPECT_TRUE(convert("look.obj", "again/look.obj").empty());
  EXPECT_NE(content("again/look.obj").find("f 1/1/1 2/2/1 3/3/1 4/4/1\n"), std::string::npos)
      << content("again/look.obj");
  expect_same_look(read("look.obj"), read("again/look.obj"), false);
}

TEST_F(AppearanceOfFiles, InAGlbLeavesVerticesAndFacesInTheirOrder) {
  folder_.write("order.obj", "v 5 5 5\nv 0 0 1\nv 0 1 0\nv 1 0 0\nv 0 0 0\no named\nf 5 4 3\nf 4 3 2\nf 5 2 3\n");
  EXPECT_TRUE(convert("order.obj", "order.glb").empty());
  const Mesh mesh = read_mesh(folder_.file("order.obj"));
  EXPECT_EQ(read_mesh(folder_.file("order.glb")).vertices, mesh.vertices);  // also the one that no face has
  EXPECT_EQ(read_mesh(folder_.file("order.glb")).faces, mesh.faces);
  // Materials that change to and fro.
  std::string text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";
  for (int f = 0; f < 12; ++f) {
    text += f % 2 == 0 ? "usemtl a\n" : "usemtl b\n";
    text += f % 3 == 0 ? "f 1 2 3\n" : "f 2 3 4\n";
  }
  folder_.write("turns.obj", text);
  EXPECT_TRUE(convert("turns.obj", "turns.glb").empty());
  const Mesh before = read_mesh(folder_.file("turns.obj"));
  const Mesh after = read_mesh(folder_.file("turns.glb"));
  ASSERT_EQ(after.faces.rows(), before.faces.rows());
  for (Eigen::Index f = 0; f < before.faces.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      EXPECT_EQ(after.vertices.row(after.faces(f, k)), before.vertices.row(before.faces(f, k))) << f;
    }
  }
  EXPECT_EQ(read("turns.glb").material_of_face, read("turns.obj").material_of_face);
}

TEST_F(AppearanceOfFiles, SaysWhereAGlbHasTheFacesInAnotherOrder) {
  std::string text = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  for (int f = 0; f < 5000; ++f) text += f % 2 == 0 ? "usemtl a\nf 1 2 3\n" : "usemtl b\nf 1 3 2\n";
  folder_.write("turns.obj", text);
  const std::vector<std::string> problems = convert("turns.obj", "turns.glb");
  ASSERT_EQ(problems.size(), 1U);
  EXPECT_NE(problems.front().find("these change 5000 times"), std::string::npos) << problems.front();
  const Appearance look = read("turns.glb");
  EXPECT_EQ(std::count(look.material_of_face.begin(), look.material_of_face.end(), 0), 2500);
}

TEST_F(AppearanceOfFiles, HasMaterialsThatObjCannotNameUnderOthers) {
  Mesh mesh;
  mesh.vertices = Points::Identity(3, 3);
  mesh.faces.resize(3, 3);
  mesh.faces << 0, 1, 2, 1, 2, 0, 2, 0, 1;
  Appearance look;
  look.materials = {{"a#b", {1, 0, 0, 1}, "", ""}, {"a_b", {0, 1, 0, 1}, "", ""}, {"", {0, 0, 1, 1}, "", ""}};
  look.material_of_face = {0, 1, 2};
  EXPECT_TRUE(write_mesh(folder_.file("names.obj"), mesh, look).empty());
  const Appearance again = read("names.obj");
  ASSERT_EQ(again.materials.size(), 3U);
  EXPECT_EQ(again.material_of_face, look.material_of_face);
  for (std::size_t m = 0; m < 3; ++m) EXPECT_EQ(again.materials[m].base_colour, look.materials[m].base_colour) << m;
}

TEST_F(AppearanceOfFiles, SaysWhatAFormatDoesNotTake) {
  const std::vector<std::string> lost = convert("look.obj", "plain.stl");
  ASSERT_EQ(lost.size(), 1U);
  EXPECT_NE(lost.front().find("texture coordinates, normals, materials"), std::string::npos) << lost.front();
}

TEST_F(AppearanceOfFiles, WarnsOfWhatIsMissingAndKeepsItsName) {
  fs::remove(folder_.file("grain fine.png"));
  const Appearance look = read("look.obj");
  ASSERT_EQ(look.warnings.size(), 1U);
  EXPECT_NE(look.warnings.front().find("grain fine.png"), std::string::npos);
  EXPECT_TRUE(convert("look.obj", "kept.glb").empty());
  EXPECT_EQ(read("kept.glb").materials[0].texture, "grain fine.png");
  fs::remove(folder_.file("look.mtl"));
  EXPECT_NE(read("look.obj").warnings.at(0).find("look.mtl"), std::string::npos);
  folder_.write("outside.obj", "mtllib ../other.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_NE(read("outside.obj").warnings.at(0).find("outside"), std::string::npos);
  fs::create_directory(folder_.file("in"));
  folder_.write("secret.png", kLookImage);
  for (const std::string& name : {std::string("../secret.png"), folder_.file("secret.png").string()}) {
    folder_.write("in/a.mtl", "newmtl red\nmap_Kd " + name + "\n");
    folder_.write("in/a.obj", "mtllib a.mtl\nusemtl red\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    const Appearance outside = read("in/a.obj");
    EXPECT_EQ(outside.materials.at(0).image, "") << name;
    EXPECT_EQ(outside.materials.at(0).texture, name);
    EXPECT_NE(outside.warnings.at(0).find("is outside of the mesh's folder"), std::string::npos) << name;
  }
}

TEST_F(AppearanceOfFiles, RefusesNumbersThatDisagree) {
  const std::string points = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\n";
  for (const char* face :
       {"f 1/2 2/1 3/1\n", "f 1/0 2/1 3/1\n", "f 1/x 2/1 3/1\n", "f 1//2 2//1 3//1\n", "f 1/-5 2/1 3/1\n"}) {
    folder_.write("bad.obj", points + face);
    EXPECT_THROW(read("bad.obj"), InputError) << face;
  }
  folder_.write("bad.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt zero 0\nf 1/1 2/1 3/1\n");
  EXPECT_THROW(read("bad.obj"), InputError);
}

TEST_F(AppearanceOfFiles, RefusesAGlbWhoseAttributesDoNotFit) {
  convert("look.obj", "good.glb");
  const std::string good = content("good.glb");
  const auto with = [&](const std::string& old, const std::string& text) {
    std::string bytes = good;
    const std::size_t at = bytes.find(old);
    EXPECT_NE(at, std::string::npos) << old;
    EXPECT_EQ(old.size(), text.size());
    bytes.replace(at, old.size(), text);
    folder_.write("bad.glb", bytes);
  };
  for (const auto& [old, text] :
       {std::pair("\"TEXCOORD_0\":2", "\"TEXCOORD_0\":9"), std::pair("\"NORMAL\":1", "\"NORMAL\":3"),
        std::pair("\"TEXCOORD_0\":2", "\"TEXCOORD_0\":3"), std::pair("\"index\":0", "\"index\":7"),
        std::pair("\"source\":0", "\"source\":4"), std::pair("\"type\":\"VEC2\"", "\"type\":\"MAT2\"")}) {
    with(old, text);
    EXPECT_THROW(read("bad.glb"), InputError) << old;
  }
}

TEST(AppearanceOfCutFaces, FollowsTheFaceThatWasCutAndItsMotion) {
  Mesh source;
  source.vertices.resize(3, 3);
  source.vertices << 0, 0, 0, 2, 0, 0, 0, 2, 0;
  source.faces.resize(1, 3);
  source.faces << 0, 1, 2;
  Appearance look;
  look.uvs.resize(3, 2);
  look.uvs << 0, 0, 1, 0, 0, 1;
  look.normals = Points::Constant(3, 3, 0);
  look.normals.col(2).setOnes();
  look.material_of_face = {0};
  look.materials = {{"only", {1, 1, 1, 1}, "", ""}};
  const std::vector<Motion> motions{Motion{}, Motion::rotation(Eigen::Vector3d::UnitX(), std::acos(-1) / 2, {0, 0, 0})};
  Mesh cut;
  cut.vertices.resize(3, 3);
  cut.vertices << 0, 0, 0, 1, 0, 0, 0, 0, 1;  // half the size, turned so that y becomes z
  cut.faces = source.faces;
  const Appearance moved = transferred(look, source, cut, {0}, motions, {1});
  EXPECT_LT((moved.uvs - 0.5 * look.uvs).norm(), 1e-12);
  EXPECT_LT((moved.normals.row(1) - Eigen::RowVector3d(0, -1, 0)).norm(), 1e-12);
  EXPECT_EQ(moved.material_of_face, (std::vector<int>{0}));
}

}  // namespace
}  // namespace orbifit
