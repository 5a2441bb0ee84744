#include "surface/repeated_parts.h"

#include <array>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "patterns/pattern_search.h"
#include "shapes.h"
#include "surface/segments.h"

namespace orbifit {
namespace {

using Cell = std::array<int, 3>;

// The welded surface of some unit cubes of a lattice, two triangles a square.
Mesh surface_of(const std::set<Cell>& cells) {
  std::map<Cell, int> vertices;
  std::vector<std::array<int, 3>> faces;
  const auto vertex = [&](Cell at) { return vertices.emplace(at, static_cast<int>(vertices.size())).first->second; };
  for (const Cell& cell : cells) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (const int side : {0, 1}) {
        Cell next = cell;
        next[axis] += side == 1 ? 1 : -1;
        if (cells.contains(next)) continue;
        std::array<int, 4> corners{};
        for (std::size_t k = 0; k < 4; ++k) {
          Cell at = cell;
          at[axis] += side;
          at[(axis + 1) % 3] += k == 1 || k == 2 ? 1 : 0;
          at[(axis + 2) % 3] += k >= 2 ? 1 : 0;
          corners[k] = vertex(at);
        }
        if (side == 0) std::swap(corners[1], corners[3]);
        faces.push_back({corners[0], corners[1], corners[2]});
        faces.push_back({corners[0], corners[2], corners[3]});
      }
    }
  }
  Mesh mesh;
  mesh.vertices.resize(static_cast<Eigen::Index>(vertices.size()), 3);
  for (const auto& [at, number] : vertices) mesh.vertices.row(number) << at[0], at[1], at[2];
  mesh.faces.resize(static_cast<Eigen::Index>(faces.size()), 3);
  for (std::size_t f = 0; f < faces.size(); ++f) {
    mesh.faces.row(static_cast<Eigen::Index>(f)) << faces[f][0], faces[f][1], faces[f][2];
  }
  return mesh;
}

// A slab with a row of towers on it, and a step at one end that makes the slab asymmetric.
std::set<Cell> slab_with_towers(int towers) {
  std::set<Cell> cells;
  for (int x = 0; x < 2 * towers + 2; ++x) {
    for (int y = 0; y < 5; ++y) cells.insert({x, y, 0});
  }
  for (int t = 0; t < towers; ++t) {
    cells.insert({2 * t + 1, 1, 1});
    cells.insert({2 * t + 1, 1, 2});
  }
  return cells;
}

PreparedMesh in_pieces(const Mesh& mesh) {
  PreparedMesh prepared = prepare(mesh);
  prepared.components = smooth_segments(prepared);
  return prepared;
}

class Towers : public testing::TestWithParam<int> {};

TEST_P(Towers, AreThePartsOfASlab) {
  constexpr std::size_t kFacesOfTower = 2 * 9;
  const PreparedMesh pieces = in_pieces(surface_of(slab_with_towers(GetParam())));
  const Components parts = repeated_parts(pieces);
  int towers = 0;
  std::size_t faces = 0;
  for (const std::vector<int>& part : parts.faces) {
    faces += part.size();
    if (part.size() == kFacesOfTower) ++towers;
  }
  EXPECT_EQ(towers, GetParam());
  EXPECT_EQ(faces, parts.component_of_face.size());
  for (std::size_t f = 0; f < parts.component_of_face.size(); ++f) {
    const std::vector<int>& of = parts.faces[static_cast<std::size_t>(parts.component_of_face[f])];
    EXPECT_TRUE(std::ranges::binary_search(of, static_cast<int>(f)));
  }
}

TEST_P(Towers, AreARow) {
  PreparedMesh prepared = in_pieces(surface_of(slab_with_towers(GetParam())));
  prepared.components = repeated_parts(prepared);
  const RunContext context;
  PartRegionOptions options;
  options.pieces = true;
  const SurfaceIndex whole(prepared.mesh);
  const PartRegions parts =
      find_part_regions(prepared, survey_components(prepared, options.tolerance, options.least_share, context), whole,
                        {}, hemisphere_directions(500), options, context);
  const std::vector<Pattern> found = find_patterns(prepared, parts, {}, options, context);
  const auto row = std::ranges::find(found, Pattern::Kind::translation_1d, &Pattern::kind);
  ASSERT_NE(row, found.end());
  EXPECT_EQ(row->instances.size(), static_cast<std::size_t>(GetParam()));
  EXPECT_NEAR(row->generators.at(0).translation.norm(), 2, 1e-9);  // in the frame of the mesh as given
  EXPECT_LT(row->residual.max, 1e-12);
}

INSTANTIATE_TEST_SUITE_P(Counts, Towers, testing::Values(3, 4, 7));

TEST(RepeatedParts, OfABoxAreItsPieces) {
  const PreparedMesh pieces = in_pieces(test::box(1, 1.4, 2.3));
  std::size_t faces = 0;
  for (const std::vector<int>& part : repeated_parts(pieces).faces) faces += part.size();
  EXPECT_EQ(faces, static_cast<std::size_t>(pieces.mesh.faces.rows()));
}

}  // namespace
}  // namespace orbifit
