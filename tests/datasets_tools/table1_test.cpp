#include "cases/table1.h"

#include <algorithm>
#include <string>

#include <gtest/gtest.h>

#include "orbifit/datasets_tools/symmetry_residual.h"
#include "orbifit/model/errors.h"

#include "geometry/topology.h"

namespace orbifit {
namespace {

class Table1 : public testing::TestWithParam<std::string> {
 protected:
  Table1Model row_ = table1_model(GetParam());
};

TEST_P(Table1, HasTheRowsCounts) {
  const Mesh& mesh = row_.model.mesh;
  EXPECT_NEAR(static_cast<double>(mesh.vertices.rows()) / 1000, row_.vertices_k, 0.05 * row_.vertices_k);
  EXPECT_NEAR(static_cast<double>(mesh.faces.rows()) / 1000, row_.triangles_k, 0.05 * row_.triangles_k);
  EXPECT_EQ(static_cast<int>(row_.model.truth.regions.size()), row_.groups);
}

// Every element, but on the two largest models those that generate the group: the others are their products.
TEST_P(Table1, IsSymmetricToRoundingVertexOntoVertex) {
  SymmetryAnnotation measured = row_.model.truth;
  if (row_.vertices_k > 60) {
    for (Region& region : measured.regions) {
      region.group = {};
      region.elements = region.generators;
    }
  }
  RunContext context;
  const SymmetryReport report = symmetry_residual(row_.model.mesh, measured, nullptr, CarriedMotions::fixed, context);
  EXPECT_TRUE(report.vertices_onto_vertices);
  EXPECT_LT(report.worst_floor, 1e-14);
  for (const RegionResidual& region : report.regions) EXPECT_GT(region.pairs, 0) << region.name;
}

TEST_P(Table1, IsMadeOfClosedParts) {
  const bool two_sided = row_.parameters.contains("two_sided");
  Mesh mesh = row_.model.mesh;
  if (two_sided) {
    const Eigen::Index half = mesh.faces.rows() / 2;
    for (Eigen::Index f = 0; f < half; ++f) {
      EXPECT_EQ(mesh.faces.row(f), mesh.faces.row(f + half)({0, 2, 1}));
    }
    mesh.faces.conservativeResize(half, 3);
  }
  const MeshReport report = inspect(mesh);
  EXPECT_TRUE(report.watertight);
  EXPECT_EQ(report.inconsistent_edges, 0);
  EXPECT_EQ(report.degenerate_faces, 0);
  EXPECT_EQ(report.unused_vertices, 0);
  EXPECT_EQ(report.duplicate_faces, 0);
  for (const std::vector<int>& faces : connected_components(mesh, weld_vertices(mesh.vertices)).faces) {
    EXPECT_GT(inspect(submesh(mesh, faces)).volume, 0);
  }
}

// What is to be bent needs triangles that are not slivers: the longest edge's square over the area is 2.3 if
// equilateral.
TEST_P(Table1, HasHardlyAnySlivers) {
  const Mesh& mesh = row_.model.mesh;
  const Eigen::VectorXd areas = face_areas(mesh);
  Eigen::Index slivers = 0;
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    double longest = 0;
    for (int k = 0; k < 3; ++k) {
      const Eigen::RowVector3d edge =
          mesh.vertices.row(mesh.faces(f, k)) - mesh.vertices.row(mesh.faces(f, (k + 1) % 3));
      longest = std::max(longest, edge.squaredNorm());
    }
    if (longest > 8 * 2.3 * areas[f]) ++slivers;
  }
  EXPECT_LT(static_cast<double>(slivers), 0.01 * static_cast<double>(mesh.faces.rows()));
}

TEST_P(Table1, HasHandlesOnTheModelOfWhichTheFirstHoldsIt) {
  ASSERT_GE(row_.handles.size(), 2U);
  for (std::size_t i = 0; i < row_.handles.size(); ++i) {
    const Table1Handle& handle = row_.handles[i];
    const auto distances = (row_.model.mesh.vertices.rowwise() - handle.centre.transpose()).rowwise().norm();
    EXPECT_GE((distances.array() <= handle.radius).count(), 5) << handle.name;
    const double moved = (handle.motion(handle.centre) - handle.centre).norm();
    EXPECT_EQ(moved > 0, i > 0) << handle.name;
    EXPECT_LT(orthogonality_error(handle.motion.linear), 1e-14) << handle.name;
  }
}

TEST_P(Table1, IsReproducible) {
  const Table1Model again = table1_model(GetParam());
  EXPECT_EQ(again.model.mesh.vertices, row_.model.mesh.vertices);
  EXPECT_EQ(again.model.mesh.faces, row_.model.mesh.faces);
}

INSTANTIATE_TEST_SUITE_P(Models, Table1, testing::ValuesIn(table1_names()),
                         [](const auto& given) { return given.param; });

TEST(Table1Names, AreThePapers) {
  EXPECT_EQ(table1_names(), (std::vector<std::string>{"bar", "centre_piece", "plane", "yard_tool", "car", "wind_mill",
                                                      "fan", "chair"}));
  EXPECT_THROW(table1_model("boat"), UsageError);
}

TEST(ThePlane, GrowsWithTheSquareOfItsDetail) {
  const double once = static_cast<double>(generate("plane", {{"detail", 1}}).mesh.vertices.rows());
  const double tenfold = static_cast<double>(generate("plane", {{"detail", 10}}).mesh.vertices.rows());
  EXPECT_NEAR(tenfold / once, 100, 5);
}

}  // namespace
}  // namespace orbifit
