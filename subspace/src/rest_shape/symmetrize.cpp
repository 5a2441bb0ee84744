#include "orbifit/subspace/symmetrize.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>
#include <utility>

#include "orbifit/model/errors.h"

#include "rest_shape/gap_closing.h"
#include "rest_shape/held_orbits.h"
#include "rest_shape/image_pairs.h"
#include "rest_shape/matched_orbits.h"
#include "rest_shape/ring_average.h"
#include "rest_shape/vertex_matching.h"
#include "symmetry/generating_set.h"
#include "symmetry/turning_group.h"

namespace orbifit {

namespace {

using Eigen::Index;
using Eigen::Vector3d;

// Image and vertex may each be off by the tolerance.
constexpr double kReach = 2;
constexpr int kMaxPasses = 3;          // in which images are looked for anew
constexpr int kMaxStiffer = 3;         // in which faces that fold are made stiff
constexpr int kMaxHolds = 8;           // in which single orbits are held; then those of whole regions
constexpr int kMaxRounds = 4;          // in which what is held is found anew
constexpr double kRingLink = 3;        // times the movement to rings of the regular angles
constexpr double kRounding = 1e-9;     // of the diagonal
constexpr double kAlmostExact = 1e-6;  // of the diagonal: a region that is off by less needs no more weight
constexpr double kSameResidual = 1e-12;

// Everything about the mesh that the steps share.
struct Shape {
  const Mesh& mesh;
  const SymmetryAnnotation& annotation;
  double scale;  // diagonal
  double reach;  // mesh units
  Places places;
  std::vector<std::vector<int>> inside;       // places of each region
  std::vector<std::optional<Region>> finite;  // each region with a finite group; nothing where it has none
  std::vector<char> round;  // of each region: its surface is round, and no vertices tell a finite group
};

// A finite group for the continuous one of a region: that of a related region, carried here, or of its own places.
std::optional<Region> finite_subgroup_of(const Shape& shape, const std::vector<Motion>& known, std::size_t number) {
  const Region& region = shape.annotation.regions[number];
  for (std::size_t r = 0; r < number; ++r) {
    const Region& other = shape.annotation.regions[r];
    if (!shape.finite[r] || !(other.group == region.group) || shape.inside[r].size() != shape.inside[number].size()) {
      continue;
    }
    std::optional<Region> carried = conjugated_region(*shape.finite[r], region, known, shape.scale);
    if (carried) return carried;
  }
  return turning_region(region, shape.places.positions(shape.inside[number], Eigen::all), shape.reach, known);
}

bool forms_circles(const Shape& shape, std::size_t number) {
  Points places = shape.places.positions(shape.inside[number], Eigen::all);
  return 2 * ring_average(shape.annotation.regions[number], shape.reach / 4, places).places >= places.rows();
}

Shape prepare(const Mesh& mesh, const SymmetryAnnotation& annotation, const RunContext& context) {
  Shape shape{mesh, annotation, diagonal(mesh.vertices), 0, vertex_places(mesh), {}, {}, {}};
  shape.reach = kReach * annotation.tolerance * shape.scale;
  std::vector<Motion> known;
  for (const Region& region : annotation.regions) {
    known.insert(known.end(), region.elements.begin(), region.elements.end());
  }
  for (const Region& region : annotation.regions) {
    shape.inside.push_back(places_of(shape.places, mesh, region));
    shape.round.push_back(0);
    if (!region.group.continuous()) {
      shape.finite.emplace_back(region);
      continue;
    }
    const std::size_t number = shape.inside.size() - 1;
    shape.finite.push_back(finite_subgroup_of(shape, known, number));
    if (!shape.finite.back() && !forms_circles(shape, number)) {
      shape.finite.back() = even_region(region, shape.scale, known);
      shape.round.back() = shape.finite.back() ? 1 : 0;
    }
    if (shape.finite.back()) {
      known.insert(known.end(), shape.finite.back()->elements.begin(), shape.finite.back()->elements.end());
    }
    context.message("region \"" + region.name + "\": " + region.group.symbol() + " is taken as " +
                    (shape.finite.back() ? shape.finite.back()->group.symbol() : "circles alone"));
  }
  return shape;
}

// Orbits of the places as they lie at `positions`.
std::vector<PlaceOrbit> find_orbits(const Shape& shape, const Points& positions, const RunContext& context) {
  Places places = shape.places;
  places.positions = positions;
  std::vector<RegionMatching> matchings;
  for (std::size_t r = 0; r < shape.finite.size(); ++r) {
    context.progress("images", static_cast<double>(r) / static_cast<double>(shape.finite.size()));
    RegionMatching matching;
    if (shape.finite[r]) {
      matching.inside = shape.inside[r];
      matching.generators = generating_set(*shape.finite[r]);
      for (const Motion& generator : matching.generators) {
        matching.matches.push_back(matched_places(places, matching.inside, generator, shape.reach, context));
      }
    }
    matchings.push_back(std::move(matching));
  }
  return matched_orbits(places, matchings, shape.scale, 2 * shape.reach);
}

std::size_t complete_members(const std::vector<PlaceOrbit>& orbits) {
  std::size_t count = 0;
  for (const PlaceOrbit& orbit : orbits) count += orbit.complete ? orbit.members.size() : 0;
  return count;
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

// The mean of every orbit that may move, of its members at `positions`.
void average_orbits(const std::vector<PlaceOrbit>& orbits, const std::vector<char>& held, Points& positions) {
  for (std::size_t o = 0; o < orbits.size(); ++o) {
    if (held[o] != 0 || (orbits[o].members.size() == 1 && orbits[o].stabilisers.empty())) continue;
    place_images(orbits[o], orbit_mean(orbits[o], positions), positions);
  }
}

void put_back(const Shape& shape, const std::vector<PlaceOrbit>& orbits, const std::vector<char>& held,
              Points& positions) {
  for (std::size_t o = 0; o < orbits.size(); ++o) {
    if (held[o] == 0) continue;
    for (const int member : orbits[o].members) positions.row(member) = shape.places.positions.row(member);
  }
}

std::vector<RegionDemand> region_demands(const Shape& shape) {
  std::vector<RegionDemand> demands;
  for (std::size_t r = 0; r < shape.finite.size(); ++r) {
    demands.push_back(
        region_demand(shape.mesh, shape.places, shape.annotation.regions[r], shape.finite[r], shape.round[r] != 0));
  }
  return demands;
}

// Every region counts by what it gains of what it had, so that none pays for another.
std::vector<double> region_weights(const Shape& shape, const std::vector<GapSummary>& before) {
  std::vector<double> weights;
  for (const GapSummary& gaps : before) {
    const double pairs = static_cast<double>(std::max<std::size_t>(1, gaps.pairs));
    const double least = kAlmostExact * shape.scale;
    weights.push_back(1 / (gaps.squares + pairs * least * least));
  }
  return weights;
}

struct Outcome {
  std::vector<PlaceOrbit> orbits;
  Points positions;
  std::vector<GapSummary> before, after;  // of each region
  std::vector<char> held;                 // by orbit
  int iterations = 0;
};

// From `start`: orbits' means, circles, then what lies between vertices.
int average(const Shape& shape, ImagePairs& pairs, const std::vector<PlaceOrbit>& orbits, const HeldOrbits& holding,
            const std::vector<char>& stiff, const Points& start, Points& positions, const RunContext& context) {
  positions = start;
  average_orbits(orbits, holding.held(), positions);
  make_rings(shape, positions, context);
  put_back(shape, orbits, holding.held(), positions);
  average_orbits(orbits, holding.held(), positions);
  GapWeights weights{{}, region_weights(shape, holding.before()), stiff};
  for (const char held : holding.held()) weights.free.push_back(held != 0 ? 0 : 1);
  return close_gaps(pairs, orbits, weights, shape.reach, shape.places, positions, context);
}

Outcome make_symmetric(const Shape& shape, const RunContext& context) {
  ImagePairs pairs(shape.mesh, shape.places, region_demands(shape));
  Outcome outcome;
  Points start = shape.places.positions;
  std::vector<char> stiff(static_cast<std::size_t>(start.rows()), 0);
  outcome.orbits = find_orbits(shape, start, context);
  const std::vector<SurfaceMatch> at_rest = pairs.match(start, nullptr, context);
  RunContext quiet = context;  // what was said once need not be said again
  quiet.on_message = nullptr;
  // Parts out of place by more than they are fine find their images once they are in place.
  for (int pass = 1; pass < kMaxPasses; ++pass) {
    const HeldOrbits none(pairs, outcome.orbits, shape.places.positions, at_rest);
    const int iterations =
        average(shape, pairs, outcome.orbits, none, stiff, start, outcome.positions, pass == 1 ? context : quiet);
    if (iterations == 0) break;
    outcome.iterations += iterations;
    std::vector<PlaceOrbit> orbits = find_orbits(shape, outcome.positions, context);
    if (complete_members(orbits) <= complete_members(outcome.orbits)) break;
    outcome.orbits = std::move(orbits);
  }
  HeldOrbits holding(pairs, outcome.orbits, shape.places.positions, at_rest);
  outcome.before = holding.before();
  bool worse = true;
  for (int round = 0; worse && round < kMaxRounds; ++round) {
    outcome.iterations += average(shape, pairs, outcome.orbits, holding, stiff, start, outcome.positions, quiet);
    const std::vector<int> folded = holding.folded(outcome.positions);
    if (!folded.empty() && round < kMaxStiffer) {
      for (const int face : folded) {
        for (const int corner : pairs.corners(face)) stiff[static_cast<std::size_t>(corner)] = 1;
      }
      continue;
    }
    holding.hold_far(outcome.positions, 2 * shape.reach);
    holding.hold_folded(outcome.positions);
    put_back(shape, outcome.orbits, holding.held(), outcome.positions);
    worse = holding.hold_more(outcome.positions, false, context) || !holding.folded(outcome.positions).empty();
  }
  for (int round = 0; worse; ++round) {
    context.check();
    put_back(shape, outcome.orbits, holding.held(), outcome.positions);
    const bool folded = holding.hold_folded(outcome.positions);
    worse = holding.hold_more(outcome.positions, round >= kMaxHolds, context) || folded;
  }
  outcome.held = holding.held();
  outcome.after = holding.summary(outcome.positions, context);
  return outcome;
}

Residual residual_of(const GapSummary& gaps, double scale) {
  if (gaps.pairs == 0) return {};
  return {std::sqrt(gaps.squares / static_cast<double>(gaps.pairs)) / scale, gaps.max / scale};
}

SymmetrizeReport make_report(const Shape& shape, const Outcome& outcome, const Mesh& result) {
  SymmetrizeReport report;
  report.iterations = outcome.iterations;
  const auto places = static_cast<std::size_t>(shape.places.positions.rows());
  std::vector<char> inside(places, 0);
  for (const std::vector<int>& region : shape.inside) {
    for (const int place : region) inside[static_cast<std::size_t>(place)] = 1;
  }
  std::vector<char> mapped(places, 0);
  std::vector<char> clashing(places, 0);
  std::vector<char> held(places, 0);
  for (std::size_t o = 0; o < outcome.orbits.size(); ++o) {
    const PlaceOrbit& orbit = outcome.orbits[o];
    for (const int member : orbit.members) {
      const auto place = static_cast<std::size_t>(member);
      mapped[place] = orbit.complete && outcome.held[o] == 0 ? 1 : 0;
      clashing[place] = orbit.clashes ? 1 : 0;
      held[place] = outcome.held[o];
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
    report.mapped += mapped[place];
    report.unclosed += clashing[place];
    report.held += held[place];
  }
  if (report.in_regions > 0) report.rms_movement = std::sqrt(sum / report.in_regions);
  for (std::size_t r = 0; r < shape.inside.size(); ++r) {
    const Region& region = shape.annotation.regions[r];
    SymmetrizeReport::RegionChange change;
    change.id = region.id;
    change.name = region.name;
    change.places = static_cast<int>(shape.inside[r].size());
    change.mapped = static_cast<int>(std::ranges::count_if(
        shape.inside[r], [&](int place) { return mapped[static_cast<std::size_t>(place)] != 0; }));
    if (shape.finite[r]) change.group = shape.finite[r]->group.symbol();
    change.before = residual_of(outcome.before[r], shape.scale);
    change.after = residual_of(outcome.after[r], shape.scale);
    report.regions.push_back(change);
  }
  return report;
}

void refuse_worse(const SymmetrizeReport::RegionChange& change) {
  const auto grew = [](double before, double after) { return after > before + kSameResidual; };
  if (!grew(change.before.max, change.after.max) && !grew(change.before.rms, change.after.rms)) return;
  std::ostringstream text;
  text << "region \"" << change.name << "\" would be worse than before: its residual would go from "
       << change.before.max << " to " << change.after.max << " of the diagonal at worst, from " << change.before.rms
       << " to " << change.after.rms << " on average";
  throw NoResultError(text.str());
}

}  // namespace

Mesh symmetrized(const Mesh& mesh, const SymmetryAnnotation& annotation, const RunContext& context,
                 SymmetrizeReport* report) {
  const Shape shape = prepare(mesh, annotation, context);
  const Outcome outcome = make_symmetric(shape, context);
  // What no region holds keeps its very coordinates, also where vertices lie a rounding apart.
  Mesh result = mesh;
  for (Index v = 0; v < result.vertices.rows(); ++v) {
    const int place = shape.places.of_vertex[static_cast<std::size_t>(v)];
    if (outcome.positions.row(place) != shape.places.positions.row(place)) {
      result.vertices.row(v) = outcome.positions.row(place);
    }
  }
  const SymmetrizeReport made = make_report(shape, outcome, result);
  for (const SymmetrizeReport::RegionChange& change : made.regions) refuse_worse(change);
  if (report != nullptr) *report = made;
  return result;
}

}  // namespace orbifit
