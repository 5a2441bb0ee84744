#include <cmath>
#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "orbifit/model/appearance.h"
#include "orbifit/model/errors.h"
#include "orbifit/model/mesh_io.h"

#include "files/file.h"
#include "gltf_sample.h"
#include "mesh_samples.h"
#include "temporary_folder.h"

namespace orbifit {
namespace {

struct BadAttribute {
  std::string name;
  std::function<void(GltfSample&)> spoil;
  std::string message;
  bool of_normals = true;  // which an edit reads as well
};

void PrintTo(const BadAttribute& bad, std::ostream* out) {
  *out << bad.name;
}

GltfSample::Json& accessor_of(GltfSample& sample, const char* attribute) {
  return sample.root["accessors"][sample.attributes()[attribute].get<std::size_t>()];
}

GltfSample::Json& view_of(GltfSample& sample, const char* attribute) {
  return sample.root["bufferViews"][accessor_of(sample, attribute)["bufferView"].get<std::size_t>()];
}

std::vector<BadAttribute> bad_attributes() {
  const auto accessor = [](const char* key, const GltfSample::Json& value) {
    return [=](GltfSample& sample) { accessor_of(sample, "NORMAL")[key] = value; };
  };
  const auto view = [](const char* key, const GltfSample::Json& value) {
    return [=](GltfSample& sample) { view_of(sample, "NORMAL")[key] = value; };
  };
  return {
      {"FewerNormals", accessor("count", 6), "has 6 rows for 9 vertices"},
      {"MoreNormals", [](GltfSample& s) { s.attributes()["NORMAL"] = s.accessor(std::vector<float>(30), "VEC3"); },
       "has 10 rows for 9 vertices"},
      {"FewerUvs", [](GltfSample& s) { accessor_of(s, "TEXCOORD_0")["count"] = 8; }, "has 8 rows for 9 vertices",
       false},
      {"UvsOfThree", [](GltfSample& s) { s.attributes()["TEXCOORD_0"] = s.attributes()["NORMAL"]; },
       "is VEC3, which TEXCOORD_0 cannot be", false},
      {"NoSuchAccessor", [](GltfSample& s) { s.attributes()["NORMAL"] = 77; }, "names an entry of accessors"},
      {"NegativeAccessor", [](GltfSample& s) { s.attributes()["NORMAL"] = -1; }, "names an entry of accessors"},
      {"WordForAccessor", [](GltfSample& s) { s.attributes()["NORMAL"] = "first"; }, "names an entry of accessors"},
      {"NoSuchType", accessor("type", "MAT3"), "is no list of vectors"},
      {"NoSuchComponent", accessor("componentType", 5127), "a component type that there is not"},
      {"WordForCount", accessor("count", "nine"), "a key that is no integer"},
      {"NoSuchView", accessor("bufferView", 77), "names an entry of bufferViews"},
      {"NoView", [](GltfSample& s) { accessor_of(s, "NORMAL").erase("bufferView"); }, "has no bufferView"},
      {"OffsetBeyondView", accessor("byteOffset", 4), "reaches beyond its bufferView: 9 entries are announced"},
      {"HugeOffset", accessor("byteOffset", 8'000'000'000'000'000), "reaches beyond its bufferView"},
      {"NegativeOffset", view("byteOffset", -4), "has a key that is missing or no integer"},
      {"ViewBeyondBuffer", view("byteLength", 100'000), "reaches beyond its buffer"},
      {"ViewTooShort", view("byteLength", 100), "reaches beyond its bufferView"},
      {"WordForBuffer", view("buffer", "first"), "has a key that is missing or no integer"},
      {"NoSuchBuffer", view("buffer", 3), "names an entry of buffers"},
      {"StrideTooSmall", view("byteStride", 4), "does not fit its data"},
      {"StrideTooLarge", view("byteStride", 1'000'000'000'000), "does not fit its data"},
      {"StrideBeyondView", view("byteStride", 64), "reaches beyond its bufferView"},
      {"FractionForStride", view("byteStride", 12.5), "must be an integer"},
  };
}

class BadGltfAttribute : public testing::TestWithParam<BadAttribute> {
 protected:
  void SetUp() override {
    GltfSample sample = gltf_of(mesh_);
    write_file(folder_.file("good.glb"), sample.glb());
    GetParam().spoil(sample);
    write_file(file_, sample.glb());
  }

  void expect_refused(const std::function<void()>& run) const {
    try {
      run();
      ADD_FAILURE() << "was accepted";
    } catch (const InputError& error) {
      const std::string message = error.what();
      EXPECT_TRUE(message.starts_with(file_.string() + ": ")) << message;
      EXPECT_NE(message.find(GetParam().message), std::string::npos) << message;
    }
  }

  TemporaryFolder folder_;
  Mesh mesh_ = polygon_mesh();
  std::filesystem::path file_ = folder_.file("bad.glb");
};

TEST_P(BadGltfAttribute, IsRefusedByThoseWhoReadTheLook) {
  const Mesh mesh = read_mesh(file_);  // which does not need it
  EXPECT_EQ(mesh.vertices.rows(), mesh_.vertices.rows());
  EXPECT_NO_THROW(read_appearance(folder_.file("good.glb"), mesh));
  expect_refused([&] { read_appearance(file_, mesh); });
}

TEST_P(BadGltfAttribute, IsRefusedByAnEditThatTurnsIt) {
  Mesh mesh = read_mesh(file_);
  mesh.vertices.row(0).array() += 0.5;
  const auto edit = [&] { write_edited_mesh(folder_.file("edited.glb"), file_, mesh); };
  if (!GetParam().of_normals) return edit();
  expect_refused(edit);
  EXPECT_FALSE(std::filesystem::exists(folder_.file("edited.glb")));
}

INSTANTIATE_TEST_SUITE_P(All, BadGltfAttribute, testing::ValuesIn(bad_attributes()),
                         [](const auto& test) { return test.param.name; });

TEST(GltfImages, OutsideOfTheFolderAreNotRead) {
  const TemporaryFolder folder;
  write_file(folder.file("secret.png"), "\x89PNG secret");
  std::filesystem::create_directory(folder.file("in"));
  for (const std::string& uri :
       {std::string("../secret.png"), std::string("%2e%2e/secret.png"), folder.file("secret.png").string(),
        std::string("file:///etc/passwd"), std::string("http://example.org/a.png")}) {
    GltfSample sample = gltf_of(polygon_mesh());
    sample.root["images"] = {{{"uri", uri}}};
    sample.root["textures"] = {{{"source", 0}}};
    sample.root["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
    sample.primitive()["material"] = 0;
    const auto file = folder.file("in") / "a.glb";
    write_file(file, sample.glb());
    const Appearance look = read_appearance(file, read_mesh(file));
    ASSERT_EQ(look.materials.size(), 1U);
    EXPECT_EQ(look.materials[0].image, "") << uri;
    EXPECT_EQ(look.materials[0].texture, gltf::decode_percent(uri));  // its name is kept
    EXPECT_EQ(look.warnings.size(), 1U) << uri;
  }
}

// Positions and normals as integers (KHR_mesh_quantization): what a step of them is decides how near they come.
template <class Number>
void expect_quantised(double full) {
  SCOPED_TRACE(sizeof(Number));
  const TemporaryFolder folder;
  const Mesh mesh = polygon_mesh();
  const double size = mesh.vertices.cwiseAbs().maxCoeff();
  GltfSample sample = gltf_of(mesh);
  std::vector<Number> numbers;
  std::vector<std::int8_t> normals;
  for (const double number : mesh.vertices.reshaped<Eigen::RowMajor>()) {
    const double within = std::is_signed_v<Number> ? number / size : 0.5 + 0.5 * number / size;
    numbers.push_back(static_cast<Number>(std::lround(within * full)));
  }
  for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) {
    for (const int number : {0, 0, 127}) normals.push_back(static_cast<std::int8_t>(number));
  }
  sample.attributes()["POSITION"] = sample.accessor(numbers, "VEC3", true);
  sample.attributes()["NORMAL"] = sample.accessor(normals, "VEC3", true);
  sample.root["extensionsUsed"] = sample.root["extensionsRequired"] = {"KHR_mesh_quantization"};
  const double scale = std::is_signed_v<Number> ? size : 2 * size;
  const double shift = std::is_signed_v<Number> ? 0 : -size;
  sample.root["nodes"][0]["scale"] = {scale, scale, scale};
  sample.root["nodes"][0]["translation"] = {shift, shift, shift};
  write_file(folder.file("a.glb"), sample.glb());
  const Mesh read = read_mesh(folder.file("a.glb"));
  EXPECT_EQ(read.faces, mesh.faces);
  EXPECT_LE((read.vertices - mesh.vertices).cwiseAbs().maxCoeff(), 0.501 * scale / full);
  EXPECT_EQ(read_appearance(folder.file("a.glb"), read).normals,
            (Points(Points::Zero(3 * mesh.faces.rows(), 3)).rowwise() + Eigen::RowVector3d::UnitZ()));
  // An edit writes floats: nothing but their own rounding is added, and what has not moved stays where it was.
  Mesh edited = read;
  edited.vertices.row(2).array() += 0.1 * size;
  write_edited_mesh(folder.file("b.glb"), folder.file("a.glb"), edited);
  EXPECT_LE((read_mesh(folder.file("b.glb")).vertices - edited.vertices).cwiseAbs().maxCoeff(), 2e-7 * scale);
}

TEST(GltfQuantised, RoundTripsToHalfAStep) {
  expect_quantised<std::int8_t>(127);
  expect_quantised<std::uint8_t>(255);
  expect_quantised<std::int16_t>(32767);
  expect_quantised<std::uint16_t>(65535);
}

}  // namespace
}  // namespace orbifit
