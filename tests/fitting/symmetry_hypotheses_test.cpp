#include "placement/symmetry_hypotheses.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <ostream>

#include <gtest/gtest.h>

#include "orbifit/datasets_tools/generate.h"

#include "poses_apart.h"

namespace orbifit {
namespace {

struct Brought {
  const char* model;
  SymmetryElement::Kind kind;
  int seed;

  friend void PrintTo(const Brought& brought, std::ostream* stream) {
    *stream << brought.model << (brought.kind == SymmetryElement::Kind::plane ? "Plane" : "Axis") << brought.seed;
  }
};

class BroughtBySymmetry : public testing::TestWithParam<Brought> {};

TEST_P(BroughtBySymmetry, OfAPosedElementAndPointHoldThePose) {
  Random random(static_cast<std::uint64_t>(GetParam().seed), GetParam().model);
  const GeneratedModel model = generate(GetParam().model);
  const SurfaceSamples samples = sample_surface(model.mesh, 60, random);
  const Similarity truth{std::exp(random.uniform(-2, 2)), random.rotation(), 5 * random.direction()};
  const std::vector<SymmetryElement> own = template_symmetries(model.mesh, model.truth);
  const SymmetryHypotheses hypotheses(samples, own);
  int proposed = 0;
  double nearest = std::numeric_limits<double>::infinity();
  for (const SymmetryElement& element : own) {
    if (element.kind != GetParam().kind) continue;
    // The sense of a direction says nothing.
    const double sense = random.uniform() < 0.5 ? -1 : 1;
    const SymmetryElement posed{element.kind, truth(element.point), sense * (truth.linear * element.direction), 1};
    for (Eigen::Index i = 0; i < samples.points.rows(); ++i) {
      hypotheses.propose(posed, truth(samples.points.row(i)), truth.linear * samples.normals.row(i).transpose(), 400,
                         random, [&](const Similarity& pose) {
                           ++proposed;
                           nearest = std::min(nearest, poses_apart(samples.points, pose, truth));
                         });
    }
  }
  EXPECT_GT(proposed, 0);
  EXPECT_LT(nearest, 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Models, BroughtBySymmetry,
                         testing::Values(Brought{"chair", SymmetryElement::Kind::plane, 1},
                                         Brought{"armchair", SymmetryElement::Kind::plane, 2},
                                         Brought{"fan", SymmetryElement::Kind::plane, 1},
                                         Brought{"fan", SymmetryElement::Kind::axis, 2}),
                         [](const auto& each) { return testing::PrintToString(each.param); });

struct Elements {
  const char* model;
  std::ptrdiff_t planes, axes;

  friend void PrintTo(const Elements& each, std::ostream* stream) { *stream << each.model; }
};

class TemplateSymmetries : public testing::TestWithParam<Elements> {};

TEST_P(TemplateSymmetries, AreOneOfThoseThatTheGroupMakesOne) {
  const GeneratedModel model = generate(GetParam().model);
  const std::vector<SymmetryElement> found = template_symmetries(model.mesh, model.truth);
  EXPECT_EQ(std::ranges::count(found, SymmetryElement::Kind::plane, &SymmetryElement::kind), GetParam().planes);
  EXPECT_EQ(std::ranges::count(found, SymmetryElement::Kind::axis, &SymmetryElement::kind), GetParam().axes);
}

INSTANTIATE_TEST_SUITE_P(Models, TemplateSymmetries,
                         testing::Values(Elements{"desk_fan", 1, 0}, Elements{"fan", 2, 2}, Elements{"bar", 3, 0}),
                         [](const auto& each) { return testing::PrintToString(each.param); });

}  // namespace
}  // namespace orbifit
