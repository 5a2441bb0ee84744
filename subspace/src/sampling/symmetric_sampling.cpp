#include "sampling/symmetric_sampling.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <set>
#include <string>
#include <unordered_map>

#include <Eigen/Geometry>

#include "orbifit/model/errors.h"

#include "base/random.h"
#include "files/text.h"
#include "geometry/grid_cell.h"
#include "sampling/symmetric_sampler.h"

namespace orbifit {

namespace {

std::string short_text(double number) {
  std::string text;
  append_number(text, number);
  return text;
}

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kDoubletSamples = 1e-4;  // of the diagonal (paper, section 5)
constexpr double kCrowded = 0.4;          // of r
constexpr double kRingSpacing = 0.9;      // of r
constexpr int kMinCopies = 6;
constexpr int kCandidatesPerDisc = 30;
constexpr int kMaxCandidates = 400000;
constexpr int kCandidatesPerPlace = 24;
constexpr double kBorderSpacing = 0.125;  // of r, between candidates on borders
constexpr double kOnBorder = 0.02;        // of r: images on borders may be this far off

// Samples in cells as wide as the largest disc.
class DiscGrid {
 public:
  DiscGrid(double radius, const RegionMap& regions) : width_(radius), regions_(regions) {}

  bool covered(const Vector3d& point, int set, double radius) const {
    constexpr int kMiddle = 13;  // of the cells around
    const Cell cell = cell_of(point);
    for (int neighbour = 0; neighbour < 27; ++neighbour) {
      const int k = (neighbour + kMiddle) % 27;  // what covers it lies in its own cell mostly
      const auto found = cells_.find(key({cell[0] + k % 3 - 1, cell[1] + k / 3 % 3 - 1, cell[2] + k / 9 - 1}));
      if (found == cells_.end()) continue;
      for (const Disc& disc : found->second) {
        const double reach = std::min(radius, disc.radius);
        if ((disc.centre - point).squaredNorm() < reach * reach && regions_.contains(disc.set, set)) return true;
      }
    }
    return false;
  }

  void insert(const Vector3d& point, int set, double radius) {
    cells_[key(cell_of(point))].push_back({point, radius, set});
  }

 private:
  using Cell = std::array<std::int64_t, 3>;
  struct Disc {
    Vector3d centre;
    double radius;
    int set;
  };

  Cell cell_of(const Vector3d& point) const { return grid_cell(point, width_); }

  static std::uint64_t key(const Cell& cell) {
    std::uint64_t value = 0;
    for (const std::int64_t coordinate : cell) {
      value = (value ^ static_cast<std::uint64_t>(coordinate)) * 0x9e3779b97f4a7c15ULL;
      value ^= value >> 29U;
    }
    return value;
  }

