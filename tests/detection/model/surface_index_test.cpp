#include "geometry/surface_index.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <ostream>
#include <string>
#include <thread>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "base/random.h"
#include "geometry/space_order.h"

namespace orbifit {
namespace {

// Triangles of all sizes in the unit cube: every eighth a needle, every ninth a segment or a point.
Mesh random_soup(Random& random, int faces) {
  Mesh mesh;
  mesh.vertices.resize(3 * faces, 3);
  mesh.faces.resize(faces, 3);
  for (int f = 0; f < faces; ++f) {
    const Eigen::Vector3d a(random.uniform(), random.uniform(), random.uniform());
    const double size = std::exp(random.uniform(-5, 0));
    const Eigen::Vector3d ab = size * random.direction();
    Eigen::Vector3d ac = size * random.direction();
    if (f % 8 == 0) ac = random.uniform(-1, 2) * ab + 1e-9 * size * random.direction();
    if (f % 9 == 0) ac = f % 2 == 0 ? Eigen::Vector3d(0.5 * ab) : Eigen::Vector3d(ab);
    mesh.vertices.row(3 * f) = a;
    mesh.vertices.row(3 * f + 1) = f % 27 == 0 ? a : Eigen::Vector3d(a + ab);
    mesh.vertices.row(3 * f + 2) = f % 27 == 0 ? a : Eigen::Vector3d(a + ac);
    mesh.faces.row(f) << 3 * f, 3 * f + 1, 3 * f + 2;
  }
  return mesh;
}

// Nearest point by the definition: the least over the plane, where the projection falls inside, and the three sides.
double brute_distance(const Eigen::Vector3d& p, const Mesh& mesh, int face) {
  using Vector = Eigen::Matrix<long double, 3, 1>;
  const Vector point = p.cast<long double>();
  Vector corner[3];
  for (int k = 0; k < 3; ++k) {
    corner[k] = mesh.vertices.row(mesh.faces(face, k)).transpose().cast<long double>();
  }
  long double best = std::numeric_limits<long double>::infinity();
  for (int k = 0; k < 3; ++k) {
    const Vector side = corner[(k + 1) % 3] - corner[k];
    const long double length = side.squaredNorm();
    const long double t = length > 0 ? std::clamp<long double>((point - corner[k]).dot(side) / length, 0, 1) : 0;
    best = std::min(best, (corner[k] + t * side - point).norm());
  }
  const Vector normal = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
  bool inside = normal.norm() > 0;
  for (int k = 0; k < 3 && inside; ++k) {
    inside = normal.dot((corner[(k + 1) % 3] - corner[k]).cross(point - corner[k])) >= 0;
  }
  if (inside) best = std::min(best, std::abs((point - corner[0]).dot(normal.normalized())));
  return static_cast<double>(best);
}

struct Placement {
  std::string name;
  double scale;
  double offset;  // in mesh diagonals

  friend void PrintTo(const Placement& placement, std::ostream* stream) { *stream << placement.name; }
};

class Placed : public testing::TestWithParam<Placement> {
 protected:
  void SetUp() override {
    const double shift = GetParam().offset * diagonal(mesh_.vertices);
    mesh_.vertices =
        GetParam().scale * (mesh_.vertices.rowwise() + shift * Eigen::RowVector3d(0.6, -0.64, 0.48)).eval();
    diagonal_ = diagonal(mesh_.vertices);
    centre_ = bounding_box_centre(mesh_.vertices);
  }

  Eigen::Vector3d query(double reach) { return centre_ + diagonal_ * reach * random_.uniform() * random_.direction(); }

  struct BruteRay {
    double distance = std::numeric_limits<double>::infinity();
    bool near_a_rim = false;  // where single precision may decide either way
  };

