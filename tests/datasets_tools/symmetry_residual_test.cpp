#include "orbifit/datasets_tools/symmetry_residual.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "orbifit/datasets_tools/generate.h"
#include "orbifit/model/errors.h"

#include "base/random.h"
#include "models/orbit_model.h"

namespace orbifit {
namespace {

using Eigen::Vector3d;

SymmetryReport measure(const GeneratedModel& model, const Mesh* deformed, CarriedMotions motions) {
  RunContext context;
  return symmetry_residual(model.mesh, model.truth, deformed, motions, context);
}

Mesh moved_by(Mesh mesh, const Similarity& similarity) {
  for (auto vertex : mesh.vertices.rowwise()) vertex = similarity(Vector3d(vertex.transpose())).transpose();
  return mesh;
}

// Moves the vertices of some faces.
void shift(Mesh& mesh, const std::vector<int>& faces, const Motion& motion) {
  std::vector<bool> done(static_cast<std::size_t>(mesh.vertices.rows()), false);
  for (const int f : faces) {
    for (int k = 0; k < 3; ++k) {
      const int v = mesh.faces(f, k);
      if (done[static_cast<std::size_t>(v)]) continue;
      done[static_cast<std::size_t>(v)] = true;
      mesh.vertices.row(v) = motion(Vector3d(mesh.vertices.row(v).transpose())).transpose();
    }
  }
}

const Region& region_named(const GeneratedModel& model, const std::string& name) {
  return *std::ranges::find(model.truth.regions, name, &Region::name);
}

// A square of 2 x 2 quadrangles with the mirror x -> -x; vertex 3 * j + i at (i - 1, j - 1, 0).
GeneratedModel square() {
  GeneratedModel model;
  model.mesh.vertices.resize(9, 3);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) model.mesh.vertices.row(3 * j + i) = Eigen::RowVector3d(i - 1, j - 1, 0);
  }
  model.mesh.faces.resize(8, 3);
  model.mesh.faces << 0, 1, 3, 1, 4, 3, 1, 2, 5, 1, 5, 4, 3, 4, 6, 4, 7, 6, 4, 5, 8, 4, 8, 7;
  model.truth = empty_annotation(model.mesh, 0.005);
  std::vector<int> faces(8);
  std::iota(faces.begin(), faces.end(), 0);
  model.truth.regions.push_back(
      make_region({PointGroup::Family::Cs, 1}, Vector3d::Zero(), frame_about(Vector3d::UnitX()), faces, "square"));
  return model;
}

TEST(SymmetryResidual, IsWhatOneComputesByHand) {
  const GeneratedModel model = square();
  Mesh deformed = model.mesh;
  deformed.vertices.row(3) += Eigen::RowVector3d(0, 0, 0.3);  // its image, vertex 5, stays
  const SymmetryReport report = measure(model, &deformed, CarriedMotions::fixed);
  const RegionResidual& region = report.regions.front();
  const double size = diagonal(deformed.vertices);
  EXPECT_EQ(region.pairs, 9);
  EXPECT_EQ(region.mapped, 9);
  EXPECT_EQ(region.floor.max, 0);
  EXPECT_NEAR(region.deformed.max, 0.3 / size, 1e-15);
  EXPECT_NEAR(region.deformed.rms, 0.3 / size * std::sqrt(2.0 / 9), 1e-15);  // of the pairs 3 -> 5 and 5 -> 3
  EXPECT_TRUE(region.worst_vertex == 3 || region.worst_vertex == 5);
}

TEST(SymmetryResidual, MeasuresTheRestShapesOwnFlaw) {
  GeneratedModel model = square();
  model.mesh.vertices(3, 2) = 0.01;
  const SymmetryReport report = measure(model, nullptr, CarriedMotions::fixed);
  const RegionResidual& region = report.regions.front();
  EXPECT_EQ(region.mapped, 7);
  EXPECT_FALSE(report.vertices_onto_vertices);
  // Vertex 3's image lies 0.01 above the flat side; vertex 5's image lies under the raised one, a little nearer.
  EXPECT_NEAR(region.floor.max, 0.01 / diagonal(model.mesh.vertices), 1e-9);
  EXPECT_EQ(region.worst_vertex, 3);
  EXPECT_EQ(region.excess.max, 0);
}

