// Identities that hold on every region of every model: partial, nested and overlapping ones, and patterns.

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <tuple>

#include <gtest/gtest.h>

#include "orbifit/datasets_tools/symmetry_residual.h"
#include "orbifit/model/annotation_io.h"
#include "orbifit/model/mesh_io.h"
#include "orbifit/subspace/deformer.h"
#include "orbifit/subspace/displacement_field.h"

#include "base/random.h"
#include "basis/subspace_parts.h"
#include "geometry/vertex_grid.h"
#include "subspaces.h"
#include "temporary_folder.h"

namespace orbifit {
namespace {

struct ModelCase {
  std::string name;
  std::map<std::string, double> parameters;
  double radius;  // of the diagonal
};

// Table 1's own models among them, coarser.
const std::vector<ModelCase> kModels{{"bar", {}, 0.1},
                                     {"table", {{"detail", 1}}, 0.06},
                                     {"chair", {{"detail", 1}}, 0.08},
                                     {"fan", {{"wires", 12}}, 0.15},
                                     {"wheel", {{"detail", 1}}, 0.15},
                                     {"desk_fan", {{"detail", 1}}, 0.1},
                                     {"armchair", {{"detail", 1}}, 0.08},
                                     {"yard_tool", {{"detail", 1}}, 0.08},
                                     {"wind_mill", {{"detail", 1}}, 0.1},
                                     {"car", {{"detail", 1}}, 0.1}};

using RegionCase = std::tuple<int, GroupMode>;

class EveryRegion : public testing::TestWithParam<RegionCase> {
 protected:
  EveryRegion() : case_(kModels[static_cast<std::size_t>(std::get<0>(GetParam()))]), mode_(std::get<1>(GetParam())) {
    model_ = generate(case_.name, case_.parameters);
    subspace_ = subspace_of(model_, mode_, case_.radius);
    state_ = random_state(subspace_, 0.03);
  }

