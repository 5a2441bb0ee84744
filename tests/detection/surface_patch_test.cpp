#include "surface/surface_patch.h"

#include <gtest/gtest.h>

#include "orbifit/model/errors.h"

#include "shapes.h"

namespace orbifit {
namespace {

TEST(Prepare, NormalisesAndGivesTheWayBack) {
  const Mesh mesh = test::moved(test::box(3, 4, 12), test::shift(1e4, -5, 7));
  const PreparedMesh prepared = prepare(mesh);
  EXPECT_NEAR(diagonal(prepared.mesh.vertices), 1, 1e-12);
  EXPECT_NEAR(prepared.input_of_normalised.scale, 13, 1e-9);
  for (int v = 0; v < mesh.vertices.rows(); ++v) {
    const Eigen::Vector3d back = prepared.input_of_normalised(prepared.mesh.vertices.row(v));
    EXPECT_LT((back - mesh.vertices.row(v).transpose()).norm(), 1e-9);
  }
}

TEST(Prepare, GivesNoAreaToASecondSide) {
  Mesh mesh = test::box(1, 1, 1);
  Mesh inside = mesh;
  inside.faces.col(1).swap(inside.faces.col(2));
  const PreparedMesh one = prepare(mesh);
  const PreparedMesh two = prepare(test::joined({mesh, inside}));
  EXPECT_NEAR(one.area, two.area, 1e-12);
  EXPECT_EQ(two.components.faces.size(), 1U);
}

TEST(Prepare, RefusesWhatHasNoArea) {
  Mesh line = test::scalene();
  line.vertices.col(1).setZero();
  line.vertices.col(2).setZero();
  EXPECT_THROW(prepare(line), InputError);
  Mesh broken = test::scalene();
  broken.vertices(2, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(prepare(broken), InputError);
}

TEST(SurfaceMoments, OfABoxAreThoseOfItsSixRectangles) {
  const double a = 2;
  const double b = 3;
  const double c = 5;
  const Mesh mesh = test::box(a, b, c);
  const PreparedMesh prepared = prepare(mesh);
  const double scale = prepared.input_of_normalised.scale;
  const SurfaceMoments moments = surface_moments(prepared, test::all_faces(mesh));
  EXPECT_NEAR(moments.area * scale * scale, 2 * (a * b + b * c + c * a), 1e-9);
  EXPECT_LT(moments.centroid.norm(), 1e-12);
  // Integral of x^2: the two faces x = +-a/2, and a^2/12 over the four others.
  const double xx = 2 * b * c * a * a / 4 + 2 * (a * b + a * c) * a * a / 12;
  EXPECT_NEAR(moments.covariance(0, 0) * moments.area * std::pow(scale, 4), xx, 1e-8);
  EXPECT_NEAR(moments.covariance(0, 1), 0, 1e-12);
}

TEST(MakePatch, MarksSamplesAtCreases) {
  const Mesh mesh = test::box(1, 1, 1);
  const PreparedMesh prepared = prepare(mesh);
  const RunContext context;
  const SurfacePatch patch = make_patch(prepared, test::all_faces(mesh), 2000, 0.01, context, "test");
  const double half = 0.5 / prepared.input_of_normalised.scale;
  int marked = 0;
  for (Eigen::Index i = 0; i < patch.samples.points.rows(); ++i) {
    Eigen::Vector3d depth = half - patch.samples.points.row(i).transpose().cwiseAbs().array();
    std::sort(depth.data(), depth.data() + 3);
    const bool at_crease = patch.at_crease[static_cast<std::size_t>(i)] != 0;
    if (std::abs(depth[1] - 0.03) > 1e-9) {
      EXPECT_EQ(at_crease, depth[1] < 0.03) << depth.transpose();
    }
    marked += at_crease ? 1 : 0;
  }
  EXPECT_GT(marked, 100);
}

}  // namespace
}  // namespace orbifit
