#include "evidence/noise_check.h"

#include <cmath>
#include <numeric>
#include <ostream>
#include <string>

#include <gtest/gtest.h>

#include "base/random.h"
#include "resolution/denoise.h"
#include "shapes.h"

namespace orbifit {
namespace {

using Eigen::Vector3d;

Mesh with_noise(Mesh mesh, double sigma) {
  Random random(3);
  for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) mesh.vertices(v, 2) += sigma * random.normal();
  return mesh;
}

// What detection makes of a noisy mesh, and a mirror claimed for all of it.
struct Claim {
  PreparedMesh given, clean;
  double sigma;
  FoundRegion region;

  explicit Claim(const Mesh& mesh) : given(prepare(mesh)), clean(given), sigma(noise_of(given)) {
    denoise(clean, sigma, {});
    const Similarity& input = given.input_of_normalised;
    const GroupPlacement mirror{*PointGroup::parse("Cs"), frame_about(Vector3d::UnitX()),
                                -input.translation / input.scale};
    region = {mirror, std::vector<int>(static_cast<std::size_t>(mesh.faces.rows())), given.area, "all"};
    std::iota(region.faces.begin(), region.faces.end(), 0);
  }
};

const RunContext kQuiet;  // which checks keep

class NoisyHills : public testing::TestWithParam<double> {};

TEST_P(NoisyHills, AreSymmetricAsFarAsNoiseLetsThem) {
  const Claim claim(with_noise(test::hills(60, 0), GetParam()));
  EXPECT_NEAR(claim.sigma, GetParam() / diagonal(test::hills(60, 0).vertices), 0.25 * GetParam() + 1e-5);
  const NoiseCheck check(claim.given, claim.clean, claim.sigma, test::kTolerance, kQuiet);
  EXPECT_TRUE(check.holds(claim.region));
  const NoiseCheck::Share share = check.share(claim.region);
  EXPECT_NEAR(share.kept, share.expected, 0.04);
}

TEST_P(NoisyHills, AreNotWhereTheyDifferByMoreThanTheTolerance) {
  const Claim claim(with_noise(test::hills(60, 0.008), GetParam()));
  const NoiseCheck check(claim.given, claim.clean, claim.sigma, test::kTolerance, kQuiet);
  EXPECT_FALSE(check.holds(claim.region));
}

INSTANTIATE_TEST_SUITE_P(Sigma, NoisyHills, testing::Values(0, 0.001, 0.003, 0.006), [](const auto& each) {
  return "PerMille" + std::to_string(static_cast<int>(std::lround(1000 * each.param)));
});

TEST(NoiseCheck, AsksNothingOfNoNoise) {
  const Claim claim(test::hills(60, 0));
  const NoiseCheck check(claim.given, claim.clean, 0, test::kTolerance, kQuiet);
  EXPECT_EQ(check.share(claim.region).expected, 1);
  EXPECT_EQ(check.share(claim.region).kept, 1);
}

}  // namespace
}  // namespace orbifit
