#include "orbifit/subspace/symmetrize.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "orbifit/datasets_tools/generate.h"
#include "orbifit/datasets_tools/symmetry_residual.h"

#include "base/random.h"
#include "geometry/point_index.h"
#include "models/orbit_model.h"
#include "suite/suite_parts.h"

namespace orbifit {
namespace {

// Coincident vertices move together, so that no seams open.
Mesh perturbed(const Mesh& mesh, double size, std::uint64_t seed = 7) {
  Mesh result = mesh;
  const PointIndex index(mesh.vertices);
  Random random(seed, "noise");
  std::vector<char> moved(static_cast<std::size_t>(mesh.vertices.rows()), 0);
  for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) {
    if (moved[static_cast<std::size_t>(v)] != 0) continue;
    const Eigen::RowVector3d step = size * random.direction().transpose();
    for (const auto& same : index.within(mesh.vertices.row(v).transpose(), 1e-9 * diagonal(mesh.vertices))) {
      result.vertices.row(same.index) += step;
      moved[static_cast<std::size_t>(same.index)] = 1;
    }
  }
  return result;
}

// As fraction of the diagonal: a part of the shortest edge, so that the finest wires keep their form.
double bearable_noise(const Mesh& mesh) {
  double shortest = diagonal(mesh.vertices);
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const auto side = mesh.vertices.row(mesh.faces(f, k)) - mesh.vertices.row(mesh.faces(f, (k + 1) % 3));
      if (side.norm() > 1e-9 * diagonal(mesh.vertices)) shortest = std::min(shortest, side.norm());
    }
  }
  return 0.15 * shortest / diagonal(mesh.vertices);
}

double residual(const Mesh& mesh, const SymmetryAnnotation& annotation) {
  RunContext context;
  return symmetry_residual(mesh, annotation, nullptr, CarriedMotions::fixed, context).worst_floor;
}

class SymmetrizeModel : public testing::TestWithParam<std::string> {
 protected:
  GeneratedModel model_ = generate(GetParam());
  double size_ = diagonal(model_.mesh.vertices);
  double noise_ = bearable_noise(model_.mesh);
};

TEST_P(SymmetrizeModel, RecoversThePerturbedTruthExactly) {
  const Mesh rough = perturbed(model_.mesh, noise_ * size_);
  ASSERT_GT(residual(rough, model_.truth), 0.5 * noise_);
  SymmetrizeReport report;
  const Mesh exact = symmetrized(rough, model_.truth, RunContext{}, &report);
  EXPECT_EQ(exact.faces, rough.faces);
  EXPECT_LT(residual(exact, model_.truth), 1e-12);
  EXPECT_EQ(report.mapped, report.in_regions);
  EXPECT_EQ(report.unclosed, 0);
  // The mean of many is nearer to the truth than each: and no vertex moved farther than the noise warrants.
  EXPECT_LT(report.largest_movement, 2.5 * noise_);
  EXPECT_LT((exact.vertices - model_.mesh.vertices).norm(), (rough.vertices - model_.mesh.vertices).norm());
  for (const SymmetrizeReport::RegionChange& region : report.regions) {
    EXPECT_EQ(region.mapped, region.places);
    EXPECT_GT(region.before.max, 0.1 * noise_);
    EXPECT_LT(region.after.max, 1e-12);
  }
}

TEST_P(SymmetrizeModel, LeavesASymmetricShapeAsItIs) {
  SymmetrizeReport report;
  const Mesh same = symmetrized(model_.mesh, model_.truth, RunContext{}, &report);
  EXPECT_LT((same.vertices - model_.mesh.vertices).rowwise().norm().maxCoeff(), 1e-12 * size_);
  EXPECT_LT(report.largest_movement, 1e-12);
}

TEST_P(SymmetrizeModel, IsIdempotent) {
  const Mesh once = symmetrized(perturbed(model_.mesh, noise_ * size_), model_.truth, RunContext{});
  const Mesh twice = symmetrized(once, model_.truth, RunContext{});
  EXPECT_LT((once.vertices - twice.vertices).rowwise().norm().maxCoeff(), 1e-12 * size_);
}

TEST_P(SymmetrizeModel, DoesNotDependOnThreads) {
  const Mesh rough = perturbed(model_.mesh, noise_ * size_);
  RunContext two;
  two.threads = 2;
  EXPECT_EQ(symmetrized(rough, model_.truth, RunContext{}).vertices, symmetrized(rough, model_.truth, two).vertices);
}

