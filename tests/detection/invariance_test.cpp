#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <numeric>
#include <ostream>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "orbifit/detection/detect.h"
#include "orbifit/model/annotation_io.h"

#include "base/random.h"
#include "shapes.h"

namespace orbifit {
namespace {

using Eigen::Vector3d;

constexpr double kSame = 1e-6;  // of the diagonal, and radians

struct Model {
  std::string name;
  std::function<Mesh()> build;
};

void PrintTo(const Model& model, std::ostream* out) {
  *out << model.name;
}

Mesh around(const Mesh& part, int n, int i) {
  return test::moved(part, Motion::rotation({0, 0, 1}, 2 * std::numbers::pi * i / n, {0, 0, 0}));
}

// Five spokes and three bolts about a hub: nested groups that have one axis and no common order.
Mesh wheel() {
  std::vector<Mesh> parts{test::prism(30, 0.35, 0.5)};
  for (int i = 0; i < 5; ++i) {
    parts.push_back(around(test::moved(test::box(0.9, 0.2, 0.1), test::shift(0.7, 0, 0.1)), 5, i));
  }
  for (int i = 0; i < 3; ++i) {
    parts.push_back(around(test::moved(test::box(0.12, 0.16, 0.2), test::shift(0.2, 0, 0.3)), 3, i));
  }
  return test::joined(parts);
}

Mesh table() {
  std::vector<Mesh> parts{test::box(2, 2, 0.1)};
  for (int i = 0; i < 4; ++i) {
    parts.push_back(around(test::moved(test::box(0.3, 0.2, 1.2), test::shift(0.75, 0.8, -0.6)), 4, i));
  }
  return test::joined(parts);
}

// A bolt with a hexagonal head as one surface: rings of points around its axis, joined from each to the next.
Mesh bolt() {
  constexpr int kRing = 48;
  const auto hexagon = [](double angle) {
    const double sixth = std::numbers::pi / 3;
    const double within = std::remainder(angle, sixth);
    return 1 / std::cos(within);
  };
  struct Level {
    double z, radius;
    bool round;
  };
  // A hollow in the head, nearly as wide as the shaft, leaves narrow rims: faces that are hexagons at their outer edge.
  const std::vector<Level> levels{{0.6, 0, true},  {0.6, 0.82, true}, {1, 0.82, true},   {1, 1, false},
                                  {0.2, 1, false}, {0.2, 0.9, true},  {-1.5, 0.9, true}, {-1.5, 0, true}};
  Mesh mesh;
  const auto rings = static_cast<int>(levels.size());
  mesh.vertices.resize(rings * kRing, 3);
  for (int l = 0; l < rings; ++l) {
    const Level& level = levels[static_cast<std::size_t>(l)];
    for (int i = 0; i < kRing; ++i) {
      // Between two corners of the hexagon at odd multiples of 30 degrees lie eight points.
      const double angle = 2 * std::numbers::pi * i / kRing + std::numbers::pi / 6;
      const double radius = level.radius * (level.round ? 1 : hexagon(angle));
      mesh.vertices.row(l * kRing + i) << radius * std::cos(angle), radius * std::sin(angle), level.z;
    }
  }
  mesh.faces.resize((rings - 1) * kRing * 2 - 2 * kRing, 3);
  int row = 0;
  for (int l = 0; l + 1 < rings; ++l) {
    for (int i = 0; i < kRing; ++i) {
      const int a = l * kRing + i;
      const int b = l * kRing + (i + 1) % kRing;
      if (l > 0) mesh.faces.row(row++) << a, a + kRing, b;
      if (l + 2 < rings) mesh.faces.row(row++) << b, a + kRing, b + kRing;
    }
  }
  return mesh;
}

SymmetryAnnotation regions_of(const Mesh& mesh, int threads = 1, Explanation* explanation = nullptr) {
  DetectOptions options;
  options.samples = 1500;
  options.explanation = explanation;
  RunContext context;
  context.threads = threads;
  return detect(mesh, options, context);
}

std::string summary_of(const SymmetryAnnotation& annotation) {
  std::string text;
  for (const Region& region : annotation.regions) {
    text += region.group.symbol() + " on " + std::to_string(region.faces.size()) + " faces (" + region.name + ")\n";
  }
  for (const Pattern& pattern : annotation.patterns) {
    text += to_string(pattern.kind) + " of " + std::to_string(pattern.instances.size()) + "\n";
  }
  return text;
}

// A mesh moved and with its vertices and faces in another order.
struct Changed {
  Mesh mesh;
  Similarity motion;
  std::vector<int> face;  // by the number of a changed face: the one it was
};

Changed changed(const Mesh& mesh, const Similarity& motion, bool reorder, Random& random) {
  Changed result{mesh, motion, test::all_faces(mesh)};
  for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) {
    result.mesh.vertices.row(v) = motion(mesh.vertices.row(v)).transpose();
  }
  if (!reorder) return result;
  std::vector<int> place(static_cast<std::size_t>(mesh.vertices.rows()));
  std::iota(place.begin(), place.end(), 0);
  const auto shuffle = [&](std::vector<int>& order) {
    for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random.below(i)]);
  };
  shuffle(place);
  shuffle(result.face);
  const Points vertices = result.mesh.vertices;
  for (std::size_t v = 0; v < place.size(); ++v) {
    result.mesh.vertices.row(place[v]) = vertices.row(static_cast<Eigen::Index>(v));
  }
  for (std::size_t f = 0; f < result.face.size(); ++f) {
    const int first = static_cast<int>(random.below(3));
    for (int k = 0; k < 3; ++k) {
      result.mesh.faces(static_cast<Eigen::Index>(f), k) =
          place[static_cast<std::size_t>(mesh.faces(result.face[f], (first + k) % 3))];
    }
  }
  return result;
}

