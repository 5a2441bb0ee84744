#include "files/gltf_plain.h"

#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "orbifit/model/appearance.h"
#include "orbifit/model/errors.h"
#include "orbifit/model/mesh_io.h"

#include "base/random.h"
#include "draco_sample.h"
#include "files/file.h"
#include "gltf_sample.h"
#include "mesh_samples.h"
#include "refused_mesh.h"
#include "temporary_folder.h"

namespace orbifit {
namespace {

class PlainGltf : public testing::Test {
 protected:
  Mesh read(GltfSample sample) {
    write_file(file_, sample.glb());
    return read_mesh(file_);
  }

  void expect_refused(GltfSample sample, const std::string& reason) {
    write_file(file_, sample.glb());
    expect_mesh_refused(file_, reason);
  }

  // The JSON of the file after one vertex has moved. The mesh that is read from it is the edited one.
  GltfSample::Json edited(const GltfSample& sample, int vertex) {
    Mesh mesh = read(sample);
    write_edited_mesh(folder_.file("same.glb"), file_, mesh);
    EXPECT_EQ(read_file(folder_.file("same.glb")), read_file(file_));
    mesh.vertices(vertex, 1) += 0.25;
    write_edited_mesh(folder_.file("edited.glb"), file_, mesh);
    const Mesh again = read_mesh(folder_.file("edited.glb"));
    EXPECT_EQ(again.faces, mesh.faces);
    EXPECT_LE((again.vertices - mesh.vertices).cwiseAbs().maxCoeff(), 1e-6);
    const std::string bytes = read_file(folder_.file("edited.glb"));
    const auto length = static_cast<unsigned char>(bytes[12]) + 256U * static_cast<unsigned char>(bytes[13]);
    return GltfSample::Json::parse(bytes.substr(20, length));
  }

