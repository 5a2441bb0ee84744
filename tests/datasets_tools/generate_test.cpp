#include "orbifit/datasets_tools/generate.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <ostream>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "orbifit/datasets_tools/symmetry_residual.h"
#include "orbifit/model/errors.h"

#include "geometry/topology.h"

namespace orbifit {
namespace {

struct Case {
  std::string model;
  std::map<std::string, double> values;
};

void PrintTo(const Case& given, std::ostream* out) {  // NOLINT(readability-identifier-naming): GoogleTest's name
  *out << given.model;
  for (const auto& [name, value] : given.values) *out << ' ' << name << '=' << value;
}

const Region& region_named(const SymmetryAnnotation& truth, const std::string& name) {
  const auto found = std::ranges::find(truth.regions, name, &Region::name);
  if (found == truth.regions.end()) throw std::runtime_error("no region " + name);
  return *found;
}

class GeneratedTruth : public testing::TestWithParam<Case> {
 protected:
  GeneratedModel model_ = generate(GetParam().model, GetParam().values);
};

TEST_P(GeneratedTruth, HoldsToRoundingVertexOntoVertex) {
  RunContext context;
  const SymmetryReport report = symmetry_residual(model_.mesh, model_.truth, nullptr, CarriedMotions::fixed, context);
  EXPECT_LT(report.worst_floor, 1e-14);
  EXPECT_TRUE(report.vertices_onto_vertices);
  for (const RegionResidual& region : report.regions) EXPECT_GT(region.pairs, 0) << region.name;
  for (const PatternResidual& pattern : report.patterns) EXPECT_LT(pattern.floor.max, 1e-14) << pattern.name;
}

TEST_P(GeneratedTruth, NamesItsMesh) {
  EXPECT_EQ(model_.truth.mesh_vertices, model_.mesh.vertices.rows());
  EXPECT_EQ(model_.truth.mesh_faces, model_.mesh.faces.rows());
  EXPECT_EQ(model_.truth.mesh_diagonal, diagonal(model_.mesh.vertices));
  ASSERT_FALSE(model_.truth.regions.empty());
}

TEST_P(GeneratedTruth, PartsAreWatertightAndFaceOutwards) {
  const MeshReport report = inspect(model_.mesh);
  EXPECT_TRUE(report.watertight);
  EXPECT_EQ(report.inconsistent_edges, 0);
  EXPECT_EQ(report.degenerate_faces, 0);
  EXPECT_EQ(report.unused_vertices, 0);
  EXPECT_EQ(report.duplicate_faces, 0);
  for (const std::vector<int>& faces : connected_components(model_.mesh, weld_vertices(model_.mesh.vertices)).faces) {
    EXPECT_GT(inspect(submesh(model_.mesh, faces)).volume, 0);
  }
}

TEST_P(GeneratedTruth, RegionsAreWellFormed) {
  std::set<std::string> names;
  for (std::size_t i = 0; i < model_.truth.regions.size(); ++i) {
    const Region& region = model_.truth.regions[i];
    EXPECT_EQ(region.id, static_cast<int>(i));
    EXPECT_TRUE(names.insert(region.name).second) << region.name;
    EXPECT_TRUE(std::ranges::is_sorted(region.faces));
    EXPECT_EQ(std::ranges::adjacent_find(region.faces), region.faces.end());
    EXPECT_EQ(static_cast<int>(region.elements.size()), region.group.order());
    if (region.parent) {
      EXPECT_TRUE(
          std::ranges::includes(model_.truth.regions[static_cast<std::size_t>(*region.parent)].faces, region.faces));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    Models, GeneratedTruth,
    testing::Values(Case{"armchair", {{"seat", 0.8}, {"leg_spread", 0}, {"detail", 1}}}, Case{"bar", {}},
                    Case{"car", {{"camber", 6}, {"length", 5.5}, {"detail", 1}}},
                    Case{"centre_piece", {{"reach", 0.4}, {"bowl", 0.2}, {"detail", 1}}},
                    Case{"desk_fan", {{"radius", 0.26}, {"detail", 3}}}, Case{"plane", {{"sweep", 2}, {"detail", 1}}},
                    Case{"plane", {{"detail", 3}}}, Case{"wind_mill", {{"pitch", 30}, {"detail", 1}}},
                    Case{"yard_tool", {{"tine", 0.3}, {"detail", 1}}}, Case{"bar", {{"height", 0.5}, {"length", 5}}},
                    Case{"bar", {{"detail", 2}}}, Case{"chair", {}}, Case{"chair", {{"seat_depth", 0.5}, {"slats", 3}}},
                    Case{"chair", {{"leg_spread", 0}, {"back_tilt", 0}, {"slats", 1}, {"detail", 1}}},
                    Case{"chair", {{"leg_height", 0.8}, {"leg_spread", 0.12}, {"leg_thickness", 0.02}}},
                    Case{"stool", {}}, Case{"stool", {{"legs", 3}, {"continuous", 0}, {"detail", 1}}},
                    Case{"stool", {{"legs", 6}, {"leg_spread", 0.1}, {"stretcher_height", 0.2}, {"detail", 1}}},
                    Case{"fan", {}}, Case{"fan", {{"blades", 3}, {"wires", 16}, {"continuous", 0}}}, Case{"table", {}},
                    Case{"table", {{"foot", 0.9}, {"inset", 0}, {"leg_thickness", 0.03}, {"detail", 1}}},
                    Case{"wheel", {{"detail", 1}}}, Case{"wheel", {{"tread", 1}, {"continuous", 0}, {"detail", 1}}}));

TEST(Generate, EveryLengthKeepsTheConnectivityAtBothEndsOfItsRange) {
  for (const Generator& generator : generators()) {
    const Mesh usual = generate(generator.name).mesh;
    for (const GeneratorParameter& parameter : generator.parameters) {
      if (parameter.integer) continue;
      for (const double value : {parameter.minimum, parameter.maximum}) {
        const Mesh other = generate(generator.name, {{parameter.name, value}}).mesh;
        ASSERT_EQ(other.faces.rows(), usual.faces.rows()) << generator.name << ' ' << parameter.name;
        EXPECT_EQ(other.faces, usual.faces) << generator.name << ' ' << parameter.name;
        EXPECT_GT((other.vertices - usual.vertices).cwiseAbs().maxCoeff(), 1e-3)
            << generator.name << ' ' << parameter.name << " changes nothing";
      }
    }
  }
}

TEST(Generate, NestsTheRegionsOfTheChair) {
  const SymmetryAnnotation truth = generate("chair").truth;
  const auto group_of = [&](const std::string& name) { return region_named(truth, name).group.symbol(); };
  const auto parent_of = [&](const std::string& name) {
    return truth.regions[static_cast<std::size_t>(region_named(truth, name).parent.value())].name;
  };
  EXPECT_EQ(group_of("chair"), "Cs");
  EXPECT_FALSE(region_named(truth, "chair").parent.has_value());
  EXPECT_EQ(group_of("seat and legs"), "C4v");
  EXPECT_EQ(parent_of("seat and legs"), "chair");
  EXPECT_EQ(parent_of("leg 3"), "seat and legs");
  EXPECT_EQ(group_of("back"), "C2v");
  EXPECT_EQ(parent_of("posts and slats"), "back");
  EXPECT_EQ(parent_of("slat 2"), "posts and slats");
  ASSERT_EQ(truth.patterns.size(), 1U);
  EXPECT_EQ(truth.patterns.front().kind, Pattern::Kind::translation_1d);
  EXPECT_EQ(truth.patterns.front().instances.size(), 4U);
}

TEST(Generate, AnOblongSeatHasTheSmallerGroup) {
  const SymmetryAnnotation truth = generate("chair", {{"seat_depth", 0.5}}).truth;
  EXPECT_EQ(region_named(truth, "seat and legs").group.symbol(), "C2v");
  EXPECT_EQ(region_named(truth, "seat").group.symbol(), "D2h");
}

TEST(Generate, TheFansRotorIsChiral) {
  const GeneratedModel fan = generate("fan");
  const Region& rotor = region_named(fan.truth, "rotor");
  EXPECT_EQ(rotor.group.symbol(), "C5");
  // A mirror through the first blade's own plane must not fit, or C5v would have been right.
  SymmetryAnnotation mirrored = empty_annotation(fan.mesh, 0.005);
  for (int k = 0; k < 10; ++k) {
    const Eigen::Vector3d across = axis_rotation(rotor.axis, 0.1 * k * std::numbers::pi) * Eigen::Vector3d::UnitX();
    mirrored.regions.push_back(
        make_region({PointGroup::Family::Cs, 1}, rotor.centre, frame_about(across), rotor.faces, "mirror"));
  }
  RunContext context;
  const SymmetryReport report = symmetry_residual(fan.mesh, mirrored, nullptr, CarriedMotions::fixed, context);
  for (const RegionResidual& region : report.regions) EXPECT_GT(region.floor.max, 0.01);
}

TEST(Generate, TheBarIsAsLargeAsThePapers) {
  const Mesh bar = generate("bar").mesh;
  EXPECT_NEAR(static_cast<double>(bar.vertices.rows()), 4000, 100);
  EXPECT_NEAR(static_cast<double>(bar.faces.rows()), 8000, 200);
}

TEST(Generate, IsReproducible) {
  for (const Generator& generator : generators()) {
    const GeneratedModel a = generate(generator.name);
    const GeneratedModel b = generate(generator.name);
    EXPECT_EQ(a.mesh.vertices, b.mesh.vertices) << generator.name;
    EXPECT_EQ(a.mesh.faces, b.mesh.faces) << generator.name;
  }
}

TEST(Generate, ListsItsModelsInOrderWithUsableDefaults) {
  EXPECT_TRUE(std::ranges::is_sorted(generators(), {}, &Generator::name));
  for (const Generator& generator : generators()) {
    EXPECT_FALSE(generator.meaning.empty());
    for (const GeneratorParameter& parameter : generator.parameters) {
      EXPECT_FALSE(parameter.meaning.empty()) << generator.name << ' ' << parameter.name;
      EXPECT_LE(parameter.minimum, parameter.value) << generator.name << ' ' << parameter.name;
      EXPECT_GE(parameter.maximum, parameter.value) << generator.name << ' ' << parameter.name;
    }
  }
}

struct BadCase {
  std::string name;
  std::string model;
  std::map<std::string, double> values;
  std::string message;
};

class BadParameters : public testing::TestWithParam<BadCase> {};

TEST_P(BadParameters, AreRefusedByName) {
  try {
    generate(GetParam().model, GetParam().values);
    FAIL() << "accepted";
  } catch (const UsageError& error) {
    EXPECT_EQ(std::string(error.what()), GetParam().message);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Generate, BadParameters,
    testing::Values(
        BadCase{"Model",
                "sofa",
                {},
                "unknown model 'sofa'; there are armchair, bar, car, centre_piece, chair, desk_fan, fan, plane, stool, "
                "table, wheel, wind_mill, yard_tool"},
        BadCase{"Parameter",
                "bar",
                {{"mass", 1}},
                "bar: unknown parameter 'mass'; there are length, width, height, detail"},
        BadCase{"TooSmall", "chair", {{"slats", 0}}, "chair: slats = 0: must be from 1 to 12"},
        BadCase{"Fraction", "chair", {{"slats", 2.5}}, "chair: slats = 2.5: must be a whole number"},
        BadCase{"NotANumber",
                "table",
                {{"width", std::numeric_limits<double>::quiet_NaN()}},
                "table: width = nan: must be from 0.5 to 1.6"}),
    [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace orbifit
