#include "orbifit/subspace/subspace_io.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <numbers>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "orbifit/datasets_tools/generate.h"
#include "orbifit/model/errors.h"
#include "orbifit/subspace/deformer.h"
#include "orbifit/subspace/displacement_field.h"

#include "base/random.h"
#include "basis/conjugated_regions.h"
#include "basis/subspace_parts.h"
#include "files/file.h"
#include "io/section_file.h"
#include "models/orbit_model.h"
#include "temporary_folder.h"

namespace orbifit {
namespace {

constexpr std::size_t kTable = 32;  // where the table starts, and how long a row is
constexpr std::size_t kTableRow = 32;

// Copies of a body in a row, evenly spaced.
GeneratedModel row_of_bodies() {
  constexpr int kCopies = 4;
  OrbitOptions options;
  options.subdivisions = 1;
  const GeneratedModel body = generate_orbit(PointGroup::parse("C2").value(), options);
  const Eigen::Index vertices = body.mesh.vertices.rows();
  const auto faces = static_cast<int>(body.mesh.faces.rows());
  GeneratedModel row;
  row.mesh.vertices.resize(kCopies * vertices, 3);
  row.mesh.faces.resize(kCopies * faces, 3);
  Pattern pattern;
  pattern.name = "bodies";
  pattern.kind = Pattern::Kind::translation_1d;
  const Eigen::Vector3d step(5, 1, 0.5);
  pattern.generators.push_back({Eigen::Matrix3d::Identity(), step});
  for (int k = 0; k < kCopies; ++k) {
    row.mesh.vertices.middleRows(k * vertices, vertices) = body.mesh.vertices.rowwise() + k * step.transpose();
    row.mesh.faces.middleRows(k * faces, faces) = body.mesh.faces.array() + k * static_cast<int>(vertices);
    PatternInstance instance;
    instance.motion.translation = k * step;
    for (int face = 0; face < faces; ++face) instance.faces.push_back(k * faces + face);
    pattern.instances.push_back(instance);
  }
  row.truth = empty_annotation(row.mesh, 0.005);
  row.truth.patterns.push_back(pattern);
  return row;
}

// A turned vase: all rotations about z and the mirrors through it.
GeneratedModel vase() {
  constexpr int kSides = 12, kRings = 7;
  GeneratedModel model;
  model.mesh.vertices.resize(kSides * kRings, 3);
  model.mesh.faces.resize(2 * kSides * (kRings - 1), 3);
  std::vector<int> faces;
  for (int ring = 0; ring < kRings; ++ring) {
    for (int side = 0; side < kSides; ++side) {
      const double angle = 2 * std::numbers::pi * side / kSides;
      const double radius = 1 + 0.3 * std::sin(ring);
      const int next = (side + 1) % kSides, here = kSides * ring;
      model.mesh.vertices.row(here + side) << radius * std::cos(angle), radius * std::sin(angle), 0.6 * ring;
      if (ring + 1 == kRings) continue;
      const int face = 2 * (here + side);
      model.mesh.faces.row(face) << here + side, here + next, here + kSides + next;
      model.mesh.faces.row(face + 1) << here + side, here + kSides + next, here + kSides + side;
      faces.insert(faces.end(), {face, face + 1});
    }
  }
  model.truth = empty_annotation(model.mesh, 0.005);
  model.truth.regions.push_back(make_region(PointGroup::parse("Cinfv").value(), Eigen::Vector3d::Zero(),
                                            GroupFrame::Identity(), std::move(faces), "vase"));
  return model;
}

GeneratedModel model_named(const std::string& name) {
  if (name == "row") return row_of_bodies();
  if (name == "vase") return vase();
  if (name != "Oh") return generate(name);
  OrbitOptions options;
  options.subdivisions = 0;
  return generate_orbit(PointGroup::parse(name).value(), options);
}

Subspace built(const GeneratedModel& model, GroupMode mode, LiftKind lift) {
  SubspaceOptions options;
  options.mode = mode;
  options.lift = lift;
  options.radius = 0.1 * diagonal(model.mesh.vertices);
  return build_subspace(model.mesh, model.truth, options, RunContext{});
}

// Random coordinates, in mode moving with turned groups.
SubspaceState random_state_of(const Subspace& subspace) {
  Random random(23, "state");
  SubspaceState state;
  if (subspace->mode == GroupMode::moving) {
    const ConjugatedRegions regions(subspace);
    const auto angle = [&] { return 0.2 * random.normal(); };
    const Eigen::VectorXd angles = Eigen::VectorXd::NullaryExpr(regions.freedom(), angle);
    const auto rotations = regions.rotations(regions.turned(regions.rest(), angles));
    state.basis = std::make_shared<const ConjugatedBasis>(conjugated_basis(subspace, rotations));
  }
  const auto coordinate = [&] { return 0.1 * subspace->diagonal * random.normal(); };
  state.q = Eigen::VectorXd::NullaryExpr(basis_of(subspace, state).degrees_of_freedom(), coordinate);
  return state;
}

using StoredCase = std::tuple<std::string, GroupMode, LiftKind>;

class StoredSubspace : public testing::TestWithParam<StoredCase> {
 protected:
  StoredSubspace()
      : model_(model_named(std::get<0>(GetParam()))),
        built_(built(model_, std::get<1>(GetParam()), std::get<2>(GetParam()))) {
    write_subspace(file_, built_, model_.mesh, model_.truth);
    read_ = read_subspace(file_, model_.mesh, model_.truth, RunContext{});
  }

