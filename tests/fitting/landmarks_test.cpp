#include "orbifit/fitting/landmarks.h"

#include <string>

#include <gtest/gtest.h>

#include "orbifit/datasets_tools/generate.h"
#include "orbifit/model/errors.h"

#include "temporary_folder.h"

namespace orbifit {
namespace {

std::vector<Landmark> parse(const std::string& text) {
  const TemporaryFolder folder;
  return read_landmarks(folder.write("landmarks_test.json", text), generate("bar").mesh);
}

TEST(Landmarks, AreRead) {
  const auto landmarks = parse(R"({"landmarks": [{"vertex": 12, "target": [1, 2.5, -3]}]})");
  ASSERT_EQ(landmarks.size(), 1U);
  EXPECT_EQ(landmarks[0].vertex, 12);
  EXPECT_EQ(landmarks[0].target, Eigen::Vector3d(1, 2.5, -3));
}

struct Broken {
  const char* name;
  const char* text;
  const char* message;
};

class BrokenLandmarks : public testing::TestWithParam<Broken> {};

TEST_P(BrokenLandmarks, AreRefusedWithTheirKey) {
  try {
    parse(GetParam().text);
    FAIL() << "accepted: " << GetParam().text;
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find(GetParam().message), std::string::npos) << error.what();
  }
}

INSTANTIATE_TEST_SUITE_P(
    Cases, BrokenLandmarks,
    testing::Values(
        Broken{"NotJson", "{", "is not JSON"}, Broken{"NoLandmarks", "{}", "landmarks"},
        Broken{"Empty", R"({"landmarks": []})", "is empty"},
        Broken{"NoTarget", R"({"landmarks": [{"vertex": 1}]})", "landmarks[0]"},
        Broken{"VertexTooHigh", R"({"landmarks": [{"vertex": 99999999, "target": [0, 0, 0]}]})", "landmarks[0].vertex"},
        Broken{"ShortTarget", R"({"landmarks": [{"vertex": 1, "target": [0, 0]}]})", "landmarks[0].target"},
        Broken{"VertexTwice",
               R"({"landmarks": [{"vertex": 1, "target": [0, 0, 0]}, {"vertex": 1, "target": [0, 1, 0]}]})",
               "landmarks[1].vertex: is that of landmarks[0]"},
        Broken{"OnTopOfOneAnother",
               R"({"landmarks": [{"vertex": 1, "target": [0, 0, 0]}, {"vertex": 2, "target": [0, 0, 0]}]})",
               "landmarks[1].target: is that of landmarks[0]"},
        Broken{"TargetIsText", R"({"landmarks": [{"vertex": 1, "target": [0, "x", 0]}]})", "landmarks[0].target"}),
    [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace orbifit