TEST_P(SymmetrizeModel, FollowsPoseAndScale) {
  const Mesh rough = perturbed(model_.mesh, noise_ * size_);
  const Mesh exact = symmetrized(rough, model_.truth, RunContext{});
  const Similarity pose{40, Random(3, "pose").rotation(), {500, -200, 100}};
  Mesh moved = rough;
  for (Eigen::Index v = 0; v < moved.vertices.rows(); ++v) {
    moved.vertices.row(v) = pose(rough.vertices.row(v).transpose()).transpose();
  }
  const Mesh moved_exact = symmetrized(moved, transformed(model_.truth, pose), RunContext{});
  for (Eigen::Index v = 0; v < moved.vertices.rows(); ++v) {
    const Eigen::Vector3d due = pose(exact.vertices.row(v).transpose());
    ASSERT_LT((moved_exact.vertices.row(v).transpose() - due).norm(), 1e-9 * 40 * size_);
  }
}

class SymmetrizeNoise : public testing::TestWithParam<std::tuple<std::string, double>> {};

// Every vertex is off by a large part of the distance to the next one: the mean of its images is nearer to the truth by
// as much as means of so many are, or of more where regions within the whole add theirs.
TEST_P(SymmetrizeNoise, GoesWhereItIsAsLargeAsTheTriangles) {
  const auto& [name, noise] = GetParam();
  const GeneratedModel model = generate(name);
  const Mesh rough = perturbed(model.mesh, noise * diagonal(model.mesh.vertices));
  SymmetrizeReport report;
  const Mesh exact = symmetrized(rough, model.truth, RunContext{}, &report);
  EXPECT_EQ(report.mapped, report.in_regions);
  EXPECT_LT(residual(exact, model.truth), 1e-12);
  const double left = (exact.vertices - model.mesh.vertices).norm() / (rough.vertices - model.mesh.vertices).norm();
  EXPECT_LT(left, 1.05 / std::sqrt(static_cast<double>(model.truth.regions.front().elements.size())));
}

INSTANTIATE_TEST_SUITE_P(Models, SymmetrizeNoise,
                         testing::Combine(testing::Values("table", "chair", "armchair", "plane"),
                                          testing::Values(5e-4, 1e-3)),
                         [](const auto& noise) {
                           return std::get<0>(noise.param) + (std::get<1>(noise.param) < 7e-4 ? "_less" : "_more");
                         });

INSTANTIATE_TEST_SUITE_P(Models, SymmetrizeModel, testing::Values("bar", "table", "chair", "wheel"),
                         [](const auto& model) { return model.param; });

class SymmetrizeGroup : public testing::TestWithParam<std::string> {};

TEST_P(SymmetrizeGroup, IsExactForEveryFiniteGroup) {
  OrbitOptions orbit;
  orbit.subdivisions = 1;
  orbit.frame = Random(3, GetParam()).rotation();
  orbit.centre = {0.3, -0.2, 0.7};
  const GeneratedModel model = generate_orbit(PointGroup::parse(GetParam()).value(), orbit);
  const Mesh rough = perturbed(model.mesh, 2e-4 * diagonal(model.mesh.vertices));
  SymmetrizeReport report;
  const Mesh exact = symmetrized(rough, model.truth, RunContext{}, &report);
  EXPECT_LT(residual(exact, model.truth), 1e-12);
  EXPECT_EQ(report.mapped, exact.vertices.rows());
}

INSTANTIATE_TEST_SUITE_P(Groups, SymmetrizeGroup,
                         testing::Values("Cs", "Ci", "C2", "C3", "C4v", "C3h", "D3", "D4h", "D2d", "D3d", "S4", "S6",
                                         "T", "Td", "Th", "O", "Oh", "I", "Ih"),
                         [](const auto& group) { return group.param; });

// `facets` equal steps round the circle.
std::vector<double> equal_steps(int facets, double phase) {
  std::vector<double> angles;
  for (int k = 0; k < facets; ++k) angles.push_back(phase + 2 * std::numbers::pi * k / facets);
  return angles;
}