TEST(SymmetryResidual, PairsServeOneShapeAfterAnother) {
  const GeneratedModel model = generate("table", {{"detail", 1}});
  const GeneratedModel other = generate("table", {{"detail", 1}, {"height", 0.8}});
  RunContext context;
  const SymmetryPairs pairs(model.mesh, model.truth, context);
  for (const Mesh* deformed : {&other.mesh, &model.mesh, &other.mesh}) {
    const SymmetryReport report = pairs.residual(deformed, CarriedMotions::floating, context);
    const SymmetryReport anew = symmetry_residual(model.mesh, model.truth, deformed, CarriedMotions::floating, context);
    EXPECT_EQ(report.worst_excess, anew.worst_excess);
    EXPECT_EQ(report.worst_deformed, anew.worst_deformed);
    EXPECT_EQ(report.vertex_excess, anew.vertex_excess);
  }
}

TEST(SymmetryResidual, ExcessLeavesTheFloorOut) {
  GeneratedModel model = square();
  model.mesh.vertices(3, 2) = 0.01;
  const RegionResidual same = measure(model, &model.mesh, CarriedMotions::fixed).regions.front();
  EXPECT_NEAR(same.deformed.max, same.floor.max, 1e-15);
  EXPECT_NEAR(same.excess.max, 0, 1e-15);
}

TEST(SymmetryResidual, FindsASingleMovedVertex) {
  const GeneratedModel model = generate("table", {{"detail", 1}});
  const Region& leg = region_named(model, "leg 2");
  for (const double size : {1e-3, 1e-7, 1e-11}) {
    Mesh deformed = model.mesh;
    const int vertex = deformed.faces(leg.faces[40], 0);
    deformed.vertices(vertex, 2) += size;
    const SymmetryReport report = measure(model, &deformed, CarriedMotions::fixed);
    const double expected = size / diagonal(deformed.vertices);
    EXPECT_NEAR(report.regions[static_cast<std::size_t>(leg.id)].deformed.max / expected, 1, 1e-4);
    EXPECT_LT(report.regions[static_cast<std::size_t>(region_named(model, "leg 1").id)].deformed.max, 1e-14);
    // Free motions may spread the flaw, but not hide it.
    const SymmetryReport free = measure(model, &deformed, CarriedMotions::moving);
    EXPECT_GT(free.regions[static_cast<std::size_t>(leg.id)].deformed.max / expected, 0.5);
  }
}

class PosedShape : public testing::TestWithParam<int> {};

TEST_P(PosedShape, IsExactOnceItsPoseIsTakenOut) {
  const GeneratedModel model = generate("chair", {{"detail", 1}});
  Random random(static_cast<std::uint64_t>(GetParam()));
  const Eigen::Matrix3d turn = random.rotation();
  const Mesh posed = moved_by(model.mesh, {1, turn, Vector3d(4, -7, 1)});
  const Mesh scaled = moved_by(model.mesh, {2.5, turn, Vector3d(4, -7, 1)});
  EXPECT_GT(measure(model, &posed, CarriedMotions::fixed).worst_deformed, 0.05);
  EXPECT_LT(measure(model, &posed, CarriedMotions::posed).worst_deformed, 2e-14);
  // The regions' centres have moved apart: one rigid motion is not enough.
  EXPECT_GT(measure(model, &scaled, CarriedMotions::posed).worst_deformed, 0.05);
  EXPECT_LT(measure(model, &scaled, CarriedMotions::floating).worst_deformed, 2e-14);
  EXPECT_LT(measure(model, &scaled, CarriedMotions::moving).worst_deformed, 2e-14);
}

INSTANTIATE_TEST_SUITE_P(Poses, PosedShape, testing::Range(1, 7));

