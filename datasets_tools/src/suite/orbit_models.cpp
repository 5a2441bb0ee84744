// Exact groups: chiral bodies, one for each element, that a ball joins.

#include <cmath>
#include <string>

#include "models/orbit_model.h"
#include "suite/suite_builder.h"
#include "suite/suite_lists.h"
#include "suite/suite_parts.h"

namespace orbifit {

namespace {

using Family = PointGroup::Family;

// Of those about an axis a multiple of 2 n facets: the ball's triangles then have the group as well.
PartKind joining_ball(const PointGroup& given, double radius) {
  switch (given.family) {
    case Family::T:
    case Family::Td:
    case Family::Th:
    case Family::O:
    case Family::Oh:
      return {"ball", cubic_ball(radius, 4), group("Kh"), OwnRegion::optional};
    case Family::I:
    case Family::Ih:
      return {"ball", icosahedral_ball(radius), group("Kh"), OwnRegion::optional};
    default:
      const int sectors = 2 * given.n;
      return {"ball", ball(radius, sectors * ((47 + sectors) / sectors)), group("Kh"), OwnRegion::optional};
  }
}

TruthModel orbit_model(const std::string& symbol) {
  const PointGroup given = group(symbol);
  OrbitOptions options;
  options.subdivisions = given.order() < 16 ? 3 : 2;
  const Mesh all = generate_orbit(given, options).mesh;
  std::vector<int> first(static_cast<std::size_t>(all.faces.rows() / given.order()));
  for (std::size_t f = 0; f < first.size(); ++f) first[f] = static_cast<int>(f);
  const Mesh body = submesh(all, first);
  const Eigen::RowVector3d middle = body.vertices.colwise().mean();
  const double size = (body.vertices.rowwise() - middle).rowwise().norm().maxCoeff();

  SuiteBuilder model;
  model.add(model.kind(joining_ball(given, middle.norm() - 0.3 * size)));
  model.orbit(model.kind({"body", body, {}}), {}, given);
  return model.finish();
}

}  // namespace

std::vector<SuiteModel> orbit_suite() {
  std::vector<SuiteModel> models;
  for (const char* symbol : {"Ci", "C5", "C11", "C4h", "D2", "D7", "D5d", "S4", "S6", "S8", "T", "Th", "O", "I"}) {
    models.push_back({std::string("bodies_") + symbol, "group", [symbol] { return orbit_model(symbol); }});
  }
  return models;
}

}  // namespace orbifit
