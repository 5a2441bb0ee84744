#include "files/three_mf.h"

#include <ostream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "orbifit/model/appearance.h"
#include "orbifit/model/errors.h"
#include "orbifit/model/mesh_io.h"

#include "base/random.h"
#include "files/file.h"
#include "mesh_samples.h"
#include "refused_mesh.h"
#include "temporary_folder.h"
#include "three_mf_package.h"
#include "three_mf_sample.h"

namespace orbifit {
namespace {

using Place = ThreeMfSample::Place;

class ThreeMf : public testing::Test {
 protected:
  Mesh read(const ThreeMfSample& sample) const {
    sample.write(file_);
    return read_mesh(file_);
  }

  ThreeMfContent content() const {
    MeshBuilder builder(file_.string());
    return read_three_mf_content(file_, read_file(file_), builder);
  }

  void expect_refused(const std::string& reason) const { expect_mesh_refused(file_, reason); }

  TemporaryFolder folder_;
  std::filesystem::path file_ = folder_.file("a.3mf");
};

Place quarter_about_z(double x) {
  Place place;
  place << 0, -1, 0, x, 1, 0, 0, 0, 0, 0, 1, 0;
  return place;
}

Points placed(const Points& points, const Place& place) {
  return (points * place.leftCols<3>().transpose()).rowwise() + place.col(3).transpose();
}

// A leg at two places of a table, the second turned; a table as it is and mirrored; and the leg alone.
ThreeMfSample furniture() {
  ThreeMfSample sample;
  sample.unit = 3;
  const Mesh leg = polygon_mesh();
  Place mirror = ThreeMfSample::at(0, 0, 7);
  mirror(0, 0) = -1;
  sample.objects = {
      {"leg", leg, {}}, {"table", {}, {{0, ThreeMfSample::at(10, 0, 0)}, {0, quarter_about_z(20)}}}, {"", leg, {}}};
  sample.items = {{1, ThreeMfSample::at(0, 0, 0)}, {1, mirror}, {2, ThreeMfSample::at(0, 50, 0)}};
  return sample;
}

TEST_F(ThreeMf, HasTheItemsOfTheBuildInTheirOrder) {
  const Mesh mesh = read(furniture());
  const Mesh leg = polygon_mesh();
  ASSERT_EQ(mesh.vertices.rows(), 5 * 9);
  ASSERT_EQ(mesh.faces.rows(), 5 * 8);
  Place mirror = ThreeMfSample::at(0, 0, 7);
  mirror(0, 0) = -1;
  const Points first = placed(leg.vertices, ThreeMfSample::at(10, 0, 0));
  const Points second = placed(leg.vertices, quarter_about_z(20));
  const auto near = [&](int part, const Points& wanted) {
    EXPECT_LE((mesh.vertices.middleRows(9 * part, 9) - wanted).cwiseAbs().maxCoeff(), 1e-5) << part;
  };
  near(0, first);
  near(1, second);
  near(2, placed(first, mirror));
  near(3, placed(second, mirror));
  near(4, placed(leg.vertices, ThreeMfSample::at(0, 50, 0)));
  EXPECT_EQ(mesh.faces.topRows(8), leg.faces);
  EXPECT_EQ(mesh.faces.bottomRows(8), (leg.faces.array() + 36).matrix());
  const Eigen::RowVector3i corners = leg.faces.row(3).array() + 27;
  EXPECT_EQ(mesh.faces.row(3 * 8 + 3), Eigen::RowVector3i(corners[0], corners[2], corners[1]));  // turned over
}

TEST_F(ThreeMf, TellsUnitNamesAndCopies) {
  const Mesh mesh = read(furniture());
  const ThreeMfContent told = content();
  EXPECT_EQ(told.unit, "inch");
  EXPECT_EQ(told.objects, 3);
  EXPECT_EQ(told.items, 3);
  ASSERT_EQ(told.parts.size(), 5U);
  EXPECT_EQ(told.parts[3].object, told.parts[0].object);
  EXPECT_NE(told.parts[4].object, told.parts[0].object);
  EXPECT_EQ(told.parts[4].first_face, 32);
  const Appearance look = read_appearance(file_, mesh);
  ASSERT_EQ(look.part_of_face.size(), 40U);
  EXPECT_EQ(look.parts[static_cast<std::size_t>(look.part_of_face[0])].object, "leg");
  EXPECT_EQ(look.parts[static_cast<std::size_t>(look.part_of_face[39])].object, "");
  EXPECT_EQ(look.part_of_face[7], 0);
  EXPECT_EQ(look.part_of_face[8], 1);
}

TEST_F(ThreeMf, RefusesComponentsThatMultiplyBeyondBounds) {
  ThreeMfSample sample;
  sample.objects = {{"seed", polygon_mesh(), {}}};
  for (int level = 0; level < 25; ++level) {
    sample.objects.push_back({"", {}, {{level, ThreeMfSample::at(1, 0, 0)}, {level, ThreeMfSample::at(2, 0, 0)}}});
  }
  sample.items = {{25, ThreeMfSample::at(0, 0, 0)}};
  sample.write(file_);
  expect_refused("components that multiply to more than a million parts");
}

TEST_F(ThreeMf, RefusesWhatIsEmptyOrNoZip) {
  ThreeMfSample sample = furniture();
  sample.items.clear();
  sample.write(file_);
  expect_refused("has no vertices");
  write_file(file_, "PK\x03\x04 and no more");
  expect_refused("is no 3MF, or damaged: its zip archive cannot be opened");
  write_file(file_, "v 0 0 0\n");
  expect_refused("is no 3MF, or damaged: its zip archive cannot be opened");
}

struct BadModel {
  std::string name, resources, build, reason;
};

void PrintTo(const BadModel& model, std::ostream* out) {
  *out << model.name;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

// Objects of which each has two of the one before it, from a mesh of id 1 on.
std::string doubled(int levels) {
  std::string text;
  for (int id = 2; id < 2 + levels; ++id) {
    const std::string component = "<component objectid=\"" + std::to_string(id - 1) + "\"/>";
    text += "<object id=\"" + std::to_string(id) + "\"><components>" + component + component + "</components></object>";
  }
  return text;
}

std::vector<BadModel> bad_models() {
  const std::string mesh =
      "<object id=\"1\"><mesh><vertices><vertex x=\"0\" y=\"0\" z=\"0\"/><vertex x=\"1\" y=\"0\" z=\"0\"/>"
      "<vertex x=\"0\" y=\"1\" z=\"0\"/></vertices><triangles><triangle v1=\"0\" v2=\"1\" v3=\"2\"/></triangles></mesh>"
      "</object>";
  const std::string item = "<item objectid=\"1\"/>";
  std::string items;
  for (int i = 0; i < 31'000; ++i) items += item;
  const std::string last = "<item objectid=\"200\"/>";
  return {
      {"IndexBeyond", replaced(mesh, "v3=\"2\"", "v3=\"3\""), item, "Invalid model node index"},
      {"IndexNegative", replaced(mesh, "v3=\"2\"", "v3=\"-1\""), item, "Invalid model node index"},
      {"IndexHuge", replaced(mesh, "v3=\"2\"", "v3=\"99999999999\""), item, "Invalid model node index"},
      {"CoordinateNan", replaced(mesh, "x=\"1\"", "x=\"nan\""), item, "Invalid Model Coordinates"},
      {"CoordinateWord", replaced(mesh, "x=\"1\"", "x=\"one\""), item, "a vertex whose x is no number: 'one'"},
      {"CoordinateTooLarge", replaced(mesh, "x=\"1\"", "x=\"1e40\""), item, "Invalid Model Coordinates"},
      {"ItemOfNoObject", mesh, "<item objectid=\"7\"/>", "Could not find Object associated to the Build item"},
      {"ComponentOfItself", "<object id=\"1\"><components><component objectid=\"1\"/></components></object>", item,
       "Could not find Object associated to Component"},
      {"ComponentOfALaterObject",
       "<object id=\"9\"><components><component objectid=\"1\"/></components></object>" + mesh, item,
       "Could not find Object associated to Component"},
      {"SameIdTwice", mesh + mesh, item, "Duplicate Resource ID"},
      {"TransformTooShort", mesh, "<item objectid=\"1\" transform=\"1 0 0\"/>", "Not enough values"},
      {"TransformNan", mesh, "<item objectid=\"1\" transform=\"nan 0 0 0 1 0 0 0 1 0 0 0\"/>", "is not finite"},
      {"NoItems", mesh, "", "has no vertices"},
      {"TextThatEnds", mesh + "<object id=", item, "cannot be read as 3MF: "},
      {"ComponentsThatDouble", mesh + doubled(199), last, "components that multiply to more than a million parts"},
      {"TooManyItems", mesh, items, "more than 30000 objects, components and items"},
  };
}

class BadThreeMf : public ThreeMf, public testing::WithParamInterface<BadModel> {};

TEST_P(BadThreeMf, IsRefusedWithItsReason) {
  write_three_mf_of(file_,
                    "<?xml version=\"1.0\"?><model unit=\"millimeter\" "
                    "xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\"><resources>" +
                        GetParam().resources + "</resources><build>" + GetParam().build + "</build></model>");
  expect_refused(GetParam().reason);
}

INSTANTIATE_TEST_SUITE_P(All, BadThreeMf, testing::ValuesIn(bad_models()),
                         [](const auto& test) { return test.param.name; });

TEST_F(ThreeMf, OfAnExtensionThatIsRequiredAndUnknownIsRefused) {
  const std::string model =
      "<?xml version=\"1.0\"?><model requiredextensions=\"q\" xmlns:q=\"http://q.example\" unit=\"millimeter\" "
      "xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\"><resources><object id=\"1\"><mesh>"
      "<vertices><vertex x=\"0\" y=\"0\" z=\"0\"/><vertex x=\"1\" y=\"0\" z=\"0\"/><vertex x=\"0\" y=\"1\" z=\"0\"/>"
      "</vertices><triangles><triangle v1=\"0\" v2=\"1\" v3=\"2\"/></triangles></mesh></object></resources>"
      "<build><item objectid=\"1\"/></build></model>";
  write_three_mf_of(file_, model);
  expect_refused("requiredextensions: names an extension of 3MF that cannot be read");
  write_three_mf_of(file_, replaced(model, "requiredextensions=\"q\" ", ""));
  EXPECT_EQ(read_mesh(file_).faces.rows(), 1);
}

TEST_F(ThreeMf, OfDamagedBytesIsAMeshOrAnError) {
  furniture().write(file_);
  const std::string whole = read_file(file_);
  int refused = 0;
  const auto try_to_read = [&](const std::string& bytes) {
    write_file(file_, bytes);
    try {
      const Mesh mesh = read_mesh(file_);
      EXPECT_LT(mesh.faces.maxCoeff(), mesh.vertices.rows());
    } catch (const InputError&) {
      ++refused;
    }
  };
  for (std::size_t length = 1; length < whole.size(); length += 17) try_to_read(whole.substr(0, length));
  EXPECT_GT(refused, 50);
  Random random(5, "damaged 3mf");
  for (int round = 0; round < 400; ++round) {
    std::string bytes = whole;
    for (std::uint64_t flips = 1 + random.below(4); flips > 0; --flips) {
      bytes[random.below(bytes.size())] = static_cast<char>(random.below(256));
    }
    try_to_read(bytes);
  }
  EXPECT_GT(refused, 300);
}

}  // namespace
}  // namespace orbifit
