#include "orbifit/detection/detect.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include <gtest/gtest.h>

#include "orbifit/datasets_tools/generate.h"
#include "orbifit/model/errors.h"

#include "base/random.h"
#include "models/orbit_model.h"
#include "shapes.h"

namespace orbifit {
namespace {

using Eigen::Vector3d;

SymmetryAnnotation found_in(const Mesh& mesh, double tolerance = 0.005, int threads = 1) {
  DetectOptions options;
  options.tolerance = tolerance;
  RunContext context;
  context.threads = threads;
  return detect(mesh, options, context);
}

std::vector<std::string> summary(const SymmetryAnnotation& annotation) {
  std::vector<std::string> lines;
  for (const Region& region : annotation.regions) {
    lines.push_back(region.group.symbol() + " on " + std::to_string(region.faces.size()));
  }
  for (const Pattern& pattern : annotation.patterns) {
    lines.push_back(to_string(pattern.kind) + " of " + std::to_string(pattern.instances.size()));
  }
  std::ranges::sort(lines);
  return lines;
}

const Region* region_of(const SymmetryAnnotation& annotation, const std::string& symbol, std::size_t faces) {
  for (const Region& region : annotation.regions) {
    if (region.group.symbol() == symbol && region.faces.size() == faces) return &region;
  }
  return nullptr;
}

class EveryFiniteGroup : public testing::TestWithParam<const char*> {};

TEST_P(EveryFiniteGroup, IsFoundAsItIsAndWhereItIs) {
  const PointGroup group = *PointGroup::parse(GetParam());
  Random random(11, GetParam());
  OrbitOptions options;
  options.frame = random.rotation();
  options.subdivisions = 1;
  options.radius = std::pow(10, random.uniform(-3, 3));
  options.centre = random.uniform(0, 1e4) * random.direction();
  const GeneratedModel model = generate_orbit(group, options);
  const SymmetryAnnotation annotation = found_in(model.mesh);
  ASSERT_EQ(annotation.regions.size(), 1U) << ::testing::PrintToString(summary(annotation));
  const Region& region = annotation.regions.front();
  EXPECT_EQ(region.group.symbol(), GetParam());
  EXPECT_EQ(region.faces.size(), static_cast<std::size_t>(model.mesh.faces.rows()));
  EXPECT_TRUE(closed(region.elements, options.radius + options.centre.norm(), 1e-12));
  EXPECT_LT(region.residual.max, 1e-6);
  // Every true element is among those found, on the whole body.
  const double reach = annotation.mesh_diagonal;
  for (const Motion& element : model.truth.regions.front().elements) {
    double nearest = 1e300;
    for (const Motion& other : region.elements) {
      nearest = std::min(nearest, motion_distance(element, other, options.centre, reach));
    }
    EXPECT_LT(nearest, 1e-3 * annotation.mesh_diagonal);
  }
}

INSTANTIATE_TEST_SUITE_P(Groups, EveryFiniteGroup,
                         testing::Values("Cs", "Ci", "C2", "C3", "C4", "C5", "C6", "C7", "C11", "C2v", "C3v", "C4v",
                                         "C5v", "C8v", "C2h", "C3h", "C4h", "C5h", "C6h", "D2", "D3", "D4", "D5", "D6",
                                         "D2h", "D3h", "D4h", "D5h", "D6h", "D2d", "D3d", "D4d", "D5d", "S4", "S6",
                                         "S8", "S10", "T", "Td", "Th", "O", "Oh", "I", "Ih"));

TEST(Detect, FindsNothingWhereThereIsNothing) {
  const SymmetryAnnotation annotation = found_in(test::scalene());
  EXPECT_TRUE(annotation.regions.empty());
  EXPECT_TRUE(annotation.patterns.empty());
  EXPECT_TRUE(found_in(generate_orbit(*PointGroup::parse("C1")).mesh).regions.empty());
}

TEST(Detect, TheTolerancesTellANearMiss) {
  const SymmetryAnnotation tight = found_in(test::box(1, 1.006, 2), 0.0008);
  ASSERT_EQ(tight.regions.size(), 1U);
  EXPECT_EQ(tight.regions[0].group.symbol(), "D2h");
  EXPECT_EQ(found_in(test::box(1, 1.006, 2)).regions[0].group.symbol(), "D4h");
}

class Models : public testing::TestWithParam<const char*> {};

TEST_P(Models, TheirRegionsAreFound) {
  const GeneratedModel model = generate(GetParam());
  const SymmetryAnnotation annotation = found_in(model.mesh);
  int found = 0;
  for (const Region& truth : model.truth.regions) {
    found += region_of(annotation, truth.group.symbol(), truth.faces.size()) != nullptr ? 1 : 0;
  }
  // Parts that repeat a larger region's group, and unions without a name of their own, may go unsaid.
  EXPECT_GE(2 * found, static_cast<int>(model.truth.regions.size())) << ::testing::PrintToString(summary(annotation));
  for (const Region& region : annotation.regions) EXPECT_LT(region.residual.rms, 0.005) << region.name;
}

INSTANTIATE_TEST_SUITE_P(Generated, Models, testing::Values("chair", "table", "fan", "wheel", "bar"));

TEST(Detect, ATableAndItsLegs) {
  const GeneratedModel model = generate("table");
  const SymmetryAnnotation annotation = found_in(model.mesh);
  const Region* whole = region_of(annotation, "C4v", static_cast<std::size_t>(model.mesh.faces.rows()));
  ASSERT_NE(whole, nullptr);
  EXPECT_FALSE(whole->parent.has_value());
  for (const Region& region : annotation.regions) {
    if (&region != whole) {
      EXPECT_TRUE(region.parent.has_value()) << region.name;
    }
  }
}

TEST(Detect, OneMissingBoltIsNotAveragedAway) {
  const auto plate = [](int missing) {
    std::vector<Mesh> parts{test::prism(40, 1, 0.3)};
    for (int i = 0; i < 8; ++i) {
      if (i == missing) continue;
      const Mesh bolt = test::moved(test::box(0.12, 0.16, 0.2), test::shift(0.7, 0, 0.25));
      parts.push_back(test::moved(bolt, Motion::rotation({0, 0, 1}, i * std::numbers::pi / 4, {0, 0, 0})));
    }
    return test::joined(parts);
  };
  const Mesh full = plate(-1);
  const SymmetryAnnotation all = found_in(full);
  EXPECT_NE(region_of(all, "C8v", static_cast<std::size_t>(full.faces.rows())), nullptr);
  const Mesh lacking = plate(3);
  const SymmetryAnnotation fewer = found_in(lacking);
  EXPECT_EQ(region_of(fewer, "C8v", static_cast<std::size_t>(lacking.faces.rows())), nullptr);
  EXPECT_NE(region_of(fewer, "Cs", static_cast<std::size_t>(lacking.faces.rows())), nullptr)
      << ::testing::PrintToString(summary(fewer));
}

TEST(Detect, ARowOfCopiesIsALattice) {
  std::vector<Mesh> parts;
  for (int i = 0; i < 4; ++i) parts.push_back(test::moved(test::scalene(), test::shift(1.5 * i, 0.2 * i, 0)));
  const SymmetryAnnotation annotation = found_in(test::joined(parts));
  EXPECT_TRUE(annotation.regions.empty()) << ::testing::PrintToString(summary(annotation));
  ASSERT_EQ(annotation.patterns.size(), 1U);
  EXPECT_EQ(annotation.patterns[0].kind, Pattern::Kind::translation_1d);
  EXPECT_LT((annotation.patterns[0].generators[0].translation.cwiseAbs() - Vector3d(1.5, 0.2, 0)).norm(), 1e-9);
  EXPECT_LT(annotation.patterns[0].residual.max, 1e-9);
}

TEST(Detect, AHiddenMirrorPairIsAPattern) {
  // The image is not related by any symmetry of the pair when a third body stands aside.
  const Mesh part = test::scalene();
  const Motion image{axis_rotation(Vector3d(1, 2, 3).normalized(), 0.9), Vector3d(2, 0.3, 0.4)};
  const SymmetryAnnotation annotation = found_in(test::joined({part, test::moved(part, image)}));
  ASSERT_EQ(annotation.patterns.size(), 1U);
  EXPECT_LT(motion_distance(annotation.patterns[0].instances[1].motion, image, Vector3d::Zero(), 1), 1e-6);
}

TEST(Detect, SameForAnyNumberOfThreadsAndAnyRun) {
  const Mesh mesh = generate("table").mesh;
  const SymmetryAnnotation one = found_in(mesh, 0.005, 1);
  const SymmetryAnnotation three = found_in(mesh, 0.005, 3);
  ASSERT_EQ(one.regions.size(), three.regions.size());
  for (std::size_t i = 0; i < one.regions.size(); ++i) {
    EXPECT_EQ(one.regions[i].centre, three.regions[i].centre);
    EXPECT_EQ(one.regions[i].faces, three.regions[i].faces);
    EXPECT_EQ(one.regions[i].residual.rms, three.regions[i].residual.rms);
    for (std::size_t e = 0; e < one.regions[i].elements.size(); ++e) {
      EXPECT_EQ(one.regions[i].elements[e].linear, three.regions[i].elements[e].linear);
    }
  }
}

TEST(Detect, SameForAnyPoseScaleAndOrder) {
  const Mesh mesh = generate("chair").mesh;
  const std::vector<std::string> expected = summary(found_in(mesh));
  Random random(21);
  for (int trial = 0; trial < 2; ++trial) {
    Mesh other = mesh;
    const Eigen::Matrix3d turn = random.rotation();
    const double scale = trial == 0 ? 1e-3 : 1e3;
    other.vertices = scale * other.vertices * turn.transpose();
    other.vertices.rowwise() += 1e4 * random.direction().transpose();
    // Vertices and faces in another order.
    std::vector<int> order(static_cast<std::size_t>(mesh.vertices.rows()));
    std::iota(order.begin(), order.end(), 0);
    for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random.below(i)]);
    Mesh shuffled = other;
    std::vector<int> place(order.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
      shuffled.vertices.row(static_cast<Eigen::Index>(i)) = other.vertices.row(order[i]);
      place[static_cast<std::size_t>(order[i])] = static_cast<int>(i);
    }
    for (Eigen::Index f = 0; f < other.faces.rows(); ++f) {
      for (int k = 0; k < 3; ++k) {
        shuffled.faces(other.faces.rows() - 1 - f, k) = place[static_cast<std::size_t>(other.faces(f, k))];
      }
    }
    shuffled.polygon_of_face.clear();
    EXPECT_EQ(summary(found_in(shuffled)), expected);
  }
}

