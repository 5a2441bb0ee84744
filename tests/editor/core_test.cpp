#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "orbifit/datasets_tools/generate.h"
#include "orbifit/model/annotation_io.h"
#include "orbifit/model/mesh_io.h"

#include "editor.h"
#include "temporary_folder.h"

namespace orbifit {
namespace {

// A session on a generated chair, driven as the page does it.
class EditorCoreTest : public testing::Test {
 protected:
  void SetUp() override {
    write_mesh(folder_.file("chair.ply"), chair_.mesh);
    write_annotation(folder_.file("chair.json"), chair_.truth);
    ASSERT_EQ(editor_read_mesh(session_, path("chair.ply").c_str()), 0) << editor_error();
    ASSERT_EQ(editor_read_annotation(session_, path("chair.json").c_str(), 0), 0) << editor_error();
    ASSERT_EQ(editor_build_basis(session_, 1, 0, 0, 0, 0, nullptr), 0) << editor_error();
  }
  void TearDown() override { editor_free(session_); }

  std::string path(const char* name) const { return folder_.file(name).string(); }
  std::size_t vertices() const { return static_cast<std::size_t>(chair_.mesh.vertices.rows()); }
  std::vector<double> shown(int side = 0) const {
    const double* numbers = editor_vertices(session_, side);
    return {numbers, numbers + 3 * vertices()};
  }
  // One foot, moved outwards, while the crest is held: with nothing held the chair would move as a whole.
  void move_foot(double by) {
    folder_.write("handles.json", R"({"handles": [{"name": "foot", "centre": [0.23, 0.23, 0], "radius": 0.08},
                                               {"name": "crest", "centre": [0, 0.27, 0.93], "radius": 0.12}]})");
    ASSERT_EQ(editor_set_handles(session_, path("handles.json").c_str()), 2) << editor_error();
    solve(0, by);
  }
  void solve(int side, double by, int iterations = 10, bool onwards = false) {
    const std::array<double, 24> motion{1, 0, 0, by, 0, 1, 0, by, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    std::array<double, 5> record{};
    ASSERT_EQ(editor_solve(session_, side, motion.data(), 2, iterations, onwards ? 1 : 0, record.data()), 0)
        << editor_error();
  }
  // The side without symmetries, from a basis that another session built, as the page's worker does.
  void compare() {
    const auto samples = nlohmann::json::parse(editor_info(session_))["samples"].get<int>();
    write_annotation(folder_.file("none.json"), empty_annotation(chair_.mesh, chair_.truth.tolerance));
    EditorSession* other = editor_new();
    ASSERT_EQ(editor_read_mesh(other, path("chair.ply").c_str()), 0) << editor_error();
    ASSERT_EQ(editor_read_annotation(other, path("none.json").c_str(), 0), 0) << editor_error();
    ASSERT_EQ(editor_build_basis(other, 1, 0, 0, samples, 0, nullptr), 0) << editor_error();
    ASSERT_EQ(editor_write_basis(other, path("free.basis").c_str()), 0) << editor_error();
    editor_free(other);
    ASSERT_EQ(editor_compare(session_, path("free.basis").c_str()), 0) << editor_error();
  }
  double worst(int kind) {
    std::vector<double> numbers(2 * chair_.truth.regions.size());
    const int regions = editor_residuals(session_, kind, numbers.data());
    EXPECT_GT(regions, 0) << editor_error();
    double result = 0;
    for (int r = 0; r < regions; ++r) result = std::max(result, numbers[2 * static_cast<std::size_t>(r) + 1]);
    return result;
  }

  TemporaryFolder folder_;
  GeneratedModel chair_ = generate("chair");
  EditorSession* session_ = editor_new();
};

TEST_F(EditorCoreTest, AnEditIsSymmetricToRoundingAndOneWithoutSymmetriesIsNot) {
  ASSERT_NO_FATAL_FAILURE(compare());
  move_foot(0.05);
  solve(1, 0.05);
  EXPECT_LT(worst(0), 1e-9);
  EXPECT_GT(worst(1), 1e-3);
  EXPECT_GT((Eigen::Map<const Eigen::VectorXd>(shown().data(), 3) - chair_.mesh.vertices.row(0).transpose()).size(), 0);
}

TEST_F(EditorCoreTest, TheSameMotionsGiveTheSameBitsWhateverWasBefore) {
  move_foot(0.05);
  const std::vector<double> first = shown();
  solve(0, 0.02);
  EXPECT_NE(shown(), first);
  solve(0, 0.05);
  EXPECT_EQ(shown(), first);
  for (int step = 1; step <= 5; ++step) solve(0, 0.01 * step, 2, true);
  const std::vector<double> dragged = shown();
  EXPECT_NE(dragged, first);
  double off = 0;
  for (std::size_t i = 0; i < first.size(); ++i) off = std::max(off, std::abs(dragged[i] - first[i]));
  EXPECT_LT(off, 0.005) << "a drag of few iterations a frame shows nearly what the release does";
  solve(0, 0.05);
  EXPECT_EQ(shown(), first);
  ASSERT_EQ(editor_rest(session_), 0);
  const std::vector<double> rest = shown();
  EXPECT_TRUE(std::equal(rest.begin(), rest.end(), chair_.mesh.vertices.data()));
}

TEST_F(EditorCoreTest, ABasisThatIsReadGivesTheSameBits) {
  move_foot(0.05);
  const std::vector<double> built = shown();
  ASSERT_EQ(editor_write_basis(session_, path("basis").c_str()), 0) << editor_error();
  ASSERT_EQ(editor_read_annotation(session_, path("chair.json").c_str(), 0), 0);
  ASSERT_EQ(editor_read_basis(session_, path("basis").c_str()), 0) << editor_error();
  solve(0, 0.05);
  EXPECT_EQ(shown(), built);
}

TEST_F(EditorCoreTest, ARayMeetsTheSurfaceAndItsPointHasAnOrbit) {
  // From below, onto a foot: the chair's legs are images of one another.
  const Eigen::Vector3d foot(0.196, 0.196, 0);
  const auto info = nlohmann::json::parse(editor_info(session_));
  const Eigen::Vector3d centre(info["centre"][0], info["centre"][1], info["centre"][2]);
  const Eigen::Vector3d origin = (foot - centre) / info["diagonal"].get<double>() - Eigen::Vector3d(0, 0, 2);
  const std::array<double, 6> ray{origin.x(), origin.y(), origin.z(), 0, 0, 1};
  std::array<double, 6> point{};
  const int face = editor_pick(session_, ray.data(), point.data());
  ASSERT_GE(face, 0) << editor_error();
  EXPECT_NEAR(point[0], origin.x(), 1e-9);
  EXPECT_NEAR(point[1], origin.y(), 1e-9);
  const int images = editor_orbit(session_, face, point.data() + 3, 0.05);
  EXPECT_GE(images, 4) << editor_error();
  const std::uint8_t* marks = editor_marks(session_);
  int marked = 0;
  for (int i = 0; i < editor_display_vertices(session_); ++i) marked += marks[4 * i] != 0 ? 1 : 0;
  EXPECT_GT(marked, 0);
  std::array<std::int32_t, 16> regions{};
  EXPECT_GT(editor_regions_of(session_, face, regions.data(), 16), 0);
}

TEST_F(EditorCoreTest, WhatIsShownFollowsTheVertices) {
  move_foot(0.05);
  const auto info = nlohmann::json::parse(editor_info(session_));
  const std::vector<double> moved = shown();
  const std::uint32_t* triangles = editor_triangles(session_);
  const float* positions = editor_positions(session_, 0);
  for (Eigen::Index f = 0; f < chair_.mesh.faces.rows(); f += 97) {
    for (Eigen::Index k = 0; k < 3; ++k) {
      const auto vertex = static_cast<std::size_t>(chair_.mesh.faces(f, k));
      for (std::size_t c = 0; c < 3; ++c) {
        const double place = (moved[3 * vertex + c] - info["centre"][c].get<double>()) / info["diagonal"].get<double>();
        EXPECT_NEAR(positions[3 * triangles[3 * f + k] + c], place, 1e-6);
      }
    }
  }
}

TEST_F(EditorCoreTest, RefusesWithoutLosingWhatThereIs) {
  move_foot(0.05);
  const std::vector<double> before = shown();
  folder_.write("broken.ply", "ply\nformat ascii 1.0\nelement vertex 2\n");
  EXPECT_LT(editor_read_mesh(session_, path("broken.ply").c_str()), 0);
  EXPECT_NE(std::string(editor_error()).find("broken.ply"), std::string::npos) << editor_error();
  write_annotation(folder_.file("other.json"), generate("wheel").truth);
  EXPECT_LT(editor_read_annotation(session_, path("other.json").c_str(), 0), 0);
  folder_.write("handles.json", R"({"handles": [{"centre": [9, 9, 9], "radius": 0.01}]})");
  EXPECT_LT(editor_set_handles(session_, path("handles.json").c_str()), 0);
  EXPECT_EQ(shown(), before);
  solve(0, 0.05);
  EXPECT_EQ(shown(), before);
}

TEST_F(EditorCoreTest, TheSliderGoesFromTheMeshToItsSymmetricShape) {
  Mesh uneven = chair_.mesh;
  constexpr double kUneven = 3e-4;  // of the chair's 0.94 m: far less than its vertices lie apart, at bevels too
  for (Eigen::Index v = 0; v < uneven.vertices.rows(); ++v) uneven.vertices(v, 2) += kUneven * std::sin(double(v));
  write_mesh(folder_.file("uneven.ply"), uneven);
  SymmetryAnnotation annotation = chair_.truth;
  annotation.mesh_diagonal = diagonal(uneven.vertices);
  write_annotation(folder_.file("uneven.json"), annotation);
  ASSERT_EQ(editor_read_mesh(session_, path("uneven.ply").c_str()), 0) << editor_error();
  ASSERT_EQ(editor_read_annotation(session_, path("uneven.json").c_str(), 0), 0) << editor_error();
  const double before = worst(2);
  ASSERT_NE(editor_symmetrize(session_), nullptr) << editor_error();
  ASSERT_EQ(editor_blend(session_, 0.5), 0);
  const double half = worst(2);
  ASSERT_EQ(editor_blend(session_, 1), 0);
  EXPECT_NEAR(half, before / 2, 0.1 * before);
  EXPECT_LT(worst(2), 1e-9);
}

}  // namespace
}  // namespace orbifit