  BruteRay brute_cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const {
    BruteRay result;
    for (int f = 0; f < 300; ++f) {
      const auto corner = [&](int k) -> Eigen::Vector3d {
        return (mesh_.vertices.row(mesh_.faces(f, k)).transpose() - origin) / diagonal_;
      };
      // The corners as the ray sees them: the ray meets the face where they surround its axis.
      Eigen::Matrix3d frame;
      frame << direction.unitOrthogonal(), direction.cross(direction.unitOrthogonal()), direction;
      Eigen::Matrix3d seen;
      seen << frame.transpose() * corner(0), frame.transpose() * corner(1), frame.transpose() * corner(2);
      const Eigen::Matrix3d flat = seen.array().colwise() * Eigen::Array3d(1, 1, 0);
      const Eigen::Vector3d zero = Eigen::Vector3d::Zero();
      for (int k = 0; k < 3; ++k) {
        const Eigen::Vector3d from = flat.col(k);
        const Eigen::Vector3d to = flat.col((k + 1) % 3);
        const Eigen::Vector3d weights = nearest_on_triangle(zero, from, to, to);
        if ((weights[0] * from + (1 - weights[0]) * to).norm() < 1e-5) result.near_a_rim = true;
      }
      const Eigen::Vector3d weights = nearest_on_triangle(zero, flat.col(0), flat.col(1), flat.col(2));
      if ((flat * weights).norm() > 1e-9) continue;
      result.distance = std::min(result.distance, seen.row(2).dot(weights) * diagonal_);
    }
    return result;
  }

  Random random_{3, GetParam().name};
  Mesh mesh_ = random_soup(random_, 300);
  double diagonal_ = 0;
  Eigen::Vector3d centre_;
};

TEST_P(Placed, NearestIsTheBruteForceMinimum) {
  const SurfaceIndex index(mesh_);
  // Differences of coordinates are rounded relative to the coordinates' size.
  const double rounding = 1e-14 * diagonal_ * (1 + GetParam().offset);
  for (int i = 0; i < 400; ++i) {
    const double reach = i % 4 == 0 ? 30 : 0.7;
    const Eigen::Vector3d p = query(reach);
    double expected = std::numeric_limits<double>::infinity();
    for (int f = 0; f < 300; ++f) expected = std::min(expected, brute_distance(p, mesh_, f));
    const SurfaceIndex::Nearest nearest = index.nearest(p);
    ASSERT_GE(nearest.face, 0);
    EXPECT_NEAR(nearest.distance, expected, rounding * (1 + reach));
    EXPECT_NEAR((nearest.point - p).stableNorm(), nearest.distance, rounding * (1 + reach));
    EXPECT_NEAR(nearest.barycentric.sum(), 1, 1e-14);
    EXPECT_GE(nearest.barycentric.minCoeff(), -1e-14);
    Eigen::Vector3d rebuilt = Eigen::Vector3d::Zero();
    for (int k = 0; k < 3; ++k) {
      rebuilt += nearest.barycentric[k] * mesh_.vertices.row(mesh_.faces(nearest.face, k)).transpose();
    }
    EXPECT_LE((rebuilt - nearest.point).stableNorm(), rounding);
  }
}

TEST_P(Placed, PointsOfFacesAreAtDistanceZero) {
  const SurfaceIndex index(mesh_);
  for (int f = 0; f < 300; ++f) {
    const double u = random_.uniform();
    const double v = random_.uniform() * (1 - u);
    const Eigen::Vector3d a = mesh_.vertices.row(mesh_.faces(f, 0));
    const Eigen::Vector3d b = mesh_.vertices.row(mesh_.faces(f, 1));
    const Eigen::Vector3d c = mesh_.vertices.row(mesh_.faces(f, 2));
    EXPECT_LE(index.nearest(a + u * (b - a) + v * (c - a)).distance, 1e-15 * diagonal_ * (4 + 4 * GetParam().offset));
    // A degenerate face has its corners all the same.
    EXPECT_EQ(index.nearest(b).distance, 0);
  }
}

TEST_P(Placed, MaximumDistanceIsInclusiveAndExact) {
  const SurfaceIndex index(mesh_);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d p = query(2);
    const SurfaceIndex::Nearest nearest = index.nearest(p);
    EXPECT_EQ(index.nearest(p, nearest.distance).face, nearest.face);
    EXPECT_EQ(index.nearest(p, nearest.distance, static_cast<int>(random_.below(300))).face, nearest.face);
    EXPECT_EQ(index.nearest(p, std::nextafter(nearest.distance, 0)).face, -1);
    EXPECT_EQ(index.nearest(p, -1).face, -1);
  }
}

TEST_P(Placed, WithinSaysWhetherThereIsANearest) {
  const SurfaceIndex index(mesh_);
  int faced = 0;
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d p = query(0.7);
    const Eigen::Vector3d direction = random_.direction();
    const double distance = index.nearest(p).distance;
    EXPECT_TRUE(index.within(p, distance));
    EXPECT_FALSE(index.within(p, std::nextafter(distance, 0)));
    const double facing = index.nearest_facing(p, direction, 0.7, 10 * diagonal_, true).distance;
    if (!std::isfinite(facing)) continue;
    ++faced;
    EXPECT_TRUE(index.within_facing(p, direction, 0.7, facing));
    EXPECT_FALSE(index.within_facing(p, direction, 0.7, std::nextafter(facing, 0)));
  }
  EXPECT_GT(faced, 100);
}