TEST(SymmetryResidual, FloatingForgivesATranslationOfARegionAndFixedDoesNot) {
  const GeneratedModel model = generate("table", {{"detail", 1}});
  Mesh deformed = model.mesh;
  const Region& leg = region_named(model, "leg 3");
  const Vector3d step(0.02, -0.01, 0.03);
  shift(deformed, leg.faces, {Eigen::Matrix3d::Identity(), step});
  const auto of_leg = [&](CarriedMotions motions) {
    return measure(model, &deformed, motions).regions[static_cast<std::size_t>(leg.id)].deformed.max;
  };
  // Of the step only what the elements do not carry along counts: half turns double its part across the axis.
  EXPECT_NEAR(of_leg(CarriedMotions::fixed) * diagonal(deformed.vertices), 2 * std::hypot(step.x(), step.y()), 1e-12);
  EXPECT_LT(of_leg(CarriedMotions::moving), 1e-14);
  GeneratedModel alone = model;
  alone.truth.regions = {leg, region_named(model, "leg 1")};
  EXPECT_LT(measure(alone, &deformed, CarriedMotions::floating).worst_deformed, 1e-14);
  EXPECT_GT(measure(alone, &deformed, CarriedMotions::posed).worst_deformed, 1e-3);
}

TEST(SymmetryResidual, OnlyMovingForgivesATurnedRegion) {
  const GeneratedModel model = generate("table", {{"detail", 1}});
  Mesh deformed = model.mesh;
  const Region& leg = region_named(model, "leg 4");
  shift(deformed, leg.faces, Motion::rotation(Vector3d(1, 2, 0).normalized(), 0.2, leg.centre));
  const auto of_leg = [&](CarriedMotions motions) {
    return measure(model, &deformed, motions).regions[static_cast<std::size_t>(leg.id)].deformed.max;
  };
  EXPECT_GT(of_leg(CarriedMotions::floating), 0.01);
  EXPECT_LT(of_leg(CarriedMotions::moving), 1e-14);
}

TEST(SymmetryResidual, AnotherChairIsASymmetricDeformationOfTheFirst) {
  const GeneratedModel model = generate("chair", {{"detail", 1}});
  const Mesh deformed =
      generate("chair", {{"detail", 1}, {"leg_height", 0.6}, {"leg_spread", 0.1}, {"back_tilt", 20}}).mesh;
  const SymmetryReport report = measure(model, &deformed, CarriedMotions::moving);
  EXPECT_LT(report.worst_deformed, 1e-13);
  for (const PatternResidual& pattern : report.patterns) EXPECT_LT(pattern.deformed.max, 1e-14);
}

TEST(SymmetryResidual, KeepsItsDigitsFarFromTheOrigin) {
  OrbitOptions options;
  options.centre = {1024, -2048, 512};
  const GeneratedModel far = generate_orbit({PointGroup::Family::Td, 1}, options);
  const SymmetryReport report = measure(far, &far.mesh, CarriedMotions::moving);
  EXPECT_LT(report.worst_floor, 1e-12);
  EXPECT_LT(report.worst_deformed, 1e-12);
}

TEST(SymmetryResidual, ContinuousGroupsAreTriedOnTheTessellationsTurns) {
  const GeneratedModel model = generate("wheel", {{"detail", 1}});
  Mesh deformed = model.mesh;
  const Region& rim = region_named(model, "rim");
  ASSERT_TRUE(rim.group.continuous());
  EXPECT_LT(measure(model, &deformed, CarriedMotions::fixed).worst_deformed, 1e-14);
  const int vertex = deformed.faces(rim.faces[7], 1);
  const Vector3d out = (deformed.vertices.row(vertex).transpose() - rim.centre).normalized();
  deformed.vertices.row(vertex) += 1e-4 * out.transpose();
  const SymmetryReport report = measure(model, &deformed, CarriedMotions::fixed);
  EXPECT_NEAR(report.regions[static_cast<std::size_t>(rim.id)].deformed.max * diagonal(deformed.vertices), 1e-4, 1e-8);
}

