#include "remeshing/remesh.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <ostream>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "orbifit/datasets_tools/generate.h"
#include "orbifit/model/errors.h"

#include "base/random.h"
#include "geometry/surface_index.h"
#include "geometry/topology.h"
#include "solids.h"

namespace orbifit {
namespace {

using Eigen::Vector3d;

Remeshed remeshed(const Mesh& mesh, double cell = 1.0 / 60, std::uint64_t seed = 1, int threads = 1) {
  RunContext context;
  context.seed = seed;
  context.threads = threads;
  return remesh(mesh, {.cell = cell}, context);
}

int euler_characteristic(const Mesh& mesh) {
  return static_cast<int>(mesh.vertices.rows() - welded_edges(mesh, weld_vertices(mesh.vertices)).size() +
                          mesh.faces.rows());
}

// Whether the faces at every vertex follow one another round it in a single ring.
bool every_vertex_has_one_ring(const Mesh& mesh) {
  std::vector<std::map<int, int>> rings(static_cast<std::size_t>(mesh.vertices.rows()));
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      auto& ring = rings[static_cast<std::size_t>(mesh.faces(f, k))];
      if (!ring.emplace(mesh.faces(f, (k + 1) % 3), mesh.faces(f, (k + 2) % 3)).second) return false;
    }
  }
  return std::ranges::all_of(rings, [](const std::map<int, int>& ring) {
    if (ring.empty()) return false;
    std::size_t steps = 0;
    int at = ring.begin()->first;
    do {
      const auto next = ring.find(at);
      if (next == ring.end()) return false;
      at = next->second;
      ++steps;
    } while (at != ring.begin()->first && steps <= ring.size());
    return steps == ring.size();
  });
}

void expect_closed_surface(const Mesh& mesh) {
  const MeshReport report = inspect(mesh);
  EXPECT_TRUE(report.watertight);
  EXPECT_EQ(report.non_manifold_edges, 0);
  EXPECT_EQ(report.inconsistent_edges, 0);
  EXPECT_EQ(report.unused_vertices, 0);
  EXPECT_EQ(report.duplicate_vertices, 0);
  EXPECT_EQ(report.degenerate_faces, 0);
  EXPECT_GT(report.volume, 0);
  EXPECT_TRUE(every_vertex_has_one_ring(mesh));
}

struct Solid {
  std::string name;
  Mesh mesh;      // may be of several parts
  Mesh outer;     // the union's surface as one mesh, where it is the same; else no faces
  double volume;  // of the union
  double area;
  int euler;
};

void PrintTo(const Solid& solid, std::ostream* out) {  // NOLINT(readability-identifier-naming): GoogleTest's name
  *out << solid.name;
}

Solid alone(const std::string& name, const Mesh& mesh, int euler) {
  const MeshReport report = inspect(mesh);
  return {name, mesh, mesh, report.volume, report.area, euler};
}

std::vector<Solid> solids() {
  using test::joined_meshes;
  using test::solid_box;
  const Mesh bar = solid_box({-2, -0.5, -0.5}, {2, 0.5, 0.5});
  const Mesh post = solid_box({-0.5, -2, -0.25}, {0.5, 2, 0.25});
  const Mesh core = solid_box({-0.3, -0.3, -0.3}, {0.3, 0.3, 0.3});
  const Mesh away = solid_box({2, 2, 2}, {3, 3, 3});
  return {alone("box", solid_box({0, 0, 0}, {1, 2, 3}), 2),
          alone("sphere", test::solid_sphere(1, 4), 2),
          alone("torus", test::solid_torus(2, 0.7, 60, 24), 0),
          {"cross of two boxes", joined_meshes({bar, post}), {}, 4 + 2 - 0.5, 18 + 13 - 3 - 1, 2},
          {"box in a box", joined_meshes({bar, core}), bar, 4, 18, 2},
          {"two boxes apart", joined_meshes({core, away}), joined_meshes({core, away}), 0.216 + 1, 6 * 0.36 + 6, 4},
          {"the same box twice", joined_meshes({bar, bar}), bar, 4, 18, 2}};
}

class RemeshedSolid : public testing::TestWithParam<Solid> {};

