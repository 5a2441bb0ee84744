#include "orbifit/fitting/landmarks.h"

#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "orbifit/datasets_tools/generate.h"
#include "orbifit/model/errors.h"

namespace orbifit {
namespace {

std::vector<Landmark> parse(const std::string& text) {
  const auto file = std::filesystem::path(testing::TempDir()) / "orbifit_landmarks_test.json";
  std::ofstream(file) << text;
  return read_landmarks(file, generate("bar").mesh);
}

TEST(Landmarks, AreRead) {
  const auto landmarks = parse(R"({"landmarks": [{"vertex": 12, "target": [1, 2.5, -3]}]})");
  ASSERT_EQ(landmarks.size(), 1U);
  EXPECT_EQ(landmarks[0].vertex, 12);
  EXPECT_EQ(landmarks[0].target, Eigen::Vector3d(1, 2.5, -3));
}

class BrokenLandmarks : public testing::TestWithParam<std::pair<const char*, const char*>> {};

TEST_P(BrokenLandmarks, AreRefusedWithTheirKey) {
  try {
    parse(GetParam().first);
    FAIL() << "accepted: " << GetParam().first;
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find(GetParam().second), std::string::npos) << error.what();
  }
}

INSTANTIATE_TEST_SUITE_P(
    Cases, BrokenLandmarks,
    testing::Values(std::pair{"{", "is not JSON"}, std::pair{"{}", "landmarks"},
                    std::pair{R"({"landmarks": []})", "is empty"},
                    std::pair{R"({"landmarks": [{"vertex": 1}]})", "landmarks[0]"},
                    std::pair{R"({"landmarks": [{"vertex": 99999999, "target": [0, 0, 0]}]})", "landmarks[0].vertex"},
                    std::pair{R"({"landmarks": [{"vertex": 1, "target": [0, 0]}]})", "landmarks[0].target"},
                    std::pair{R"({"landmarks": [{"vertex": 1, "target": [0, "x", 0]}]})", "landmarks[0].target"}));

}  // namespace
}  // namespace orbifit
