#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "orbifit/datasets_tools/generate.h"

#include "geometry/face_tree.h"
#include "geometry/space_order.h"

namespace orbifit {
namespace {

// Faces of a wheel about the origin, in the order in which an index has them.
std::vector<TreeFace> wheel_faces() {
  const Mesh mesh = generate("wheel").mesh;
  const Eigen::Vector3d centre = bounding_box_centre(mesh.vertices);
  std::vector<TreeFace> faces;
  for (const int f : space_order(face_centroids(mesh))) {
    TreeFace face;
    for (std::size_t k = 0; k < 3; ++k) {
      const Eigen::Vector3d corner = mesh.vertices.row(mesh.faces(f, static_cast<Eigen::Index>(k)));
      face[k] = (corner - centre).cast<float>();
    }
    faces.push_back(face);
  }
  return faces;
}

struct Nearest {
  const std::vector<TreeFace>* faces;
  Eigen::Vector3f point;
  float distance = std::numeric_limits<float>::infinity();
  int measured = 0;
};

// By the nearest corner: what is measured does not matter to a tree, as long as no face is nearer than its box.
bool measure(void* state, unsigned face, float& radius) {
  Nearest& nearest = *static_cast<Nearest*>(state);
  ++nearest.measured;
  for (const Eigen::Vector3f& corner : (*nearest.faces)[face]) {
    nearest.distance = std::min(nearest.distance, (corner - nearest.point).norm());
  }
  if (!(nearest.distance < radius)) return false;
  radius = nearest.distance;
  return true;
}

class BoxTreeTest : public testing::Test {
 protected:
  Eigen::Vector3f point() { return {spread_(random_), spread_(random_), spread_(random_)}; }

  std::vector<TreeFace> faces_ = wheel_faces();
  BoxTree boxes_{faces_};
  EmbreeTree embree_{faces_};
  std::mt19937 random_{7};
  std::uniform_real_distribution<float> spread_{-1, 1};
};

TEST_F(BoxTreeTest, FindsTheNearestOfAllFacesAndMeasuresFew) {
  int measured = 0;
  for (int i = 0; i < 300; ++i) {
    Nearest found{&faces_, point()}, all{&faces_, found.point};
    float radius = std::numeric_limits<float>::infinity();
    boxes_.search(found.point, radius, measure, &found);
    for (unsigned face = 0; face < faces_.size(); ++face) measure(&all, face, radius);
    EXPECT_EQ(found.distance, all.distance);
    measured += found.measured;
  }
  EXPECT_LT(measured, 300 * static_cast<int>(faces_.size()) / 20);
}

TEST_F(BoxTreeTest, SearchesNoFartherThanTheRadius) {
  Nearest found{&faces_, Eigen::Vector3f(40, 0, 0)};
  boxes_.search(found.point, 1, measure, &found);
  EXPECT_EQ(found.measured, 0);
}

TEST_F(BoxTreeTest, RaysMeetWhatTheyMeetInEmbree) {
  int hits = 0;
  for (int i = 0; i < 2000; ++i) {
    TreeRay ray;
    ray.origin = 3 * point().normalized();
    ray.direction = (point() * 0.5F - ray.origin).normalized();
    ray.far = 100;
    TreeHit here, there;
    const bool met = boxes_.cast(ray, here);
    ASSERT_EQ(met, embree_.cast(ray, there)) << "ray " << i;
    EXPECT_EQ(boxes_.occluded(ray), embree_.occluded(ray));
    if (!met) continue;
    ++hits;
    EXPECT_NEAR(here.distance, there.distance, 1e-4);
  }
  EXPECT_GT(hits, 200);
}

TEST_F(BoxTreeTest, RaysAlongAnAxisHitFlatFaces) {
  const std::vector<TreeFace> square{{Eigen::Vector3f(-1, -1, 0), Eigen::Vector3f(1, -1, 0), Eigen::Vector3f(1, 1, 0)},
                                     {Eigen::Vector3f(-1, -1, 0), Eigen::Vector3f(1, 1, 0), Eigen::Vector3f(-1, 1, 0)}};
  TreeRay ray;
  ray.origin = {0.25F, 0.25F, 2};  // the seam between both
  ray.direction = {0, 0, -1};
  ray.far = 10;
  TreeHit hit;
  ASSERT_TRUE(BoxTree(square).cast(ray, hit));
  EXPECT_NEAR(hit.distance, 2, 1e-6);
}

TEST(BoxTree, OfNoFacesFindsNothing) {
  const std::vector<TreeFace> none;
  const BoxTree tree(none);
  Nearest found{&none, Eigen::Vector3f::Zero()};
  tree.search(found.point, 10, measure, &found);
  EXPECT_EQ(found.measured, 0);
  TreeRay ray;
  ray.direction = {1, 0, 0};
  ray.far = 10;
  EXPECT_FALSE(tree.occluded(ray));
}

}  // namespace
}  // namespace orbifit
