#include "resolution/denoise.h"

#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "base/random.h"
#include "shapes.h"

namespace orbifit {
namespace {

// Rows of prisms whose size grows from the first to the last; together as wide as they are long.
Mesh prisms(int n, double height) {
  constexpr int kRow = 20;
  std::vector<Mesh> parts;
  for (int i = 0; i < kRow * kRow; ++i) {
    const double size = 0.2 + 0.4 * i / (kRow * kRow);
    parts.push_back(
        test::moved(test::prism(n, size, height * size), test::shift(1.5 * (i % kRow), 1.5 * (i / kRow), 0)));
  }
  return test::joined(parts);
}

// Vertices at one place stay together.
Mesh shaken(Mesh mesh, double sigma) {
  Random random(5);
  const PreparedMesh prepared = prepare(mesh);
  Points steps(static_cast<Eigen::Index>(prepared.faces_of_vertex.size()), 3);
  for (Eigen::Index i = 0; i < steps.size(); ++i) steps(i) = sigma * diagonal(mesh.vertices) * random.normal();
  for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) {
    mesh.vertices.row(v) += steps.row(prepared.weld.group_of_vertex[static_cast<std::size_t>(v)]);
  }
  return mesh;
}

struct MadeShape {
  std::string name;
  std::function<Mesh()> make;
};

void PrintTo(const MadeShape& shape, std::ostream* out) {
  *out << shape.name;
}

class ShapeWithoutNoise : public testing::TestWithParam<MadeShape> {};

TEST_P(ShapeWithoutNoise, HasNone) {
  EXPECT_EQ(noise_of(prepare(GetParam().make())), 0);
}

INSTANTIATE_TEST_SUITE_P(Each, ShapeWithoutNoise,
                         testing::Values(MadeShape{"Bolts", [] { return prisms(6, 0.7); }},
                                         MadeShape{"Nuts", [] { return prisms(8, 0.4); }},
                                         MadeShape{"Pins", [] { return prisms(12, 3); }},
                                         MadeShape{"Triangles", [] { return prisms(3, 1); }},
                                         MadeShape{"Hills", [] { return test::hills(60, 0); }},
                                         MadeShape{"Ball", [] { return test::ball(48, 1); }}),
                         [](const auto& each) { return each.param.name; });

class NoiseOn : public testing::TestWithParam<std::tuple<MadeShape, double>> {};

TEST_P(NoiseOn, IsFound) {
  const auto& [shape, sigma] = GetParam();
  EXPECT_NEAR(noise_of(prepare(shaken(shape.make(), sigma))), sigma, 0.25 * sigma);
}

INSTANTIATE_TEST_SUITE_P(
    Each, NoiseOn,
    testing::Combine(testing::Values(MadeShape{"Hills", [] { return test::hills(60, 0); }},
                                     MadeShape{"Box", [] { return test::subdivided(test::box(1, 2, 3), 5); }},
                                     MadeShape{"Ball", [] { return test::ball(100, 1); }}),
                     testing::Values(0.001, 0.002, 0.003)),
    [](const auto& each) {
      return std::get<0>(each.param).name + "PerTenThousand" +
             std::to_string(static_cast<int>(1e4 * std::get<1>(each.param) + 0.5));
    });

}  // namespace
}  // namespace orbifit