TEST(SymmetryResidual, SeesAStretchedInstanceOfAPattern) {
  const GeneratedModel model = generate("chair", {{"detail", 1}});
  Mesh deformed = model.mesh;
  const std::vector<int>& slat = model.truth.patterns.front().instances[2].faces;
  shift(deformed, slat, Motion::rotation(Vector3d::UnitY(), 0.3, Vector3d(0.1, 0.2, 0.3)));
  EXPECT_LT(measure(model, &deformed, CarriedMotions::fixed).patterns.front().deformed.max, 1e-14);
  deformed.vertices(deformed.faces(slat[3], 2), 1) += 1e-3;
  EXPECT_GT(measure(model, &deformed, CarriedMotions::fixed).patterns.front().deformed.max, 5e-4);
}

TEST(SymmetryResidual, IsTheSameOnTwoThreads) {
  const GeneratedModel model = generate("chair", {{"detail", 1}});
  Mesh deformed = model.mesh;
  Random random(8);
  for (auto vertex : deformed.vertices.rowwise()) vertex += 1e-3 * random.direction().transpose();
  RunContext one;
  RunContext two;
  two.threads = 2;
  const SymmetryReport a = symmetry_residual(model.mesh, model.truth, &deformed, CarriedMotions::moving, one);
  const SymmetryReport b = symmetry_residual(model.mesh, model.truth, &deformed, CarriedMotions::moving, two);
  ASSERT_EQ(a.regions.size(), b.regions.size());
  for (std::size_t r = 0; r < a.regions.size(); ++r) {
    EXPECT_EQ(a.regions[r].deformed.rms, b.regions[r].deformed.rms);
    EXPECT_EQ(a.regions[r].worst_vertex, b.regions[r].worst_vertex);
  }
}

// A box from `low` to `high` with vertices of its own, each side a grid of `cells` by `cells`.
void add_box(Mesh& mesh, const Vector3d& low, const Vector3d& high, int cells) {
  std::vector<Eigen::RowVector3d> vertices;
  std::vector<Eigen::RowVector3i> faces;
  const int first = static_cast<int>(mesh.vertices.rows());
  // One surface: a vertex on the border of two sides is one.
  const auto vertex = [&](const Eigen::Vector3i& at) {
    const Vector3d share = at.cast<double>() / cells;
    const Eigen::RowVector3d point = (low + share.cwiseProduct(high - low)).transpose();
    const auto known = std::ranges::find(vertices, point);
    if (known != vertices.end()) return first + static_cast<int>(known - vertices.begin());
    vertices.push_back(point);
    return first + static_cast<int>(vertices.size()) - 1;
  };
  for (int axis = 0; axis < 3; ++axis) {
    for (const int side : {0, cells}) {
      for (int i = 0; i < cells; ++i) {
        for (int j = 0; j < cells; ++j) {
          const auto corner = [&](int a, int b) {
            Eigen::Vector3i at;
            at[axis] = side;
            at[(axis + 1) % 3] = i + a;
            at[(axis + 2) % 3] = j + b;
            return vertex(at);
          };
          const int ring[4] = {corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)};
          const bool out = side != 0;
          faces.emplace_back(ring[0], ring[out ? 1 : 2], ring[out ? 2 : 1]);
          faces.emplace_back(ring[0], ring[out ? 2 : 3], ring[out ? 3 : 2]);
        }
      }
    }
  }
  mesh.vertices.conservativeResize(first + static_cast<Eigen::Index>(vertices.size()), 3);
  for (std::size_t v = 0; v < vertices.size(); ++v)
    mesh.vertices.row(first + static_cast<Eigen::Index>(v)) = vertices[v];
  const Eigen::Index before = mesh.faces.rows();
  mesh.faces.conservativeResize(before + static_cast<Eigen::Index>(faces.size()), 3);
  for (std::size_t f = 0; f < faces.size(); ++f) mesh.faces.row(before + static_cast<Eigen::Index>(f)) = faces[f];
}

// Boxes, and the mirror x -> -x of all of them.
class Boxes : public testing::Test {
 protected:
  // A box from `low` to `high` and one in its mirror image, each face of which has other vertices.
  void add_pair(Vector3d low, Vector3d high, int cells, int mirrored_cells) {
    add_box(model_.mesh, low, high, cells);
    ends_.push_back(model_.mesh.vertices.rows());
    const double left = low.x();
    low.x() = -high.x();
    high.x() = -left;
    add_box(model_.mesh, low, high, mirrored_cells);
    ends_.push_back(model_.mesh.vertices.rows());
  }

