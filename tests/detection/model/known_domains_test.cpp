#include "domains/known_domains.h"

#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "orbifit/model/point_group.h"

#include "domains/closed_sets.h"

namespace orbifit {
namespace {

using Eigen::Vector3d;

Mesh tetrahedron() {
  Mesh mesh;
  mesh.vertices.resize(4, 3);
  mesh.vertices << 1, 1, 1, 1, -1, -1, -1, 1, -1, -1, -1, 1;
  mesh.faces.resize(4, 3);
  mesh.faces << 0, 1, 2, 0, 3, 1, 0, 2, 3, 1, 3, 2;
  return mesh;
}

SymmetryAnnotation mirrored() {
  SymmetryAnnotation annotation;
  annotation.regions = {make_region(*PointGroup::parse("Cs"), Vector3d::Zero(),
                                    frame_about(Vector3d(1, -1, 0).normalized()), {0, 1, 2, 3}, "whole")};
  Pattern pattern;
  pattern.instances = {{Motion{}, {0}}, {Motion::rotation(Vector3d::UnitZ(), 1, Vector3d::Zero()), {2}}};
  annotation.patterns = {pattern};
  return annotation;
}

struct Change {
  const char* name;
  std::function<void(SymmetryAnnotation&)> make;
};

class KnownDomainsOf : public testing::TestWithParam<Change> {};

TEST_P(KnownDomainsOf, AChangedAnnotationAreItsOwn) {
  const Mesh mesh = tetrahedron();
  KnownDomains known(mesh);
  SymmetryAnnotation annotation = mirrored();
  known.of(annotation);
  GetParam().make(annotation);
  const DomainMap& found = known.of(annotation);
  const DomainMap expected(mesh, annotation, instance_motions(annotation));
  ASSERT_EQ(found.places(), expected.places());
  EXPECT_EQ(found.sets_of_faces(), expected.sets_of_faces());
  EXPECT_EQ(by_vertex(found.points()), by_vertex(expected.points()));
  for (int place = 0; place < expected.places(); ++place) {
    EXPECT_EQ(found.name(place), expected.name(place));
    EXPECT_EQ(found.centre(place), expected.centre(place));
    ASSERT_EQ(found.elements(place).size(), expected.elements(place).size());
    for (std::size_t e = 0; e < expected.elements(place).size(); ++e) {
      EXPECT_EQ(found.elements(place)[e].linear, expected.elements(place)[e].linear);
      EXPECT_EQ(found.elements(place)[e].translation, expected.elements(place)[e].translation);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    Changes, KnownDomainsOf,
    testing::Values(Change{"none", [](SymmetryAnnotation&) {}},
                    Change{"faces",
                           [](SymmetryAnnotation& a) {
                             a.regions[0].faces = {1, 2, 3};
                           }},
                    Change{"motion", [](SymmetryAnnotation& a) { a.regions[0].elements[1].linear *= 1 + 1e-15; }},
                    Change{"centre", [](SymmetryAnnotation& a) { a.regions[0].centre = Vector3d(0, 0, 1e-9); }},
                    Change{"name", [](SymmetryAnnotation& a) { a.regions[0].name = "all"; }},
                    Change{"region", [](SymmetryAnnotation& a) { a.regions.clear(); }},
                    Change{"instance", [](SymmetryAnnotation& a) { a.patterns[0].instances[1].faces = {3}; }},
                    Change{"pattern", [](SymmetryAnnotation& a) { a.patterns.clear(); }}),
    [](const auto& change) { return std::string(change.param.name); });

TEST(KnownDomains, AreRememberedForTheSame) {
  const Mesh mesh = tetrahedron();
  KnownDomains known(mesh);
  const SymmetryAnnotation annotation = mirrored();
  EXPECT_EQ(&known.of(annotation), &known.of(SymmetryAnnotation(annotation)));
}

}  // namespace
}  // namespace orbifit
