#include "orbifit/subspace/radius_field.h"

#include <string>

#include <gtest/gtest.h>

#include "orbifit/datasets_tools/generate.h"
#include "orbifit/model/errors.h"

#include "base/random.h"
#include "geometry/point_index.h"
#include "temporary_folder.h"

namespace orbifit {
namespace {

class RadiusField : public testing::TestWithParam<std::string> {
 protected:
  RadiusField() : model_(generate(GetParam())), size_(diagonal(model_.mesh.vertices)) { options_.base = 0.05 * size_; }

  Eigen::VectorXd field() const { return radius_field(model_.mesh, options_, RunContext{}); }

  // r(p) <= r(q) + g |p - q| along every edge.
  void expect_graded(const Eigen::VectorXd& radii) const {
    const Mesh& mesh = model_.mesh;
    for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
      for (int k = 0; k < 3; ++k) {
        const int v = mesh.faces(f, k);
        const int w = mesh.faces(f, (k + 1) % 3);
        const double length = (mesh.vertices.row(v) - mesh.vertices.row(w)).norm();
        ASSERT_LE(std::abs(radii[v] - radii[w]), options_.gradation * length + 1e-12 * size_);
      }
    }
  }

  GeneratedModel model_;
  double size_;
  RadiusFieldOptions options_;
};

TEST_P(RadiusField, IsTheBaseWhereNothingIsSaid) {
  EXPECT_EQ(field(), Eigen::VectorXd::Constant(model_.mesh.vertices.rows(), options_.base));
}

TEST_P(RadiusField, IsFineInsideAnAreaAndGrowsBackOutside) {
  const Eigen::Vector3d centre = model_.mesh.vertices.row(model_.mesh.vertices.rows() / 2);
  options_.areas = {{centre, 0.1 * size_, 0.3}};
  const Eigen::VectorXd radii = field();
  expect_graded(radii);
  for (Eigen::Index v = 0; v < radii.size(); ++v) {
    const double outside = (model_.mesh.vertices.row(v).transpose() - centre).norm() - 0.1 * size_;
    const double due = options_.base * 0.3 + options_.gradation * std::max(0.0, outside);
    EXPECT_NEAR(radii[v], std::min(options_.base, due), 1e-12 * size_);
  }
}

TEST_P(RadiusField, CoarseAreasStayGraded) {
  const Eigen::Vector3d centre = model_.mesh.vertices.row(0);
  options_.areas = {{centre, 0.4 * size_, 3}, {centre, 0.05 * size_, 0.5}};
  const Eigen::VectorXd radii = field();
  expect_graded(radii);
  EXPECT_NEAR(radii[0], 0.5 * options_.base, 1e-12 * size_);
  EXPECT_LE(radii.maxCoeff(), 3 * options_.base);
  EXPECT_GT(radii.maxCoeff(), options_.base);
}

TEST_P(RadiusField, OfThicknessHasTheSymmetriesOfTheMesh) {
  options_.feature_size = true;
  const Eigen::VectorXd radii = field();
  expect_graded(radii);
  EXPECT_GE(radii.minCoeff(), options_.smallest * options_.base);
  EXPECT_LE(radii.maxCoeff(), options_.largest * options_.base);
  const PointIndex index(model_.mesh.vertices);
  for (const Region& region : model_.truth.regions) {
    if (static_cast<Eigen::Index>(region.faces.size()) != model_.mesh.faces.rows()) continue;
    for (const Motion& element : region.elements) {
      for (Eigen::Index v = 0; v < radii.size(); ++v) {
        const auto image = index.nearest(element(model_.mesh.vertices.row(v).transpose()), 1).front();
        ASSERT_LT(image.distance, 1e-9 * size_);
        // Coincident vertices have the same radius: any of them will do.
        ASSERT_NEAR(radii[image.index], radii[v], 1e-6 * options_.base);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Models, RadiusField, testing::Values("bar", "table", "chair", "wheel"),
                         [](const auto& model) { return model.param; });

// A box of 2 by 2 by `height` with a vertex in the middle of each large side.
Mesh slab(double height) {
  Mesh mesh;
  mesh.vertices.resize(10, 3);
  mesh.vertices << -1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0, -1, -1, height, 1, -1, height, 1, 1, height, -1, 1, height,
      0, 0, 0, 0, 0, height;
  mesh.faces.resize(16, 3);
  mesh.faces << 1, 0, 8, 2, 1, 8, 3, 2, 8, 0, 3, 8, 4, 5, 9, 5, 6, 9, 6, 7, 9, 7, 4, 9, 0, 1, 5, 0, 5, 4, 1, 2, 6, 1, 6,
      5, 2, 3, 7, 2, 7, 6, 3, 0, 4, 3, 4, 7;
  return mesh;
}

// Triangles without common vertices: what is near in space grades all the same, each vertex by the eight nearest.
TEST(RadiusFieldOfSoup, IsGradedBetweenNeighboursInSpace) {
  constexpr int kTriangles = 200;
  constexpr int kNeighbours = 8;
  Random random(5, "soup");
  Mesh mesh;
  mesh.vertices.resize(3 * kTriangles, 3);
  mesh.faces.resize(kTriangles, 3);
  for (Eigen::Index f = 0; f < kTriangles; ++f) {
    const Eigen::RowVector3d centre = Eigen::RowVector3d(random.uniform(), random.uniform(), 0.2 * random.uniform());
    for (Eigen::Index k = 0; k < 3; ++k) {
      mesh.vertices.row(3 * f + k) = centre + 0.01 * random.direction().transpose();
      mesh.faces(f, k) = static_cast<int>(3 * f + k);
    }
  }
  RadiusFieldOptions options;
  options.base = 0.02;
  options.areas = {{Eigen::Vector3d(0.5, 0.5, 0.1), 0.4, 10}};
  const Eigen::VectorXd radii = radius_field(mesh, options, RunContext{});
  EXPECT_GT(radii.maxCoeff(), 2 * options.base);
  const PointIndex index(mesh.vertices);
  for (Eigen::Index v = 0; v < radii.size(); ++v) {
    for (const auto& near : index.nearest(mesh.vertices.row(v).transpose(), kNeighbours + 1)) {
      EXPECT_LE(radii[v], radii[near.index] + options.gradation * near.distance + 1e-12);
    }
  }
}

TEST(RadiusFieldOfThickness, IsHalfTheThicknessOfASlab) {
  RadiusFieldOptions options;
  options.base = 0.2;
  options.feature_size = true;
  options.smallest = 0.1;
  options.gradation = 100;
  for (const double height : {0.06, 0.2, 0.3}) {
    EXPECT_NEAR(radius_field(slab(height), options, RunContext{})[9], height / 2, 1e-5);
  }
  EXPECT_NEAR(radius_field(slab(0.02), options, RunContext{})[9], 0.02, 1e-12);
  EXPECT_NEAR(radius_field(slab(0.9), options, RunContext{})[9], 0.2, 1e-12);
}

TEST(RadiusFieldFile, IsRead) {
  const TemporaryFolder folder;
  folder.write("field.json",
               R"({"areas": [{"centre": [1, 2, 3], "radius": 0.5, "factor": 0.25}], "feature_size": true,
                 "gradation": 0.3, "note": "ignored"})");
  const RadiusFieldOptions options = read_radius_field(folder.file("field.json"), 0.7);
  EXPECT_EQ(options.base, 0.7);
  EXPECT_TRUE(options.feature_size);
  EXPECT_EQ(options.gradation, 0.3);
  ASSERT_EQ(options.areas.size(), 1U);
  EXPECT_EQ(options.areas[0].centre, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(options.areas[0].radius, 0.5);
  EXPECT_EQ(options.areas[0].factor, 0.25);
}

struct BadField {
  const char* name;
  const char* text;
  const char* reason;
};

class RadiusFieldRefusal : public testing::TestWithParam<BadField> {};

TEST_P(RadiusFieldRefusal, NamesFileKeyAndReason) {
  const TemporaryFolder folder;
  folder.write("field.json", GetParam().text);
  try {
    read_radius_field(folder.file("field.json"), 1);
    FAIL();
  } catch (const InputError& error) {
    const std::string what = error.what();
    EXPECT_NE(what.find("field.json"), std::string::npos) << what;
    EXPECT_NE(what.find(GetParam().reason), std::string::npos) << what;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Files, RadiusFieldRefusal,
    testing::Values(
        BadField{"NotJson", "{", "is not JSON"}, BadField{"NoObject", "[1]", "must be an object"},
        BadField{"NoList", R"({"areas": 3})", "areas: must be a list"},
        BadField{"NoFactor", R"({"areas": [{"centre": [0, 0, 0], "radius": 1}]})", "areas[0]: needs factor"},
        BadField{"Centre", R"({"areas": [{"centre": [0, 0], "radius": 1, "factor": 1}]})", "areas[0].centre"},
        BadField{"Radius", R"({"areas": [{"centre": [0, 0, 0], "radius": -1, "factor": 1}]})",
                 "areas[0].radius: is -1"},
        BadField{"FeatureSize", R"({"feature_size": 1})", "feature_size: is 1"},
        BadField{"Limits", R"({"smallest": 2, "largest": 1})", "largest"},
        BadField{"Gradation", R"({"gradation": 0})", "gradation: is 0"}),
    [](const auto& file) { return file.param.name; });

TEST(RadiusFieldOptions, AreValidated) {
  RadiusFieldOptions options;
  EXPECT_THROW(options.validate(), UsageError);
  options.base = 1;
  EXPECT_NO_THROW(options.validate());
  options.areas = {{Eigen::Vector3d::Zero(), 1, 0}};
  EXPECT_THROW(options.validate(), UsageError);
}

}  // namespace
}  // namespace orbifit