  TemporaryFolder folder_;
  std::filesystem::path file_ = folder_.file("stored.basis");
  GeneratedModel model_;
  Subspace built_, read_;
};

TEST_P(StoredSubspace, GivesTheSameDisplacementsToTheLastBit) {
  EXPECT_EQ(read_->mode, built_->mode);
  EXPECT_EQ(read_->lift_kind, built_->lift_kind);
  EXPECT_EQ(read_->diagonal, built_->diagonal);
  ASSERT_EQ(read_.degrees_of_freedom(), built_.degrees_of_freedom());
  const Eigen::VectorXd q = Eigen::VectorXd::LinSpaced(built_.degrees_of_freedom(), -1, 1);
  EXPECT_EQ(sample_displacements(read_, q), sample_displacements(built_, q));
  EXPECT_EQ(vertex_displacements(read_, q), vertex_displacements(built_, q));
  ASSERT_GT(vertex_displacements(built_, q).norm(), 1);
  const SubspaceState state = random_state_of(built_);
  const SubspaceState same = random_state_of(read_);
  EXPECT_EQ(same.q, state.q);
  EXPECT_EQ(vertex_displacements(read_, same), vertex_displacements(built_, state));
}

TEST_P(StoredSubspace, GivesTheSameFieldInSpaceAndTheSameAnnotation) {
  const SubspaceState state = random_state_of(built_);
  const SubspaceState same = random_state_of(read_);
  Points points = built_->sampling.points.topRows(std::min<Eigen::Index>(8, built_->sampling.points.rows()));
  points.array() += 0.01 * built_->sampling.radius;
  const std::vector<int> sets(built_->sampling.sets.begin(), built_->sampling.sets.begin() + points.rows());
  EXPECT_EQ(displacement_field(read_, same, points, sets, RunContext{}),
            displacement_field(built_, state, points, sets, RunContext{}));
  for (int region = 0; region < built_->regions->count(); ++region) {
    const Motion there = region_motion(built_, state, region), here = region_motion(read_, same, region);
    EXPECT_EQ(here.linear, there.linear);
    EXPECT_EQ(here.translation, there.translation);
  }
}

TEST_P(StoredSubspace, DeformsAlike) {
  Handle held, pulled;
  held.vertices = {0, 1, 2};
  pulled.vertices = {static_cast<int>(model_.mesh.vertices.rows()) - 1};
  pulled.motion.translation = {0.1 * built_->diagonal, 0.03 * built_->diagonal, 0};
  const auto deformed = [&](const Subspace& subspace) {
    Deformer deformer(subspace, model_.mesh, {}, RunContext{});
    deformer.set_handles({held, pulled}, 100);
    return vertex_displacements(subspace, deformer.solve({held.motion, pulled.motion}, 3).state);
  };
  EXPECT_EQ(deformed(read_), deformed(built_));
}

TEST_P(StoredSubspace, IsWrittenAgainAsTheSameBytes) {
  const std::filesystem::path again = folder_.file("again.basis");
  write_subspace(again, read_, model_.mesh, model_.truth);
  EXPECT_TRUE(read_file(again) == read_file(file_));
}

std::string stored_case_name(const testing::TestParamInfo<StoredCase>& info) {
  const auto& [model, mode, lift] = info.param;
  return model + "_" + to_string(mode) + "_" + to_string(lift);
}

INSTANTIATE_TEST_SUITE_P(Models, StoredSubspace,
                         testing::Combine(testing::Values("Oh", "row", "vase", "table", "wheel"),
                                          testing::Values(GroupMode::fixed, GroupMode::floating, GroupMode::moving),
                                          testing::Values(LiftKind::orbit)),
                         stored_case_name);
INSTANTIATE_TEST_SUITE_P(PaperLift, StoredSubspace,
                         testing::Values(StoredCase{"Oh", GroupMode::floating, LiftKind::paper},
                                         StoredCase{"row", GroupMode::fixed, LiftKind::paper}),
                         stored_case_name);

class RefusedBasis : public testing::Test {
 protected:
  RefusedBasis() {
    write_subspace(file_, built(model_, GroupMode::floating, LiftKind::orbit), model_.mesh, model_.truth);
    content_ = read_file(file_);
  }