TEST_P(RemeshedSolid, IsAClosedSurfaceOfTheSameShape) {
  const Solid& solid = GetParam();
  const double size = diagonal(solid.mesh.vertices);
  for (const std::uint64_t seed : {1, 2, 3}) {
    const Mesh mesh = remeshed(solid.mesh, 1.0 / 60, seed).mesh;
    expect_closed_surface(mesh);
    EXPECT_EQ(euler_characteristic(mesh), solid.euler);
    EXPECT_NEAR(inspect(mesh).volume, solid.volume, 1e-3 * solid.volume);
    EXPECT_NEAR(inspect(mesh).area, solid.area, 3e-3 * solid.area);
    EXPECT_LT(test::one_sided_distance(mesh, solid.mesh), 2e-3 * size);
    if (solid.outer.faces.rows() > 0) {
      EXPECT_LT(test::one_sided_distance(solid.outer, mesh), 2e-3 * size);
    }
  }
}

TEST_P(RemeshedSolid, DependsOnTheSeedAndNotOnThreads) {
  const Remeshed one = remeshed(GetParam().mesh, 1.0 / 40, 7, 1);
  const Remeshed two = remeshed(GetParam().mesh, 1.0 / 40, 7, 2);
  const Remeshed other = remeshed(GetParam().mesh, 1.0 / 40, 8, 1);
  EXPECT_TRUE(one.mesh.vertices == two.mesh.vertices);
  EXPECT_TRUE(one.mesh.faces == two.mesh.faces);
  EXPECT_EQ(one.source_face, two.source_face);
  EXPECT_FALSE(one.mesh.vertices.rows() == other.mesh.vertices.rows() && one.mesh.vertices == other.mesh.vertices);
}

INSTANTIATE_TEST_SUITE_P(Solids, RemeshedSolid, testing::ValuesIn(solids()));

TEST(Remesh, KeepsCreasesAndCornersSharp) {
  const Mesh box = test::solid_box({0, 0, 0}, {1, 1.3, 0.7});
  const double cell = diagonal(box.vertices) / 40;
  const SurfaceIndex surface(remeshed(box, 1.0 / 40).mesh);
  for (Eigen::Index v = 0; v < 8; ++v) EXPECT_LT(surface.nearest(box.vertices.row(v)).distance, 0.05 * cell) << v;
  double worst = 0;
  double sum = 0;
  int count = 0;
  for (const Edge& edge : welded_edges(box, weld_vertices(box.vertices))) {
    const Vector3d from = box.vertices.row(edge.vertices[0]);
    const Vector3d to = box.vertices.row(edge.vertices[1]);
    if (((to - from).array().abs() > 1e-9).count() > 1) continue;  // a side's diagonal
    for (int i = 0; i <= 200; ++i) {
      const double distance = surface.nearest(from + i / 200.0 * (to - from)).distance;
      worst = std::max(worst, distance);
      sum += distance;
      ++count;
    }
  }
  EXPECT_EQ(count, 12 * 201);
  EXPECT_LT(worst, 0.1 * cell);
  EXPECT_LT(sum / count, 0.005 * cell);
}

TEST(Remesh, FittingSharpensCreases) {
  const Mesh box = test::solid_box({0, 0, 0}, {1, 1.3, 0.7});
  RunContext context;
  const Mesh coarse = remesh(box, {.cell = 1.0 / 40, .fitting_passes = 0}, context).mesh;
  const Mesh fitted = remesh(box, {.cell = 1.0 / 40}, context).mesh;
  expect_closed_surface(coarse);
  EXPECT_LT(test::one_sided_distance(box, fitted), 0.5 * test::one_sided_distance(box, coarse));
}

TEST(Remesh, NamesTheFacesOfTheOriginal) {
  const Mesh box = test::solid_box({0, 0, 0}, {1, 2, 3});
  const Remeshed result = remeshed(box);
  ASSERT_EQ(static_cast<Eigen::Index>(result.source_face.size()), result.mesh.faces.rows());
  const Points old_normals = face_normals(box);
  const Points normals = face_normals(result.mesh);
  const Eigen::VectorXd areas = face_areas(result.mesh);
  Eigen::VectorXd carried = Eigen::VectorXd::Zero(12);
  for (Eigen::Index f = 0; f < result.mesh.faces.rows(); ++f) {
    const int source = result.source_face[static_cast<std::size_t>(f)];
    EXPECT_GT(normals.row(f).dot(old_normals.row(source)), 0.3);
    const Vector3d centroid = result.mesh.vertices(result.mesh.faces.row(f), Eigen::all).colwise().mean();
    const SurfaceIndex face(box, {source});
    EXPECT_LT(face.nearest(centroid).distance, 0.1 * diagonal(box.vertices) / 60);
    carried[source] += areas[f];
  }
  const Eigen::VectorXd expected = face_areas(box);
  for (Eigen::Index f = 0; f < 12; ++f) EXPECT_NEAR(carried[f], expected[f], 0.05 * expected[f]) << f;
}