TEST_P(Placed, AllWithinAreThoseOfBruteForce) {
  const SurfaceIndex index(mesh_);
  for (int i = 0; i < 50; ++i) {
    const Eigen::Vector3d p = query(0.7);
    const double distance = index.nearest(p).distance * random_.uniform(1, 2);
    const std::vector<SurfaceIndex::Nearest> found = index.all_within(p, distance);
    std::vector<int> expected;
    for (int f = 0; f < static_cast<int>(mesh_.faces.rows()); ++f) {
      if (index.part({f}).nearest(p).distance <= distance) expected.push_back(f);
    }
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t k = 0; k < found.size(); ++k) {
      EXPECT_EQ(found[k].face, expected[k]);
      const SurfaceIndex::Nearest same = index.part({expected[k]}).nearest(p);
      EXPECT_EQ(found[k].distance, same.distance);
      EXPECT_EQ(found[k].barycentric, same.barycentric);
    }
    EXPECT_TRUE(index.all_within(p, std::nextafter(index.nearest(p).distance, 0)).empty());
  }
}

TEST_P(Placed, FacingFilterIsTheBruteForceOne) {
  const SurfaceIndex index(mesh_);
  const Points normals = face_normals(mesh_);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d p = query(0.7);
    const Eigen::Vector3d direction = random_.direction();
    const bool either_way = i % 2 == 0;
    double expected = std::numeric_limits<double>::infinity();
    for (int f = 0; f < 300; ++f) {
      const double cosine = normals.row(f).dot(direction);
      if ((either_way ? std::abs(cosine) : cosine) >= 0.9) expected = std::min(expected, brute_distance(p, mesh_, f));
    }
    const auto nearest = index.nearest_facing(p, direction, 0.9, std::numeric_limits<double>::infinity(), either_way);
    EXPECT_EQ(nearest.face >= 0, std::isfinite(expected));
    if (nearest.face >= 0) {
      EXPECT_NEAR(nearest.distance, expected, 1e-14 * diagonal_ * (1 + GetParam().offset));
    }
  }
}

TEST_P(Placed, RaysHitTheFirstFace) {
  const SurfaceIndex index(mesh_);
  const double single = 3e-6 * diagonal_;
  int hits = 0;
  int misses = 0;
  for (int i = 0; i < 500; ++i) {
    const Eigen::Vector3d direction = random_.direction();
    const Eigen::Vector3d origin = query(0.4) - (i % 3 == 0 ? 2000 : 1.5) * diagonal_ * direction;
    const BruteRay brute = brute_cast(origin, direction);
    if (brute.near_a_rim) continue;
    const auto hit = index.cast(origin, direction);
    ASSERT_EQ(hit.has_value(), std::isfinite(brute.distance));
    EXPECT_EQ(index.occluded(origin, direction, 0, 3000 * diagonal_), hit.has_value());
    if (!hit) {
      ++misses;
      continue;
    }
    ++hits;
    EXPECT_NEAR(hit->distance, brute.distance, single);
    EXPECT_LE((origin + hit->distance * direction - hit->point).stableNorm(), single);
    EXPECT_LE(index.nearest(hit->point).distance, 1e-14 * diagonal_ * (1 + GetParam().offset));
    EXPECT_TRUE(index.occluded(origin, direction, 0, hit->distance + single));
    EXPECT_FALSE(index.occluded(origin, direction, 0, hit->distance - single));
    const auto behind = index.cast(origin, direction, hit->distance + single);
    EXPECT_TRUE(!behind || behind->distance >= hit->distance);
  }
  EXPECT_GT(hits, 100);
  EXPECT_GT(misses, 10);
}

