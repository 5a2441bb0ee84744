#include <algorithm>
#include <map>
#include <string>
#include <tuple>

#include <Eigen/QR>
#include <gtest/gtest.h>

#include "orbifit/datasets_tools/generate.h"
#include "orbifit/datasets_tools/symmetry_residual.h"
#include "orbifit/model/errors.h"
#include "orbifit/subspace/displacement_field.h"

#include "base/random.h"
#include "basis/subspace_parts.h"
#include "geometry/point_index.h"
#include "geometry/surface_index.h"
#include "models/orbit_model.h"

namespace orbifit {
namespace {

Eigen::VectorXd random_coordinates(const Subspace& subspace, double size) {
  Random random(11, "coordinates");
  Eigen::VectorXd q(subspace.degrees_of_freedom());
  for (double& coordinate : q) coordinate = size * random.normal();
  return q;
}

using GroupAndMode = std::tuple<std::string, GroupMode>;

class SubspaceOfGroup : public testing::TestWithParam<GroupAndMode> {
 protected:
  SubspaceOfGroup() {
    OrbitOptions orbit;
    orbit.subdivisions = 1;
    orbit.frame = Random(3, std::get<0>(GetParam())).rotation();
    orbit.centre = {0.3, -0.2, 0.7};
    model_ = generate_orbit(PointGroup::parse(std::get<0>(GetParam())).value(), orbit);
    SubspaceOptions options;
    options.mode = std::get<1>(GetParam());
    options.radius = 0.15 * diagonal(model_.mesh.vertices);
    subspace_ = build_subspace(model_.mesh, model_.truth, options, RunContext{});
    q_ = random_coordinates(subspace_, 0.1 * diagonal(model_.mesh.vertices));
  }

  GeneratedModel model_;
  Subspace subspace_;
  Eigen::VectorXd q_;
};

// u(g p) = O u(p) + (I - O) t on the samples: every image of a sample is a sample with the displacement due.
TEST_P(SubspaceOfGroup, BasisSatisfiesTheConstraintsOnTheSamples) {
  const Points displacements = sample_displacements(subspace_, q_);
  const Eigen::Vector3d t = region_translation(subspace_, q_, 0);
  const Points& samples = subspace_->sampling.points;
  const double size = diagonal(model_.mesh.vertices);
  for (const Motion& g : model_.truth.regions[0].elements) {
    for (Eigen::Index k = 0; k < samples.rows(); ++k) {
      Eigen::Index image = 0;
      const double distance =
          (samples.rowwise() - g(samples.row(k).transpose()).transpose()).rowwise().norm().minCoeff(&image);
      ASSERT_LT(distance, 1e-12 * size);
      const Eigen::Vector3d due = g.linear * (displacements.row(k).transpose() - t) + t;
      EXPECT_LT((displacements.row(image).transpose() - due).norm(), 1e-12 * size);
    }
  }
}

TEST_P(SubspaceOfGroup, FieldIsSymmetricInSpace) {
  const Residual field = field_residual(subspace_, model_.mesh, model_.truth.regions[0], 0, q_, RunContext{});
  EXPECT_LT(field.max, 1e-12);
  EXPECT_LE(field.rms, field.max);
}

TEST_P(SubspaceOfGroup, DeformedMeshIsSymmetricUnderTheCarriedGroup) {
  Mesh deformed = model_.mesh;
  deformed.vertices += vertex_displacements(subspace_, q_);
  const SymmetryAnnotation carried = deformed_annotation(model_.truth, subspace_, q_, deformed);
  RunContext context;
  const SymmetryReport report = symmetry_residual(deformed, carried, nullptr, CarriedMotions::fixed, context);
  EXPECT_TRUE(report.vertices_onto_vertices);
  EXPECT_LT(report.worst_floor, 1e-12);
}

TEST_P(SubspaceOfGroup, ColumnsAreIndependentAndAsManyAsOrbitsAndStabilisersAllow) {
  const Eigen::MatrixXd columns(subspace_->basis.columns);
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> rank(columns);
  EXPECT_EQ(rank.rank(), columns.cols());
  // Each orbit has the dimension of what its seed's stabiliser keeps, by the trace formula; carried translations add
  // the directions that the group does not fix.
  double dimension = 0;
  const auto& elements = model_.truth.regions[0].elements;
  for (int orbit = 0; orbit < subspace_->sampling.orbits(); ++orbit) {
    const Eigen::Vector3d seed =
        subspace_->sampling.points.row(subspace_->sampling.first_sample[static_cast<std::size_t>(orbit)]);
    double trace = 0;
    int size = 0;
    for (const Motion& g : elements) {
      if ((g(seed) - seed).norm() > 1e-9) continue;
      trace += g.linear.trace();
      ++size;
    }
    dimension += trace / size;
  }
  if (subspace_->mode == GroupMode::floating) {
    double fixed = 0;
    for (const Motion& g : elements) fixed += g.linear.trace() / static_cast<double>(elements.size());
    dimension += 3 - fixed;
  }
  EXPECT_NEAR(dimension, static_cast<double>(columns.cols()), 1e-6);
}

std::string group_test_name(const testing::TestParamInfo<GroupAndMode>& info) {
  return std::get<0>(info.param) + "_" + to_string(std::get<1>(info.param));
}

INSTANTIATE_TEST_SUITE_P(Groups, SubspaceOfGroup,
                         testing::Combine(testing::Values("Cs", "Ci", "C2", "C3", "C5", "C4v", "C3h", "C6h", "D2", "D3",
                                                          "D4h", "D3h", "D2d", "D3d", "S4", "S6", "S8", "T", "Td", "Th",
                                                          "O", "Oh", "I", "Ih"),
                                          testing::Values(GroupMode::fixed, GroupMode::floating)),
                         group_test_name);

class SubspaceOfModel : public testing::TestWithParam<std::tuple<std::string, GroupMode>> {
 protected:
  SubspaceOfModel() {
    // Finite groups for turned parts: a subgroup of a continuous one is what the subspace keeps.
    model_ = generate(std::get<0>(GetParam()));
    SubspaceOptions options;
    options.mode = std::get<1>(GetParam());
    options.radius = 0.06 * diagonal(model_.mesh.vertices);
    subspace_ = build_subspace(model_.mesh, model_.truth, options, RunContext{});
  }

