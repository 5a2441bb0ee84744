#include "orbifit/subspace/symmetrize.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <optional>

#include "orbifit/model/errors.h"
#include "orbifit/model/surface_index.h"

#include "generating_set.h"
#include "matched_orbits.h"
#include "ring_average.h"
#include "surface_average.h"
#include "turning_group.h"
#include "vertex_matching.h"

namespace orbifit {

namespace {

using Eigen::Index;
using Eigen::Vector3d;

// Image and vertex may each be off by the tolerance.
constexpr double kReach = 2;
constexpr int kMostIterations = 20;
constexpr double kStill = 1e-14;       // of the diagonal
constexpr double kConverging = 0.8;    // of the step before
constexpr double kExact = 2e-14;       // of the diagonal
constexpr double kRingLink = 3;        // times the movement to rings of the regular angles
constexpr double kRounding = 1e-9;     // of the diagonal
constexpr double kMostPairs = 200000;  // of a region's residual

// Everything about the mesh that the steps share.
struct Shape {
  const Mesh& mesh;
  const SymmetryAnnotation& annotation;
  double scale;  // diagonal
  double reach;  // mesh units
  Places places;
  std::vector<std::vector<int>> inside;       // places of each region
  std::vector<std::optional<Region>> finite;  // each region with a finite group; nothing where it has none
};

// A finite group for the continuous one of a region: that of a related region, carried here, or of its own places.
std::optional<Region> finite_stand_in(const Shape& shape, const std::vector<Motion>& known, std::size_t number) {
  const Region& region = shape.annotation.regions[number];
  for (std::size_t r = 0; r < number; ++r) {
    const Region& other = shape.annotation.regions[r];
    if (!shape.finite[r] || !(other.group == region.group) || shape.inside[r].size() != shape.inside[number].size()) {
      continue;
    }
    std::optional<Region> carried = carried_region(*shape.finite[r], region, known, shape.scale);
    if (carried) return carried;
  }
  return turning_region(region, shape.places.positions(shape.inside[number], Eigen::all), shape.reach, known);
}

Shape prepare(const Mesh& mesh, const SymmetryAnnotation& annotation, const RunContext& context) {
  Shape shape{mesh, annotation, diagonal(mesh.vertices), 0, vertex_places(mesh), {}, {}};
  shape.reach = kReach * annotation.tolerance * shape.scale;
  std::vector<Motion> known;
  for (const Region& region : annotation.regions) {
    known.insert(known.end(), region.elements.begin(), region.elements.end());
  }
  for (const Region& region : annotation.regions) {
    shape.inside.push_back(places_of(shape.places, mesh, region));
    if (!region.group.continuous()) {
      shape.finite.emplace_back(region);
      continue;
    }
    shape.finite.push_back(finite_stand_in(shape, known, shape.inside.size() - 1));
    if (shape.finite.back()) {
      known.insert(known.end(), shape.finite.back()->elements.begin(), shape.finite.back()->elements.end());
    }
    context.message("region \"" + region.name + "\": " + region.group.symbol() + " is taken as " +
                    (shape.finite.back() ? shape.finite.back()->group.symbol() : "circles alone"));
  }
  return shape;
}

std::vector<RegionMatching> match_regions(const Shape& shape, const RunContext& context) {
  std::vector<RegionMatching> matchings;
  for (std::size_t r = 0; r < shape.finite.size(); ++r) {
    context.progress("images", static_cast<double>(r) / static_cast<double>(shape.finite.size()));
    RegionMatching matching;
    if (shape.finite[r]) {
      matching.inside = shape.inside[r];
      matching.generators = generating_set(*shape.finite[r]);
      for (const Motion& generator : matching.generators) {
        matching.matches.push_back(matched_places(shape.places, matching.inside, generator, shape.reach, context));
      }
    }
    matchings.push_back(std::move(matching));
  }
  return matchings;
}

void place_images(const PlaceOrbit& orbit, const Vector3d& first, Points& positions) {
  for (std::size_t k = 0; k < orbit.members.size(); ++k) {
    positions.row(orbit.members[k]) = orbit.motions[k](first).transpose();
  }
}

// Largest distance between images and the places they stand for, mesh units.
double mismatch(const RegionMatching& matching, const Points& positions) {
  double worst = 0;
  for (std::size_t g = 0; g < matching.generators.size(); ++g) {
    for (std::size_t i = 0; i < matching.inside.size(); ++i) {
      const int image = matching.matches[g][i];
      if (image < 0) continue;
      const Vector3d due = matching.generators[g](positions.row(matching.inside[i]).transpose());
      const int place = matching.inside[static_cast<std::size_t>(image)];
      worst = std::max(worst, (positions.row(place).transpose() - due).norm());
    }
  }
  return worst;
}

// Detected groups may miss one another by less than the tolerance: no shape then has all of them. One region after
// the other is made exact by itself, the annotation's first ones last, so that those stay exact.
void settle(const Shape& shape, const std::vector<RegionMatching>& matchings, Points& positions,
            const RunContext& context) {
  for (auto matching = matchings.rbegin(); matching != matchings.rend(); ++matching) {
    context.check();
    if (mismatch(*matching, positions) <= kExact * shape.scale) continue;
    Places places = shape.places;
    places.positions = positions;
    for (const PlaceOrbit& orbit : matched_orbits(places, {*matching}, shape.scale, 2 * shape.reach)) {
      if (orbit.members.size() == 1 && orbit.stabilisers.empty()) continue;
      place_images(orbit, orbit_mean(orbit, places.positions), positions);
    }
  }
}

Mesh moved_mesh(const Shape& shape, const Points& positions) {
  Mesh result = shape.mesh;
  for (Index v = 0; v < result.vertices.rows(); ++v) {
    result.vertices.row(v) = positions.row(shape.places.of_vertex[static_cast<std::size_t>(v)]);
  }
  return result;
}

// For each place the face at it that lies in the most regions; -1 for places in none.
std::vector<int> faces_of_places(const Shape& shape) {
  std::vector<int> regions_of_face(static_cast<std::size_t>(shape.mesh.faces.rows()), 0);
  for (const std::optional<Region>& region : shape.finite) {
    if (!region) continue;
    for (const int face : region->faces) ++regions_of_face[static_cast<std::size_t>(face)];
  }
  std::vector<int> result(static_cast<std::size_t>(shape.places.positions.rows()), -1);
  for (Index f = 0; f < shape.mesh.faces.rows(); ++f) {
    const auto face = static_cast<std::size_t>(f);
    if (regions_of_face[face] == 0) continue;
    for (int k = 0; k < 3; ++k) {
      int& known =
          result[static_cast<std::size_t>(shape.places.of_vertex[static_cast<std::size_t>(shape.mesh.faces(f, k))])];
      if (known < 0 || regions_of_face[static_cast<std::size_t>(known)] < regions_of_face[face]) {
        known = static_cast<int>(f);
      }
    }
  }
  return result;
}

// Orbits some of whose images lie between vertices: their first members go to the mean of the surface's nearest points.
int average_over_surfaces(const Shape& shape, const std::vector<PlaceOrbit>& orbits, Points& positions,
                          std::vector<char>& unclosed, const RunContext& context) {
  SymmetryAnnotation finite = shape.annotation;
  finite.regions.clear();
  for (const std::optional<Region>& region : shape.finite) {
    if (region) finite.regions.push_back(*region);
  }
  const std::vector<int> faces = faces_of_places(shape);
  std::vector<std::size_t> moving;
  for (std::size_t o = 0; o < orbits.size(); ++o) {
    if (!orbits[o].complete && faces[static_cast<std::size_t>(orbits[o].members.front())] >= 0) moving.push_back(o);
  }
  if (moving.empty()) return 0;
  int iteration = 0;
  double step = shape.scale;
  double last = 2 * step;
  for (; iteration < kMostIterations && step > kStill * shape.scale && step < kConverging * last; ++iteration) {
    context.progress("surface", static_cast<double>(iteration) / kMostIterations);
    const Mesh mesh = moved_mesh(shape, positions);
    const Points normals = vertex_normals(mesh);
    std::vector<Vector3d> normal_of_place(static_cast<std::size_t>(positions.rows()), Vector3d::Zero());
    for (Index v = 0; v < normals.rows(); ++v) {
      normal_of_place[static_cast<std::size_t>(shape.places.of_vertex[static_cast<std::size_t>(v)])] +=
          normals.row(v).transpose();
    }
    const SurfaceAverage average(mesh, finite, shape.reach, iteration == 0 ? context : RunContext{});
    std::vector<Vector3d> targets(moving.size());
    parallel_for(context, moving.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const auto first = static_cast<std::size_t>(orbits[moving[i]].members.front());
        const Vector3d position = positions.row(static_cast<Index>(first));
        targets[i] = position;
        if (unclosed[first] != 0) continue;
        try {
          targets[i] = average(position, normal_of_place[first].normalized(), faces[first]);
        } catch (const InputError&) {  // the orbit does not close
          unclosed[first] = 1;
        }
      }
    });
    last = step;
    step = 0;
    for (std::size_t i = 0; i < moving.size(); ++i) {
      const PlaceOrbit& orbit = orbits[moving[i]];
      const Vector3d target = stabilised(orbit, targets[i]);
      if ((target - targets[i]).norm() > shape.reach) continue;
      step = std::max(step, (target - positions.row(orbit.members.front()).transpose()).norm());
      place_images(orbit, target, positions);
    }
  }
  return iteration;
}

