#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "orbifit/model/mesh_io.h"
#include "orbifit/model/scan_io.h"

#include "files/file.h"
#include "grey_png.h"
#include "program.h"

namespace orbifit {
namespace {

using nlohmann::json;

constexpr int kWidth = 320;
constexpr int kHeight = 240;
constexpr double kUnit = 1e-4;  // of depth

// What `orbifit scan` sees of a mesh as the depth image that its camera would have taken.
class OrbifitFitToDepth : public testing::Test {
 protected:
  void SetUp() override {
    run("generate table -o . --quiet");
    run("generate table --param width=1 -o wide --quiet");
    run("scan wide/table.ply -o scan.ply --quiet");
    take_picture();
  }

  std::filesystem::path file(const std::string& name) const { return program_.folder().file(name); }

  std::string run(const std::string& line, int code = 0) const {
    const ProgramResult result = program_.run(line);
    EXPECT_EQ(result.code, code) << line << "\n" << result.errors;
    return result.errors;
  }

  // Mean distance of the fitted vertices from the true ones, of the diagonal.
  double error(const std::string& fitted) const {
    const Points truth = read_mesh(file("wide/table.ply")).vertices;
    return (read_mesh(file(fitted)).vertices - truth).rowwise().norm().mean() / diagonal(truth);
  }

  void take_picture() {
    const PointCloud scan = read_scan(file("scan.ply"));
    const Eigen::Vector3d eye = scan.viewpoints.row(0);
    const Eigen::Vector3d centre = bounding_box_centre(read_mesh(file("wide/table.ply")).vertices);
    Eigen::Matrix3d frame;  // right, down, forwards
    frame.col(2) = (centre - eye).normalized();
    frame.col(0) = frame.col(2).cross(Eigen::Vector3d::UnitZ()).normalized();
    frame.col(1) = frame.col(2).cross(frame.col(0));
    const double focal = 0.5 * kHeight / std::tan(20 * std::numbers::pi / 180);
    std::vector<int> depths(static_cast<std::size_t>(kWidth) * kHeight, 0);
    std::vector<int> all(depths.size(), 255);
    for (const auto& point : scan.points.rowwise()) {
      const Eigen::Vector3d own = frame.transpose() * (point.transpose() - eye);
      const auto u = static_cast<int>(std::lround(focal * own.x() / own.z() + 0.5 * kWidth - 0.5));
      const auto v = static_cast<int>(std::lround(focal * own.y() / own.z() + 0.5 * kHeight - 0.5));
      depths[static_cast<std::size_t>(v * kWidth + u)] = static_cast<int>(std::lround(own.z() / kUnit));
    }
    program_.folder().write("depth.png", grey_png(kWidth, kHeight, 16, depths));
    program_.folder().write("mask.png", grey_png(kWidth, kHeight, 8, all));
    program_.folder().write("small.png", grey_png(2, 2, 8, {1, 1, 1, 1}));
    program_.folder().write("grey.png", grey_png(kWidth, kHeight, 8, all));
    json rows = json::array();
    for (int r = 0; r < 3; ++r) rows.push_back({frame(r, 0), frame(r, 1), frame(r, 2), eye[r]});
    program_.folder().write("camera.json", json{{"camera_to_world", {rows}}}.dump());
    camera_ =
        "--intrinsics " + std::to_string(focal) + "," + std::to_string(focal) + ",159.5,119.5 --depth-scale 1e-4 ";
  }

  Program program_;
  std::string fit_ = "fit table.ply --annotation table.annotation.json --quiet -o fitted.ply ";
  std::string camera_;
};

TEST_F(OrbifitFitToDepth, FindsTheTemplateInTheCamerasFrame) {
  run(fit_ + "depth.png --mask mask.png --report report.json " + camera_);
  const json report = json::parse(read_file(file("report.json")));
  EXPECT_EQ(report["converged"], true);
  EXPECT_GT(report["confidence"], 0.9);
  EXPECT_EQ(report["other_scans"], json::array());
}

TEST_F(OrbifitFitToDepth, IsWhereTheExtrinsicsSay) {
  run(fit_ + "depth.png --aligned --extrinsics camera.json " + camera_);
  EXPECT_LT(error("fitted.ply"), 0.01);
}

TEST_F(OrbifitFitToDepth, TakesAnImageAndAScanTogether) {
  run(fit_ + "scan.ply depth.png --report report.json " + camera_);
  const json report = json::parse(read_file(file("report.json")));
  ASSERT_EQ(report["other_scans"].size(), 1U);
  EXPECT_EQ(report["other_scans"][0]["used"], true);
}

TEST_F(OrbifitFitToDepth, RefusesWhatDoesNotGoTogether) {
  const auto says = [&](const std::string& line, int code, const std::string& why) {
    const std::string errors = run(fit_ + line, code);
    EXPECT_NE(errors.find(why), std::string::npos) << line << "\n" << errors;
    EXPECT_FALSE(std::filesystem::exists(file("fitted.ply"))) << line;
  };
  says("depth.png", 2, "needs --intrinsics");
  says("scan.ply " + camera_, 2, "no scan is a PNG");
  says("grey.png " + camera_, 3, "8 bits");
  says("depth.png --mask small.png " + camera_, 3, "has 2 by 2 pixels");
  says("depth.png --mask mask.png --mask mask.png " + camera_, 2, "2 given by --mask for 1 depth image");
  says("depth.png --extrinsics table.annotation.json " + camera_, 3, "camera_to_world");
  says("depth.png --intrinsics 500,500,900,100", 3, "outside the image");
  says("depth.png --intrinsics 0,500,100,100", 2, "focal length");
  says("depth.png --intrinsics 500,500,100", 2, "--intrinsics");
  says("depth.png --intrinsics 500,500,160,120 --depth-scale -1", 2, "depth scale");
  says("depth.png missing.ply " + camera_, 3, "missing.ply");
}

}  // namespace
}  // namespace orbifit
