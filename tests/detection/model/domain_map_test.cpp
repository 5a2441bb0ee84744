#include "domains/domain_map.h"

#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <ostream>
#include <string>
#include <utility>
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

// Two boards across the x axis, each of two sheets that all but coincide, cut along one diagonal or the other.
Mesh boards(double apart, unsigned cuts) {
  Mesh mesh;
  mesh.vertices.resize(16, 3);
  mesh.faces.resize(8, 3);
  const std::array<double, 4> places{1 + apart, 1 - apart, -1 - apart, -1 + apart};
  for (int sheet = 0; sheet < 4; ++sheet) {
    const double x = places[static_cast<std::size_t>(sheet)];
    const int v = 4 * sheet;
    mesh.vertices.middleRows(v, 4) << x, -0.2, -0.5, x, 0.2, -0.5, x, 0.2, 0.5, x, -0.2, 0.5;
    if ((cuts >> static_cast<unsigned>(sheet) & 1U) != 0) {
      mesh.faces.middleRows(2 * sheet, 2) << v, v + 1, v + 2, v, v + 2, v + 3;
    } else {
      mesh.faces.middleRows(2 * sheet, 2) << v, v + 1, v + 3, v + 1, v + 2, v + 3;
    }
  }
  return mesh;
}

TEST(DomainMap, TakesSheetsThatAllButCoincideToTheirOwnImagesHoweverTheyAreCut) {
  SymmetryAnnotation annotation;
  annotation.regions = {region("D2h", Vector3d::UnitZ(), 0, 8)};
  const double apart = 1e-4;
  Pattern pattern;
  pattern.kind = Pattern::Kind::congruent;
  std::vector<Motion> motions;
  for (int sheet = 0; sheet < 4; ++sheet) {
    Motion motion = sheet < 2 ? Motion{} : Motion::reflection(Vector3d::UnitX(), Vector3d::Zero());
    if (sheet % 2 == 1) motion.translation.x() = (sheet < 2 ? -2 : 2) * apart;
    pattern.instances.push_back({motion, {2 * sheet, 2 * sheet + 1}});
    motions.push_back(motion);
  }
  annotation.patterns = {pattern};
  for (unsigned cuts = 0; cuts < 16; ++cuts) {
    const DomainMap domains(boards(apart, cuts), annotation, {motions});
    for (std::size_t e = 0; e < domains.elements(0).size(); ++e) {
      const bool across = domains.elements(0)[e].linear(0, 0) < 0;
      for (int sheet = 0; sheet < 4; ++sheet) {
        const std::vector image{1 + (across ? (sheet + 2) % 4 : sheet)};
        EXPECT_EQ(domains.images_of(1 + sheet, 0, static_cast<int>(e)), image) << cuts << ' ' << e << ' ' << sheet;
      }
    }
  }
}

// Of faces that only one of two overlapping regions holds, both, or their larger group as well.
struct Holder {
  const char* group;
  Vector3d axis;
  int first, count;  // faces; both have 3 to 6
  bool follows;
};

void PrintTo(const Holder& holder, std::ostream* to) {
  *to << holder.group << " about " << holder.axis.transpose() << " on " << holder.count << " faces";
}

class Followers : public testing::TestWithParam<Holder> {};

TEST_P(Followers, StayWhereALargerGroupHoldsAllThatTheyHaveInCommon) {
  const Holder& holder = GetParam();
  SymmetryAnnotation annotation;
  annotation.regions = {region("C5", Vector3d::UnitZ(), 0, 7), region("Cs", Vector3d::UnitX(), 3, 7),
                        region(holder.group, holder.axis, holder.first, holder.count)};
  const DomainMap domains(pinwheels(Matrix3d::Identity()), annotation, {});
  EXPECT_EQ(domains.follows(0, 1), holder.follows);
  EXPECT_EQ(domains.follows(1, 0), holder.follows);
  if (!holder.follows) return;
  for (int e = 0; e < kBlades; ++e) EXPECT_EQ(domains.images_of(1, 0, e), std::vector{1});
  for (int e = 0; e < 2; ++e) EXPECT_EQ(domains.images_of(0, 1, e), std::vector{0});
}