TEST(Detect, AnArmThatIsShorterDoesNotHideWhatItShares) {
  std::vector<Mesh> parts{test::subdivided(test::prism(6, 0.6, 0.5), 4)};
  for (int k = 0; k < 3; ++k) {
    const double length = k == 0 ? 1.1 : 2;
    const Mesh arm = test::moved(test::subdivided(test::box(length, 0.3, 0.2), 5), test::shift(0.3 + length / 2, 0, 0));
    parts.push_back(test::moved(arm, Motion::rotation(Vector3d::UnitZ(), 2 * k * std::numbers::pi / 3, {0, 0, 0})));
  }
  const Mesh mesh = test::joined(parts);
  // Of each arm the C2v that it has with the hub is listed, which overlap on the hub and generate the D3h there.
  const SymmetryAnnotation listed = found_in(mesh);
  EXPECT_EQ(std::ranges::count_if(listed.regions,
                                  [&](const Region& r) {
                                    return r.group.symbol() == "C2v" &&
                                           r.faces.size() >= static_cast<std::size_t>(parts[0].faces.rows());
                                  }),
            3)
      << ::testing::PrintToString(summary(listed));
  DetectOptions options;
  options.all = true;
  RunContext context;
  const SymmetryAnnotation annotation = detect(mesh, options, context);
  const auto whole = std::ranges::find_if(listed.regions, [](const Region& r) { return r.group.symbol() == "C2v"; });
  ASSERT_NE(whole, listed.regions.end());
  EXPECT_EQ(whole->faces.size(), static_cast<std::size_t>(mesh.faces.rows()));
  const auto of_turns = std::ranges::find_if(annotation.regions, [&](const Region& r) {
    return r.group.symbol() == "D3h" && r.faces.size() > static_cast<std::size_t>(parts[0].faces.rows());
  });
  ASSERT_NE(of_turns, annotation.regions.end()) << ::testing::PrintToString(summary(annotation));
  for (const int f : of_turns->faces) {
    EXPECT_LT(face_centroids(mesh).row(f).head<2>().norm(), 1.45) << "beyond the shorter arm";
  }
}

TEST(Detect, StopsWhenToldTo) {
  const Mesh mesh = generate("chair").mesh;
  DetectOptions options;
  RunContext context;
  context.deadline = std::chrono::steady_clock::now() - std::chrono::seconds(1);
  EXPECT_THROW(detect(mesh, options, context), TimeoutError);
  context.deadline.reset();
  options.time_budget = 1e-6;
  EXPECT_LE(detect(mesh, options, context).regions.size(), 1U) << "what is verified by then";
}

TEST(DetectOptions, NamesWhatIsWrong) {
  DetectOptions options;
  options.tolerance = 0.5;
  EXPECT_THROW(options.validate(), UsageError);
  options = {};
  options.samples = 5;
  EXPECT_THROW(options.validate(), UsageError);
  options = {};
  options.time_budget = -1;
  try {
    options.validate();
    FAIL();
  } catch (const UsageError& error) {
    EXPECT_NE(std::string(error.what()).find("time_budget"), std::string::npos);
  }
}

}  // namespace
}  // namespace orbifit