  // What is said against the content; empty when it is taken.
  std::string refusal(const std::string& content) const {
    const std::filesystem::path file = folder_.write("other.basis", content);
    try {
      read_subspace(file, model_.mesh, model_.truth, RunContext{});
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }

  std::string refusal(const Mesh& mesh, const SymmetryAnnotation& annotation) const {
    try {
      read_subspace(file_, mesh, annotation, RunContext{});
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }

  TemporaryFolder folder_;
  std::filesystem::path file_ = folder_.file("stored.basis");
  GeneratedModel model_ = model_named("Oh");
  std::string content_;
};

TEST_F(RefusedBasis, CutOffAnywhere) {
  ASSERT_EQ(refusal(content_), "");
  for (std::size_t length = 0; length < content_.size(); length += length < 512 ? 1 : 101) {
    ASSERT_NE(refusal(content_.substr(0, length)), "") << length << " of " << content_.size() << " bytes";
  }
  EXPECT_NE(refusal(content_.substr(0, content_.size() - 1)).find("the file is cut off"), std::string::npos);
  EXPECT_NE(refusal(content_ + '\0'), "");
}

TEST_F(RefusedBasis, OneBitFlippedAnywhere) {
  Random random(5, "bits");
  for (int trial = 0; trial < 3000; ++trial) {
    const std::size_t place = trial < 600 ? static_cast<std::size_t>(trial) : random.below(content_.size());
    std::string damaged = content_;
    damaged[place] = static_cast<char>(damaged[place] ^ (1 << random.below(8)));
    ASSERT_NE(refusal(damaged), "") << "byte " << place;
  }
}

TEST_F(RefusedBasis, OfAnotherFormatOrVersion) {
  EXPECT_NE(refusal("ply\nformat ascii 1.0\n").find("is not a basis"), std::string::npos);
  EXPECT_NE(refusal("").find("is empty"), std::string::npos);
  std::string newer = content_;
  newer[8] = 3;
  EXPECT_NE(refusal(newer).find("version: is 3; this program reads version 2"), std::string::npos) << refusal(newer);
  EXPECT_THROW(read_subspace(folder_.file("none.basis"), model_.mesh, model_.truth, RunContext{}), InputError);
}

TEST_F(RefusedBasis, OfAnotherMesh) {
  EXPECT_EQ(refusal(model_.mesh, model_.truth), "");
  Mesh mesh = model_.mesh;
  mesh.vertices(3, 1) += 1e-15;
  EXPECT_NE(refusal(mesh, model_.truth).find("of another mesh"), std::string::npos);
  mesh = model_.mesh;
  mesh.faces.row(0).reverseInPlace();
  EXPECT_NE(refusal(mesh, model_.truth).find("of another mesh"), std::string::npos);
  mesh = model_.mesh;
  mesh.vertices.conservativeResize(mesh.vertices.rows() + 1, 3);
  mesh.vertices.bottomRows<1>().setZero();
  EXPECT_NE(refusal(mesh, model_.truth).find("the basis is of a mesh of "), std::string::npos);
}

TEST_F(RefusedBasis, OfAnotherAnnotation) {
  SymmetryAnnotation annotation = model_.truth;
  annotation.regions[0].name = "renamed";
  annotation.regions[0].residual.max = 1;
  EXPECT_EQ(refusal(model_.mesh, annotation), "");
  std::swap(annotation.regions[0].elements[1], annotation.regions[0].elements[2]);
  EXPECT_NE(refusal(model_.mesh, annotation).find("of another annotation"), std::string::npos);
  annotation = model_.truth;
  annotation.regions[0].faces.pop_back();
  EXPECT_NE(refusal(model_.mesh, annotation).find("of another annotation"), std::string::npos);
  annotation.regions.clear();
  EXPECT_NE(refusal(model_.mesh, annotation).find("of an annotation of 1 regions"), std::string::npos);
}

template <class Number>
Number number_at(const std::string& content, std::size_t place) {
  Number number;
  std::memcpy(&number, content.data() + place, sizeof number);
  return number;
}

// Enters the checksums that the content has.
void put_checksums(std::string& content) {
  const auto put = [&](std::size_t place, const Checksum& sum) {
    const std::uint64_t value = sum.value();
    std::memcpy(content.data() + place, &value, sizeof value);
  };
  const auto sections = number_at<std::uint32_t>(content, 12);
  for (std::size_t row = kTable; row < kTable + sections * kTableRow; row += kTableRow) {
    Checksum sum;
    sum.add(content.data() + number_at<std::uint64_t>(content, row + 8), number_at<std::uint64_t>(content, row + 16));
    put(row + 24, sum);
  }
  Checksum header;
  header.add(content.data(), 24);
  header.add(content.data() + kTable, sections * kTableRow);
  put(24, header);
}

class WronglyWrittenBasis : public StoredSubspace {};

// Wrong numbers under right checksums, as a faulty program would write them: refused, or taken without harm.
TEST_P(WronglyWrittenBasis, DoesNoHarm) {
  const std::string content = read_file(file_);
  std::string same = content;
  put_checksums(same);
  ASSERT_TRUE(same == content);
  Random random(6, "words");
  const std::size_t first = kTable + number_at<std::uint32_t>(content, 12) * kTableRow;
  int refused = 0;
  for (int trial = 0; trial < 800; ++trial) {
    std::string wrong = content;
    const std::size_t words = (wrong.size() - first) / 4;
    // Every other one among the first fields of a section, where the counts are.
    const std::size_t row = kTable + random.below(number_at<std::uint32_t>(content, 12)) * kTableRow;
    const std::size_t place = trial % 2 == 0 ? first + 4 * random.below(words)
                                             : number_at<std::uint64_t>(content, row + 8) + 4 * random.below(8);
    const std::int32_t values[] = {
        -1, 0, 1, 1 << 20, std::numeric_limits<std::int32_t>::max(), std::numeric_limits<std::int32_t>::min()};
    std::memcpy(wrong.data() + place, &values[random.below(6)], 4);
    put_checksums(wrong);
    const std::filesystem::path file = folder_.write("wrong.basis", wrong);
    try {
      const Subspace subspace = read_subspace(file, model_.mesh, model_.truth, RunContext{});
      const Eigen::VectorXd q = Eigen::VectorXd::Ones(subspace.degrees_of_freedom());
      EXPECT_EQ(vertex_displacements(subspace, q).rows(), model_.mesh.vertices.rows());
    } catch (const InputError&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 100);
}

INSTANTIATE_TEST_SUITE_P(Models, WronglyWrittenBasis,
                         testing::Values(StoredCase{"Oh", GroupMode::floating, LiftKind::orbit},
                                         StoredCase{"row", GroupMode::floating, LiftKind::orbit},
                                         StoredCase{"vase", GroupMode::moving, LiftKind::orbit}),
                         stored_case_name);

TEST(WrittenBasis, LeavesNothingBehindInAFolderThatDoesNotExist) {
  const GeneratedModel model = model_named("Oh");
  const Subspace subspace = built(model, GroupMode::fixed, LiftKind::orbit);
  const TemporaryFolder folder;
  EXPECT_THROW(write_subspace(folder.file("none/stored.basis"), subspace, model.mesh, model.truth), InputError);
  EXPECT_TRUE(folder.listing().empty());
}

}  // namespace
}  // namespace orbifit