INSTANTIATE_TEST_SUITE_P(
    Groups, Followers,
    testing::Values(Holder{"Cinfv", Vector3d::UnitZ(), 3, 4, true}, Holder{"Dinfh", Vector3d::UnitZ(), 3, 4, true},
                    Holder{"Kh", Vector3d::UnitZ(), 3, 4, true}, Holder{"K", Vector3d::UnitZ(), 3, 4, false},
                    Holder{"Cinf", Vector3d::UnitZ(), 3, 4, false}, Holder{"Cinfh", Vector3d::UnitZ(), 3, 4, false},
                    Holder{"Cinfv", Vector3d::UnitX(), 3, 4, false}, Holder{"C5", Vector3d::UnitZ(), 3, 4, false},
                    Holder{"Cinfv", Vector3d::UnitZ(), 3, 3, false}, Holder{"Cinfv", Vector3d::UnitZ(), 3, 5, false}));

// Two regions of all ten faces, and what may lie around some of them.
struct Meeting {
  const char *first, *second;
  double angle;  // from the first one's axis, z, to the second one's, about x
  const char* holder;
  bool closes;
};

void PrintTo(const Meeting& meeting, std::ostream* to) {
  *to << meeting.first << " and " << meeting.second << " at " << meeting.angle << ", in " << meeting.holder;
}

class Meetings : public testing::TestWithParam<Meeting> {};

TEST_P(Meetings, CloseOrAreNamed) {
  const Meeting& meeting = GetParam();
  const Vector3d axis(0, -std::sin(meeting.angle), std::cos(meeting.angle));
  SymmetryAnnotation annotation;
  annotation.regions = {region(meeting.first, Vector3d::UnitZ(), 0, 2 * kBlades),
                        region(meeting.second, axis, 0, 2 * kBlades), region(meeting.holder, Vector3d::UnitX(), 0, 4)};
  const DomainMap domains(pinwheels(Matrix3d::Identity()), annotation, {});
  const std::vector<std::pair<int, int>> none;
  const std::vector<std::pair<int, int>> both{{0, 1}};
  EXPECT_EQ(domains.unclosed(domains.set_of_face(9)), meeting.closes ? none : both);
  const bool round = std::string(meeting.holder) == "Cinfv";  // about x: holds mirrors through it
  EXPECT_EQ(domains.unclosed(domains.set_of_face(0)), meeting.closes || round ? none : both);
}

INSTANTIATE_TEST_SUITE_P(
    Groups, Meetings,
    testing::Values(Meeting{"Cs", "Cs", 0.7, "C1", false}, Meeting{"Cs", "Cs", 0.7, "Cinfv", false},
                    Meeting{"Cs", "Cs", 0.04, "Cinfv", false}, Meeting{"Cs", "Cs", std::numbers::pi / 5, "C1", true},
                    Meeting{"Cs", "Cs", std::numbers::pi / 2, "C1", true}, Meeting{"C4", "C4", 0.7, "C1", false},
                    Meeting{"C4", "C4", std::numbers::pi / 2, "C1", true},
                    Meeting{"C2", "C2", std::numbers::pi / 3, "C1", true},
                    Meeting{"C3", "C2", std::numbers::pi / 2, "C1", true}, Meeting{"C3", "C2", 1.0, "C1", false},
                    Meeting{"Dinfh", "Cs", 0.7, "C1", false}, Meeting{"Dinfh", "Cs", std::numbers::pi / 2, "C1", true},
                    Meeting{"Kh", "Cs", 0.7, "C1", true}, Meeting{"Cinfv", "Dinfh", 0.7, "C1", false},
                    Meeting{"Cinfv", "Dinfh", 0, "C1", true}));

}  // namespace
}  // namespace orbifit
