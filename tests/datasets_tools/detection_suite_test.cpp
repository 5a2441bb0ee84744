#include "suite/detection_suite.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <ostream>
#include <set>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "orbifit/datasets_tools/symmetry_residual.h"

#include "base/dense.h"
#include "base/random.h"
#include "geometry/surface_index.h"
#include "geometry/topology.h"

namespace orbifit {

void PrintTo(const SuiteModel& model, std::ostream* out) {  // NOLINT(readability-identifier-naming): GoogleTest's name
  *out << model.name;
}

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Family = PointGroup::Family;

constexpr double kSagitta = 1e-3;        // of turned parts, as a fraction of the diagonal
constexpr double kHiddenSagitta = 2e-3;  // of balls that are nearly hidden
// What breaks a larger group is at least so large, as a fraction of the diagonal and of the region's own.
constexpr double kPerceptible = 4e-3;
constexpr double kPerceptibleOfRegion = 16e-3;

// The models' truths are built once.
const TruthModel& built(const SuiteModel& model) {
  static std::map<std::string, TruthModel> all;
  const auto [entry, fresh] = all.try_emplace(model.name);
  if (fresh) entry->second = model.build();
  return entry->second;
}

Vector3d area_centre(const Mesh& mesh, const std::vector<int>& faces) {
  const Eigen::VectorXd areas = face_areas(mesh);
  Vector3d sum = Vector3d::Zero();
  double area = 0;
  for (const int face : faces) {
    for (int k = 0; k < 3; ++k) sum += areas[face] / 3 * mesh.vertices.row(mesh.faces(face, k)).transpose();
    area += areas[face];
  }
  return sum / area;
}

// Whether linear maps about the area's centre put some faces onto themselves.
class OwnMaps {
 public:
  OwnMaps(const Mesh& mesh, const std::vector<int>& faces)
      : part_(submesh(mesh, faces)),
        surface_(part_),
        centre_(area_centre(mesh, faces)),
        tolerance_(std::min(kPerceptible * diagonal(mesh.vertices), kPerceptibleOfRegion * diagonal(part_.vertices))) {}

  bool fits(const Matrix3d& linear) const {
    const Eigen::Index step = std::max<Eigen::Index>(1, part_.vertices.rows() / 3000);
    for (Eigen::Index v = 0; v < part_.vertices.rows(); v += step) {
      const Vector3d point = part_.vertices.row(v);
      const Vector3d image = centre_ + linear * (point - centre_);
      if (surface_.nearest(image, tolerance_).face < 0) return false;
    }
    return true;
  }

  Matrix3d moments() const {
    const Points local = part_.vertices.rowwise() - centre_.transpose();
    return local.transpose() * local;
  }