  double width_;
  const RegionMap& regions_;
  std::unordered_map<std::uint64_t, std::vector<Disc>> cells_;
};

struct Candidate {
  Vector3d position;
  int face;
  int set;
  bool border;
  int rank;  // drawn earlier: features, then points of many places, whose samples serve their surroundings too
};

void append(std::vector<Candidate>& candidates, const SurfaceSamples& samples, const RegionMap& regions, bool first) {
  for (Eigen::Index i = 0; i < samples.points.rows(); ++i) {
    const int face = samples.faces[static_cast<std::size_t>(i)];
    const int places = static_cast<int>(regions.regions_of_face(face).size());
    candidates.push_back(
        {samples.points.row(i).transpose(), face, regions.set_of_face(face), false, 2 * places + (first ? 1 : 0)});
  }
}

// Those on borders come before all from the borders' sides, since they lie in more places.
void append(std::vector<Candidate>& candidates, const std::vector<BorderPoint>& points, const RegionMap& regions) {
  for (const BorderPoint& point : points) {
    const int places = static_cast<int>(regions.set_places(point.set).size());
    candidates.push_back({point.position, point.face, point.set, true, 2 * places + 1});
  }
}

// In the order in which they are drawn.
std::vector<Candidate> draw_candidates(const Mesh& mesh, const RegionMap& regions, const AbuttingPlaces& borders,
                                       const SamplingOptions& options, double least_radius, const RunContext& context) {
  Random random(context.seed, "symmetric sampling");
  const Eigen::VectorXd areas = face_areas(mesh);
  const double discs = areas.sum() / (std::numbers::pi / 4 * least_radius * least_radius);
  const int count = static_cast<int>(std::clamp(kCandidatesPerDisc * discs, 1000.0, double{kMaxCandidates}));
  std::vector<Candidate> candidates;
  append(candidates, options.first, regions, true);
  append(candidates, sample_surface(mesh, count, random), regions, false);
  // Small places get candidates however small they are.
  std::vector<int> drawn(static_cast<std::size_t>(regions.places()), 0);
  for (const Candidate& candidate : candidates) {
    for (const int place : regions.regions_of_face(candidate.face)) ++drawn[static_cast<std::size_t>(place)];
  }
  std::vector<std::vector<int>> missed(drawn.size());
  for (Eigen::Index face = 0; face < areas.size(); ++face) {
    if (!(areas[face] > 0)) continue;
    for (const int place : regions.regions_of_face(static_cast<int>(face))) {
      const auto number = static_cast<std::size_t>(place);
      if (drawn[number] < kCandidatesPerPlace) missed[number].push_back(static_cast<int>(face));
    }
  }
  for (const std::vector<int>& faces : missed) {
    if (!faces.empty()) append(candidates, sample_surface(mesh, kCandidatesPerPlace, random, faces), regions, false);
  }
  if (!borders.empty()) append(candidates, borders.points(kBorderSpacing * least_radius), regions);
  for (std::size_t i = candidates.size(); i > 1; --i) std::swap(candidates[i - 1], candidates[random.below(i)]);
  std::ranges::stable_sort(candidates, [](const Candidate& a, const Candidate& b) { return a.rank > b.rank; });
  return candidates;
}

// Turns from a canonical place to its copies, the identity first, and how many the radius asks for.
std::vector<Motion> copy_turns(const Continuum& continuum, const Vector3d& position, double radius, double& needed) {
  const double distance = continuum.distance(position);
  std::vector<Motion> turns{Motion{}};
  needed = 1;
  if (!(distance > 0)) return turns;
  if (!continuum.spherical) {
    const double around = 2 * std::numbers::pi * distance / (kRingSpacing * radius);
    const int fold = continuum.fold;
    const int count = fold > 1 ? fold * static_cast<int>(std::ceil(around / fold))
                               : std::max(kMinCopies, static_cast<int>(std::ceil(around)));
    needed = std::max(double{kMinCopies}, around);
    for (int k = 1; k < count; ++k) {
      turns.push_back(Motion::rotation(continuum.axis, 2 * std::numbers::pi * k / count, continuum.centre));
    }
    return turns;
  }
  // A spiral of points at equal areas (Vogel 1979), the canonical pole first.
  const double area = kRingSpacing * radius / distance;
  const int count = std::max(12, static_cast<int>(std::ceil(4 * std::numbers::pi / (area * area))));
  needed = count;
  const double golden = std::numbers::pi * (3 - std::sqrt(5.0));
  const Vector3d side = continuum.axis.cross(continuum.reference);
  for (int k = 1; k < count; ++k) {
    const double height = 1 - 2 * (k + 0.5) / count;
    const double level = std::sqrt(std::max(0.0, 1 - height * height));
    const Vector3d direction = height * continuum.axis + level * std::cos(golden * k) * continuum.reference +
                               level * std::sin(golden * k) * side;
    turns.push_back(continuum.turn_to(continuum.centre + distance * direction));
  }
  return turns;
}

int continuous_place(const RegionMap& regions, int set) {
  int chosen = -1;
  for (const int place : regions.set_places(set)) {
    const Continuum* continuum = regions.continuum(place);
    if (continuum != nullptr && (chosen < 0 || continuum->spherical)) chosen = place;
  }
  return chosen;
}

void append(SymmetricSampling& sampling, const Orbit& orbit, const RegionMap& regions, double radius,
            std::vector<Vector3d>& points, std::vector<double>& radii) {
  const int number = sampling.orbits();
  for (const OrbitPoint& point : orbit.points) {
    const int place = continuous_place(regions, point.set);
    double needed = 1;
    const std::vector<Motion> turns = place < 0 ? std::vector<Motion>{Motion{}}
                                                : copy_turns(*regions.continuum(place), point.position, radius, needed);
    const int first = static_cast<int>(points.size());
    for (std::size_t k = 0; k < turns.size(); ++k) {
      points.push_back(turns[k](point.position));
      radii.push_back(radius);
      sampling.orbit_of_sample.push_back(number);
      sampling.words.push_back(point.word);
      sampling.sets.push_back(point.set);
      sampling.copies.push_back({place, first, turns[k]});
      sampling.copy_counts.push_back(static_cast<int>(turns.size()));
      sampling.shares.push_back(std::min(1.0, needed / static_cast<double>(turns.size())));
    }
  }
  for (const OrbitConstraint& constraint : orbit.constraints) {
    const int word = orbit.points[static_cast<std::size_t>(constraint.point)].word;
    sampling.constraints.push_back({number, word, constraint.word});
  }
  sampling.first_sample.push_back(static_cast<int>(points.size()));
}

// Orbits taken one after another, each where no disc of those before lies.
class OrbitSampler {
 public:
  // \param largest  of the radii
  OrbitSampler(const Mesh& mesh, const RegionMap& regions, const AbuttingPlaces& borders, GroupWords& words,
               const SamplingOptions& options, double largest, const RunContext& context)
      : regions_(regions), borders_(borders), words_(words), options_(options), grid_(largest, regions) {
    closure_.doublet = kDoubletSamples * diagonal(mesh.vertices);
    closure_.context = &context;
    sampling_.radius = options.radius;
    sampling_.first_sample.push_back(0);
  }

