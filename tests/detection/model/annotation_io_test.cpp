#include "orbifit/model/annotation_io.h"

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "orbifit/model/errors.h"
#include "orbifit/model/mesh_io.h"

#include "base/random.h"
#include "files/file.h"
#include "mesh_samples.h"
#include "temporary_folder.h"

namespace orbifit {
namespace {

SymmetryAnnotation sample_annotation(const Mesh& mesh, const Eigen::Vector3d& centre = {0.1, 0.2, 0.3}) {
  SymmetryAnnotation annotation = empty_annotation(mesh, 0.005);
  const Eigen::Matrix3d frame = Random(2, "frame").rotation();
  std::vector<int> all(static_cast<std::size_t>(mesh.faces.rows()));
  for (std::size_t f = 0; f < all.size(); ++f) all[f] = static_cast<int>(f);
  int id = 0;
  for (const char* symbol : {"C4v", "Cs", "Ci", "Ih", "Dinfh", "Kh", "D6d"}) {
    const std::vector<int> faces = id == 0 ? all : std::vector<int>{0, 1, 2, 5, 7};
    Region region =
        make_region(*PointGroup::parse(symbol), centre, frame, faces, "part \"" + std::to_string(id) + "\" \xC3\xA9");
    region.id = id++;
    region.residual = {1.0 / 3, 2.0 / 3};
    if (id % 2 == 0) region.importance = 1.0 / (id + 3);
    annotation.regions.push_back(region);
  }
  set_parents(annotation.regions);
  Pattern pattern;
  pattern.id = 4;
  pattern.name = "windows";
  pattern.kind = Pattern::Kind::translation_1d;
  pattern.generators = {{Eigen::Matrix3d::Identity(), {1.0 / 7, 0, 0}}};
  pattern.instances = {{{}, {0, 1}}, {pattern.generators.front(), {3, 4}}};
  annotation.patterns.push_back(pattern);
  return annotation;
}

void expect_equal(const std::vector<Motion>& a, const std::vector<Motion>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].linear, b[i].linear);
    EXPECT_EQ(a[i].translation, b[i].translation);
  }
}

TEST(Annotation, GivesBackEveryBit) {
  const TemporaryFolder folder;
  const Mesh mesh = polygon_mesh();
  const SymmetryAnnotation written = sample_annotation(mesh);
  write_annotation(folder.file("a.json"), written);
  const SymmetryAnnotation read = read_annotation(folder.file("a.json"), mesh);
  EXPECT_EQ(read.mesh_diagonal, written.mesh_diagonal);
  ASSERT_EQ(read.regions.size(), written.regions.size());
  for (std::size_t r = 0; r < read.regions.size(); ++r) {
    const Region& a = read.regions[r];
    const Region& b = written.regions[r];
    EXPECT_EQ(a.id, b.id);
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.group, b.group);
    EXPECT_EQ(a.centre, b.centre);
    EXPECT_LT((a.axis - b.axis).norm(), 3e-16);
    EXPECT_EQ(a.faces, b.faces);
    EXPECT_EQ(a.parent, b.parent);
    EXPECT_EQ(a.residual.max, b.residual.max);
    expect_equal(a.generators, b.generators);
    expect_equal(a.elements, b.elements);
  }
  ASSERT_EQ(read.patterns.size(), 1U);
  expect_equal(read.patterns[0].generators, written.patterns[0].generators);
  EXPECT_EQ(read.patterns[0].instances[1].faces, written.patterns[0].instances[1].faces);
  EXPECT_EQ(to_json(read), to_json(written));
}

TEST(Annotation, KnowsWhereUpIsIfSomebodySaidSo) {
  const Mesh mesh = polygon_mesh();
  SymmetryAnnotation annotation = sample_annotation(mesh);
  EXPECT_EQ(to_json(annotation).find("\"up\""), std::string::npos);
  annotation.up = -Eigen::Vector3d::UnitY();
  const std::string text = to_json(annotation);
  EXPECT_EQ(annotation_from_json(text, mesh, "a.json").up, annotation.up);
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(std::acos(0.0), Eigen::Vector3d::UnitX()).toRotationMatrix();
  EXPECT_LT((*transformed(annotation, {2, turn, {1, 2, 3}}).up + Eigen::Vector3d::UnitZ()).norm(), 1e-15);
  std::string spoilt = text;
  spoilt.replace(spoilt.find("[0, -1, 0]"), 10, "[0, 0, 0]");
  EXPECT_THROW(annotation_from_json(spoilt, mesh, "a.json"), InputError);
}