  void annotate() {
    model_.truth = empty_annotation(model_.mesh, 0.005);
    std::vector<int> faces(static_cast<std::size_t>(model_.mesh.faces.rows()));
    std::iota(faces.begin(), faces.end(), 0);
    model_.truth.regions.push_back(
        make_region({PointGroup::Family::Cs, 1}, Vector3d::Zero(), frame_about(Vector3d::UnitX()), faces, "boxes"));
  }

  void move_box(Mesh& mesh, std::size_t box, const Vector3d& step) const {
    for (Eigen::Index v = box == 0 ? 0 : ends_[box - 1]; v < ends_[box]; ++v) mesh.vertices.row(v) += step.transpose();
  }

  GeneratedModel model_;
  std::vector<Eigen::Index> ends_;  // of the boxes' vertices
};

TEST_F(Boxes, ThatTouchArePairedWithTheirCounterparts) {
  // Two planks side by side, their mirror images with a joint a little off: there images of one plank's vertices lie on
  // the other's counterpart.
  constexpr double kJoint = 1e-3;
  add_pair({0.5, 0, 0}, {1.5 + kJoint, 1, 0.1}, 2, 3);
  add_pair({1.5, 0, 0}, {2.5, 1, 0.1}, 3, 4);
  model_.mesh.vertices = model_.mesh.vertices.eval();
  for (Eigen::Index v = ends_[0]; v < ends_[1]; ++v) {
    if (model_.mesh.vertices(v, 0) < -1.5) model_.mesh.vertices(v, 0) = -1.5;
  }
  annotate();
  const double size = diagonal(model_.mesh.vertices);
  Mesh deformed = model_.mesh;
  const Vector3d up(0, 0, 0.2);
  for (const std::size_t plank : {0U, 1U}) move_box(deformed, plank, up);
  const RegionResidual region = measure(model_, &deformed, CarriedMotions::fixed).regions.front();
  EXPECT_LE(region.floor.max, 1.01 * kJoint / size);
  EXPECT_LE(region.deformed.max, 1.01 * kJoint / size);
  // A plank that goes up alone is still seen in full.
  deformed = model_.mesh;
  move_box(deformed, 0, up);
  EXPECT_NEAR(measure(model_, &deformed, CarriedMotions::fixed).regions.front().deformed.max * size, up.z(), 0.02);
}

TEST_F(Boxes, InOnePlaceAreToldApartOnceTheyAreDeformed) {
  for (const CarriedMotions motions : {CarriedMotions::fixed, CarriedMotions::floating, CarriedMotions::moving}) {
    model_ = {};
    ends_.clear();
    add_pair({0.5, 0, 0}, {1.5, 1, 0.5}, 2, 3);
    add_pair({2, 0, 0}, {3, 1, 0.5}, 3, 3);
    add_pair({2, 0, 0}, {3, 1, 0.5}, 4, 4);
    annotate();
    // Of the boxes in one place the first on one side is the image of the second on the other.
    Mesh deformed = model_.mesh;
    const Vector3d step(0.1, 0.2, 0.3);
    move_box(deformed, 2, step);
    move_box(deformed, 5, step.cwiseProduct(Vector3d(-1, 1, 1)));
    const SymmetryReport report = measure(model_, &deformed, motions);
    EXPECT_LT(report.worst_deformed, 1e-12);
    move_box(deformed, 5, Vector3d(0, 0.01, 0));
    EXPECT_GT(measure(model_, &deformed, motions).worst_deformed * diagonal(deformed.vertices), 0.002);
  }
}

TEST(SymmetryResidual, RefusesAnotherConnectivity) {
  const GeneratedModel model = square();
  Mesh deformed = model.mesh;
  deformed.vertices.conservativeResize(8, 3);
  EXPECT_THROW(measure(model, &deformed, CarriedMotions::fixed), InputError);
  deformed = model.mesh;
  deformed.faces.row(0).reverseInPlace();
  EXPECT_THROW(measure(model, &deformed, CarriedMotions::fixed), InputError);
}

}  // namespace
}  // namespace orbifit