double rms_distance(const Points& a, const Points& b, const std::vector<int>& rows) {
  double sum = 0;
  for (const int row : rows) sum += (a.row(row) - b.row(row)).squaredNorm();
  return rows.empty() ? 0 : std::sqrt(sum / static_cast<double>(rows.size()));
}

void make_rings(const Shape& shape, Points& positions, const RunContext& context) {
  for (std::size_t r = 0; r < shape.inside.size(); ++r) {
    const Region& region = shape.annotation.regions[r];
    if (!region.group.continuous()) continue;
    double link = shape.reach / 4;
    if (shape.finite[r]) {
      link = std::min(link, kRingLink * rms_distance(positions, shape.places.positions, shape.inside[r]));
    }
    Points here = positions(shape.inside[r], Eigen::all);
    const Rings rings = ring_average(region, std::max(link, kRounding * shape.scale), here);
    if (2 * rings.places < here.rows() && !shape.finite[r]) {
      context.message("region \"" + region.name + "\": its vertices form no circles; it is left as it is");
      continue;
    }
    positions(shape.inside[r], Eigen::all) = here;
  }
}

// Of a region's vertices' images from its surface.
Residual residual_of(const Mesh& mesh, const Region& region, const RunContext& context) {
  if (region.faces.empty() || region.elements.size() < 2) return {};
  const Points vertices = submesh(mesh, region.faces).vertices;
  const SurfaceIndex surface(mesh, region.faces);
  const std::size_t elements = region.elements.size() - 1;
  const double pairs = static_cast<double>(vertices.rows()) * static_cast<double>(elements);
  const auto stride = static_cast<Index>(std::max(1.0, std::ceil(pairs / kMostPairs)));
  const auto taken = static_cast<std::size_t>((vertices.rows() + stride - 1) / stride);
  std::vector<Residual> parts(taken);
  parallel_for(context, taken, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Vector3d vertex = vertices.row(static_cast<Index>(i) * stride);
      for (std::size_t e = 1; e <= elements; ++e) {
        const double distance = surface.nearest(region.elements[e](vertex)).distance;
        parts[i].rms += distance * distance;
        parts[i].max = std::max(parts[i].max, distance);
      }
    }
  });
  const double scale = diagonal(mesh.vertices);
  Residual result;
  for (const Residual& part : parts) {
    result.rms += part.rms;
    result.max = std::max(result.max, part.max / scale);
  }
  result.rms = std::sqrt(result.rms / static_cast<double>(taken * elements)) / scale;
  return result;
}