// How far the group of `b` is from that of `a`, on the mesh and as a fraction of its diagonal; both in the same frame.
double apart(const Region& a, const Region& b, const Vector3d& centre, double diagonal) {
  if (a.group.continuous()) {
    const Vector3d off = b.centre - a.centre;
    const bool along = a.group.symbol() == "Cinfv" || a.group.symbol() == "Cinf";
    const double distance = along ? off.cross(a.axis).norm() : off.norm();
    return std::max(distance / diagonal, a.axis.cross(b.axis).norm());
  }
  double worst = 0;
  for (const Motion& element : a.elements) {
    double nearest = 1e300;
    for (const Motion& other : b.elements) {
      nearest = std::min(nearest, motion_distance(element, other, centre, 0.5 * diagonal));
    }
    worst = std::max(worst, nearest / diagonal);
  }
  return worst;
}

class Invariance : public testing::TestWithParam<Model> {
 protected:
  void SetUp() override {
    mesh_ = GetParam().build();
    static std::map<std::string, SymmetryAnnotation> known;  // what is found in the models as they are
    const auto place = known.find(GetParam().name);
    expected_ = place != known.end() ? place->second : (known[GetParam().name] = regions_of(mesh_));
    ASSERT_FALSE(expected_.regions.empty());
  }

  void expect_same(const Similarity& motion, bool reorder, const std::string& what) {
    SCOPED_TRACE(what);
    Random random(7, what);
    const Changed other = changed(mesh_, motion, reorder, random);
    SymmetryAnnotation found = regions_of(other.mesh);
    EXPECT_EQ(found.regions.size(), expected_.regions.size()) << summary_of(found) << "instead of\n"
                                                              << summary_of(expected_);
    EXPECT_EQ(found.patterns.size(), expected_.patterns.size());
    for (Region& region : found.regions) {
      for (int& face : region.faces) face = other.face[static_cast<std::size_t>(face)];
      std::ranges::sort(region.faces);
    }
    const SymmetryAnnotation truth = transformed(expected_, motion);
    for (const Region& region : truth.regions) {
      double nearest = 1e300;
      for (const Region& candidate : found.regions) {
        if (candidate.group != region.group || candidate.faces != region.faces) continue;
        nearest =
            std::min(nearest, apart(region, candidate, bounding_box_centre(other.mesh.vertices), truth.mesh_diagonal));
      }
      EXPECT_LT(nearest, kSame) << region.group.symbol() << " on " << region.name << " of " << region.faces.size()
                                << " faces; found\n"
                                << summary_of(found);
    }
  }