TEST(Remesh, LeavesHiddenFacesOut) {
  const Mesh outer = test::solid_box({-2, -2, -2}, {2, 2, 2});
  const Mesh through = test::solid_box({-0.5, -0.5, -1}, {0.5, 0.5, 3});
  const Remeshed result = remeshed(test::joined_meshes({through, outer}));
  // The second part's lower end and the first 12 faces' share below z = 2 are inside.
  EXPECT_EQ(std::ranges::count(result.source_face, 8), 0);
  EXPECT_EQ(std::ranges::count(result.source_face, 9), 0);
  for (Eigen::Index f = 0; f < result.mesh.faces.rows(); ++f) {
    const Vector3d centroid = result.mesh.vertices(result.mesh.faces.row(f), Eigen::all).colwise().mean();
    if (result.source_face[static_cast<std::size_t>(f)] < 12) {
      EXPECT_GT(centroid.z(), 1.95);
    }
  }
}

TEST(Remesh, TakesPartsTurnedInsideOutTwoSidedOrInconsistent) {
  const Mesh box = test::solid_box({0, 0, 0}, {1, 2, 3});
  Mesh turned = box;
  turned.faces.col(1).swap(turned.faces.col(2));
  Mesh inconsistent = box;
  std::swap(inconsistent.faces(4, 1), inconsistent.faces(4, 2));
  Mesh soup;  // every face with corners of its own
  soup.vertices.resize(36, 3);
  soup.faces.resize(12, 3);
  for (int f = 0; f < 12; ++f) {
    for (int k = 0; k < 3; ++k) {
      soup.vertices.row(3 * f + k) = box.vertices.row(box.faces(f, k));
      soup.faces(f, k) = 3 * f + k;
    }
  }
  const Remeshed plain = remeshed(box);
  for (const Mesh& mesh : {turned, inconsistent, soup, test::joined_meshes({box, turned})}) {
    const Remeshed result = remeshed(mesh);
    expect_closed_surface(result.mesh);
    ASSERT_EQ(result.mesh.vertices.rows(), plain.mesh.vertices.rows());
    EXPECT_LT((result.mesh.vertices - plain.mesh.vertices).cwiseAbs().maxCoeff(), 1e-9);
    EXPECT_EQ(result.source_face, plain.source_face);
  }
  const std::vector<int> sources = remeshed(test::joined_meshes({box, turned})).source_face;
  EXPECT_LT(*std::ranges::max_element(sources), 12);
}

// Signs of the grid as wild as can be: hundreds of parts about as large as a cell.
TEST(Remesh, StaysManifoldWhereSheetsMeetAmbiguously) {
  Random random(3, "boxes");
  std::vector<Mesh> boxes;
  for (int i = 0; i < 1500; ++i) {
    const Vector3d low(random.uniform(), random.uniform(), random.uniform());
    const Vector3d extent(random.uniform(0.03, 0.1), random.uniform(0.03, 0.1), random.uniform(0.03, 0.1));
    boxes.push_back(test::solid_box(low, low + extent));
  }
  const Mesh mesh = test::joined_meshes(boxes);
  for (const double cells : {25.0, 40.0, 60.0}) {
    for (const std::uint64_t seed : {1, 2, 3}) {
      const Mesh result = remeshed(mesh, 1 / cells, seed).mesh;
      const MeshReport report = inspect(result);
      EXPECT_GT(report.faces, 3000);
      EXPECT_TRUE(report.watertight);
      EXPECT_EQ(report.non_manifold_edges, 0);
      EXPECT_EQ(report.inconsistent_edges, 0);
      EXPECT_TRUE(every_vertex_has_one_ring(result));
    }
  }
}

