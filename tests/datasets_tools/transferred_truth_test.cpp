#include "truth/transferred_truth.h"

#include <algorithm>
#include <numeric>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "orbifit/datasets_tools/generate.h"
#include "orbifit/model/errors.h"

#include "cases/spoil.h"
#include "geometry/surface_index.h"
#include "models/orbit_model.h"
#include "remeshing/remesh.h"
#include "solids.h"

namespace orbifit {
namespace {

Eigen::Vector3d corner_heights(const Mesh& mesh, int face) {
  const auto height = [&](int k) { return mesh.vertices(mesh.faces(face, k), 2); };
  return {height(0), height(1), height(2)};
}

using Eigen::Vector3d;
using Family = PointGroup::Family;

TruthModel as_truth(GeneratedModel model) {
  return {std::move(model.mesh), {std::move(model.truth), {}, {}, {}}};
}

TruthModel with_region(const Mesh& mesh, Region region) {
  TruthModel model{mesh, {}};
  model.truth.expected = empty_annotation(mesh, 0.005);
  model.truth.expected.regions.push_back(std::move(region));
  return model;
}

std::vector<int> range(int first, int count) {
  std::vector<int> result(static_cast<std::size_t>(count));
  std::iota(result.begin(), result.end(), first);
  return result;
}

double area_of(const Mesh& mesh, const std::vector<int>& faces) {
  return faces.empty() ? 0 : face_areas(mesh)(faces).sum();
}

const Region* find_region(const std::vector<Region>& regions, const std::string& name) {
  const auto found = std::ranges::find(regions, name, &Region::name);
  return found == regions.end() ? nullptr : &*found;
}

TEST(CarriedTruth, StaysOnASubdividedMesh) {
  for (const char* name : {"chair", "table"}) {
    const TruthModel model = as_truth(generate(name));
    const Derived fine = subdivided(model.mesh, 0.02);
    RunContext context;
    const DetectionTruth truth = transferred_truth(model, fine.mesh, fine.source_face, {}, context);
    EXPECT_EQ(truth.expected.mesh_faces, fine.mesh.faces.rows());
    EXPECT_EQ(truth.expected.mesh_vertices, fine.mesh.vertices.rows());
    EXPECT_EQ(truth.expected.mesh_diagonal, diagonal(fine.mesh.vertices));
    ASSERT_EQ(truth.expected.regions.size(), model.truth.expected.regions.size());
    for (std::size_t r = 0; r < truth.expected.regions.size(); ++r) {
      const Region& before = model.truth.expected.regions[r];
      const Region& after = truth.expected.regions[r];
      EXPECT_EQ(after.id, before.id);
      EXPECT_EQ(after.group, before.group);
      EXPECT_EQ(after.parent, before.parent);
      EXPECT_NEAR(area_of(fine.mesh, after.faces), area_of(model.mesh, before.faces), 1e-9);
      EXPECT_LT(after.residual.max, 1e-12);
    }
    EXPECT_EQ(truth.expected.patterns.size(), model.truth.expected.patterns.size());
    EXPECT_TRUE(truth.optional_regions.empty());
  }
}

class CarriedOrbit : public testing::TestWithParam<std::string> {};

TEST_P(CarriedOrbit, CoversTheRemeshedOrbit) {
  const TruthModel model = as_truth(generate_orbit(PointGroup::parse(GetParam()).value()));
  RunContext context;
  const Remeshed remeshed = remesh(model.mesh, {.cell = 1.0 / 90}, context);
  const DetectionTruth truth = transferred_truth(model, remeshed.mesh, remeshed.source_face, {}, context);
  ASSERT_EQ(truth.expected.regions.size(), 1U);
  const Region& region = truth.expected.regions.front();
  EXPECT_EQ(region.group.symbol(), GetParam());
  EXPECT_GT(area_of(remeshed.mesh, region.faces), 0.95 * face_areas(remeshed.mesh).sum());
  EXPECT_LT(region.residual.rms, 1e-3);
  EXPECT_LE(region.residual.rms, region.residual.max);
  EXPECT_LE(region.residual.max, 0.005);
}

INSTANTIATE_TEST_SUITE_P(Groups, CarriedOrbit, testing::Values("Cs", "Ci", "C5", "C3v", "D4", "D2d", "S6", "Th", "O"));

TEST(CarriedTruth, NestsTheRegionsOfARemeshedChair) {
  const TruthModel model = as_truth(generate("chair"));
  RunContext context;
  const Remeshed remeshed = remesh(model.mesh, {}, context);
  const DetectionTruth truth = transferred_truth(model, remeshed.mesh, remeshed.source_face, {}, context);
  const std::vector<Region>& regions = truth.expected.regions;
  const Region* whole = find_region(regions, "chair");
  const Region* lower = find_region(regions, "seat and legs");
  const Region* leg = find_region(regions, "leg 1");
  ASSERT_TRUE(whole != nullptr && lower != nullptr && leg != nullptr);
  EXPECT_EQ(lower->parent, whole->id);
  EXPECT_EQ(leg->parent, lower->id);
  EXPECT_EQ(static_cast<Eigen::Index>(whole->faces.size()), remeshed.mesh.faces.rows());
  // Bars between legs have lost both their ends: any length would do.
  EXPECT_EQ(find_region(regions, "bar 1"), nullptr);
  EXPECT_NE(find_region(truth.optional_regions, "bar 1"), nullptr);
  ASSERT_EQ(truth.expected.patterns.size(), 1U);
  EXPECT_EQ(truth.expected.patterns.front().instances.size(), model.truth.expected.patterns.front().instances.size());

  std::set<int> ids;
  for (const auto* list : {&truth.expected.regions, &truth.optional_regions}) {
    for (const Region& region : *list) {
      EXPECT_TRUE(ids.insert(region.id).second);
      EXPECT_TRUE(std::ranges::is_sorted(region.faces));
      EXPECT_FALSE(region.faces.empty());
    }
  }
  for (const auto& [id, sets] : truth.also_accepted) {
    EXPECT_TRUE(ids.contains(id));
    for (const std::vector<int>& faces : sets) EXPECT_TRUE(std::ranges::is_sorted(faces));
  }
}

// A cylinder-like prism from z = 0 to 4 with its ends.
Mesh prism(int sides, double low, double high) {
  Mesh mesh;
  mesh.vertices.resize(2 * sides + 2, 3);
  mesh.faces.resize(4 * sides, 3);
  for (int i = 0; i < sides; ++i) {
    const double angle = 2 * 3.14159265358979323846 * i / sides;
    mesh.vertices.row(i) << std::cos(angle), std::sin(angle), low;
    mesh.vertices.row(sides + i) << std::cos(angle), std::sin(angle), high;
    const int next = (i + 1) % sides;
    mesh.faces.row(4 * i) << i, next, sides + next;
    mesh.faces.row(4 * i + 1) << i, sides + next, sides + i;
    mesh.faces.row(4 * i + 2) << 2 * sides, next, i;
    mesh.faces.row(4 * i + 3) << 2 * sides + 1, sides + i, sides + next;
  }
  mesh.vertices.row(2 * sides) << 0, 0, low;
  mesh.vertices.row(2 * sides + 1) << 0, 0, high;
  return mesh;
}

class RoundBar : public testing::Test {
 protected:
  RoundBar() {
    const Mesh bar = prism(64, -3, 3);
    model_ = with_region(bar, make_region({Family::Dinfh, 1}, Vector3d::Zero(), GroupFrame::Identity(),
                                          range(0, static_cast<int>(bar.faces.rows())), "bar"));
    fine_ = subdivided(model_.mesh, 0.03);
  }

