#include "batch/bop.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "orbifit/model/errors.h"

#include "cube.h"

namespace orbifit::batch {
namespace {

SymmetryAnnotation read(const std::string& text) {
  return annotation_from_bop(text, cube_mesh(), "models_info.json: 1");
}

TEST(Bop, DiscreteSymmetriesAreAGroupOfTheWhole) {
  // A half turn about the vertical through (1, 2, 0).
  const auto found = read(R"({"symmetries_discrete": [[-1,0,0,2, 0,-1,0,4, 0,0,1,0, 0,0,0,1]]})");
  ASSERT_EQ(found.regions.size(), 1U);
  EXPECT_EQ(found.regions[0].group.symbol(), "C2");
  EXPECT_EQ(found.regions[0].faces.size(), static_cast<std::size_t>(cube_mesh().faces.rows()));
  EXPECT_NEAR(found.regions[0].centre.x(), 1, 1e-12);
  EXPECT_NEAR(found.regions[0].centre.y(), 2, 1e-12);
}

TEST(Bop, ContinuousOnesAreAboutAnAxis) {
  const std::string axis = R"("symmetries_continuous": [{"axis": [0,0,1], "offset": [0,0,5]}])";
  EXPECT_EQ(read("{" + axis + "}").regions[0].group.symbol(), "Cinf");
  const auto flipped = read("{" + axis + R"(, "symmetries_discrete": [[1,0,0,0, 0,-1,0,0, 0,0,-1,4, 0,0,0,1]]})");
  EXPECT_EQ(flipped.regions[0].group.symbol(), "Dinf");
  EXPECT_NEAR(flipped.regions[0].centre.z(), 2, 1e-12);
  EXPECT_TRUE(read(R"({"diameter": 1})").regions.empty());
}

TEST(Bop, ComesBackAsItWas) {
  for (const char* symbol : {"C2", "C5", "D3", "O", "Cinf", "Dinf", "K"}) {
    const Mesh mesh = cube_mesh();
    SymmetryAnnotation annotation = empty_annotation(mesh, 0.005);
    std::vector<int> faces(static_cast<std::size_t>(mesh.faces.rows()));
    for (std::size_t f = 0; f < faces.size(); ++f) faces[f] = static_cast<int>(f);
    const Eigen::Vector3d centre(0.1, 0.2, 0.3), axis = Eigen::Vector3d(1, 2, 2) / 3;
    annotation.regions.push_back(make_region(*PointGroup::parse(symbol), centre, frame_about(axis), faces, "whole"));
    const std::string text = annotation_to_bop(annotation, mesh);
    EXPECT_NEAR(nlohmann::json::parse(text).at("diameter").get<double>(), std::sqrt(3.0), 1e-12);
    const auto back = read(text);
    ASSERT_EQ(back.regions.size(), 1U);
    EXPECT_EQ(back.regions[0].group.symbol(), symbol);
    // Of a group about an axis the centre is any point of it.
    const Eigen::Vector3d off = back.regions[0].centre - centre;
    EXPECT_LT((off - axis * axis.dot(off)).norm(), 1e-9) << symbol;
  }
}

TEST(Bop, RefusesWhatIsNoSymmetry) {
  EXPECT_THROW(read(R"({"symmetries_discrete": [[1,2,3]]})"), InputError);
  EXPECT_THROW(read(R"({"symmetries_discrete": [[2,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]]})"), InputError);
  EXPECT_THROW(read(R"({"symmetries_discrete": [[0,-1,0,0, 1,0,0,0, 0,0,1,0, 0,0,0,1]]})"),
               InputError);  // no half turn
  EXPECT_THROW(read(R"({"symmetries_continuous": [{"axis": [0,0,1]}]})"), InputError);
  EXPECT_THROW(read("[1"), InputError);
}

}  // namespace
}  // namespace orbifit::batch
