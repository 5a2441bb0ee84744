#include "orbifit/subspace/symmetric_sampling.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <unordered_map>

#include "orbifit/model/errors.h"
#include "orbifit/model/random.h"
#include "orbifit/model/sampling.h"

namespace orbifit {

namespace {

constexpr double kDoublet = 1e-4;  // of the diagonal (paper, section 5)
constexpr double kCrowded = 0.4;   // of r
constexpr int kCandidatesPerDisc = 30;
constexpr int kMostCandidates = 400000;

// Samples in cells as wide as the disc radius.
class DiscGrid {
 public:
  explicit DiscGrid(double radius) : radius_(radius) {}

  bool covered(const Eigen::Vector3d& point) const {
    const Cell cell = cell_of(point);
    for (int k = 0; k < 27; ++k) {
      const auto found = cells_.find(key({cell[0] + k % 3 - 1, cell[1] + k / 3 % 3 - 1, cell[2] + k / 9 - 1}));
      if (found == cells_.end()) continue;
      for (const Eigen::Vector3d& other : found->second) {
        if ((other - point).squaredNorm() < radius_ * radius_) return true;
      }
    }
    return false;
  }

  void insert(const Eigen::Vector3d& point) { cells_[key(cell_of(point))].push_back(point); }

 private:
  using Cell = std::array<std::int64_t, 3>;

  Cell cell_of(const Eigen::Vector3d& point) const {
    Cell cell{};
    for (int k = 0; k < 3; ++k) cell[static_cast<std::size_t>(k)] = std::llround(std::floor(point[k] / radius_));
    return cell;
  }

  static std::uint64_t key(const Cell& cell) {
    std::uint64_t value = 0;
    for (const std::int64_t coordinate : cell) {
      value = (value ^ static_cast<std::uint64_t>(coordinate)) * 0x9e3779b97f4a7c15ULL;
      value ^= value >> 29U;
    }
    return value;
  }

  double radius_;
  std::unordered_map<std::uint64_t, std::vector<Eigen::Vector3d>> cells_;
};

std::vector<int> random_order(Eigen::Index count, Random& random) {
  std::vector<int> order(static_cast<std::size_t>(count));
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<int>(i);
  for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random.below(i)]);
  return order;
}

void append(SymmetricSampling& sampling, const Orbit& orbit, std::vector<Eigen::Vector3d>& points) {
  const int number = sampling.orbits();
  for (const OrbitPoint& point : orbit.points) {
    points.push_back(point.position);
    sampling.orbit_of_sample.push_back(number);
    sampling.transports.push_back(point.transport);
  }
  for (const OrbitConstraint& constraint : orbit.constraints) {
    const Transport& left = orbit.points[static_cast<std::size_t>(constraint.point)].transport;
    sampling.constraints.push_back({number, left, constraint.other});
  }
  sampling.first_sample.push_back(static_cast<int>(points.size()));
}

}  // namespace

SymmetricSampling sample_symmetrically(const Mesh& mesh, const RegionMap& regions, const SamplingOptions& options,
                                       const RunContext& context) {
  Random random(context.seed, "symmetric sampling");
  const double r = options.radius;
  const double discs = face_areas(mesh).sum() / (std::numbers::pi / 4 * r * r);
  const int candidates = static_cast<int>(std::clamp(kCandidatesPerDisc * discs, 1000.0, double{kMostCandidates}));
  const SurfaceSamples surface = sample_surface(mesh, candidates, random);

  SymmetricSampling sampling;
  sampling.radius = r;
  sampling.first_sample.push_back(0);
  std::vector<Eigen::Vector3d> points;
  DiscGrid grid(r);
  ClosureOptions closure;
  closure.floating = options.floating;
  closure.doublet = kDoublet * diagonal(mesh.vertices);
  closure.snap = kCrowded * r;
  int done = 0;
  for (const int candidate : random_order(surface.points.rows(), random)) {
    if (++done % 256 == 0) context.progress("sampling", double(done) / candidates);
    const Eigen::Vector3d seed = surface.points.row(candidate);
    const int face = surface.faces[static_cast<std::size_t>(candidate)];
    if (grid.covered(seed)) continue;
    Orbit orbit = orbit_of(seed, face, regions, closure);
    if (!orbit.stabilisers.empty()) {
      const Eigen::Vector3d fixed = fixed_point(seed, orbit.stabilisers);
      // Motions without a common fixed point nearby crowd the seed by accident; it stays where it is.
      if ((fixed - seed).norm() < r) {
        ClosureOptions exact = closure;
        exact.snap = 0;
        orbit = orbit_of(fixed, face, regions, exact);
      }
    }
    if (points.size() + orbit.points.size() > static_cast<std::size_t>(options.most_samples)) {
      throw InputError(
          "", "radius " + std::to_string(r),
          "more than " + std::to_string(options.most_samples) + " samples are needed; take a larger radius");
    }
    append(sampling, orbit, points);
    for (const OrbitPoint& point : orbit.points) grid.insert(point.position);
  }
  sampling.points.resize(static_cast<Eigen::Index>(points.size()), 3);
  for (std::size_t i = 0; i < points.size(); ++i) sampling.points.row(static_cast<Eigen::Index>(i)) = points[i];
  return sampling;
}

}  // namespace orbifit