// Two halves of a lathe's work about z, one on the other, with vertices at the given angles.
Mesh turned(const std::vector<double>& lower, const std::vector<double>& upper) {
  const std::vector<std::pair<double, double>> profile{{0.2, 0}, {0.5, 0.1}, {0.5, 0.4}, {0.3, 0.6}, {0.4, 0.9}};
  std::vector<Eigen::RowVector3d> vertices;
  std::vector<Eigen::RowVector3i> faces;
  for (const auto& [first, last, angles] : {std::tuple{0, 2, &lower}, std::tuple{2, 4, &upper}}) {
    const int start = static_cast<int>(vertices.size());
    const int facets = static_cast<int>(angles->size());
    for (int ring = first; ring <= last; ++ring) {
      for (const double angle : *angles) {
        const auto& [radius, height] = profile[static_cast<std::size_t>(ring)];
        vertices.emplace_back(radius * std::cos(angle), radius * std::sin(angle), height);
      }
    }
    for (int ring = 0; ring < last - first; ++ring) {
      for (int k = 0; k < facets; ++k) {
        const int a = start + ring * facets + k;
        const int b = start + ring * facets + (k + 1) % facets;
        faces.emplace_back(a, b, b + facets);
        faces.emplace_back(a, b + facets, a + facets);
      }
    }
  }
  Mesh mesh;
  mesh.vertices.resize(static_cast<Eigen::Index>(vertices.size()), 3);
  mesh.faces.resize(static_cast<Eigen::Index>(faces.size()), 3);
  for (std::size_t v = 0; v < vertices.size(); ++v) mesh.vertices.row(static_cast<Eigen::Index>(v)) = vertices[v];
  for (std::size_t f = 0; f < faces.size(); ++f) mesh.faces.row(static_cast<Eigen::Index>(f)) = faces[f];
  return mesh;
}

SymmetryAnnotation whole(const Mesh& mesh, const std::string& group) {
  SymmetryAnnotation annotation = empty_annotation(mesh, 0.005);
  std::vector<int> faces;
  for (int f = 0; f < mesh.faces.rows(); ++f) faces.push_back(f);
  annotation.regions.push_back(make_region(PointGroup::parse(group).value(), Eigen::Vector3d::Zero(),
                                           Eigen::Matrix3d::Identity(), std::move(faces), "whole"));
  return annotation;
}

// Distance from the axis and height scatter over a ring by so much.
double ring_scatter(const Mesh& mesh, int first, int count) {
  const Points ring = mesh.vertices.middleRows(first, count);
  const Eigen::VectorXd radius = ring.leftCols(2).rowwise().norm();
  return std::max(radius.maxCoeff() - radius.minCoeff(), ring.col(2).maxCoeff() - ring.col(2).minCoeff());
}

TEST(SymmetrizeTurned, MakesARegularTurnedShape) {
  const Mesh rough = perturbed(turned(equal_steps(24, 0.1), equal_steps(24, 0.1)), 5e-4);
  const SymmetryAnnotation annotation = whole(rough, "Cinfv");
  SymmetrizeReport report;
  const Mesh exact = symmetrized(rough, annotation, RunContext{}, &report);
  EXPECT_EQ(report.regions[0].group, "C24v");
  EXPECT_LT(residual(exact, annotation), 1e-12);
  EXPECT_LT(report.largest_movement, 2e-3);
  for (int ring = 0; ring < 5; ++ring) EXPECT_LT(ring_scatter(exact, 24 * ring, 24), 1e-12);
}

// 33 and 35 facets have no turn in common: circles alone.
TEST(SymmetrizeTurned, MakesCirclesWhereTheFacetsDiffer) {
  const Mesh rough = perturbed(turned(equal_steps(33, 0.1), equal_steps(35, 0.1)), 5e-4);
  SymmetrizeReport report;
  const Mesh exact = symmetrized(rough, whole(rough, "Cinfv"), RunContext{}, &report);
  EXPECT_EQ(report.regions[0].group, "");
  for (int ring = 0; ring < 3; ++ring) EXPECT_LT(ring_scatter(exact, 33 * ring, 33), 1e-12);
  for (int ring = 0; ring < 3; ++ring) EXPECT_LT(ring_scatter(exact, 99 + 35 * ring, 35), 1e-12);
}