  DetectionTruth after(const Derived& rest) {
    std::vector<int> sources;
    for (const int face : rest.source_face) sources.push_back(fine_.source_face[static_cast<std::size_t>(face)]);
    RunContext context;
    return transferred_truth(model_, rest.mesh, sources, {}, context);
  }

  TruthModel model_;
  Derived fine_;
};

TEST_F(RoundBar, KeepsItsGroupWhole) {
  RunContext context;
  const DetectionTruth truth = transferred_truth(model_, fine_.mesh, fine_.source_face, {}, context);
  ASSERT_EQ(truth.expected.regions.size(), 1U);
  EXPECT_EQ(static_cast<Eigen::Index>(truth.expected.regions.front().faces.size()), fine_.mesh.faces.rows());
}

TEST_F(RoundBar, LosesTheImagesOfWhatIsCutAway) {
  // One end goes: the other end's mirror image and its surroundings must go from the region as well.
  const Derived rest = cut(fine_.mesh, HalfSpace{{0, 0, 2}, {0, 0, 1}});
  const DetectionTruth truth = after(rest);
  ASSERT_EQ(truth.also_accepted.size(), 1U);
  ASSERT_EQ(truth.optional_regions.size(), 1U);
  const std::vector<int>& faces = truth.optional_regions.front().faces;
  ASSERT_FALSE(faces.empty());
  double lowest = 0;
  for (const int face : faces) {
    lowest = std::min(lowest, corner_heights(rest.mesh, face).minCoeff());
  }
  EXPECT_GT(lowest, -2.3);
  EXPECT_LT(lowest, -1.8);
  // What is left is a tube that slides along its axis.
  EXPECT_TRUE(truth.expected.regions.empty());
}

TEST_F(RoundBar, BecomesOptionalWithoutItsEnds) {
  const Derived once = cut(fine_.mesh, HalfSpace{{0, 0, 2.9}, {0, 0, 1}});
  Derived twice = cut(once.mesh, HalfSpace{{0, 0, -2.9}, {0, 0, -1}});
  for (int& face : twice.source_face) face = once.source_face[static_cast<std::size_t>(face)];
  const DetectionTruth truth = after(twice);
  EXPECT_TRUE(truth.expected.regions.empty());
  ASSERT_EQ(truth.optional_regions.size(), 1U);
  EXPECT_EQ(static_cast<Eigen::Index>(truth.optional_regions.front().faces.size()), twice.mesh.faces.rows());
}

TEST_F(RoundBar, LosesEveryCircleThatANotchBreaks) {
  // A notch in the middle of the bar, a fifth of a turn wide: the bar is round only away from it.
  const Derived rest = cut(fine_.mesh, CutBall{{1, 0, 0}, 0.6});
  const DetectionTruth truth = after(rest);
  const std::vector<Region>& regions = truth.expected.regions.empty() ? truth.optional_regions : truth.expected.regions;
  ASSERT_EQ(regions.size(), 1U);
  const Points& vertices = rest.mesh.vertices;
  double broken = 0;
  double kept = 0;
  const Eigen::VectorXd areas = face_areas(rest.mesh);
  for (Eigen::Index f = 0; f < rest.mesh.faces.rows(); ++f) {
    const Vector3d centroid = vertices(rest.mesh.faces.row(f), Eigen::all).colwise().mean();
    if (std::abs(centroid.z()) < 0.4 && std::hypot(centroid.x(), centroid.y()) > 0.9) {
      broken += areas[f];
      if (std::ranges::binary_search(regions.front().faces, static_cast<int>(f))) kept += areas[f];
    }
    if (std::abs(centroid.z()) > 0.9) {
      EXPECT_TRUE(std::ranges::binary_search(regions.front().faces, static_cast<int>(f)));
    }
  }
  EXPECT_GT(broken, 3);
  EXPECT_LT(kept, 0.02 * broken);
}

TEST_F(RoundBar, IsNotKeptByAWrongGroup) {
  // Tilted axis: hardly a face stays on the bar.
  const GroupFrame tilted = axis_rotation(Vector3d::UnitX(), 0.2);
  model_.truth.expected.regions.front() =
      make_region({Family::Dinfh, 1}, Vector3d::Zero(), tilted, model_.truth.expected.regions.front().faces, "bar");
  RunContext context;
  const DetectionTruth truth = transferred_truth(model_, fine_.mesh, fine_.source_face, {}, context);
  EXPECT_TRUE(truth.expected.regions.empty());
}

TEST(CarriedTruth, DropsSmallRegionsAndSpoiltPatterns) {
  // Five posts of a row on a plate, one of them cut off but for its foot.
  std::vector<Mesh> parts{test::solid_box({-1, -1, -0.5}, {9, 1, 0})};
  Pattern row;
  row.kind = Pattern::Kind::translation_1d;
  row.name = "posts";
  row.generators.push_back({Eigen::Matrix3d::Identity(), 2 * Vector3d::UnitX()});
  for (int i = 0; i < 5; ++i) {
    parts.push_back(test::solid_box({2.0 * i - 0.3, -0.2, -0.2}, {2.0 * i + 0.3, 0.2, 1.5}));
    row.instances.push_back({{Eigen::Matrix3d::Identity(), 2.0 * i * Vector3d::UnitX()}, range(12 * i + 12, 12)});
  }
  parts.push_back(test::solid_box({8.7, 0.7, -0.1}, {8.8, 0.8, 0.1}));
  TruthModel model{test::joined_meshes(parts), {}};
  model.truth.expected = empty_annotation(model.mesh, 0.005);
  model.truth.expected.patterns.push_back(row);
  model.truth.expected.regions.push_back(
      make_region({Family::Dnh, 2}, {4, 0, -0.25}, GroupFrame::Identity(), range(0, 12), "plate"));
  model.truth.expected.regions.push_back(
      make_region({Family::Dnh, 4}, {8.75, 0.75, 0}, GroupFrame::Identity(), range(72, 12), "knob"));
  model.truth.expected.regions.back().id = 1;

  const Derived fine = subdivided(model.mesh, 0.02);
  RunContext context;
  const DetectionTruth whole = transferred_truth(model, fine.mesh, fine.source_face, {}, context);
  ASSERT_EQ(whole.expected.patterns.size(), 1U);
  EXPECT_LT(whole.expected.patterns.front().residual.max, 1e-9);
  EXPECT_NE(find_region(whole.expected.regions, "plate"), nullptr);
  // 0.1 by 0.1 by 0.2 of more than 50.
  EXPECT_EQ(find_region(whole.expected.regions, "knob"), nullptr);
  EXPECT_EQ(find_region(whole.optional_regions, "knob"), nullptr);
  const DetectionTruth large =
      transferred_truth(model, fine.mesh, fine.source_face, {.least_expected = 0, .least_area = 0}, context);
  EXPECT_NE(find_region(large.expected.regions, "knob"), nullptr);

  Derived rest = cut(fine.mesh, CutBall{{4, 0, 1.2}, 1.0});
  for (int& face : rest.source_face) face = fine.source_face[static_cast<std::size_t>(face)];
  const DetectionTruth spoilt = transferred_truth(model, rest.mesh, rest.source_face, {}, context);
  EXPECT_TRUE(spoilt.expected.patterns.empty());
  EXPECT_TRUE(spoilt.optional_patterns.empty());
}

TEST(CarriedTruth, KeepsOfAPatternWhatAllInstancesShow) {
  // Three posts; a slab hides the lower half of the last one.
  std::vector<Mesh> parts;
  Pattern row;
  row.kind = Pattern::Kind::translation_1d;
  row.generators.push_back({Eigen::Matrix3d::Identity(), 2 * Vector3d::UnitX()});
  for (int i = 0; i < 3; ++i) {
    parts.push_back(test::solid_box({2.0 * i, 0, 0}, {2.0 * i + 1, 1, 3}));
    row.instances.push_back({{Eigen::Matrix3d::Identity(), 2.0 * i * Vector3d::UnitX()}, range(12 * i, 12)});
  }
  parts.push_back(test::solid_box({3.5, -0.5, -0.5}, {5.5, 1.5, 0.7}));
  TruthModel model{test::joined_meshes(parts), {}};
  model.truth.expected = empty_annotation(model.mesh, 0.005);
  model.truth.expected.patterns.push_back(row);
  RunContext context;
  const Remeshed remeshed = remesh(model.mesh, {}, context);
  const DetectionTruth truth = transferred_truth(model, remeshed.mesh, remeshed.source_face, {}, context);
  ASSERT_EQ(truth.expected.patterns.size(), 1U);
  for (const PatternInstance& instance : truth.expected.patterns.front().instances) {
    // Four sides above the slab and the top; twice the tolerance and a face more.
    EXPECT_NEAR(area_of(remeshed.mesh, instance.faces), 4 * 2.3 + 1, 0.4);
    double lowest = 3;
    for (const int face : instance.faces) {
      lowest = std::min(lowest, corner_heights(remeshed.mesh, face).maxCoeff());
    }
    EXPECT_GT(lowest, 0.55);
  }
  const DetectionTruth strict =
      transferred_truth(model, remeshed.mesh, remeshed.source_face, {.least_kept = 0.9}, context);
  EXPECT_TRUE(strict.expected.patterns.empty());
  EXPECT_EQ(strict.optional_patterns.size(), 1U);
}

TEST(CarriedTruth, LeavesTheLesserOfTwoGroupsOnTheSameFacesOptional) {
  const Mesh box = test::solid_box({-1, -1, -2}, {1, 1, 2});
  TruthModel model =
      with_region(box, make_region({Family::Cnv, 2}, Vector3d::Zero(), GroupFrame::Identity(), range(0, 12), "lesser"));
  model.truth.expected.regions.push_back(
      make_region({Family::Dnh, 4}, Vector3d::Zero(), GroupFrame::Identity(), range(0, 12), "greater"));
  model.truth.expected.regions.back().id = 1;
  const Derived fine = subdivided(box, 0.05);
  RunContext context;
  const DetectionTruth truth = transferred_truth(model, fine.mesh, fine.source_face, {}, context);
  ASSERT_EQ(truth.expected.regions.size(), 1U);
  EXPECT_EQ(truth.expected.regions.front().name, "greater");
  ASSERT_EQ(truth.optional_regions.size(), 1U);
  EXPECT_EQ(truth.optional_regions.front().name, "lesser");
}

TEST(CarriedTruth, CarriesWhatIsOptionalAndAcceptedBesides) {
  const Mesh box = test::solid_box({-1, -1, -2}, {1, 1, 2});
  TruthModel model =
      with_region(box, make_region({Family::Dnh, 4}, Vector3d::Zero(), GroupFrame::Identity(), range(0, 12), "box"));
  model.truth.optional_regions.push_back(
      make_region({Family::Dnh, 2}, Vector3d::Zero(), GroupFrame::Identity(), range(0, 12), "half"));
  model.truth.optional_regions.back().id = 4;
  model.truth.also_accepted[0] = {range(0, 8)};
  const Derived fine = subdivided(box, 0.1);
  RunContext context;
  const DetectionTruth truth = transferred_truth(model, fine.mesh, fine.source_face, {}, context);
  ASSERT_EQ(truth.expected.regions.size(), 1U);
  ASSERT_EQ(truth.optional_regions.size(), 1U);
  EXPECT_EQ(truth.optional_regions.front().id, 4);
  ASSERT_EQ(truth.also_accepted.count(0), 1U);
  ASSERT_EQ(truth.also_accepted.at(0).size(), 1U);
  for (std::size_t f = 0; f < fine.source_face.size(); ++f) {
    EXPECT_EQ(std::ranges::binary_search(truth.also_accepted.at(0).front(), static_cast<int>(f)),
              fine.source_face[f] < 8);
  }
}

TEST(CarriedTruth, DoesNotDependOnThreads) {
  const TruthModel model = as_truth(generate("wheel"));
  RunContext context;
  const Remeshed remeshed = remesh(model.mesh, {.cell = 1.0 / 60}, context);
  const DetectionTruth one = transferred_truth(model, remeshed.mesh, remeshed.source_face, {}, context);
  context.threads = 2;
  const DetectionTruth two = transferred_truth(model, remeshed.mesh, remeshed.source_face, {}, context);
  ASSERT_EQ(one.expected.regions.size(), two.expected.regions.size());
  ASSERT_FALSE(one.expected.regions.empty());
  for (std::size_t r = 0; r < one.expected.regions.size(); ++r) {
    EXPECT_EQ(one.expected.regions[r].faces, two.expected.regions[r].faces);
    EXPECT_EQ(one.expected.regions[r].residual.rms, two.expected.regions[r].residual.rms);
    EXPECT_EQ(one.expected.regions[r].residual.max, two.expected.regions[r].residual.max);
  }
}

TEST(CarriedTruth, RefusesSourcesThatDoNotFit) {
  const Mesh box = test::solid_box({-1, -1, -2}, {1, 1, 2});
  const TruthModel model =
      with_region(box, make_region({Family::Dnh, 4}, Vector3d::Zero(), GroupFrame::Identity(), range(0, 12), "box"));
  RunContext context;
  EXPECT_THROW(transferred_truth(model, box, range(0, 11), {}, context), InputError);
  EXPECT_THROW(transferred_truth(model, box, range(1, 12), {}, context), InputError);
  EXPECT_THROW(transferred_truth(model, box, range(-1, 12), {}, context), InputError);
  EXPECT_THROW(transferred_truth(model, box, range(0, 12), {.tolerance = 0}, context), UsageError);
  EXPECT_THROW(transferred_truth(model, box, range(0, 12), {.least_kept = 2}, context), UsageError);
  EXPECT_THROW(transferred_truth(model, box, range(0, 12), {.least_expected = 0.001}, context), UsageError);
}

}  // namespace
}  // namespace orbifit