INSTANTIATE_TEST_SUITE_P(Placements, Placed,
                         testing::Values(Placement{"unit", 1, 0}, Placement{"far", 1, 1e4}, Placement{"small", 1e-3, 0},
                                         Placement{"large_and_far", 1e3, 1e4}, Placement{"tiny", 1e-100, 0},
                                         Placement{"huge", 1e100, 1}),
                         [](const auto& placement) { return placement.param.name; });

// Single precision, which looks first, is off by as much more.
TEST(SurfaceIndex, ALongNormalFiltersAsClosely) {
  constexpr double kLength = 1000;
  constexpr double kClosely = 1e-9 * kLength;
  Random random(4);
  const Mesh mesh = random_soup(random, 300);
  const SurfaceIndex index(mesh);
  const Points normals = face_normals(mesh);
  for (int f = 0; f < 300; ++f) {
    const Eigen::Vector3d middle = mesh.vertices(mesh.faces.row(f), Eigen::all).colwise().mean();
    const Eigen::Vector3d facing = kLength * random.direction();
    const double cosine = normals.row(f).dot(facing);
    const double reach = 1e-12 * diagonal(mesh.vertices);
    EXPECT_EQ(index.nearest_facing(middle, facing, cosine - kClosely, reach).face, f);
    EXPECT_EQ(index.nearest_facing(middle, facing, cosine + kClosely, reach).face, -1);
  }
}

TEST(SurfaceIndex, EqualDistancesGoToTheLowestFace) {
  // Forty copies of the same face, and the query on them, above them and far away.
  Mesh mesh;
  mesh.vertices.resize(3, 3);
  mesh.vertices << 0, 0, 0, 1, 0, 0, 0, 1, 0;
  mesh.faces.resize(40, 3);
  mesh.faces.rowwise() = Eigen::RowVector3i(0, 1, 2);
  for (const double z : {0.0, 1e-9, 0.3, 1e3, 1e9}) {
    EXPECT_EQ(SurfaceIndex(mesh).nearest({0.2, 0.3, z}).face, 0);
    EXPECT_EQ(SurfaceIndex(mesh, {31, 17, 5, 38}).nearest({0.2, 0.3, z}).face, 5);
  }
}

TEST(SurfaceIndex, TheMiddleOfACubeIsNearestToItsFirstFace) {
  // Six sides at the same distance from the centre, in an order that the tree does not know.
  Mesh cube;
  cube.vertices.resize(8, 3);
  for (int v = 0; v < 8; ++v) cube.vertices.row(v) << (v & 1), ((v >> 1) & 1), ((v >> 2) & 1);
  cube.faces.resize(12, 3);
  cube.faces << 0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7,
      5;
  for (int first = 0; first < 12; ++first) {
    Mesh turned = cube;
    for (int f = 0; f < 12; ++f) turned.faces.row(f) = cube.faces.row((f + first) % 12);
    const auto nearest = SurfaceIndex(turned).nearest({0.5, 0.5, 0.5});
    EXPECT_EQ(nearest.distance, 0.5);
    EXPECT_EQ(nearest.face, 0);
  }
}