TEST(Annotation, WritesRunsThatDoNotTouch) {
  const std::string text = to_json(sample_annotation(polygon_mesh()));
  EXPECT_NE(text.find("\"faces\": [[0, 3], [5, 1], [7, 1]]"), std::string::npos);
  EXPECT_NE(text.find("\"faces\": [[0, 8]]"), std::string::npos);
  EXPECT_EQ(text.find("-0,"), std::string::npos);
}

TEST(Annotation, HoldsFarFromTheOrigin) {
  const TemporaryFolder folder;
  Mesh mesh = polygon_mesh();
  const Eigen::RowVector3d offset(1e4, -2e4, 3e4);
  mesh.vertices.rowwise() += offset;
  write_annotation(folder.file("a.json"), sample_annotation(mesh, offset.transpose()));
  EXPECT_EQ(read_annotation(folder.file("a.json"), mesh).regions.size(), 7U);
}

TEST(Annotation, OfAnStlMayCountPlaces) {
  const TemporaryFolder folder;
  write_mesh(folder.file("a.stl"), polygon_mesh());
  const Mesh mesh = read_mesh(folder.file("a.stl"));
  ASSERT_EQ(mesh.vertices.rows(), 24);
  SymmetryAnnotation annotation = empty_annotation(mesh, 0.01);
  for (const int vertices : {24, 9}) {
    annotation.mesh_vertices = vertices;
    write_annotation(folder.file("a.json"), annotation);
    EXPECT_EQ(read_annotation(folder.file("a.json"), mesh).mesh_vertices, 24);
  }
  annotation.mesh_vertices = 10;
  write_annotation(folder.file("a.json"), annotation);
  EXPECT_THROW(read_annotation(folder.file("a.json"), mesh), InputError);
}

TEST(Annotation, IgnoresKeysItDoesNotKnowAndRunsOutOfOrder) {
  const TemporaryFolder folder;
  std::string text = to_json(sample_annotation(polygon_mesh()));
  const std::string runs = "[[0, 3], [5, 1], [7, 1]]";
  text.replace(text.find(runs), runs.size(), "[[7, 1], [0, 2], [1, 2], [5, 1]]");
  text.replace(text.find("\"version\""), 0, "\"comment\": {\"a\": [1, 2]}, ");
  const SymmetryAnnotation read = read_annotation(folder.write("a.json", text), polygon_mesh());
  EXPECT_EQ(read.regions[1].faces, (std::vector<int>{0, 1, 2, 5, 7}));
}

struct Mistake {
  std::string name, from, to, message;
};

