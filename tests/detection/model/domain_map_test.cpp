#include "domains/domain_map.h"

#include <array>
#include <numbers>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "orbifit/model/point_group.h"

namespace orbifit {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr int kBlades = 5;

// Two pinwheels about the z axis of `frame`, each the mirror image of the other: x -> -x.
Mesh pinwheels(const Matrix3d& frame) {
  Mesh mesh;
  mesh.vertices.resize(6 * kBlades, 3);
  mesh.faces.resize(2 * kBlades, 3);
  const std::array<Vector3d, 3> blade{Vector3d(0.1, 0, 0), Vector3d(1, 0.1, 0), Vector3d(0.8, 0.4, 0)};
  for (int i = 0; i < kBlades; ++i) {
    const Motion turn = Motion::rotation(Vector3d::UnitZ(), 2 * std::numbers::pi * i / kBlades, Vector3d::Zero());
    for (int k = 0; k < 3; ++k) {
      const Vector3d corner = turn(blade[static_cast<std::size_t>(k)]);
      mesh.vertices.row(3 * i + k) = frame * corner;
      mesh.vertices.row(3 * (kBlades + i) + k) = frame * Vector3d(-corner[0], corner[1], corner[2]);
      mesh.faces(i, k) = 3 * i + k;
      mesh.faces(kBlades + i, k) = 3 * (kBlades + i) + k;
    }
  }
  return mesh;
}

Region region(const std::string& group, const Vector3d& axis, int first, int count) {
  std::vector<int> faces(static_cast<std::size_t>(count));
  std::iota(faces.begin(), faces.end(), first);
  return make_region(*PointGroup::parse(group), Vector3d::Zero(), frame_about(axis), faces, group);
}

// Their areas, centroids and second moments are the same but for rounding, which is another in each pose; so are their
// groups.
TEST(DomainMap, TellsPlacesApartThatHaveTheSameMoments) {
  for (int pose = 0; pose < 12; ++pose) {
    SCOPED_TRACE(pose);
    const Matrix3d frame = axis_rotation(Vector3d(1, 2, 3).normalized(), 0.1 + 0.2 * pose);
    SymmetryAnnotation annotation;
    annotation.regions = {region("Cs", frame.col(0), 0, 2 * kBlades), region("C5", frame.col(2), 0, kBlades),
                          region("C5", frame.col(2), kBlades, kBlades)};
    const DomainMap domains(pinwheels(frame), annotation, {});
    ASSERT_EQ(domains.elements(0).size(), 2U);
    EXPECT_EQ(domains.images_of(1, 0, 0), std::vector{1});
    EXPECT_EQ(domains.images_of(1, 0, 1), std::vector{2});
    EXPECT_EQ(domains.images_of(2, 0, 1), std::vector{1});
  }
}

}  // namespace
}  // namespace orbifit
