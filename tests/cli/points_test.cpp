#include <cmath>
#include <numbers>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "orbifit/model/annotation_io.h"
#include "orbifit/model/scan_io.h"

#include "program.h"

namespace orbifit {
namespace {

using nlohmann::json;

// The upper half of the side of a cylinder about y: what a camera above would see.
PointCloud half_cylinder() {
  constexpr int kAround = 60;
  constexpr int kAlong = 50;
  PointCloud scan;
  scan.points.resize(kAround * kAlong, 3);
  for (int i = 0; i < kAround; ++i) {
    for (int k = 0; k < kAlong; ++k) {
      const double angle = std::numbers::pi * i / (kAround - 1);
      scan.points.row(i * kAlong + k) << std::cos(angle), 3.0 * k / kAlong, std::sin(angle);
    }
  }
  return scan;
}

TEST(DetectPoints, WritesPointNumbersWhereFaceNumbersStand) {
  const Program program;
  const PointCloud scan = half_cylinder();
  for (const char* name : {"scan.ply", "scan.pcd", "scan.xyz"}) {
    write_scan(program.folder().file(name), scan);
    const ProgramResult result = program.run(std::string("detect ") + name + " --points -o found.json --json --quiet");
    ASSERT_EQ(result.code, 0) << result.errors;
    const json printed = json::parse(result.output);
    EXPECT_EQ(printed["points"], scan.points.rows());
    const json written = json::parse(std::ifstream(program.folder().file("found.json")));
    EXPECT_EQ(written["mesh"]["vertices"], scan.points.rows());
    EXPECT_EQ(written["mesh"]["faces"], scan.points.rows());
    ASSERT_EQ(written["regions"].size(), 1U) << name;
    EXPECT_EQ(written["regions"][0]["group"], "Cinfv");
    EXPECT_NEAR(std::abs(written["regions"][0]["axis"][1].get<double>()), 1, 1e-3);
    int points = 0;
    for (const json& run : written["regions"][0]["faces"]) {
      EXPECT_LE(run[0].get<int>() + run[1].get<int>(), scan.points.rows());
      points += run[1].get<int>();
    }
    EXPECT_EQ(points, printed["regions"][0]["points"]);
    EXPECT_GT(points, 0.9 * static_cast<double>(scan.points.rows()));
  }
}

TEST(DetectPoints, RefusesTooFewPointsAndPictures) {
  const Program program;
  PointCloud few = half_cylinder();
  few.points.conservativeResize(20, 3);
  write_scan(program.folder().file("few.ply"), few);
  const ProgramResult result = program.run("detect few.ply --points");
  EXPECT_EQ(result.code, 3);
  EXPECT_NE(result.errors.find("20 points"), std::string::npos) << result.errors;
  EXPECT_EQ(program.run("detect few.ply --points --preview few.png").code, 2);
}

}  // namespace
}  // namespace orbifit