// An egg with a dent, whose vertices lie on no circles: the surface between them becomes round.
TEST(SymmetrizeTurned, MakesASurfaceRoundWhoseVerticesFormNoCircles) {
  Mesh egg = icosahedral_ball(1, 5);
  egg.vertices = egg.vertices * Random(5, "egg").rotation();
  for (Eigen::Index v = 0; v < egg.vertices.rows(); ++v) {
    Eigen::Vector3d direction = egg.vertices.row(v).normalized();
    direction *= 1 - 0.01 * std::exp(-20 * (direction - Eigen::Vector3d(0.8, 0, 0.6)).squaredNorm());
    egg.vertices.row(v) = direction.cwiseProduct(Eigen::Vector3d(1, 1, 1.5)).transpose();
  }
  const SymmetryAnnotation annotation = whole(egg, "Cinfv");
  const double before = residual(egg, annotation);
  SymmetrizeReport report;
  const Mesh rounded = symmetrized(egg, annotation, RunContext{}, &report);
  EXPECT_EQ(report.regions[0].group, "C24v");
  EXPECT_GT(before, 2e-3);
  EXPECT_LT(residual(rounded, annotation), 0.5 * before);
  EXPECT_LT(report.regions[0].after.rms, 0.3 * report.regions[0].before.rms);
  EXPECT_LT(report.largest_movement, 4 * annotation.tolerance);
}

// Images that lie between vertices: more facets on one side of the mirror than on the other.
TEST(SymmetrizeSurface, BringsUnrelatedTessellationsTogether) {
  std::vector<double> angles;
  for (int k = 0; k < 41; ++k) angles.push_back(std::numbers::pi * (k / 41.0 - 0.5));
  for (int k = 0; k < 67; ++k) angles.push_back(std::numbers::pi * (k / 67.0 + 0.5));
  Mesh rough = turned(angles, angles);
  SymmetryAnnotation mirror = whole(rough, "Cs");
  mirror.regions[0] = make_region(PointGroup::parse("Cs").value(), Eigen::Vector3d::Zero(),
                                  frame_about(Eigen::Vector3d::UnitX()), mirror.regions[0].faces, "whole");
  rough.vertices.col(0).array() += 0.004;  // off the mirror plane as a whole
  const double before = residual(rough, mirror);
  SymmetrizeReport report;
  const Mesh exact = symmetrized(rough, mirror, RunContext{}, &report);
  EXPECT_GT(before, 3e-3);
  EXPECT_LT(residual(exact, mirror), 0.25 * before);
  EXPECT_LT(report.largest_movement, 2 * before);
}

// The mesh's first face is an image as any other.
TEST(SymmetrizeSurface, BringsAVertexToTheImageOfASingleFace) {
  Mesh rough;
  rough.vertices.resize(7, 3);
  rough.vertices << 0.2, -1, 0, 2, 0, 0, 0.2, 1, 0, -0.2, -1, 0, -2, 0, 0, -0.2, 1, 0, -0.8, 0, 0.01;
  rough.faces.resize(4, 3);
  rough.faces << 0, 1, 2, 3, 6, 4, 4, 6, 5, 5, 6, 3;
  SymmetryAnnotation mirror = whole(rough, "Cs");
  mirror.regions[0] = make_region(PointGroup::parse("Cs").value(), Eigen::Vector3d::Zero(),
                                  frame_about(Eigen::Vector3d::UnitX()), mirror.regions[0].faces, "whole");
  const Mesh exact = symmetrized(rough, mirror, RunContext{});
  const Eigen::Vector3d corner = exact.vertices.row(0);
  const Eigen::Vector3d normal = face_normal(exact, 0);
  const Eigen::Vector3d image = Eigen::Vector3d(-1, 1, 1).cwiseProduct(exact.vertices.row(6).transpose());
  EXPECT_LT(std::abs(normal.dot(image - corner)), 1e-3);
  EXPECT_LT(residual(exact, mirror), 0.2 * residual(rough, mirror));
}