SymmetrizeReport make_report(const Shape& shape, const std::vector<PlaceOrbit>& orbits,
                             const std::vector<char>& unclosed, const Mesh& result, const RunContext& context) {
  SymmetrizeReport report;
  std::vector<char> inside(static_cast<std::size_t>(shape.places.positions.rows()), 0);
  for (const std::vector<int>& places : shape.inside) {
    for (const int place : places) inside[static_cast<std::size_t>(place)] = 1;
  }
  std::vector<char> mapped(inside.size(), 0);
  std::vector<char> left(inside.size(), 0);
  for (const PlaceOrbit& orbit : orbits) {
    for (const int member : orbit.members) {
      mapped[static_cast<std::size_t>(member)] = orbit.complete ? 1 : 0;
      left[static_cast<std::size_t>(member)] = unclosed[static_cast<std::size_t>(orbit.members.front())];
    }
  }
  for (std::size_t r = 0; r < shape.inside.size(); ++r) {
    if (shape.finite[r]) continue;
    for (const int place : shape.inside[r]) mapped[static_cast<std::size_t>(place)] = 0;
  }
  double sum = 0;
  for (Index v = 0; v < result.vertices.rows(); ++v) {
    const auto place = static_cast<std::size_t>(shape.places.of_vertex[static_cast<std::size_t>(v)]);
    const double movement = (result.vertices.row(v) - shape.mesh.vertices.row(v)).norm() / shape.scale;
    report.largest_movement = std::max(report.largest_movement, movement);
    if (inside[place] == 0) continue;
    sum += movement * movement;
    ++report.in_regions;
    if (mapped[place] != 0) ++report.mapped;
    if (left[place] != 0) ++report.unclosed;
  }
  if (report.in_regions > 0) report.rms_movement = std::sqrt(sum / report.in_regions);
  for (std::size_t r = 0; r < shape.inside.size(); ++r) {
    context.progress("residuals", static_cast<double>(r) / static_cast<double>(shape.inside.size()));
    const Region& region = shape.annotation.regions[r];
    SymmetrizeReport::RegionChange change;
    change.id = region.id;
    change.name = region.name;
    change.places = static_cast<int>(shape.inside[r].size());
    change.mapped = static_cast<int>(std::ranges::count_if(
        shape.inside[r], [&](int place) { return mapped[static_cast<std::size_t>(place)] != 0; }));
    if (shape.finite[r]) {
      change.group = shape.finite[r]->group.symbol();
      change.before = residual_of(shape.mesh, *shape.finite[r], context);
      change.after = residual_of(result, *shape.finite[r], context);
    }
    report.regions.push_back(change);
  }
  return report;
}

}  // namespace