std::vector<Mistake> mistakes() {
  // Written about the origin in the axes' frame, the numbers are easy to find.
  return {
      {"Format", "symmetry-annotation", "other", "format: is 'other', not 'symmetry-annotation'"},
      {"Version", "\"version\": 1", "\"version\": 2", "version: is 2: only version 1 is read"},
      {"NoVersion", "\"version\": 1,", "", "version: is missing"},
      {"Vertices", "\"vertices\": 9", "\"vertices\": 8",
       "mesh.vertices: the annotation is of a mesh with 8 vertices, this one has 9"},
      {"Faces", "\"faces\": 8", "\"faces\": 9", "mesh.faces: the annotation is of a mesh with 9 faces, this one has 8"},
      {"Comma", "\"version\": 1,", "\"version\": 1", "line 4: is not JSON: syntax error"},
      {"Tolerance", "\"tolerance\": 0.005", "\"tolerance\": \"small\"", "tolerance: must be a number"},
      {"Group", "\"C4v\"", "\"C4w\"", "regions[0].group: 'C4w' is no symbol"},
      {"OtherGroup", "\"C4v\"", "\"D4\"", "regions[0].group: is D4, but the elements form C4v"},
      {"Order", "\"C4v\"", "\"C3v\"", "regions[0].elements: has 8 motions, but C3v has 6 elements"},
      {"NoTrivialGroup", "\"C4v\"", "\"C1\"", "regions[0].group: 'C1' is no symbol"},
      {"Axis", "\"axis\": [0, 0, 1]", "\"axis\": [0, 0, 1.1]",
       "regions[0].axis: must be a unit vector, its length is 1.1"},
      {"NoAxis", "\"axis\": [0, 0, 1],", "", "regions[0].axis: is missing"},
      {"Centre", "\"centre\": [0, 0, 0]", "\"centre\": [0, 0]", "regions[0].centre: must be a list of three numbers"},
      {"CentreMoves", "\"centre\": [0, 0, 0]", "\"centre\": [1, 0, 0]", "moves the region's centre by"},
      {"Orthogonal", "[[0, -1, 0, 0]", "[[0, -1.00001, 0, 0]",
       "regions[0].generators[0]: is not orthogonal: |R R^T - 1| is 2.0000"},
      {"Rows", "[[0, -1, 0, 0], ", "[", "regions[0].generators[0]: must be a 3x4 matrix"},
      {"RunOutside", "\"faces\": [[0, 8]]", "\"faces\": [[0, 9]]",
       "regions[0].faces[0]: the run [0, 9] is outside the mesh, which has 8 faces"},
      {"RunHuge", "\"faces\": [[0, 8]]", "\"faces\": [[9223372036854775807, 9223372036854775807]]",
       "is outside the mesh"},
      {"RunNegative", "\"faces\": [[0, 8]]", "\"faces\": [[-1, 2]]",
       "regions[0].faces[0]: the run [-1, 2] is outside the mesh"},
      {"RunShape", "\"faces\": [[0, 8]]", "\"faces\": [0, 8]", "regions[0].faces[0]: must be a run [first, count]"},
      {"NoFaces", "\"faces\": [[0, 8]]", "\"faces\": []", "regions[0].faces: must name at least one face"},
      {"ParentSelf", "\"parent\": null", "\"parent\": 0", "regions[0].parent: leads back to the region itself"},
      {"Residual", "\"rms\": 0,", "\"rms\": -1,", "regions[0].residual: must not be negative"},
      {"Importance", "\"parent\": null", "\"parent\": null, \"importance\": 1.5",
       "regions[0].importance: must be from 0 to 1"},
      {"NotANumber", "\"rms\": 0,", "\"rms\": 1e999,", "is not JSON"},
      {"Regions", "\"regions\": [", "\"region\": [", "regions: is missing"},
  };
}

class RefusedAnnotation : public testing::TestWithParam<Mistake> {};

TEST_P(RefusedAnnotation, WithFileKeyAndReason) {
  const TemporaryFolder folder;
  const Mesh mesh = polygon_mesh();
  SymmetryAnnotation annotation = empty_annotation(mesh, 0.005);
  annotation.regions.push_back(make_region(*PointGroup::parse("C4v"), Eigen::Vector3d::Zero(),
                                           Eigen::Matrix3d::Identity(), {0, 1, 2, 3, 4, 5, 6, 7}, "all"));
  std::string text = to_json(annotation);
  ASSERT_NE(text.find(GetParam().from), std::string::npos) << text;
  text.replace(text.find(GetParam().from), GetParam().from.size(), GetParam().to);
  const auto file = folder.write("a.json", text);
  try {
    read_annotation(file, mesh);
    ADD_FAILURE() << "was read";
  } catch (const InputError& error) {
    const std::string message = error.what();
    EXPECT_TRUE(message.starts_with(file.string() + ": ")) << message;
    EXPECT_NE(message.find(GetParam().message), std::string::npos) << message;
  }
}

INSTANTIATE_TEST_SUITE_P(Table, RefusedAnnotation, testing::ValuesIn(mistakes()),
                         [](const auto& test) { return test.param.name; });