// A mirrored part whose halves have unrelated tessellations, both finer than it is off the mirror plane: nothing folds,
// and no image is farther from the surface than before.
TEST(SymmetrizeSurface, FoldsNothingWhereVerticesAreCloserThanTheErrorIs) {
  std::vector<double> angles;
  for (int k = 0; k < 210; ++k) angles.push_back(std::numbers::pi * (k / 210.0 - 0.5));
  for (int k = 0; k < 330; ++k) angles.push_back(std::numbers::pi * (k / 330.0 + 0.5));
  Mesh rough = turned(angles, angles);
  SymmetryAnnotation mirror = whole(rough, "Cs");
  mirror.regions[0] = make_region(PointGroup::parse("Cs").value(), Eigen::Vector3d::Zero(),
                                  frame_about(Eigen::Vector3d::UnitX()), mirror.regions[0].faces, "whole");
  rough.vertices.col(0).array() += 0.004;
  SymmetrizeReport report;
  const Mesh exact = symmetrized(rough, mirror, RunContext{}, &report);
  for (int f = 0; f < rough.faces.rows(); ++f) ASSERT_GT(face_normal(rough, f).dot(face_normal(exact, f)), 0.5) << f;
  EXPECT_LT(report.regions[0].after.max, 0.1 * report.regions[0].before.max);
  EXPECT_LT(report.regions[0].after.rms, 0.1 * report.regions[0].before.rms);
}

// Vertices at places of their own in one of four equal legs, so that its images lie between vertices.
Mesh retessellated_leg(Mesh mesh, const std::vector<int>& leg) {
  const Eigen::Index vertices = mesh.vertices.rows();
  const Eigen::Index faces = mesh.faces.rows();
  mesh.vertices.conservativeResize(vertices + static_cast<Eigen::Index>(leg.size()), 3);
  mesh.faces.conservativeResize(faces + 2 * static_cast<Eigen::Index>(leg.size()), 3);
  for (std::size_t i = 0; i < leg.size(); ++i) {
    const Eigen::RowVector3i corners = mesh.faces.row(leg[i]);
    const auto middle = static_cast<int>(vertices + static_cast<Eigen::Index>(i));
    mesh.vertices.row(middle) =
        0.5 * mesh.vertices.row(corners[0]) + 0.3 * mesh.vertices.row(corners[1]) + 0.2 * mesh.vertices.row(corners[2]);
    mesh.faces.row(leg[i]) = Eigen::RowVector3i(corners[0], corners[1], middle);
    mesh.faces.row(faces + 2 * static_cast<Eigen::Index>(i)) = Eigen::RowVector3i(corners[1], corners[2], middle);
    mesh.faces.row(faces + 2 * static_cast<Eigen::Index>(i) + 1) = Eigen::RowVector3i(corners[2], corners[0], middle);
  }
  return mesh;
}

// The table's truth on that mesh.
SymmetryAnnotation retessellated_truth(const SymmetryAnnotation& truth, const Mesh& mesh, const std::vector<int>& leg) {
  SymmetryAnnotation annotation = truth;
  annotation.mesh_vertices = static_cast<int>(mesh.vertices.rows());
  annotation.mesh_faces = static_cast<int>(mesh.faces.rows());
  annotation.patterns.clear();
  for (Region& region : annotation.regions) {
    const std::vector<int> before = region.faces;
    for (std::size_t i = 0; i < leg.size(); ++i) {
      if (!std::ranges::binary_search(before, leg[i])) continue;
      for (int k = 0; k < 2; ++k) region.faces.push_back(truth.mesh_faces + 2 * static_cast<int>(i) + k);
    }
    std::ranges::sort(region.faces);
  }
  return annotation;
}

class SymmetrizeNested : public testing::Test {
 protected:
  SymmetrizeNested() {
    const std::vector<int>& leg = std::ranges::min_element(model_.truth.regions, {}, [](const Region& region) {
                                    return region.faces.size();
                                  })->faces;
    const Mesh mesh = retessellated_leg(model_.mesh, leg);
    annotation_ = retessellated_truth(model_.truth, mesh, leg);
    rough_ = perturbed(mesh, 0.5 * bearable_noise(model_.mesh) * diagonal(mesh.vertices));
  }

  GeneratedModel model_ = generate("table");
  SymmetryAnnotation annotation_;
  Mesh rough_;
};