  GeneratedModel model_;
  Subspace subspace_;
};

// Nested and overlapping regions too: on the samples every region's constraints hold, whatever the lift does.
TEST_P(SubspaceOfModel, SamplesKeepEveryRegion) {
  const double size = diagonal(model_.mesh.vertices);
  const Eigen::VectorXd q = random_coordinates(subspace_, 0.05 * size);
  const Points displacements = sample_displacements(subspace_, q);
  const Points& samples = subspace_->sampling.points;
  const SurfaceIndex surface(model_.mesh);
  int pairs = 0;
  for (int region = 0; region < subspace_->regions->count(); ++region) {
    const Eigen::Vector3d t = region_translation(subspace_, q, region);
    for (Eigen::Index k = 0; k < samples.rows(); ++k) {
      const auto nearest = surface.nearest(samples.row(k).transpose());
      const auto& here = subspace_->regions->regions_of_face(nearest.face);
      // Well inside the region: a sample that snapped onto an axis may lie beside it.
      if (nearest.distance > 1e-9 * size || !std::ranges::binary_search(here, region)) continue;
      for (const Motion& g : subspace_->regions->elements(region)) {
        Eigen::Index image = 0;
        const double distance =
            (samples.rowwise() - g(samples.row(k).transpose()).transpose()).rowwise().norm().minCoeff(&image);
        ASSERT_LT(distance, 1e-9 * size) << subspace_->regions->name(region) << " lacks the image of sample " << k;
        const Eigen::Vector3d due = g.linear * (displacements.row(k).transpose() - t) + t;
        ASSERT_LT((displacements.row(image).transpose() - due).norm(), 1e-9 * size)
            << subspace_->regions->name(region) << ", sample " << k;
        ++pairs;
      }
    }
  }
  EXPECT_GT(pairs, 100);
}

TEST_P(SubspaceOfModel, EverySurfacePointHasASampleWithinTheRadius) {
  const PointIndex index(subspace_->sampling.points);
  double worst = 0;
  for (Eigen::Index v = 0; v < model_.mesh.vertices.rows(); ++v) {
    worst = std::max(worst, index.nearest(model_.mesh.vertices.row(v).transpose(), 1).front().distance);
  }
  // Seeds that snapped lie up to 0.4 r off; candidates are finitely many.
  EXPECT_LT(worst, 1.5 * subspace_->sampling.radius);
}

TEST_P(SubspaceOfModel, WholeMeshGroupsAreExactOnTheMesh) {
  const Eigen::VectorXd q = random_coordinates(subspace_, 0.03 * diagonal(model_.mesh.vertices));
  Mesh deformed = model_.mesh;
  deformed.vertices += vertex_displacements(subspace_, q);
  SymmetryAnnotation whole = deformed_annotation(model_.truth, subspace_, q, deformed);
  std::erase_if(whole.regions, [&](const Region& region) {
    return static_cast<Eigen::Index>(region.faces.size()) != model_.mesh.faces.rows();
  });
  whole.patterns.clear();
  RunContext context;
  EXPECT_LT(symmetry_residual(deformed, whole, nullptr, CarriedMotions::fixed, context).worst_floor, 1e-12);
}

TEST_P(SubspaceOfModel, IsTheSameWithTwoThreads) {
  SubspaceOptions options;
  options.mode = subspace_->mode;
  options.radius = subspace_->sampling.radius;
  RunContext two;
  two.threads = 2;
  const Subspace again = build_subspace(model_.mesh, model_.truth, options, two);
  EXPECT_EQ(again->sampling.points, subspace_->sampling.points);
  const Eigen::VectorXd q = random_coordinates(subspace_, 1);
  EXPECT_EQ(vertex_displacements(again, q), vertex_displacements(subspace_, q));
}

TEST_P(SubspaceOfModel, IsTheSameBuiltFromACoarserOne) {
  SubspaceOptions options;
  options.mode = subspace_->mode;
  options.radius = 1.5 * subspace_->sampling.radius;
  const Subspace coarse = build_subspace(model_.mesh, model_.truth, options, RunContext{});
  options.radius = subspace_->sampling.radius;
  const Subspace again = rebuilt_subspace(coarse, model_.mesh, model_.truth, options, RunContext{});
  EXPECT_EQ(again->surface, coarse->surface);
  EXPECT_EQ(again->sampling.points, subspace_->sampling.points);
  const Eigen::VectorXd q = random_coordinates(subspace_, 1);
  EXPECT_EQ(vertex_displacements(again, q), vertex_displacements(subspace_, q));
}

std::string model_test_name(const testing::TestParamInfo<std::tuple<std::string, GroupMode>>& info) {
  return std::get<0>(info.param) + "_" + to_string(std::get<1>(info.param));
}

INSTANTIATE_TEST_SUITE_P(Models, SubspaceOfModel,
                         testing::Combine(testing::Values("bar", "table", "chair"),
                                          testing::Values(GroupMode::fixed, GroupMode::floating)),
                         model_test_name);

TEST(Subspace, FloatingLetsATablesLegsMoveApart) {
  const GeneratedModel model = generate("table");
  SubspaceOptions options;
  options.radius = 0.05 * diagonal(model.mesh.vertices);
  const auto freedom = [&](GroupMode mode) {
    options.mode = mode;
    return build_subspace(model.mesh, model.truth, options, RunContext{}).degrees_of_freedom();
  };
  EXPECT_GT(freedom(GroupMode::floating), freedom(GroupMode::fixed));
}

TEST(Subspace, SamplesAskedForAreNearlyGiven) {
  const GeneratedModel model = generate("table");
  SubspaceOptions options;
  options.samples = 400;
  const auto samples = build_subspace(model.mesh, model.truth, options, RunContext{}).samples().rows();
  EXPECT_NEAR(static_cast<double>(samples), 400, 60);
}

// Turned parts make many samples of few degrees of freedom: half as many could not tell a disc's sides apart.
TEST(Subspace, ShapesOfFewDegreesOfFreedomHaveMoreSamples) {
  const GeneratedModel model = generate("fan");
  const Subspace subspace = build_subspace(model.mesh, model.truth, {}, RunContext{});
  EXPECT_GT(subspace.degrees_of_freedom(), 100);
  EXPECT_LT(subspace->sampling.points.rows(), 2700);
}

TEST(Subspace, RefusesOptionsThatMakeNoSense) {
  SubspaceOptions options;
  options.radius = -1;
  EXPECT_THROW(options.validate(), UsageError);
  options.radius = 0;
  options.samples = 2;
  EXPECT_THROW(options.validate(), UsageError);
}

TEST(Subspace, RefusesAMeshWithoutArea) {
  Mesh mesh;
  mesh.vertices = Points::Zero(3, 3);
  mesh.faces.resize(1, 3);
  mesh.faces << 0, 1, 2;
  EXPECT_THROW(build_subspace(mesh, empty_annotation(mesh, 0.005), {}, RunContext{}), InputError);
}

// A mesh from a file of few digits: the images miss their vertices, yet the deformation adds nothing to that.
TEST(Subspace, RoundedVerticesStayAsSymmetricAsTheyWere) {
  GeneratedModel model = generate("table");
  Random random(9);
  const double size = diagonal(model.mesh.vertices);
  for (double& coordinate : model.mesh.vertices.reshaped()) coordinate += 2e-8 * size * random.uniform(-1, 1);
  SubspaceOptions options;
  options.mode = GroupMode::fixed;
  options.radius = 0.06 * size;
  const Subspace subspace = build_subspace(model.mesh, model.truth, options, RunContext{});
  Mesh deformed = model.mesh;
  deformed.vertices += vertex_displacements(subspace, random_coordinates(subspace, 0.05 * size));
  model.truth.regions.resize(1);
  model.truth.patterns.clear();
  RunContext context;
  const SymmetryReport report = symmetry_residual(model.mesh, model.truth, &deformed, CarriedMotions::fixed, context);
  EXPECT_GT(report.worst_floor, 1e-9);
  EXPECT_LT(report.worst_excess, 1e-9);
}

}  // namespace
}  // namespace orbifit