  Mesh mesh_;
  SymmetryAnnotation expected_;
};

TEST_P(Invariance, TurnedAndSmall) {
  Random random(1, GetParam().name);
  expect_same({1e-3, random.rotation(), Vector3d::Zero()}, false, "small");
}

TEST_P(Invariance, TurnedAndLarge) {
  Random random(2, GetParam().name);
  expect_same({1e3, random.rotation(), Vector3d::Zero()}, false, "large");
}

TEST_P(Invariance, FarFromTheOrigin) {
  Random random(3, GetParam().name);
  const Vector3d offset = 1e4 * diagonal(mesh_.vertices) * random.direction();
  expect_same({1, Eigen::Matrix3d::Identity(), offset}, false, "offset");
}

TEST_P(Invariance, OtherOrderOfVerticesAndFaces) {
  expect_same({}, true, "order");
}

// To the last digit.
TEST_P(Invariance, InAnyOrder) {
  Random random(5, GetParam().name);
  const Changed other = changed(mesh_, {}, true, random);
  SymmetryAnnotation found = regions_of(other.mesh);
  const auto renumber = [&](std::vector<int>& faces) {
    for (int& face : faces) face = other.face[static_cast<std::size_t>(face)];
    std::ranges::sort(faces);
  };
  for (Region& region : found.regions) renumber(region.faces);
  for (Pattern& pattern : found.patterns) {
    for (PatternInstance& instance : pattern.instances) renumber(instance.faces);
  }
  EXPECT_EQ(to_json(found), to_json(expected_));
}

// On two threads, and asked to explain itself, the detector finds the very same.
TEST_P(Invariance, ByteForByteAndEverythingExplained) {
  Explanation explanation;
  const SymmetryAnnotation annotation = regions_of(mesh_, 2, &explanation);
  EXPECT_EQ(to_json(annotation), to_json(expected_));
  for (const Region& region : annotation.regions) {
    const std::string subject = region.group.symbol() + " on " + region.name;
    const std::string image = region.group.symbol() + " " + region.name;
    EXPECT_TRUE(std::ranges::any_of(explanation.notes, [&](const Explanation::Note& note) {
      return note.kept && (note.subject == subject || note.subject == image);
    })) << subject;
  }
  for (const Explanation::Note& note : explanation.notes) {
    EXPECT_FALSE(note.stage.empty());
    EXPECT_FALSE(note.reason.empty()) << note.stage << ": " << note.subject;
  }
}

// With any number of threads the same is looked at, and kept or dropped for the same reasons.
TEST_P(Invariance, ExplainedAlikeWithMoreThreads) {
  Explanation one;
  regions_of(mesh_, 1, &one);
  Explanation three;
  regions_of(mesh_, 3, &three);
  ASSERT_EQ(one.notes.size(), three.notes.size());
  for (std::size_t i = 0; i < one.notes.size(); ++i) {
    const Explanation::Note& a = one.notes[i];
    const Explanation::Note& b = three.notes[i];
    EXPECT_EQ(a.stage + ": " + a.subject, b.stage + ": " + b.subject);
    EXPECT_EQ(a.kept, b.kept) << a.subject;
    EXPECT_EQ(a.reason, b.reason) << a.subject;
  }
}

INSTANTIATE_TEST_SUITE_P(Models, Invariance,
                         testing::Values(Model{"wheel", wheel}, Model{"table", table}, Model{"bolt", bolt}),
                         [](const auto& each) { return each.param.name; });

}  // namespace
}  // namespace orbifit