Mesh symmetrized(const Mesh& mesh, const SymmetryAnnotation& annotation, const RunContext& context,
                 SymmetrizeReport* report) {
  const Shape shape = prepare(mesh, annotation, context);
  const std::vector<RegionMatching> matchings = match_regions(shape, context);
  const std::vector<PlaceOrbit> orbits = matched_orbits(shape.places, matchings, shape.scale, 2 * shape.reach);
  Points positions = shape.places.positions;
  for (const PlaceOrbit& orbit : orbits) {
    if (orbit.members.size() > 1 || !orbit.stabilisers.empty()) {
      place_images(orbit, orbit_mean(orbit, shape.places.positions), positions);
    }
  }
  std::vector<char> unclosed(static_cast<std::size_t>(positions.rows()), 0);
  const int iterations = average_over_surfaces(shape, orbits, positions, unclosed, context);
  make_rings(shape, positions, context);
  settle(shape, matchings, positions, context);
  // What no region holds keeps its very coordinates, also where vertices lie a rounding apart.
  Mesh result = mesh;
  for (Index v = 0; v < result.vertices.rows(); ++v) {
    const int place = shape.places.of_vertex[static_cast<std::size_t>(v)];
    if (positions.row(place) != shape.places.positions.row(place)) result.vertices.row(v) = positions.row(place);
  }
  if (report != nullptr) {
    *report = make_report(shape, orbits, unclosed, result, context);
    report->iterations = iterations;
  }
  return result;
}

}  // namespace orbifit