TEST(SurfaceIndex, OfSomeFacesReportsTheMeshsNumbers) {
  Random random(5);
  const Mesh mesh = random_soup(random, 100);
  const std::vector<int> some{3, 20, 21, 64, 99};
  const SurfaceIndex index(mesh, some);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d p = random.direction();
    double expected = std::numeric_limits<double>::infinity();
    for (const int f : some) expected = std::min(expected, brute_distance(p, mesh, f));
    const auto nearest = index.nearest(p);
    EXPECT_NEAR(nearest.distance, expected, 1e-14);
    EXPECT_NE(std::find(some.begin(), some.end(), nearest.face), some.end());
  }
}

TEST(SurfaceIndex, OfNothingFindsNothing) {
  const SurfaceIndex index{Mesh{}};
  EXPECT_EQ(index.nearest({0, 0, 0}).face, -1);
  EXPECT_FALSE(index.cast({0, 0, 0}, {1, 0, 0}));
  EXPECT_FALSE(index.occluded({0, 0, 0}, {1, 0, 0}, 0, 1));
}

TEST(SurfaceIndex, OfOnePointFindsThePoint) {
  Mesh mesh;
  mesh.vertices = Eigen::RowVector3d(1e6, 2, 3).replicate(3, 1);
  mesh.faces.resize(1, 3);
  mesh.faces << 0, 1, 2;
  const auto nearest = SurfaceIndex(mesh).nearest({1e6, 2, 7});
  EXPECT_EQ(nearest.face, 0);
  EXPECT_EQ(nearest.distance, 4);
}

TEST(SurfaceIndex, AnswersTheSameFromSeveralThreads) {
  Random random(9);
  const Mesh mesh = random_soup(random, 500);
  const SurfaceIndex index(mesh);
  std::vector<Eigen::Vector3d> queries;
  for (int i = 0; i < 2000; ++i) queries.push_back(2 * random.direction());
  std::vector<double> alone(queries.size());
  for (std::size_t i = 0; i < queries.size(); ++i) alone[i] = index.nearest(queries[i]).distance;
  std::vector<std::vector<double>> together(3, std::vector<double>(queries.size()));
  {
    std::vector<std::jthread> threads;
    for (auto& answers : together) {
      threads.emplace_back([&] {
        const SurfaceIndex own(mesh);  // builds at the same time, too
        for (std::size_t i = 0; i < queries.size(); ++i) {
          answers[i] = (i % 2 == 0 ? own : index).nearest(queries[i]).distance;
        }
      });
    }
  }
  for (const auto& answers : together) EXPECT_EQ(answers, alone);
}

TEST(PartOfASurface, AnswersAsAnIndexOfItsFaces) {
  Random random(22);
  const Mesh mesh = random_soup(random, 400);
  const SurfaceIndex whole(mesh);
  for (const std::size_t size : {1U, 19U, 40U, 399U, 400U}) {
    std::vector<int> faces(400);
    std::iota(faces.begin(), faces.end(), 0);
    for (std::size_t i = 0; i < size; ++i) std::swap(faces[i], faces[i + random.below(400 - i)]);
    faces.resize(size);
    const SurfaceIndex part = whole.part(faces);
    const std::vector<int> half(faces.begin(), faces.begin() + static_cast<std::ptrdiff_t>((size + 1) / 2));
    const SurfaceIndex fresh(mesh, faces);
    const SurfaceIndex fresh_half(mesh, half);
    const SurfaceIndex part_of_part = part.part(half);
    const SurfaceIndex no_more = part_of_part.part(faces);  // what a part does not find, its parts do not either
    for (int k = 0; k < 300; ++k) {
      const Eigen::Vector3d point = 2 * random.direction() * random.uniform();
      const Eigen::Vector3d normal = random.direction();
      const double reach = 0.5 * random.uniform();
      const SurfaceIndex::Nearest expected = fresh.nearest(point);
      EXPECT_EQ(part.nearest(point).face, expected.face);
      EXPECT_EQ(part.nearest(point).distance, expected.distance);
      EXPECT_EQ(part.within(point, reach), expected.distance <= reach);
      EXPECT_EQ(part.nearest_facing(point, normal, 0.5).face, fresh.nearest_facing(point, normal, 0.5).face);
      EXPECT_EQ(part.within_facing(point, normal, 0.5, reach), fresh.within_facing(point, normal, 0.5, reach));
      EXPECT_EQ(part_of_part.nearest(point).face, fresh_half.nearest(point).face);
      EXPECT_EQ(no_more.nearest(point).face, fresh_half.nearest(point).face);
    }
  }
}

