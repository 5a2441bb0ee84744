// Peers that do badly through a fault of ours would be no peers: each must solve what it is made for.
#include <algorithm>
#include <optional>

#include <gtest/gtest.h>

#include "orbifit/datasets_tools/generate.h"
#include "orbifit/datasets_tools/virtual_scan.h"

#include "base/random.h"
#include "geometry/surface_index.h"
#include "peers/decimater.h"
#include "peers/pcl_pose.h"

namespace orbifit::benchmarks {
namespace {

// A car has no rotation, so there is one right pose.
TEST(PclPose, FindsAShapeThatIsTheTemplateItself) {
  RunContext context;
  const Mesh mesh = generate("car").mesh;
  PointCloud scan = virtual_scan(mesh, {.views = 3, .noise = 0.001}, context);
  Random random(3, "pose");
  const Similarity truth{2.5, random.rotation(), {40, -30, 20}};
  for (Points* points : {&scan.points, &scan.viewpoints}) {
    for (Eigen::Index p = 0; p < points->rows(); ++p) points->row(p) = truth(points->row(p).transpose()).transpose();
  }
  const std::optional<Similarity> found = pcl_pose(mesh, scan, truth.scale, context, 0.9);
  ASSERT_TRUE(found.has_value());
  double farthest = 0;
  for (const auto& vertex : mesh.vertices.rowwise()) {
    farthest = std::max(farthest, ((*found)(vertex.transpose()) - truth(vertex.transpose())).norm());
  }
  EXPECT_LT(farthest, 0.01 * truth.scale * diagonal(mesh.vertices));
}

TEST(Decimater, TakesAwayWhatIsFlat) {
  const Mesh mesh = generate("bar").mesh;
  const Mesh few = decimated(mesh, 200);
  EXPECT_LE(few.faces.rows(), 200);
  EXPECT_GT(few.faces.rows(), 12);
  const SurfaceIndex surface(few);
  for (const auto& vertex : mesh.vertices.rowwise()) {
    EXPECT_LT(surface.nearest(vertex.transpose()).distance, 0.005 * diagonal(mesh.vertices));
  }
}

}  // namespace
}  // namespace orbifit::benchmarks