  void take(const Candidate& candidate, double radius) {
    if (candidate.border && unclosed_.contains(candidate.set)) return;
    if (grid_.covered(candidate.position, candidate.set, radius)) return;
    Orbit orbit;
    try {
      orbit = closed_orbit(candidate, radius);
    } catch (const InputError&) {  // groups that close on either side of a border need not do so on it
      if (!candidate.border) throw;
      unclosed_.insert(candidate.set);
      return;
    }
    const std::size_t before = points_.size();
    append(sampling_, orbit, regions_, radius, points_, radii_);
    if (points_.size() > static_cast<std::size_t>(options_.most_samples)) {
      throw InputError(
          "", "radius " + short_text(options_.radius),
          "more than " + std::to_string(options_.most_samples) + " samples are needed; take a larger radius");
    }
    // The candidate counts as covered even where its orbit moved off by almost r.
    grid_.insert(candidate.position, candidate.set, radius);
    for (std::size_t k = before; k < points_.size(); ++k) grid_.insert(points_[k], sampling_.sets[k], radius);
  }

  SymmetricSampling finish() {
    sampling_.points.resize(static_cast<Eigen::Index>(points_.size()), 3);
    for (std::size_t i = 0; i < points_.size(); ++i) {
      sampling_.points.row(static_cast<Eigen::Index>(i)) = points_[i];
    }
    sampling_.radii = Eigen::Map<const Eigen::VectorXd>(radii_.data(), static_cast<Eigen::Index>(radii_.size()));
    return std::move(sampling_);
  }

 private:
  // The candidate's orbit, or that of the nearby point that its stabilisers fix.
  Orbit closed_orbit(const Candidate& candidate, double radius) {
    ClosureOptions closure = closure_;
    closure.snap = kCrowded * radius;
    double off_border = kOnBorder * radius;
    if (candidate.border) {
      closure.set_at = [&](const Vector3d& image, int carried) { return borders_.set_at(image, carried, off_border); };
    }
    Orbit orbit = orbit_of(candidate.position, candidate.set, regions_, words_, closure);
    if (orbit.stabilisers.empty()) return orbit;
    const Vector3d start = orbit.points.front().position;
    const Vector3d fixed = fixed_point(start, orbit.stabilisers);
    // Motions without a common fixed point nearby crowd the seed by accident; it stays where it is.
    if (!((fixed - start).norm() < radius)) return orbit;
    off_border += (fixed - start).norm();
    closure.snap = 0;
    return orbit_of(fixed, orbit.points.front().set, regions_, words_, closure);
  }

  const RegionMap& regions_;
  const AbuttingPlaces& borders_;
  GroupWords& words_;
  const SamplingOptions& options_;
  ClosureOptions closure_;
  SymmetricSampling sampling_;
  std::vector<Vector3d> points_;
  std::vector<double> radii_;
  DiscGrid grid_;
  std::set<int> unclosed_;  // sets of borders
};

}  // namespace

SymmetricSampling sample_symmetrically(const Mesh& mesh, const RegionMap& regions, GroupWords& words,
                                       const SamplingOptions& options, const RunContext& context) {
  const AbuttingPlaces borders(mesh, regions);
  return SymmetricSampler(mesh, regions, borders).sample(words, options, context);
}

SymmetricSampling SymmetricSampler::sample(GroupWords& words, const SamplingOptions& options,
                                           const RunContext& context) const {
  const bool field = options.radius_field.size() == mesh_.vertices.rows() && options.radius_field.size() > 0;
  const double least = field ? options.radius_field.minCoeff() : options.radius;
  const double largest = field ? options.radius_field.maxCoeff() : options.radius;
  const std::vector<Candidate> candidates = draw_candidates(mesh_, regions_, borders_, options, least, context);
  OrbitSampler sampler(mesh_, regions_, borders_, words, options, largest, context);
  std::size_t done = 0;
  for (const Candidate& candidate : candidates) {
    if (++done % 256 == 0) context.progress("sampling", double(done) / static_cast<double>(candidates.size()));
    double radius = options.radius;
    if (field) radius = options.radius_field(mesh_.faces.row(candidate.face).transpose()).mean();
    sampler.take(candidate, radius);
  }
  return sampler.finish();
}

std::vector<Transport> sample_transports(const SymmetricSampling& sampling, const RegionMap& regions,
                                         const std::vector<Transport>& words, bool floating,
                                         const std::vector<Matrix3d>& rotations) {
  std::vector<Transport> result;
  result.reserve(sampling.words.size());
  for (std::size_t k = 0; k < sampling.words.size(); ++k) {
    const Transport& word = words[static_cast<std::size_t>(sampling.words[k])];
    const SymmetricSampling::Copy& copy = sampling.copies[k];
    if (copy.place < 0 || copy.first == static_cast<int>(k)) {
      result.push_back(word);
      continue;
    }
    const Matrix3d rotation =
        rotations.empty() ? Matrix3d(Matrix3d::Identity()) : rotations[static_cast<std::size_t>(copy.place)];
    result.push_back(composed(step_transport(regions, copy.place, -1, copy.turn, floating, rotation), word));
  }
  return result;
}

}  // namespace orbifit