TEST(PartOfASurface, NoFacesAreNowhere) {
  Random random(23);
  const SurfaceIndex none = SurfaceIndex(random_soup(random, 10)).part({});
  EXPECT_EQ(none.nearest(Eigen::Vector3d::Zero()).face, -1);
  EXPECT_FALSE(none.within(Eigen::Vector3d::Zero(), 10));
}

TEST(SurfaceIndex, WithinIsTrueAtTheDistanceOfTheNearest) {
  Random random(24);
  const Mesh mesh = random_soup(random, 2000);
  const SurfaceIndex index(mesh);
  for (int k = 0; k < 3000; ++k) {
    const auto face = static_cast<Eigen::Index>(random.below(2000));
    Eigen::Vector3d weights(random.uniform(), random.uniform(), random.uniform());
    weights /= weights.sum();
    Eigen::Vector3d point = std::pow(10, -5 * random.uniform()) * random.direction();
    for (int c = 0; c < 3; ++c) point += weights[c] * mesh.vertices.row(mesh.faces(face, c)).transpose();
    const double distance = index.nearest(point).distance;
    EXPECT_TRUE(index.within(point, distance));
    EXPECT_FALSE(index.within(point, std::nextafter(distance, 0)));
    const Eigen::Vector3d normal = random.direction();
    const double facing = index.nearest_facing(point, normal, 0.8, 10, true).distance;
    if (!std::isfinite(facing)) continue;
    EXPECT_TRUE(index.within_facing(point, normal, 0.8, facing));
    EXPECT_FALSE(index.within_facing(point, normal, 0.8, std::nextafter(facing, 0)));
  }
}

TEST(SpaceOrder, IsAPermutationThatKeepsNeighboursTogether) {
  Random random(25);
  Points points(2000, 3);
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    points.row(i) << 3 * random.uniform(), 10 + random.uniform(), -7 * random.uniform();
  }
  const std::vector<int> order = space_order(points);
  std::vector<int> sorted = order;
  std::ranges::sort(sorted);
  double way = 0;
  double given = 0;
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    ASSERT_EQ(sorted[static_cast<std::size_t>(i)], i);
    if (i == 0) continue;
    const auto k = static_cast<std::size_t>(i);
    way += (points.row(order[k]) - points.row(order[k - 1])).norm();
    given += (points.row(i) - points.row(i - 1)).norm();
  }
  EXPECT_LT(way, 0.2 * given);
  EXPECT_TRUE(space_order(Points(0, 3)).empty());
  EXPECT_EQ(space_order(Points::Zero(3, 3)), (std::vector{0, 1, 2}));
}

TEST(NearestOnTriangle, IsNoFurtherThanAnyOtherPoint) {
  Random random(11);
  for (int i = 0; i < 2000; ++i) {
    const double thin = i % 2 == 0 ? 1 : std::pow(10, random.uniform(-16, 0));
    const Eigen::Vector3d a = random.direction();
    const Eigen::Vector3d b = a + random.direction();
    const Eigen::Vector3d c = a + random.uniform(-1, 2) * (b - a) + thin * random.direction();
    const Eigen::Vector3d p = 2 * random.direction();
    const auto at = [&](const Eigen::Vector3d& weights) -> Eigen::Vector3d {
      return weights[0] * a + weights[1] * b + weights[2] * c;
    };
    const double distance = (at(nearest_on_triangle(p, a, b, c)) - p).norm();
    for (int j = 0; j < 50; ++j) {
      Eigen::Vector3d other(random.uniform(), random.uniform(), random.uniform());
      if (j % 3 == 0) other[j % 9 / 3] = 0;
      other /= other.sum();
      EXPECT_LE(distance, (at(other) - p).norm() + 1e-14);
    }
  }
}

}  // namespace
}  // namespace orbifit
