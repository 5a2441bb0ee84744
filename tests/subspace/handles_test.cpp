#include "orbifit/subspace/handles.h"

#include <string>

#include <gtest/gtest.h>

#include "orbifit/model/errors.h"

#include "temporary_folder.h"

namespace orbifit {
namespace {

Mesh square() {
  Mesh mesh;
  mesh.vertices.resize(4, 3);
  mesh.vertices << 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0;
  mesh.faces.resize(2, 3);
  mesh.faces << 0, 1, 2, 0, 2, 3;
  return mesh;
}

HandleSet parse(const std::string& text) {
  const TemporaryFolder folder;
  return read_handles(folder.write("handles_test.json", text), square());
}

TEST(Handles, ReadsCentresVerticesAndMotions) {
  const HandleSet set = parse(R"({"alpha": 7, "iterations": 3, "handles": [
      {"name": "a", "centre": [0, 0, 0], "radius": 1.1, "translation": [1, 2, 3]},
      {"vertices": [3, 2, 3], "rotation": {"axis": [0, 0, 2], "degrees": 90, "about": [0, 0, 0]}}]})");
  EXPECT_EQ(set.alpha, 7);
  EXPECT_EQ(set.iterations, 3);
  ASSERT_EQ(set.handles.size(), 2U);
  EXPECT_EQ(set.handles[0].vertices, (std::vector<int>{0, 1, 3}));
  EXPECT_EQ(set.handles[0].motion(Eigen::Vector3d::Zero()), Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(set.handles[1].vertices, (std::vector<int>{2, 3}));
  EXPECT_LT((set.handles[1].motion({1, 0, 0}) - Eigen::Vector3d(0, 1, 0)).norm(), 1e-15);
}

TEST(Handles, TurnAboutTheirCentroidUnlessToldOtherwise) {
  const HandleSet set =
      parse(R"({"handles": [{"vertices": [0, 1, 2, 3], "rotation": {"axis": [0, 0, 1], "degrees": 180}}]})");
  EXPECT_LT((set.handles[0].motion({0, 0, 0}) - Eigen::Vector3d(1, 1, 0)).norm(), 1e-15);
}

struct Broken {
  const char* name;
  const char* text;
  const char* message;
};

class BrokenHandles : public testing::TestWithParam<Broken> {};

TEST_P(BrokenHandles, AreRefusedWithTheirKey) {
  try {
    parse(GetParam().text);
    FAIL() << "accepted: " << GetParam().text;
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find(GetParam().message), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("handles_test.json"), std::string::npos) << error.what();
  }
}

INSTANTIATE_TEST_SUITE_P(
    Cases, BrokenHandles,
    testing::Values(Broken{"NotJson", "{", "is not JSON"}, Broken{"NoObject", "[]", "handles"},
                    Broken{"NoHandles", R"({"handles": []})", "is empty"},
                    Broken{"NoHandle", R"({"handles": [3]})", "handles[0]"},
                    Broken{"FarAway", R"({"handles": [{"centre": [9, 9, 9], "radius": 0.1}]})", "takes no vertex"},
                    Broken{"Centre", R"({"handles": [{"centre": [0, 0], "radius": 1}]})", "handles[0].centre"},
                    Broken{"Radius", R"({"handles": [{"centre": [0, 0, 0], "radius": 0}]})", "handles[0].radius"},
                    Broken{"VertexTooHigh", R"({"handles": [{"vertices": [4]}]})", "no vertex of the mesh"},
                    Broken{"VertexNegative", R"({"handles": [{"vertices": [-1]}]})", "no vertex of the mesh"},
                    Broken{"Name", R"({"handles": [{"name": 3, "vertices": [1]}]})", "handles[0].name"},
                    Broken{"NoAxis",
                           R"({"handles": [{"vertices": [1], "rotation": {"axis": [0, 0, 0], "degrees": 3}}]})",
                           "handles[0].rotation.axis"},
                    Broken{"Alpha", R"({"alpha": 0, "handles": [{"vertices": [1]}]})", "alpha"},
                    Broken{"Iterations", R"({"iterations": 1.5, "handles": [{"vertices": [1]}]})", "iterations"}),
    [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace orbifit
