#include <cmath>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "orbifit/model/annotation_io.h"
#include "orbifit/model/mesh_io.h"

#include "cube.h"
#include "picture.h"
#include "program.h"
#include "three_mf_sample.h"

namespace orbifit {
namespace {

using nlohmann::json;

class OrbifitConvert : public testing::Test {
 protected:
  void SetUp() override {
    write_mesh(file("obj_000007.ply"), cube_);
    write_annotation(file("cube.json"), cube_annotation(cube_));
  }

  std::filesystem::path file(const std::string& name) const { return program_.folder().file(name); }

  std::string content(const std::string& name) const {
    std::ifstream stream(file(name), std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }

  ProgramResult convert(const std::string& rest) const {
    return program_.run("convert " + rest + " --mesh obj_000007.ply");
  }

  Program program_;
  Mesh cube_ = cube_mesh();
};

TEST_F(OrbifitConvert, WritesTheImageOfEveryVertex) {
  const ProgramResult result = convert("cube.json pairs.csv --element 5 --json");
  ASSERT_EQ(result.code, 0) << result.errors;
  EXPECT_EQ(json::parse(result.output)["unmatched"], 0);
  const Motion element = cube_annotation(cube_).regions.front().elements[5];
  std::istringstream lines(content("pairs.csv"));
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line, "element,vertex,image,distance");
  int count = 0;
  while (std::getline(lines, line)) {
    int number = 0;
    int vertex = 0;
    int image = 0;
    double distance = 0;
    ASSERT_EQ(std::sscanf(line.c_str(), "%d,%d,%d,%lf", &number, &vertex, &image, &distance), 4) << line;
    EXPECT_EQ(number, 5);
    EXPECT_LT((element(cube_.vertices.row(vertex).transpose()) - cube_.vertices.row(image).transpose()).norm(), 1e-12);
    EXPECT_LT(distance, 1e-12);
    ++count;
  }
  EXPECT_EQ(count, cube_.vertices.rows());
}

TEST_F(OrbifitConvert, CountsVerticesWithoutAnImage) {
  Mesh bent = cube_;
  bent.vertices(0, 0) += 0.2 * diagonal(cube_.vertices);
  write_mesh(file("obj_000007.ply"), bent);
  SymmetryAnnotation annotation = cube_annotation(cube_);
  annotation.mesh_diagonal = diagonal(bent.vertices);
  write_annotation(file("cube.json"), annotation);
  const ProgramResult result = convert("cube.json pairs.csv --json");
  ASSERT_EQ(result.code, 0) << result.errors;
  EXPECT_GT(json::parse(result.output)["unmatched"], 0);
  EXPECT_NE(content("pairs.csv").find(",-1,"), std::string::npos);
}

TEST_F(OrbifitConvert, WritesOrbitsAndArrays) {
  ASSERT_EQ(convert("cube.json orbits.csv --orbits").code, 0);
  EXPECT_EQ(content("orbits.csv").find("vertex,orbit\n0,0\n"), 0U);
  ASSERT_EQ(convert("cube.json a.npz").code, 0);
  const std::string archive = content("a.npz");
  EXPECT_EQ(archive.substr(0, 4), "PK\x03\x04");
  const std::string shape = "'shape': (" + std::to_string(48) + "," + std::to_string(cube_.vertices.rows()) + ",)";
  EXPECT_NE(archive.find(shape), std::string::npos);
  ASSERT_EQ(convert("cube.json b.npz").code, 0);
  EXPECT_EQ(content("b.npz"), archive);
}

TEST_F(OrbifitConvert, WritesGlbThatReadsBack) {
  ASSERT_EQ(convert("cube.json regions.glb").code, 0);
  EXPECT_LT((read_mesh(file("regions.glb")).vertices - cube_.vertices).cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_NE(content("regions.glb").find("_REGION_"), std::string::npos);
  EXPECT_NE(content("regions.glb").find("mirror plane of region"), std::string::npos);
  ASSERT_EQ(convert("cube.json instances.glb --as instances").code, 0);
  EXPECT_EQ(read_mesh(file("instances.glb")).faces.rows(), cube_.faces.rows());
}

TEST_F(OrbifitConvert, MakesOneMeshOfCongruentParts) {
  ASSERT_EQ(program_.run("generate desk_fan -o .").code, 0);
  const ProgramResult result =
      program_.run("convert desk_fan.annotation.json fan.glb --mesh desk_fan.ply --as instances --json");
  ASSERT_EQ(result.code, 0) << result.errors;
  const json report = json::parse(result.output);
  EXPECT_EQ(report["instances"], 20);
  EXPECT_LT(report["meshes"], 10);
  EXPECT_LT(report["largest_distance"], 1e-9);
  const Mesh fan = read_mesh(file("desk_fan.ply"));
  const Mesh instanced = read_mesh(file("fan.glb"));
  EXPECT_EQ(instanced.faces.rows(), fan.faces.rows());
  EXPECT_NEAR(face_areas(instanced).sum(), face_areas(fan).sum(), 1e-5 * face_areas(fan).sum());
}

TEST_F(OrbifitConvert, InstancesAreSmallerByWhatRepeatsAndLookTheSame) {
  ASSERT_EQ(program_.run("generate desk_fan -o .").code, 0);
  ASSERT_EQ(program_.run("convert desk_fan.ply plain.glb").code, 0);
  ASSERT_EQ(program_.run("convert desk_fan.annotation.json fan.glb --mesh desk_fan.ply --as instances").code, 0);
  const json info = json::parse(program_.run("info fan.glb --json").output);
  const auto of_meshes = [&] {  // corners that the file has, those of an instanced mesh once
    const std::string bytes = content("fan.glb");
    const auto length = static_cast<unsigned char>(bytes[12]) + 256U * static_cast<unsigned char>(bytes[13]);
    const json root = json::parse(bytes.substr(20, length));
    double corners = 0;
    for (const json& mesh : root["meshes"]) {
      for (const json& primitive : mesh["primitives"]) {
        corners += root["accessors"][primitive["indices"].get<std::size_t>()]["count"].get<double>();
      }
    }
    return corners;
  };
  const double kept = of_meshes() / (3 * info["faces"].get<double>());
  EXPECT_LT(kept, 0.65);
  const auto size = [&](const char* name) { return static_cast<double>(std::filesystem::file_size(file(name))); };
  EXPECT_LT(size("fan.glb"), (kept + 0.05) * size("plain.glb") + 8000);  // and the text of nodes and meshes

  for (const char* name : {"plain.glb", "fan.glb", "obj_000007.ply"}) {
    const std::string line = std::string("render ") + name + " -o " + name + ".png --width 400 --height 300";
    ASSERT_EQ(program_.run(line).code, 0);
  }
  const Picture before = read_picture(file("plain.glb.png"));
  EXPECT_LT(share_that_differs(before, read_picture(file("fan.glb.png")), 8), 0.002);
  EXPECT_GT(share_that_differs(before, read_picture(file("obj_000007.ply.png")), 8), 0.1);
}

TEST_F(OrbifitConvert, KeepsTheNamesOfObjectsAndGroups) {
  program_.folder().write("a.obj",
                          "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 9 9 9\no roof\ng top\nf 1 2 3\ng side\nf 1 2 4\n"
                          "o floor\nf 2 3 4\n");
  ASSERT_EQ(program_.run("convert a.obj a.glb").code, 0);
  const json glb = json::parse(program_.run("info a.glb --json").output);
  EXPECT_EQ(glb["content"]["objects"], json({"roof", "floor"}));
  EXPECT_EQ(glb["content"]["groups"], json({"top", "side"}));
  EXPECT_EQ(glb["content"]["nodes"], 3);
  ASSERT_EQ(program_.run("convert a.glb b.obj").code, 0);
  EXPECT_NE(content("b.obj").find("o roof\ng top\nf 1 2 3\no roof\ng side\nf 4 5 6\no floor\ng default\nf 7 8 9\n"),
            std::string::npos)
      << content("b.obj");
  ASSERT_EQ(program_.run("convert a.obj c.obj").code, 0);
  EXPECT_NE(content("c.obj").find("o roof\ng top\nf 1 2 3\no roof\ng side\nf 1 2 4\no floor\ng default\nf 2 3 4\n"),
            std::string::npos)
      << content("c.obj");
  EXPECT_NE(program_.run("convert a.obj a.stl").errors.find("names of objects and groups"), std::string::npos);
}

TEST_F(OrbifitConvert, ReadsAThreeMfWithItsCopiesNamesAndUnit) {
  ThreeMfSample sample;
  sample.unit = 2;
  sample.objects = {{"brick", cube_, {}}};
  sample.items = {{0, ThreeMfSample::at(0, 0, 0)}, {0, ThreeMfSample::at(2, 0, 0)}};
  sample.write(file("wall.3mf"));
  const json info = json::parse(program_.run("info wall.3mf --json").output);
  EXPECT_EQ(info["vertices"], 2 * cube_.vertices.rows());
  const json& content = info["content"];
  EXPECT_EQ(content["format"], "3mf");
  EXPECT_EQ(content["unit"], "centimetre");
  EXPECT_EQ(content["build_items"], 2);
  EXPECT_EQ(content["parts"], 2);
  EXPECT_EQ(content["meshes"], 1);
  EXPECT_EQ(content["objects"], json({"brick"}));
  ASSERT_EQ(program_.run("convert wall.3mf wall.glb").code, 0);
  EXPECT_EQ(read_mesh(file("wall.glb")).faces, read_mesh(file("wall.3mf")).faces);
  EXPECT_EQ(json::parse(program_.run("info wall.glb --json").output)["content"]["objects"], json({"brick"}));
  EXPECT_EQ(program_.run("convert wall.glb back.3mf").code, 2);  // is not written
}

TEST_F(OrbifitConvert, WritesQualityForMeshLab) {
  ASSERT_EQ(convert("cube.json quality.ply").code, 0);
  EXPECT_NE(content("quality.ply").find("property float quality"), std::string::npos);
  EXPECT_EQ(read_mesh(file("quality.ply")).faces, cube_.faces);
}

TEST_F(OrbifitConvert, GoesToBopAndBack) {
  ASSERT_EQ(convert("cube.json models_info.json").code, 0);
  const json info = json::parse(content("models_info.json"));
  ASSERT_TRUE(info.contains("7"));
  EXPECT_EQ(info["7"]["symmetries_discrete"].size(), 23U);
  ASSERT_EQ(convert("models_info.json back.json").code, 0);
  EXPECT_EQ(read_annotation(file("back.json"), cube_).regions.front().group.symbol(), "O");
}

TEST_F(OrbifitConvert, KeepsTheLookBetweenObjAndGlb) {
  program_.folder().write("a.mtl", "newmtl red\nKd 1 0.5 0\n");
  program_.folder().write(
      "a.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl red\nf 1/1 2/2 3/3\n");
  ASSERT_EQ(program_.run("convert a.obj a.glb").code, 0);
  ASSERT_EQ(program_.run("convert a.glb b.obj").code, 0);
  EXPECT_EQ(content("b.mtl"), "newmtl red\nKd 1 0.5 0\nd 1\n");
  EXPECT_NE(content("b.obj").find("usemtl red\nf 1/1 2/2 3/3"), std::string::npos) << content("b.obj");
  EXPECT_NE(program_.run("convert a.obj a.off").errors.find("does not take"), std::string::npos);
}

TEST_F(OrbifitConvert, InfoAndCheckTellWhatAFileHolds) {
  program_.folder().write("a.mtl", "newmtl red\nKd 1 0.5 0\nmap_Kd none.png\n");
  program_.folder().write(
      "a.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl red\nf 1/1 2/2 3/3\n");
  const json content = json::parse(program_.run("info a.obj --json").output)["content"];
  EXPECT_EQ(content["format"], "obj");
  EXPECT_EQ(content["uv_sets"], 1);
  EXPECT_EQ(content["normals"], false);
  EXPECT_EQ(content["materials"][0]["name"], "red");
  EXPECT_EQ(content["materials"][0]["texture_found"], false);
  EXPECT_EQ(content["warnings"].size(), 1U);
  ASSERT_EQ(program_.run("convert a.obj a.glb").code, 0);
  const json glb = json::parse(program_.run("info a.glb --json").output)["content"];
  EXPECT_EQ(glb["nodes"], 1);
  EXPECT_EQ(glb["unit"], "metre");
  EXPECT_EQ(glb["uv_sets"], 1);
  program_.folder().write("bad.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1/4 2/4 3/4\n");
  EXPECT_TRUE(json::parse(program_.run("info bad.obj --json").output)["content"].contains("problem"));
  EXPECT_EQ(program_.run("convert bad.obj x.glb").code, 3);
  const json checked = json::parse(program_.run("check obj_000007.ply cube.json --json").output);
  EXPECT_EQ(checked["content"]["format"], "ply");
}

TEST_F(OrbifitConvert, RefusesWhatItCannotUse) {
  EXPECT_EQ(convert("cube.json x.csv --element 48").code, 2);
  EXPECT_EQ(convert("cube.json x.csv --region 9").code, 2);
  EXPECT_EQ(convert("cube.json x.glb --region 0").code, 2);
  EXPECT_EQ(convert("cube.json x.glb --as pictures").code, 2);
  EXPECT_EQ(convert("cube.json x.npz --orbits").code, 2);
  EXPECT_EQ(convert("cube.json x.stl").code, 2);
  EXPECT_EQ(convert("missing.json x.csv").code, 3);
  EXPECT_EQ(program_.run("convert cube.json x.csv").code, 2);
  program_.folder().write("other.json", "{\"1\": {}}");
  EXPECT_EQ(convert("other.json x.json").code, 3);
  program_.folder().write("other.json", "no JSON");
  EXPECT_EQ(convert("other.json x.json").code, 3);
  EXPECT_FALSE(std::filesystem::exists(file("x.csv")));
}

}  // namespace
}  // namespace orbifit