  const ModelCase& case_;
  GroupMode mode_;
  GeneratedModel model_;
  Subspace subspace_;
  SubspaceState state_;
};

TEST_P(EveryRegion, IsExactUnderRandomCoordinates) {
  EXPECT_LT(basis_of(subspace_, state_).conflict, 1e-12 * subspace_->diagonal);
  const WorstResidual worst = worst_residual(model_, subspace_, state_, 200);
  EXPECT_LT(worst.residual, 1e-12) << worst.name;

  Mesh deformed = model_.mesh;
  deformed.vertices += vertex_displacements(subspace_, state_);
  RunContext context;
  const SymmetryAnnotation carried = deformed_annotation(model_.truth, subspace_, state_, deformed);
  const SymmetryReport report = symmetry_residual(deformed, carried, nullptr, CarriedMotions::fixed, context);
  for (const RegionResidual& region : report.regions) EXPECT_LT(region.floor.max, 1e-12) << region.name;
  for (const PatternResidual& pattern : report.patterns) EXPECT_LT(pattern.floor.max, 1e-12) << pattern.name;
}

// The baked lift is the field, but for its weights' rounding to 24 bits.
TEST_P(EveryRegion, BakedLiftIsTheFieldAtTheVertices) {
  const Points baked = vertex_displacements(subspace_, state_);
  const VertexOrbits& orbits = subspace_->orbits;
  Random random(3, "vertices");
  for (int trial = 0; trial < 20; ++trial) {
    const auto v = static_cast<Eigen::Index>(random.below(static_cast<std::uint64_t>(baked.rows())));
    const VertexOrbits::Follower& follower = orbits.followers[static_cast<std::size_t>(v)];
    const auto r = static_cast<std::size_t>(follower.representative);
    int set = -1;
    for (auto k = orbits.first_point[r]; k < orbits.first_point[r + 1] && set < 0; ++k) {
      if (orbits.point_words[static_cast<std::size_t>(k)] == follower.word) {
        set = orbits.point_sets[static_cast<std::size_t>(k)];
      }
    }
    ASSERT_GE(set, 0);
    const Points field = displacement_field(subspace_, state_, model_.mesh.vertices.row(v), {set}, RunContext{});
    EXPECT_LT((field.row(0) - baked.row(v)).norm(), 1e-5 * subspace_->diagonal) << "vertex " << v;
  }
}

// u(image) = transport of u(vertex), for the vertices' own orbits.
TEST_P(EveryRegion, LiftCommutesWithTheGroups) {
  const Points moved = model_.mesh.vertices + vertex_displacements(subspace_, state_);
  const Points& rest = model_.mesh.vertices;
  Random random(4, "pairs");
  const VertexGrid at(rest, 1e-9 * subspace_->diagonal);
  int pairs = 0;
  for (std::size_t i = 0; i < model_.truth.regions.size(); ++i) {
    const Motion carried = region_motion(subspace_, state_, static_cast<int>(i));
    const std::vector<int> vertices = vertices_of_faces(model_.mesh, model_.truth.regions[i].faces);
    for (const Motion& element : model_.truth.regions[i].elements) {
      for (int trial = 0; trial < 20; ++trial) {
        const int vertex = vertices[random.below(vertices.size())];
        int image = -1;
        at.visit(element(rest.row(vertex).transpose()), [&](int other) { image = other; });
        if (image < 0) continue;
        const Eigen::Vector3d due = conjugate(carried, element)(moved.row(vertex).transpose());
        ASSERT_LT((moved.row(image).transpose() - due).norm(), 1e-12 * subspace_->diagonal)
            << model_.truth.regions[i].name;
        ++pairs;
      }
    }
  }
  EXPECT_GT(pairs, 20);
}

// A large drag, then the files as users get them.
// As the lift takes distances for: those of an image from images of places.
TEST_P(EveryRegion, ExactImagesLieOnThePlacesThatTheyAre) {
  const RegionMap& regions = *subspace_->regions;
  const VertexGrid grid(model_.mesh.vertices, 1e-9 * subspace_->diagonal);
  int others = 0;
  for (int place = 0; place < regions.count(); ++place) {
    EXPECT_EQ(regions.exact_images(place, -1), std::vector<int>(static_cast<std::size_t>(regions.places()), -1));
    for (std::size_t e = 0; e < regions.elements(place).size(); ++e) {
      const std::vector<int> images = regions.exact_images(place, static_cast<int>(e));
      for (int from = 0; from < regions.count(); ++from) {
        const int to = images[static_cast<std::size_t>(from)];
        if (to < 0) continue;
        others += from != place;
        const std::vector<int> there = vertices_of_faces(model_.mesh, model_.truth.regions[std::size_t(to)].faces);
        for (const int vertex : vertices_of_faces(model_.mesh, model_.truth.regions[std::size_t(from)].faces)) {
          bool met = false;
          grid.visit(regions.elements(place)[e](model_.mesh.vertices.row(vertex).transpose()),
                     [&](int other) { met = met || std::ranges::binary_search(there, other); });
          EXPECT_TRUE(met) << regions.name(from) << " to " << regions.name(to);
        }
      }
    }
  }
  EXPECT_GT(others, case_.name == "car" ? 200 : -1);
}

TEST_P(EveryRegion, IsExactInTheFileAfterADrag) {
  const Mesh& mesh = model_.mesh;
  const double size = subspace_->diagonal;
  Eigen::Index low = 0;
  Eigen::Index high = 0;
  mesh.vertices.rowwise().sum().minCoeff(&low);
  mesh.vertices.rowwise().sum().maxCoeff(&high);
  Deformer deformer(subspace_, mesh);
  deformer.set_handles({handle_at(mesh, mesh.vertices.row(low).transpose(), 0.1 * size),
                        handle_at(mesh, mesh.vertices.row(high).transpose(), 0.1 * size)},
                       100);
  // Neither the same for both nor each other's mirror images, which would leave nothing where a group links them.
  const Eigen::Vector3d shift = size * Eigen::Vector3d(0.25, 0.15, 0.2);
  const Motion drag = Motion{Eigen::Matrix3d::Identity(), shift} *
                      Motion::rotation(Eigen::Vector3d::UnitZ(), 0.6, mesh.vertices.row(high).transpose());
  const Motion pull{Eigen::Matrix3d::Identity(), -0.4 * shift};
  const Deformation deformation = deformer.solve({pull, drag}, 6);
  const Points displacements = vertex_displacements(subspace_, deformation.state);
  EXPECT_GT(displacements.rowwise().norm().maxCoeff(), 0.005 * size);  // groups that stay where they are allow little
  Mesh deformed = mesh;
  deformed.vertices += displacements;
  const TemporaryFolder folder;
  write_annotation(folder.file("carried.json"),
                   deformed_annotation(model_.truth, subspace_, deformation.state, deformed));
  for (const std::string name : {"deformed.ply", "deformed.obj"}) {
    write_mesh(folder.file(name), deformed);
    const Mesh written = read_mesh(folder.file(name));
    const SymmetryAnnotation carried = read_annotation(folder.file("carried.json"), written);
    RunContext context;
    const SymmetryReport report = symmetry_residual(written, carried, nullptr, CarriedMotions::fixed, context);
    for (const RegionResidual& region : report.regions) EXPECT_LT(region.floor.max, 1e-9) << name << " " << region.name;
    for (const PatternResidual& pattern : report.patterns) {
      EXPECT_LT(pattern.floor.max, 1e-9) << name << " " << pattern.name;
    }
  }
}

std::string region_case_name(const testing::TestParamInfo<RegionCase>& info) {
  return kModels[static_cast<std::size_t>(std::get<0>(info.param))].name + "_" + to_string(std::get<1>(info.param));
}

INSTANTIATE_TEST_SUITE_P(Models, EveryRegion,
                         testing::Combine(testing::Range(0, static_cast<int>(kModels.size())),
                                          testing::Values(GroupMode::fixed, GroupMode::floating, GroupMode::moving)),
                         region_case_name);

// Where vertices have no vertices as images the field in space is what is symmetric.
class BetweenVertices : public EveryRegion {};

TEST_P(BetweenVertices, EveryRegionIsExact) {
  const GeneratedModel cut = cut_irregularly(model_);
  const Subspace subspace = subspace_of(cut, mode_, case_.radius);
  EXPECT_FALSE(subspace->orbits.images_are_vertices);
  const WorstResidual worst = worst_residual(cut, subspace, random_state(subspace, 0.03), 60);
  EXPECT_LT(worst.residual, 1e-12) << worst.name;
}

// Those that are quickly followed from point to point.
INSTANTIATE_TEST_SUITE_P(Models, BetweenVertices,
                         testing::Combine(testing::Values(0, 1, 5, 7, 8),
                                          testing::Values(GroupMode::fixed, GroupMode::floating, GroupMode::moving)),
                         region_case_name);

// What the comparison of the two lifts shows: the paper's breaks regions that the samples keep.
// Distances of a place that is nearly an image are asked for themselves.
TEST(ExactImages, AreNoneOfNearlySymmetricPlaces) {
  GeneratedModel model = generate("wheel", {{"detail", 1}});
  Random random(5);
  for (double& coordinate : model.mesh.vertices.reshaped()) coordinate += 1e-5 * random.normal();
  const RegionMap regions(model.mesh, model.truth, RunContext{});
  for (int place = 0; place < regions.count(); ++place) {
    for (std::size_t e = 1; e < regions.elements(place).size(); ++e) {
      EXPECT_EQ(regions.exact_images(place, static_cast<int>(e)),
                std::vector<int>(static_cast<std::size_t>(regions.places()), -1));
    }
  }
}

TEST(PaperLift, BreaksPartialRegions) {
  const GeneratedModel model = generate("table");
  for (const GroupMode mode : {GroupMode::fixed, GroupMode::floating, GroupMode::moving}) {
    const Subspace subspace = subspace_of(model, mode, 0.06, LiftKind::paper);
    EXPECT_GT(worst_residual(model, subspace, random_state(subspace, 0.03), 500).residual, 1e-4) << to_string(mode);
  }
}

TEST(PaperLift, KeepsTheWhole) {
  const GeneratedModel model = generate("bar");
  const Subspace subspace = subspace_of(model, GroupMode::fixed, 0.1, LiftKind::paper);
  EXPECT_LT(worst_residual(model, subspace, random_state(subspace, 0.03), 500).residual, 1e-6);
}

}  // namespace
}  // namespace orbifit