TEST(Remesh, FillsWhatIsEnclosed) {
  // A box of six walls.
  std::vector<Mesh> walls;
  for (int k = 0; k < 3; ++k) {
    for (const double at : {-1.0, 0.9}) {
      Vector3d low(-1, -1, -1);
      Vector3d high(1, 1, 1);
      low[k] = at;
      high[k] = at + 0.1;
      walls.push_back(test::solid_box(low, high));
    }
  }
  const Mesh mesh = remeshed(test::joined_meshes(walls)).mesh;
  EXPECT_EQ(inspect(mesh).components, 1);
  EXPECT_NEAR(inspect(mesh).volume, 8, 8e-3);
}

TEST(Remesh, MakesOneSurfaceOfAChair) {
  const GeneratedModel chair = generate("chair");
  const Remeshed result = remeshed(chair.mesh, 1.0 / 110);
  expect_closed_surface(result.mesh);
  EXPECT_EQ(inspect(result.mesh).components, 1);
  EXPECT_LT(test::one_sided_distance(result.mesh, chair.mesh), 0.003 * diagonal(chair.mesh.vertices));
}

TEST(Remesh, DoesNotDependOnPlaceOrUnit) {
  Mesh box = test::solid_box({0, 0, 0}, {1, 2, 3});
  const Mesh near = remeshed(box).mesh;
  box.vertices *= 1e-3;
  box.vertices.rowwise() += Eigen::RowVector3d(40, -30, 20);
  const Mesh far = remeshed(box).mesh;
  ASSERT_EQ(near.vertices.rows(), far.vertices.rows());
  EXPECT_TRUE(near.faces == far.faces);
  const Points back = (far.vertices.rowwise() - Eigen::RowVector3d(40, -30, 20)) * 1e3;
  EXPECT_LT((back - near.vertices).cwiseAbs().maxCoeff(), 1e-8);
}

TEST(Remesh, RefusesWhatHasNoInside) {
  RunContext context;
  Mesh open = test::solid_box({0, 0, 0}, {1, 2, 3});
  open.faces.conservativeResize(11, 3);
  EXPECT_THROW(remesh(open, {}, context), InputError);
  try {
    remesh(test::joined_meshes({test::solid_box({5, 5, 5}, {6, 6, 6}), open}), {}, context);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("face 12"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("11 faces"), std::string::npos) << error.what();
  }
  EXPECT_THROW(remesh({}, {}, context), InputError);
  EXPECT_THROW(remesh({Points::Zero(3, 3), Triangles{{0, 1, 2}}, {}}, {}, context), InputError);
  EXPECT_THROW(remesh({Points{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, Triangles{{0, 1, 1}}, {}}, {}, context), InputError);
}

// Walls down to a cell are whole and have two sides.
class ThinWall : public testing::TestWithParam<double> {};

TEST_P(ThinWall, KeepsItsPlaceAndItsSides) {
  const Mesh wall = test::solid_box({0, 0, 0}, {1, 1.2, 1});
  Mesh thin = wall;
  const double cell = std::hypot(1.0, 1.2) / 60;
  thin.vertices.col(2) *= GetParam() * cell;
  const Mesh mesh = remeshed(thin).mesh;
  expect_closed_surface(mesh);
  EXPECT_EQ(inspect(mesh).components, 1);
  EXPECT_EQ(euler_characteristic(mesh), 2);
  EXPECT_NEAR(inspect(mesh).volume, inspect(thin).volume, 0.05 * inspect(thin).volume);
  EXPECT_LT(test::one_sided_distance(mesh, thin), 0.5 * cell);
  EXPECT_LT(test::one_sided_distance(thin, mesh), cell);
}

INSTANTIATE_TEST_SUITE_P(Cells, ThinWall, testing::Values(1.5, 2.0, 3.0));

TEST(Remesh, SaysWhenNothingIsThickEnough) {
  RunContext context;
  EXPECT_THROW(remesh(test::solid_box({0, 0, 0}, {1, 1, 1e-4}), {}, context), NoResultError);
}

TEST(Remesh, RefusesOptionsOutOfRange) {
  RunContext context;
  const Mesh box = test::solid_box({0, 0, 0}, {1, 2, 3});
  EXPECT_THROW(remesh(box, {.cell = 0}, context), UsageError);
  EXPECT_THROW(remesh(box, {.cell = 0.2}, context), UsageError);
  EXPECT_THROW(remesh(box, {.cell = std::nan("")}, context), UsageError);
  EXPECT_THROW(remesh(box, {.fitting_passes = -1}, context), UsageError);
  EXPECT_THROW(remesh(box, {.fitting_passes = 21}, context), UsageError);
}

}  // namespace
}  // namespace orbifit