  TemporaryFolder folder_;
  std::filesystem::path file_ = folder_.file("a.glb");
};

// The sample with its positions and indices sparse: two vertices and one corner differ from what the buffer says.
GltfSample sparse_sample() {
  GltfSample sample = gltf_of(polygon_mesh());
  const auto position = sample.attributes()["POSITION"].get<std::size_t>();
  const auto indices = sample.primitive()["indices"].get<std::size_t>();
  sample.root["accessors"][position]["sparse"] = {
      {"count", 2},
      {"indices", {{"bufferView", sample.view(GltfSample::bytes<std::uint8_t>({2, 7}))}, {"componentType", 5121}}},
      {"values", {{"bufferView", sample.view(GltfSample::bytes<float>({5, 6, 7, -5, -6, -7}))}}}};
  sample.root["accessors"][indices]["sparse"] = {
      {"count", 1},
      {"indices", {{"bufferView", sample.view(GltfSample::bytes<std::uint32_t>({1}))}, {"componentType", 5125}}},
      {"values", {{"bufferView", sample.view(GltfSample::bytes<std::uint16_t>({8}))}}}};
  return sample;
}

TEST_F(PlainGltf, HasAllNumbersOfSparseAccessors) {
  const Mesh mesh = read(sparse_sample());
  Mesh wanted = polygon_mesh();
  wanted.vertices.row(2) << 5, 6, 7;
  wanted.vertices.row(7) << -5, -6, -7;
  wanted.faces(0, 1) = 8;
  EXPECT_LE((mesh.vertices - wanted.vertices).cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_EQ(mesh.faces, wanted.faces);
  const GltfSample::Json root = edited(sparse_sample(), 2);
  for (const GltfSample::Json& accessor : root["accessors"]) EXPECT_FALSE(accessor.contains("sparse"));
}

TEST_F(PlainGltf, RefusesSparseAccessorsThatReachBeyond) {
  const auto with = [](const std::function<void(GltfSample::Json&)>& spoil) {
    GltfSample sample = sparse_sample();
    spoil(sample.root["accessors"][sample.attributes()["POSITION"].get<std::size_t>()]);
    return sample;
  };
  expect_refused(with([](GltfSample::Json& a) { a["sparse"]["count"] = 9; }),
                 "sparse.indices: reaches beyond its bufferView");
  expect_refused(with([](GltfSample::Json& a) { a["sparse"]["count"] = 4e9; }), "must be an integer");
  expect_refused(with([](GltfSample::Json& a) { a["sparse"]["count"] = 4'000'000'000; }),
                 "reaches beyond its bufferView");
  expect_refused(with([](GltfSample::Json& a) { a["count"] = 7; }), "entry 7 is changed, but there are 7");
  expect_refused(with([](GltfSample::Json& a) { a["sparse"]["indices"]["componentType"] = 5126; }),
                 "indices must be unsigned");
  expect_refused(with([](GltfSample::Json& a) { a["sparse"].erase("values"); }), "needs indices and values");
  expect_refused(with([](GltfSample::Json& a) { a["sparse"] = 3; }), "needs indices and values");
  expect_refused(with([](GltfSample::Json& a) { a["sparse"]["values"]["bufferView"] = 99; }), "names bufferViews[99]");
  expect_refused(with([](GltfSample::Json& a) { a.erase("bufferView"); }), "has no bufferView");
}

// Three instances of the sample under a node that is turned, and a child behind them.
GltfSample instanced_sample() {
  GltfSample sample = gltf_of(polygon_mesh());
  const std::int16_t half = 23170;  // a quarter about z, as normalised integers
  const GltfSample::Json attributes{
      {"TRANSLATION", sample.accessor<float>({0, 0, 0, 10, 0, 0, 0, 0, 20}, "VEC3")},
      {"ROTATION", sample.accessor<std::int16_t>({0, 0, 0, 32767, 0, 0, half, half, 0, 0, 0, 32767}, "VEC4", true)},
      {"SCALE", sample.accessor<float>({1, 1, 1, 1, 1, 1, -1, 2, 2}, "VEC3")},
      {"_ID", 0}};
  sample.root["nodes"] = {{{"name", "trees"},
                           {"mesh", 0},
                           {"children", {1}},
                           {"translation", {0, 100, 0}},
                           {"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", attributes}}}}}},
                          {{"mesh", 0}}};
  sample.root["extensionsUsed"] = sample.root["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
  return sample;
}

TEST_F(PlainGltf, HasInstancesAsCopiesInTheirOrder) {
  const Mesh one = polygon_mesh();
  const Mesh mesh = read(instanced_sample());
  ASSERT_EQ(mesh.vertices.rows(), 4 * one.vertices.rows());
  const auto copy = [&](int number) -> Points { return mesh.vertices.middleRows(9 * number, 9); };
  const auto expect = [&](int number, const std::function<Eigen::RowVector3d(const Eigen::RowVector3d&)>& place) {
    for (int v = 0; v < 9; ++v) {
      const Eigen::RowVector3d wanted = place(one.vertices.row(v)) + Eigen::RowVector3d(0, 100, 0);
      EXPECT_LT((copy(number).row(v) - wanted).norm(), 1e-5) << number << ' ' << v;
    }
  };
  using Row = Eigen::RowVector3d;
  expect(0, [](const Row& p) { return p; });
  expect(1, [](const Row& p) { return Row(10 - p.y(), p.x(), p.z()); });
  expect(2, [](const Row& p) { return Row(-p.x(), 2 * p.y(), 20 + 2 * p.z()); });
  expect(3, [](const Row& p) { return p; });                         // the child
  EXPECT_EQ(mesh.faces.row(2 * 8), Eigen::RowVector3i(18, 22, 19));  // mirrored: turned over
}

TEST_F(PlainGltf, OfAnEditHasTheInstancesAsNodes) {
  const GltfSample::Json root = edited(instanced_sample(), 10);
  EXPECT_FALSE(root.contains("extensionsUsed"));
  EXPECT_FALSE(root.contains("extensionsRequired"));
  ASSERT_EQ(root["nodes"].size(), 5U);
  EXPECT_EQ(root["nodes"][0]["children"], (GltfSample::Json{2, 3, 4, 1}));
  EXPECT_FALSE(root["nodes"][0].contains("mesh"));
  EXPECT_EQ(root["nodes"][2]["mesh"], 0);  // nothing of this one has moved
  EXPECT_EQ(root["nodes"][3]["mesh"], 1);
  EXPECT_EQ(root["nodes"][3]["name"], "trees");
}

TEST_F(PlainGltf, RefusesInstancesThatDisagree) {
  const auto with = [](const char* key, const GltfSample::Json& value) {
    GltfSample sample = instanced_sample();
    sample.root["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"][key] = value;
    return sample;
  };
  expect_refused(with("SCALE", 0), "has accessors of 3 and of 9 entries");
  expect_refused(with("SCALE", 77), "names accessors[77]");
  expect_refused(with("ROTATION", 0), "must be VEC4 for rotation");
  expect_refused(with("TRANSLATION", "x"), "must be an integer");
  GltfSample sample = instanced_sample();
  sample.root["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"] = GltfSample::Json::object();
  expect_refused(sample, "names no attributes");
  sample.root["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = GltfSample::Json::object();
  expect_refused(sample, "has no TRANSLATION, ROTATION or SCALE");
  sample = instanced_sample();
  sample.root["nodes"][0]["children"] = {0};
  expect_refused(sample, "must form a tree");
  sample = instanced_sample();
  const int places = sample.accessor<float>({0, 0, NAN, 0, 0, 0, 0, 0, 0}, "VEC3");
  sample.root["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["TRANSLATION"] = places;
  expect_refused(sample, "not finite");
}

// A row of a compressed file that is nearest to each place of the mesh: Draco orders vertices anew.
double farthest_from_its_own(const Mesh& of, const Mesh& in) {
  double farthest = 0;
  for (Eigen::Index v = 0; v < of.vertices.rows(); ++v) {
    farthest = std::max(farthest, (in.vertices.rowwise() - of.vertices.row(v)).rowwise().norm().minCoeff());
  }
  return farthest;
}

TEST_F(PlainGltf, HasWhatDracoCompressedToItsPrecision) {
  const Mesh mesh = polygon_mesh();
  for (const bool edgebreaker : {false, true}) {
    for (const int bits : {0, 11}) {
      SCOPED_TRACE(std::to_string(edgebreaker) + " " + std::to_string(bits));
      const Mesh decoded = read(draco_sample(mesh, edgebreaker, bits));
      EXPECT_EQ(decoded.vertices.rows(), mesh.vertices.rows());
      EXPECT_EQ(decoded.faces.rows(), mesh.faces.rows());
      EXPECT_NEAR(face_areas(decoded).sum(), face_areas(mesh).sum(), bits == 0 ? 1e-6 : 0.01);
      const double step = bits == 0 ? 1e-7 : 2.0 / (1U << 11U);
      EXPECT_LE(farthest_from_its_own(mesh, decoded), std::sqrt(3) * step);
      const Appearance look = read_appearance(file_, decoded);
      ASSERT_EQ(look.uvs.rows(), 3 * mesh.faces.rows());
      for (Eigen::Index c = 0; c < look.uvs.rows(); ++c) {  // the sample's are x and y
        const Eigen::RowVector2d place = decoded.vertices.row(decoded.faces(c / 3, c % 3)).head<2>();
        EXPECT_LT((look.uvs.row(c) - Eigen::RowVector2d(place.x() / 4, 1 - place.y() / 4)).norm(), 0.01);
      }
      EXPECT_LT((look.normals.rowwise() - Eigen::RowVector3d::UnitZ()).cwiseAbs().maxCoeff(), 0.05);
    }
  }
}

TEST_F(PlainGltf, OfAnEditIsNoLongerCompressed) {
  const GltfSample::Json root = edited(draco_sample(polygon_mesh(), true, 0), 3);
  EXPECT_FALSE(root.contains("extensionsUsed"));
  EXPECT_FALSE(root.contains("extensionsRequired"));
  EXPECT_FALSE(root["meshes"][0]["primitives"][0].contains("extensions"));
  EXPECT_EQ(read_appearance(folder_.file("edited.glb"), read_mesh(folder_.file("edited.glb"))).uvs.rows(), 24);
}

TEST_F(PlainGltf, HasTheBoundsOfWhatWasQuantised) {
  Mesh mesh = polygon_mesh();
  mesh.vertices *= 1.2345;
  GltfSample sample = draco_sample(mesh, false, 6);
  sample.root["accessors"][0]["min"] = sample.root["accessors"][0]["max"] = {0, 0, 0};
  const Mesh decoded = read(sample);
  const std::string bytes = *gltf::plain(file_, read_file(file_)).changed;
  const auto length = static_cast<unsigned char>(bytes[12]) + 256U * static_cast<unsigned char>(bytes[13]);
  const GltfSample::Json accessor = GltfSample::Json::parse(bytes.substr(20, length))["accessors"][0];
  for (int k = 0; k < 3; ++k) {
    EXPECT_EQ(accessor["min"][static_cast<std::size_t>(k)].get<double>(), decoded.vertices.col(k).minCoeff());
    EXPECT_EQ(accessor["max"][static_cast<std::size_t>(k)].get<double>(), decoded.vertices.col(k).maxCoeff());
  }
}

TEST_F(PlainGltf, OfPrimitivesThatShareAccessorsHasTheNumbersOfEach) {
  Mesh other = polygon_mesh();
  other.vertices.array() += 50;
  GltfSample sample = draco_sample(polygon_mesh(), false, 0);
  GltfSample::Json second = sample.primitive();
  second["extensions"]["KHR_draco_mesh_compression"]["bufferView"] = sample.view(draco_bytes(other, false, 0));
  sample.root["meshes"][0]["primitives"].push_back(second);
  const Mesh mesh = read(sample);
  ASSERT_EQ(mesh.vertices.rows(), 18);
  EXPECT_LE((mesh.vertices.topRows(9) - polygon_mesh().vertices).cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_LE((mesh.vertices.bottomRows(9) - other.vertices).cwiseAbs().maxCoeff(), 1e-5);
}

TEST_F(PlainGltf, RefusesDamagedDraco) {
  const auto with = [](const std::function<void(GltfSample::Json&)>& spoil) {
    GltfSample sample = draco_sample(polygon_mesh(), true, 11);
    spoil(sample.primitive()["extensions"]["KHR_draco_mesh_compression"]);
    return sample;
  };
  expect_refused(with([](GltfSample::Json& d) { d["bufferView"] = 99; }), "names bufferViews[99]");
  expect_refused(with([](GltfSample::Json& d) { d.erase("bufferView"); }), "names bufferViews[-1]");
  expect_refused(with([](GltfSample::Json& d) { d.erase("attributes"); }), "names no attributes");
  expect_refused(with([](GltfSample::Json& d) { d["attributes"]["POSITION"] = 9; }), "there is no attribute 9 in it");
  expect_refused(with([](GltfSample::Json& d) { d["attributes"].erase("POSITION"); }), "has no bufferView");
  GltfSample sample = draco_sample(polygon_mesh(), true, 11);
  sample.root["accessors"][0]["componentType"] = 5130;
  expect_refused(sample, "accessors[0].componentType: is 5130: unknown");
  sample = draco_sample(polygon_mesh(), true, 11);
  sample.root["accessors"][0]["type"] = "MAT4";
  expect_refused(sample, "accessors[0].type: must be SCALAR, VEC2, VEC3 or VEC4");
  sample = draco_sample(polygon_mesh(), true, 11);
  const std::size_t begin = sample.data.find("DRACO");
  sample.data[begin] = 'X';
  expect_refused(sample, "KHR_draco_mesh_compression: ");
  // A header of a sequential mesh with 2^32 - 1 faces.
  sample = draco_sample(polygon_mesh(), false, 0);
  sample.data.replace(sample.data.find("DRACO") + 11, 5, "\xff\xff\xff\xff\x0f");
  expect_refused(sample, "too many faces are announced");
}

TEST_F(PlainGltf, OfBytesThatAreNotWhatTheyWereIsAMeshOrAnError) {
  Random random(3, "damaged draco");
  int read_again = 0;
  int refused = 0;
  for (int round = 0; round < 400; ++round) {
    GltfSample sample = draco_sample(polygon_mesh(), round % 2 == 0, 11);
    const std::size_t begin = sample.data.find("DRACO");
    for (std::uint64_t flips = 1 + random.below(3); flips > 0; --flips) {
      sample.data[begin + random.below(sample.data.size() - begin)] = static_cast<char>(random.below(256));
    }
    write_file(file_, sample.glb());
    try {
      const Mesh mesh = read_mesh(file_);
      EXPECT_LT(mesh.faces.maxCoeff(), mesh.vertices.rows());
      ++read_again;
    } catch (const InputError&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 0);
  EXPECT_GT(read_again, 0);
}

TEST_F(PlainGltf, OfAPlainFileIsNothing) {
  EXPECT_FALSE(gltf::plain(file_, gltf_of(polygon_mesh()).glb()).changed);
  EXPECT_TRUE(gltf::plain(file_, sparse_sample().glb()).changed);
}

}  // namespace
}  // namespace orbifit
