#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "orbifit/detection/surface_colours.h"
#include "orbifit/model/annotation_io.h"
#include "orbifit/model/appearance.h"
#include "orbifit/model/mesh_io.h"

#include "cube.h"
#include "geometry/surface_index.h"
#include "painted.h"
#include "program.h"

namespace orbifit {
namespace {

using Eigen::Vector3d;

constexpr int kSide = 120;  // pixels

// What a file shows from an oblique direction, by parallel rays: colours row by row, black where there is nothing.
std::vector<Vector3d> picture(const std::filesystem::path& file) {
  const Mesh mesh = read_mesh(file);
  const SurfaceColours colours(mesh, read_appearance(file, mesh));
  const SurfaceIndex index(mesh);
  const Vector3d ahead = Vector3d(-0.6, -0.5, -0.4).normalized();
  const Vector3d right = ahead.cross(Vector3d::UnitZ()).normalized();
  const Vector3d up = right.cross(ahead);
  std::vector<Vector3d> pixels;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const Vector3d origin = (2.0 * (x + 0.5) / kSide - 1) * right + (1 - 2.0 * (y + 0.5) / kSide) * up - 3 * ahead;
      const auto hit = index.cast(origin, ahead);
      pixels.push_back(hit ? colours.at(hit->face, hit->barycentric) : Vector3d(0, 0, 0));
    }
  }
  return pixels;
}

// Share of the pixels that show something whose colour is another one by more than two 8-bit levels.
double differing(const std::vector<Vector3d>& a, const std::vector<Vector3d>& b) {
  int shown = 0;
  int other = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i].isZero() && b[i].isZero()) continue;
    ++shown;
    other += (a[i] - b[i]).cwiseAbs().maxCoeff() > 2.0 / 255 ? 1 : 0;
  }
  return static_cast<double>(other) / shown;
}

// Smooth, and nowhere black.
Vector3d paint(const Vector3d& p) {
  return Vector3d(0.5 + 0.3 * std::sin(7 * p.x() + 2 * p.y()), 0.5 + 0.3 * std::cos(5 * p.y() - p.z()),
                  0.5 + 0.3 * std::sin(6 * p.z() + p.x()));
}

class Textures : public testing::Test {
 protected:
  void SetUp() override {
    const Appearance look = test::painted(cube_, test::Paint::texture, paint);
    EXPECT_TRUE(write_mesh(file("cube.obj"), cube_, look).empty());
    write_annotation(file("cube.json"), cube_annotation(cube_));
    before_ = picture(file("cube.obj"));
  }

  std::filesystem::path file(const std::string& name) const { return program_.folder().file(name); }
  void run(const std::string& line) const {
    const ProgramResult result = program_.run(line);
    ASSERT_EQ(result.code, 0) << line << "\n" << result.errors;
  }

  Program program_;
  Mesh cube_ = cube_mesh();
  std::vector<Vector3d> before_;
};

TEST_F(Textures, ShowWhatWasPainted) {
  int shown = 0;
  for (const Vector3d& colour : before_) shown += colour.isZero() ? 0 : 1;
  EXPECT_GT(shown, static_cast<int>(before_.size()) / 4);
  Appearance look = test::painted(cube_, test::Paint::texture, paint);
  look.uvs.col(0).array() += 0.01;
  write_mesh(file("shifted.obj"), cube_, look);
  EXPECT_GT(differing(before_, picture(file("shifted.obj"))), 0.1);
}

TEST_F(Textures, StayInEditsThatChangeNothing) {
  program_.folder().write("held.json", R"({"handles": [{"name": "held", "centre": [0.5, 0.5, 0.5], "radius": 0.4}]})");
  run("deform cube.obj cube.json --handles held.json -o held.obj --quiet");
  EXPECT_LT(differing(before_, picture(file("held.obj"))), 0.002);
  run("symmetrize cube.obj cube.json -o same.obj --quiet");
  EXPECT_LT(differing(before_, picture(file("same.obj"))), 0.002);
}

TEST_F(Textures, StayInConversions) {
  run("convert cube.obj cube.glb --quiet");
  EXPECT_LT(differing(before_, picture(file("cube.glb"))), 0.002);
  std::filesystem::create_directory(file("back"));
  run("convert cube.glb back/cube.obj --quiet");
  EXPECT_LT(differing(before_, picture(file("back/cube.obj"))), 0.002);
}

// New triangles show the paint of the side that was taken: mirrored, not stretched.
TEST_F(Textures, FollowNewTriangles) {
  const auto even = [](const Vector3d& p) { return paint(p.cwiseAbs()); };
  Appearance look = test::painted(cube_, test::Paint::texture, even);
  look.materials.front().texture = "even.png";  // a texture that is there already is not written again
  write_mesh(file("even.obj"), cube_, look);
  SymmetryAnnotation annotation = cube_annotation(cube_);
  Region& region = annotation.regions.front();
  region = make_region(*PointGroup::parse("D2h"), Vector3d::Zero(), Eigen::Matrix3d::Identity(), region.faces, "cube");
  write_annotation(file("even.json"), annotation);
  run("symmetrize even.obj even.json -o remeshed.obj --remesh --quiet");
  EXPECT_LT(differing(picture(file("even.obj")), picture(file("remeshed.obj"))), 0.02);
}

}  // namespace
}  // namespace orbifit