// Lists of elements with one entry wrong, about a centre far away.
class ElementsOfARegion : public testing::Test {
 protected:
  std::string refusal(const std::function<void(Region&)>& spoil) {
    const TemporaryFolder folder;
    Mesh mesh = polygon_mesh();
    const Eigen::RowVector3d offset(1e3, 2e3, -5e3);
    mesh.vertices.rowwise() += offset;
    SymmetryAnnotation annotation = empty_annotation(mesh, 0.005);
    annotation.regions.push_back(
        make_region(*PointGroup::parse("D3h"), offset.transpose(), Random(4, "frame").rotation(), {0, 1}, "spoilt"));
    spoil(annotation.regions.front());
    write_annotation(folder.file("a.json"), annotation);
    try {
      read_annotation(folder.file("a.json"), mesh);
    } catch (const InputError& error) {
      return error.what();
    }
    return "was read";
  }
};

TEST_F(ElementsOfARegion, AreReadWhenNothingIsWrong) {
  EXPECT_EQ(refusal([](Region&) {}), "was read");
}

TEST_F(ElementsOfARegion, MustBeClosed) {
  const auto turn = [](Region& region) {
    region.elements[5] = region.elements[5] * Motion::rotation(region.axis, 1e-4, region.centre);
  };
  EXPECT_NE(refusal(turn).find("regions[0].elements: is not closed"), std::string::npos) << refusal(turn);
  const auto turn_less = [](Region& region) {
    region.elements[5] = region.elements[5] * Motion::rotation(region.axis, 1e-7, region.centre);
  };
  EXPECT_EQ(refusal(turn_less), "was read");
}

TEST_F(ElementsOfARegion, MustFixTheCentre) {
  const auto shift = [](Region& region) { region.elements[4].translation.x() += 1e-3; };
  EXPECT_NE(refusal(shift).find("regions[0].elements[4]: moves the region's centre"), std::string::npos);
}

TEST_F(ElementsOfARegion, MustDiffer) {
  const auto repeat = [](Region& region) { region.elements[3] = region.elements[2]; };
  EXPECT_NE(refusal(repeat).find("regions[0].elements[3]: repeats element 2"), std::string::npos) << refusal(repeat);
}

TEST_F(ElementsOfARegion, BeginWithTheIdentity) {
  const auto swap = [](Region& region) { std::swap(region.elements[0], region.elements[1]); };
  EXPECT_NE(refusal(swap).find("regions[0].elements[0]: must be the identity"), std::string::npos) << refusal(swap);
}

TEST(Annotation, FindsParentsAnewWhereOneWasDeletedByHand) {
  const TemporaryFolder folder;
  const Mesh mesh = polygon_mesh();
  SymmetryAnnotation written = sample_annotation(mesh);
  written.regions.resize(3);
  written.regions[1].faces = {0, 1, 2, 5, 7};
  written.regions[2].faces = {0, 1};
  set_parents(written.regions);
  ASSERT_EQ(written.regions[2].parent, 1);
  written.regions.erase(written.regions.begin() + 1);
  write_annotation(folder.file("a.json"), written);
  const SymmetryAnnotation read = read_annotation(folder.file("a.json"), mesh);
  ASSERT_EQ(read.regions.size(), 2U);
  EXPECT_FALSE(read.regions[0].parent);
  EXPECT_EQ(read.regions[1].parent, 0);
}

TEST(Annotation, DamageGivesAnAnnotationOrAnError) {
  const TemporaryFolder folder;
  const Mesh mesh = polygon_mesh();
  const std::string text = to_json(sample_annotation(mesh));
  Random random(13, "annotation");
  int errors = 0;
  for (int round = 0; round < 1500; ++round) {
    std::string damaged = text;
    if (round % 3 == 0) damaged.resize(random.below(text.size()));
    for (std::uint64_t flips = 1 + random.below(4); flips > 0 && !damaged.empty(); --flips) {
      damaged[random.below(damaged.size())] = "0123456789[]{},:\"-.e\xFFnx"[random.below(24)];
    }
    try {
      read_annotation(folder.write("a.json", damaged), mesh);
    } catch (const InputError&) {
      ++errors;
    }
  }
  EXPECT_GT(errors, 100);
}

}  // namespace
}  // namespace orbifit