 private:
  Mesh part_;
  SurfaceIndex surface_;
  Vector3d centre_;
  double tolerance_;
};

Matrix3d mirror(const Vector3d& normal) {
  return Matrix3d::Identity() - 2 * normal * normal.transpose();
}

// Maps that a group larger than `region`'s would be likely to hold, for groups about an axis.
std::vector<Matrix3d> larger_maps(const Region& region) {
  const Vector3d axis = region.axis;
  const int n = std::max(2, region.group.n);
  std::vector<Matrix3d> maps{-Matrix3d::Identity(), mirror(axis)};
  for (int k = 2; k <= 3; ++k) maps.push_back(axis_rotation(axis, 2 * std::numbers::pi / (n * k)));
  maps.emplace_back(mirror(axis) * axis_rotation(axis, std::numbers::pi / n));
  // Mirrors and twofold axes in steps that hit those of every group whose frame the region's generators show.
  const GroupFrame frame = region.group.continuous() ? frame_about(axis)
                                                     : classify([&] {
                                                         std::vector<Matrix3d> linear;
                                                         for (const Motion& element : region.elements)
                                                           linear.push_back(element.linear);
                                                         return linear;
                                                       }())
                                                           ->frame;
  const Vector3d across = std::abs(frame.col(0).dot(axis)) < 1e-6 ? frame.col(0) : frame.col(1);
  maps.push_back(axis_rotation(across, 0.7));
  const int steps = 4 * n;
  for (int k = 0; k < steps; ++k) {
    const Vector3d line = axis_rotation(axis, std::numbers::pi * k / steps) * across;
    maps.push_back(mirror(line));
    maps.push_back(axis_rotation(line, std::numbers::pi));
  }
  return maps;
}

bool holds(const Region& region, const Matrix3d& linear) {
  if (!region.group.continuous()) {
    return std::ranges::any_of(region.elements,
                               [&](const Motion& element) { return (element.linear - linear).norm() < 1e-6; });
  }
  const Vector3d image = linear * region.axis;
  const bool up = (image - region.axis).norm() < 1e-6;
  const bool down = (image + region.axis).norm() < 1e-6;
  return up || (region.group.family == Family::Dinfh && down);
}

class Suite : public testing::TestWithParam<SuiteModel> {
 protected:
  const TruthModel& model_ = built(GetParam());
  const Mesh& mesh_ = model_.mesh;
  const DetectionTruth& truth_ = model_.truth;
};

TEST_P(Suite, PartsAreClosedAndFaceOutwards) {
  const MeshReport report = inspect(mesh_);
  EXPECT_GE(report.faces, 500);
  EXPECT_LE(report.faces, 25000);
  EXPECT_TRUE(report.watertight);
  EXPECT_EQ(report.inconsistent_edges, 0);
  EXPECT_EQ(report.degenerate_faces, 0);
  EXPECT_EQ(report.unused_vertices, 0);
  EXPECT_EQ(report.duplicate_faces, 0);
  for (const std::vector<int>& faces : connected_components(mesh_, weld_vertices(mesh_.vertices)).faces) {
    EXPECT_GT(inspect(submesh(mesh_, faces)).volume, 0);
  }
}

TEST_P(Suite, GroupsMapTheirRegionsOntoThemselves) {
  const auto check = [&](const std::vector<Region>& regions, double sagitta) {
    SymmetryAnnotation measured = truth_.expected;
    measured.patterns.clear();
    measured.regions = regions;
    for (Region& region : measured.regions) {
      if (region.group.continuous()) region.elements = region.generators;
      region.group = {};
    }
    RunContext context;
    const SymmetryReport report = symmetry_residual(mesh_, measured, nullptr, CarriedMotions::fixed, context);
    for (std::size_t r = 0; r < regions.size(); ++r) {
      EXPECT_LT(report.regions[r].floor.max, regions[r].group.continuous() ? sagitta : 1e-9)
          << regions[r].group.symbol() << ' ' << regions[r].name;
      EXPECT_GT(report.regions[r].pairs, 0);
    }
  };
  check(truth_.expected.regions, kSagitta);
  check(truth_.optional_regions, kHiddenSagitta);
}

TEST_P(Suite, NoLargerGroupFitsARegion) {
  for (const Region& region : truth_.expected.regions) {
    const OwnMaps maps(mesh_, region.faces);
    std::vector<Matrix3d> tried;
    if (region.group.has_axis()) {
      tried = larger_maps(region);
    } else if (!region.group.continuous()) {
      for (const auto& larger : {PointGroup{Family::Oh, 1}, PointGroup{Family::Ih, 1}}) {
        for (const Matrix3d& element : elements(larger)) tried.push_back(element);
      }
    }
    for (const Matrix3d& linear : tried) {
      if (holds(region, linear) || !maps.fits(linear)) continue;
      ADD_FAILURE() << region.group.symbol() << ' ' << region.name << " also has\n" << linear;
      break;
    }
  }
}

TEST_P(Suite, RegionsAndPatternsAreWellFormed) {
  EXPECT_EQ(truth_.expected.mesh_faces, mesh_.faces.rows());
  EXPECT_EQ(truth_.expected.mesh_vertices, mesh_.vertices.rows());
  EXPECT_EQ(truth_.expected.mesh_diagonal, diagonal(mesh_.vertices));
  const auto well_formed = [&](const std::vector<int>& faces) {
    return !faces.empty() && faces.front() >= 0 && faces.back() < mesh_.faces.rows() &&
           std::ranges::adjacent_find(faces, std::greater_equal<>()) == faces.end();
  };
  const Eigen::VectorXd areas = face_areas(mesh_);
  std::set<int> ids;
  for (const auto* regions : {&truth_.expected.regions, &truth_.optional_regions}) {
    for (const Region& region : *regions) {
      EXPECT_TRUE(ids.insert(region.id).second);
      EXPECT_TRUE(well_formed(region.faces)) << region.name;
      EXPECT_FALSE(region.name.empty());
      EXPECT_EQ(static_cast<int>(region.elements.size()), region.group.order());
    }
  }
  for (const Region& region : truth_.expected.regions) {
    EXPECT_GE(areas(region.faces).sum(), 0.0025 * areas.sum()) << region.name;
    const Region* smallest = nullptr;
    for (const Region& other : truth_.expected.regions) {
      const bool around = other.faces.size() > region.faces.size() && std::ranges::includes(other.faces, region.faces);
      if (around && (smallest == nullptr || other.faces.size() < smallest->faces.size())) smallest = &other;
    }
    ASSERT_EQ(region.parent.has_value(), smallest != nullptr) << region.name;
    if (smallest != nullptr) {
      const auto parent = std::ranges::find(truth_.expected.regions, *region.parent, &Region::id);
      EXPECT_EQ(parent->faces.size(), smallest->faces.size());
      EXPECT_TRUE(std::ranges::includes(parent->faces, region.faces));
    }
  }
  RunContext context;
  SymmetryAnnotation patterns = truth_.expected;
  patterns.regions.clear();
  for (const PatternResidual& pattern :
       symmetry_residual(mesh_, patterns, nullptr, CarriedMotions::fixed, context).patterns) {
    EXPECT_LT(pattern.floor.max, 1e-9) << pattern.name;
  }
  for (const Pattern& pattern : truth_.expected.patterns) {
    EXPECT_GE(pattern.instances.size(), 2U);
    EXPECT_EQ(static_cast<int>(pattern.generators.size()), generator_count(pattern.kind));
    std::set<int> faces;
    for (const PatternInstance& instance : pattern.instances) {
      EXPECT_TRUE(well_formed(instance.faces)) << pattern.name;
      for (const int face : instance.faces) EXPECT_TRUE(faces.insert(face).second);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Models, Suite, testing::ValuesIn(detection_suite()),
                         [](const auto& parameter) { return parameter.param.name; });

TEST(DetectionSuite, HasManyModelsWithUniqueNames) {
  const std::set<std::string> kinds{"group", "nested", "pattern", "continuous", "none", "near miss"};
  std::set<std::string> names;
  std::set<std::string> used;
  for (const SuiteModel& model : detection_suite()) {
    EXPECT_TRUE(names.insert(model.name).second) << model.name;
    EXPECT_TRUE(kinds.contains(model.kind)) << model.kind;
    used.insert(model.kind);
  }
  EXPECT_GE(names.size(), 40U);
  EXPECT_EQ(used, kinds);
}

TEST(DetectionSuite, ShowsEveryFiniteFamilyAndOrder) {
  std::set<std::string> symbols;
  std::set<Family> families;
  std::set<int> orders;
  for (const SuiteModel& model : detection_suite()) {
    if (model.kind != "group") continue;
    // The group that a model is named after is the first to be expected.
    const TruthModel& truth = built(model);
    ASSERT_FALSE(truth.truth.expected.regions.empty()) << model.name;
    const PointGroup group = truth.truth.expected.regions.front().group;
    symbols.insert(group.symbol());
    families.insert(group.family);
    orders.insert(group.n);
  }
  for (const Family family :
       {Family::Cs, Family::Ci, Family::Cn, Family::Cnv, Family::Cnh, Family::Dn, Family::Dnh, Family::Dnd, Family::T,
        Family::Td, Family::Th, Family::O, Family::Oh, Family::I, Family::Ih}) {
    EXPECT_TRUE(families.contains(family)) << PointGroup{family, 3}.symbol();
  }
  for (const char* symbol : {"S4", "S6", "S8"}) EXPECT_TRUE(symbols.contains(symbol)) << symbol;
  for (int n = 1; n <= 12; ++n) EXPECT_TRUE(orders.contains(n)) << n;
}

TEST(DetectionSuite, AsymmetricModelsHaveNothing) {
  int models = 0;
  for (const SuiteModel& model : detection_suite()) {
    if (model.kind != "none") continue;
    ++models;
    const TruthModel& truth = built(model);
    EXPECT_TRUE(truth.truth.expected.regions.empty());
    EXPECT_TRUE(truth.truth.expected.patterns.empty());
    EXPECT_TRUE(truth.truth.optional_regions.empty());
    // Of the whole and of each part.
    std::vector<std::vector<int>> sets = connected_components(truth.mesh, weld_vertices(truth.mesh.vertices)).faces;
    std::vector<int> all;
    for (const std::vector<int>& part : sets) all.insert(all.end(), part.begin(), part.end());
    sets.push_back(all);
    for (const std::vector<int>& faces : sets) {
      const OwnMaps maps(truth.mesh, faces);
      EXPECT_TRUE(maps.fits(Matrix3d::Identity()));
      EXPECT_FALSE(maps.fits(-Matrix3d::Identity()));
      // Every axis and plane of a symmetry is an axis of inertia, unless two moments agree.
      const Eigen::SelfAdjointEigenSolver<Matrix3d> inertia(maps.moments());
      std::vector<Vector3d> directions{inertia.eigenvectors().col(0), inertia.eigenvectors().col(1),
                                       inertia.eigenvectors().col(2)};
      Random random(1, "directions");
      for (int k = 0; k < 200; ++k) directions.push_back(random.direction());
      for (const Vector3d& direction : directions) {
        EXPECT_FALSE(maps.fits(mirror(direction))) << model.name;
        for (const int n : {2, 3, 4, 5, 6}) {
          EXPECT_FALSE(maps.fits(axis_rotation(direction, 2 * std::numbers::pi / n))) << model.name << ' ' << n;
        }
      }
    }
  }
  EXPECT_EQ(models, 3);
}

}  // namespace
}  // namespace orbifit