TEST_F(SymmetrizeNested, NoRegionIsWorseWhereOneLegIsTessellatedOtherwise) {
  ASSERT_GT(annotation_.regions.size(), 3U);
  SymmetrizeReport report;
  const Mesh exact = symmetrized(rough_, annotation_, RunContext{}, &report);
  EXPECT_LT(report.mapped, report.in_regions);
  EXPECT_GT(report.mapped, report.in_regions / 4);
  EXPECT_EQ(report.unclosed, 0);
  for (const SymmetrizeReport::RegionChange& region : report.regions) {
    EXPECT_LE(region.after.max, region.before.max + 1e-12) << region.name;
    EXPECT_LT(region.after.rms, 0.5 * region.before.rms) << region.name;
  }
  for (int f = 0; f < rough_.faces.rows(); ++f) ASSERT_GT(face_normal(rough_, f).dot(face_normal(exact, f)), 0.5) << f;
}

TEST_F(SymmetrizeNested, GivesTheSameBytesWithAnyNumberOfThreads) {
  const Mesh alone = symmetrized(rough_, annotation_, RunContext{});
  for (const int threads : {2, 5}) {
    RunContext several;
    several.threads = threads;
    EXPECT_EQ(symmetrized(rough_, annotation_, several).vertices, alone.vertices) << threads;
  }
}

// Two mirrors that all but meet at a right angle generate a group without end: the first is exact, the second no worse.
TEST(SymmetrizeClash, MakesTheFirstRegionExactAndNoneWorse) {
  const GeneratedModel model = generate_orbit(PointGroup::parse("C2v").value(), OrbitOptions{});
  SymmetryAnnotation annotation = empty_annotation(model.mesh, 0.005);
  const PointGroup mirror = PointGroup::parse("Cs").value();
  const std::vector<Motion>& elements = model.truth.regions[0].elements;
  for (const Motion& element : elements) {
    const AxisAngle part = axis_angle(element.linear);
    if (part.determinant > 0) continue;
    const Eigen::Vector3d normal =
        annotation.regions.empty() ? part.axis : Eigen::Vector3d(part.axis + 1e-3 * Eigen::Vector3d(1, 1, 1));
    annotation.regions.push_back(make_region(mirror, model.truth.regions[0].centre, frame_about(normal.normalized()),
                                             model.truth.regions[0].faces, "mirror"));
    annotation.regions.back().id = static_cast<int>(annotation.regions.size()) - 1;
  }
  ASSERT_EQ(annotation.regions.size(), 2U);
  SymmetrizeReport report;
  symmetrized(perturbed(model.mesh, 3e-4 * diagonal(model.mesh.vertices)), annotation, RunContext{}, &report);
  EXPECT_GT(report.unclosed, 0);
  EXPECT_LT(report.regions[0].after.max, report.regions[0].before.max);
  for (const SymmetrizeReport::RegionChange& region : report.regions) {
    EXPECT_LE(region.after.max, region.before.max + 1e-12);
    EXPECT_LE(region.after.rms, region.before.rms + 1e-12);
  }
}

TEST(SymmetrizePart, LeavesTheRestAlone) {
  const GeneratedModel model = generate("chair");
  SymmetryAnnotation annotation = model.truth;
  ASSERT_GT(annotation.regions.size(), 1U);
  annotation.regions = {annotation.regions.back()};
  annotation.regions[0].parent.reset();
  const Mesh rough = perturbed(model.mesh, bearable_noise(model.mesh) * diagonal(model.mesh.vertices));
  const Mesh exact = symmetrized(rough, annotation, RunContext{});
  std::vector<char> inside(static_cast<std::size_t>(rough.vertices.rows()), 0);
  for (const int face : annotation.regions[0].faces) {
    for (int k = 0; k < 3; ++k) inside[static_cast<std::size_t>(rough.faces(face, k))] = 1;
  }
  ASSERT_NE(std::ranges::count(inside, 0), 0);
  for (Eigen::Index v = 0; v < rough.vertices.rows(); ++v) {
    if (inside[static_cast<std::size_t>(v)] != 0) continue;
    EXPECT_EQ(exact.vertices.row(v), rough.vertices.row(v));
  }
  EXPECT_LT(residual(exact, annotation), 1e-12);
}

TEST(SymmetrizeEmpty, WithoutRegionsNothingMoves) {
  const GeneratedModel model = generate("bar");
  SymmetrizeReport report;
  const Mesh same = symmetrized(model.mesh, empty_annotation(model.mesh, 0.005), RunContext{}, &report);
  EXPECT_EQ(same.vertices, model.mesh.vertices);
  EXPECT_EQ(report.in_regions, 0);
}

}  // namespace
}  // namespace orbifit
