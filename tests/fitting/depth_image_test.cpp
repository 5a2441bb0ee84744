#include "orbifit/fitting/depth_image.h"

#include <functional>
#include <string>

#include <gtest/gtest.h>

#include "orbifit/model/errors.h"

#include "grey_png.h"
#include "temporary_folder.h"

namespace orbifit {
namespace {

DepthCamera camera() {
  DepthCamera result;
  result.fx = 2;
  result.fy = 4;
  result.cx = 1;
  result.cy = 0.5;
  result.depth_scale = 0.5;
  return result;
}

TEST(DepthImage, GivesThePointsInFrontOfTheCamera) {
  const TemporaryFolder folder;
  const auto file = folder.write("depth.png", grey_png(3, 2, 16, {0, 0, 4000, 2, 0, 0}));
  const PointCloud scan = read_depth_image(file, camera());
  ASSERT_EQ(scan.points.rows(), 2);
  EXPECT_EQ(scan.points.row(0), Eigen::RowVector3d(1000, -250, 2000));
  EXPECT_EQ(scan.points.row(1), Eigen::RowVector3d(-0.5, 0.125, 1));
  EXPECT_EQ(scan.viewpoints, Points(Eigen::RowVector3d(0, 0, 0)));
  EXPECT_TRUE(is_depth_image(file));
}

TEST(DepthImage, IsMovedByTheExtrinsicsAndCutByTheMask) {
  const TemporaryFolder folder;
  const auto file = folder.write("depth.png", grey_png(3, 2, 16, {0, 0, 4000, 2, 0, 0}));
  const auto mask = folder.write("mask.png", grey_png(3, 2, 8, {0, 0, 0, 255, 255, 255}));
  const auto where = folder.write(
      "cameras.json", R"({"camera_to_world": [[[0, -1, 0, 10], [1, 0, 0, 20], [0, 0, 1, 30], [0, 0, 0, 1]]]})");
  DepthCamera moved = camera();
  moved.pose = read_extrinsics(where).at(0);
  const PointCloud scan = read_depth_image(file, moved, mask);
  ASSERT_EQ(scan.points.rows(), 1);
  EXPECT_EQ(scan.points.row(0), Eigen::RowVector3d(10 - 0.125, 20 - 0.5, 31));
  EXPECT_EQ(scan.viewpoints, Points(Eigen::RowVector3d(10, 20, 30)));
}

struct Refusal {
  const char* name;
  std::function<void(const TemporaryFolder&)> read;
  const char* message;
};

class RefusedDepthImage : public testing::TestWithParam<Refusal> {};

TEST_P(RefusedDepthImage, SaysWhy) {
  const TemporaryFolder folder;
  try {
    GetParam().read(folder);
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find(GetParam().message), std::string::npos) << error.what();
  }
}

std::string image_of(int bits, int value) {
  return grey_png(3, 2, bits, std::vector<int>(6, value));
}

INSTANTIATE_TEST_SUITE_P(
    Fit, RefusedDepthImage,
    testing::Values(
        Refusal{"EightBits",
                [](const TemporaryFolder& f) { read_depth_image(f.write("d.png", image_of(8, 9)), camera()); },
                "has 8 bits or fewer"},
        Refusal{"NoPng", [](const TemporaryFolder& f) { read_depth_image(f.write("d.png", "nothing"), camera()); },
                "is not a PNG"},
        Refusal{"CutPng",
                [](const TemporaryFolder& f) {
                  read_depth_image(f.write("d.png", image_of(16, 900).substr(0, 50)), camera());
                },
                "is a broken PNG"},
        Refusal{"NoDepth",
                [](const TemporaryFolder& f) { read_depth_image(f.write("d.png", image_of(16, 0)), camera()); },
                "all pixels are 0"},
        Refusal{"NoDepthWithinTheMask",
                [](const TemporaryFolder& f) {
                  read_depth_image(f.write("d.png", image_of(16, 900)), camera(), f.write("m.png", image_of(8, 0)));
                },
                "no depth within the mask"},
        Refusal{"MaskOfAnotherSize",
                [](const TemporaryFolder& f) {
                  read_depth_image(f.write("d.png", image_of(16, 900)), camera(),
                                   f.write("m.png", grey_png(1, 2, 8, {1, 1})));
                },
                "has 1 by 2 pixels"},
        Refusal{"PrincipalPointOutside",
                [](const TemporaryFolder& f) {
                  DepthCamera other = camera();
                  other.cx = 320;
                  read_depth_image(f.write("d.png", image_of(16, 900)), other);
                },
                "outside the image of 3 by 2 pixels"},
        Refusal{"FocalLengthZero",
                [](const TemporaryFolder& f) {
                  DepthCamera other = camera();
                  other.fy = 0;
                  read_depth_image(f.write("d.png", image_of(16, 900)), other);
                },
                "focal length"},
        Refusal{"ExtrinsicsThatAreNoMotion",
                [](const TemporaryFolder& f) {
                  read_extrinsics(
                      f.write("e.json", R"({"camera_to_world": [[[2, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]]]})"));
                },
                "camera_to_world[0]: is no rigid motion"},
        Refusal{"ExtrinsicsWithoutNumbers",
                [](const TemporaryFolder& f) {
                  read_extrinsics(f.write("e.json", R"({"camera_to_world": [[[1, 0, 0], [], []]]})"));
                },
                "camera_to_world[0][0]"}),
    [](const auto& each) { return std::string(each.param.name); });

}  // namespace
}  // namespace orbifit
