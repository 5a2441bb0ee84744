#include "rest_shape/gap_closing.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace orbifit {

namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Vector3d;

// A strain of 1 everywhere counts as much as so many times all gaps of a region at rest.
constexpr double kStiffness[] = {1e2, 1, 1e-2, 1e-4};
constexpr int kMaxIterations = 6;  // at each stiffness
constexpr int kMaxSolverSteps = 20;
constexpr std::size_t kMaxTerms = 30000;  // a step of the solver takes some milliseconds
constexpr double kShortest = 1e-4;        // of the diagonal: shorter edges strain like this
constexpr double kSolved = 1e-3;          // of the gradient at the start
constexpr double kDamping = 1e-3;         // of what the pairs in which an orbit has part weigh
constexpr double kStill = 1e-14;          // of the diagonal
constexpr double kStalled = 0.9;          // of the sum before

// A pair that takes part.
struct Term {
  const Motion* motion;
  int place;
  Eigen::RowVector3i corners;
  Vector3d weights;  // barycentric
  Vector3d gap;
  double weight;
};

// An edge that may be strained.
struct StrainedEdge {
  int a, b;
  Vector3d strain;  // difference of the ends' displacements since rest
  double weight;
};

class Step {
 public:
  Step(const std::vector<PlaceOrbit>& orbits, const GapWeights& weights, Index places)
      : orbits_(orbits), orbit_of_(static_cast<std::size_t>(places), -1), frames_(orbit_of_.size()) {
    for (std::size_t o = 0; o < orbits.size(); ++o) {
      if (weights.free[o] == 0) continue;
      const Matrix3d directions = free_directions(orbits[o]);
      for (std::size_t k = 0; k < orbits[o].members.size(); ++k) {
        const auto member = static_cast<std::size_t>(orbits[o].members[k]);
        orbit_of_[member] = static_cast<int>(o);
        frames_[member] = orbits[o].motions[k].linear * directions;
      }
    }
  }

  // Of all displacements of the first members, #O by 3, that which lowers the damped sum; empty where nothing moves.
  Points solve(const std::vector<Term>& terms, const std::vector<StrainedEdge>& edges) {
    damping_ = Eigen::VectorXd::Zero(static_cast<Index>(orbits_.size()));
    for (const Term& term : terms) {
      add_damping(term.place, term.weight);
      for (int k = 0; k < 3; ++k) add_damping(term.corners[k], term.weight);
    }
    for (const StrainedEdge& edge : edges) {
      add_damping(edge.a, edge.weight);
      add_damping(edge.b, edge.weight);
    }
    // Conjugate gradients on the normal equations, preconditioned by the damping's diagonal.
    Points x = Points::Zero(damping_.size(), 3);
    std::vector<Vector3d> residual(terms.size());
    for (std::size_t t = 0; t < terms.size(); ++t) residual[t] = -terms[t].gap;
    std::vector<Vector3d> strain(edges.size());
    for (std::size_t e = 0; e < edges.size(); ++e) strain[e] = -edges[e].strain;
    Points gradient = transposed(terms, residual, edges, strain);
    Points direction = preconditioned(gradient);
    double slope = (gradient.array() * direction.array()).sum();
    const double least = kSolved * kSolved * slope;
    for (int step = 0; step < kMaxSolverSteps && slope > least && slope > 0; ++step) {
      const std::vector<Vector3d> change = applied(terms, direction);
      const std::vector<Vector3d> strained = applied(edges, direction);
      double curvature = kDamping * (damping_.asDiagonal() * direction).cwiseProduct(direction).sum();
      for (std::size_t t = 0; t < terms.size(); ++t) curvature += terms[t].weight * change[t].squaredNorm();
      for (std::size_t e = 0; e < edges.size(); ++e) curvature += edges[e].weight * strained[e].squaredNorm();
      if (!(curvature > 0)) break;
      const double length = slope / curvature;
      x += length * direction;
      for (std::size_t t = 0; t < terms.size(); ++t) residual[t] -= length * change[t];
      for (std::size_t e = 0; e < edges.size(); ++e) strain[e] -= length * strained[e];
      gradient = transposed(terms, residual, edges, strain) - kDamping * (damping_.asDiagonal() * x);
      const Points next = preconditioned(gradient);
      const double next_slope = (gradient.array() * next.array()).sum();
      direction = next + next_slope / slope * direction;
      slope = next_slope;
    }
    return x;
  }

  bool moves(int place) const { return orbit_of_[static_cast<std::size_t>(place)] >= 0; }

 private:
  void add_damping(int place, double weight) {
    const int orbit = orbit_of_[static_cast<std::size_t>(place)];
    if (orbit >= 0) damping_[orbit] += weight;
  }

  Vector3d displacement(int place, const Points& x) const {
    const int orbit = orbit_of_[static_cast<std::size_t>(place)];
    if (orbit < 0) return Vector3d::Zero();
    return frames_[static_cast<std::size_t>(place)] * x.row(orbit).transpose();
  }

  // M dp - dq of each term.
  std::vector<Vector3d> applied(const std::vector<Term>& terms, const Points& x) const {
    std::vector<Vector3d> result(terms.size());
    for (std::size_t t = 0; t < terms.size(); ++t) {
      const Term& term = terms[t];
      result[t] = term.motion->linear * displacement(term.place, x);
      for (int k = 0; k < 3; ++k) result[t] -= term.weights[k] * displacement(term.corners[k], x);
    }
    return result;
  }

  std::vector<Vector3d> applied(const std::vector<StrainedEdge>& edges, const Points& x) const {
    std::vector<Vector3d> result(edges.size());
    for (std::size_t e = 0; e < edges.size(); ++e) {
      result[e] = displacement(edges[e].a, x) - displacement(edges[e].b, x);
    }
    return result;
  }

  Points transposed(const std::vector<Term>& terms, const std::vector<Vector3d>& values,
                    const std::vector<StrainedEdge>& edges, const std::vector<Vector3d>& strains) const {
    Points result = Points::Zero(damping_.size(), 3);
    const auto add = [&](int place, const Vector3d& value) {
      const int orbit = orbit_of_[static_cast<std::size_t>(place)];
      if (orbit >= 0) result.row(orbit) += (frames_[static_cast<std::size_t>(place)].transpose() * value).transpose();
    };
    for (std::size_t t = 0; t < terms.size(); ++t) {
      const Term& term = terms[t];
      const Vector3d value = term.weight * values[t];
      add(term.place, term.motion->linear.transpose() * value);
      for (int k = 0; k < 3; ++k) add(term.corners[k], -term.weights[k] * value);
    }
    for (std::size_t e = 0; e < edges.size(); ++e) {
      const Vector3d value = edges[e].weight * strains[e];
      add(edges[e].a, value);
      add(edges[e].b, -value);
    }
    return result;
  }

  Points preconditioned(const Points& gradient) const {
    Points result = gradient;
    for (Index o = 0; o < result.rows(); ++o) {
      if (damping_[o] > 0) result.row(o) /= damping_[o];
    }
    return result;
  }

  const std::vector<PlaceOrbit>& orbits_;
  std::vector<int> orbit_of_;     // of places that move
  std::vector<Matrix3d> frames_;  // from the first member's displacement to the place's
  Eigen::VectorXd damping_;
};

// \param averaged  by place: it is where the mean of its images is, and edges between such are not strained at `start`
std::vector<StrainedEdge> strained_edges(const Step& step, const Places& places, const Points& start,
                                         const std::vector<char>& averaged, const std::vector<char>& stiff,
                                         double stiffness, const Points& positions) {
  std::vector<StrainedEdge> edges;
  const double shortest = kShortest * diagonal(places.positions);
  std::size_t all = 0;
  for (int a = 0; a < static_cast<int>(places.neighbours.size()); ++a) {
    for (const int b : places.neighbours[static_cast<std::size_t>(a)]) {
      if (b < a) continue;
      ++all;
      if (!step.moves(a) && !step.moves(b)) continue;
      const bool means = averaged[static_cast<std::size_t>(a)] != 0 && averaged[static_cast<std::size_t>(b)] != 0;
      const Points& from = means ? start : places.positions;
      const Vector3d rest = from.row(a) - from.row(b);
      const Vector3d now = positions.row(a) - positions.row(b);
      const double length = std::max(rest.norm(), shortest);
      const bool both = stiff[static_cast<std::size_t>(a)] != 0 && stiff[static_cast<std::size_t>(b)] != 0;
      edges.push_back({a, b, now - rest, (both ? kStiffness[0] : stiffness) / (length * length)});
    }
  }
  for (StrainedEdge& edge : edges) edge.weight /= static_cast<double>(all);
  return edges;
}

// The pairs in which something moves.
std::vector<Term> gap_terms(const Step& step, const ImagePairs& pairs, const std::vector<SurfaceMatch>& matches,
                            const GapWeights& weights, const Points& positions) {
  std::vector<Term> terms;
  for (std::size_t m = 0; m < matches.size(); ++m) {
    if (matches[m].face < 0) continue;
    const ImagePairs::Pair pair = pairs[m];
    Term term{pair.motion,        pair.place,       pairs.corners(matches[m].face),
              matches[m].weights, Vector3d::Zero(), weights.of_region[static_cast<std::size_t>(pair.region)]};
    term.gap = (*pair.motion)(positions.row(pair.place).transpose());
    bool moves = step.moves(pair.place);
    for (int k = 0; k < 3; ++k) {
      term.gap -= term.weights[k] * positions.row(term.corners[k]).transpose();
      moves = moves || (term.weights[k] > 0 && step.moves(term.corners[k]));
    }
    if (moves) terms.push_back(term);
  }
  return terms;
}

// Probes whose images may lie between vertices: those of complete orbits are vertices, wherever those go.
std::vector<std::vector<char>> open_probes(const ImagePairs& pairs, const std::vector<PlaceOrbit>& orbits,
                                           const std::vector<char>& free, std::size_t places) {
  std::vector<char> open(places, 0);
  for (std::size_t o = 0; o < orbits.size(); ++o) {
    for (const int member : orbits[o].members) {
      open[static_cast<std::size_t>(member)] = orbits[o].complete && free[o] != 0 ? 0 : 1;
    }
  }
  std::vector<std::vector<char>> result;
  for (const RegionDemand& demand : pairs.demands()) {
    result.emplace_back(demand.probes.size(), 0);
    if (!demand.of_finite_group) continue;
    for (std::size_t i = 0; i < demand.probes.size(); ++i) {
      result.back()[i] = open[static_cast<std::size_t>(demand.probes[i].place)];
    }
  }
  return result;
}

}  // namespace

void place_images(const PlaceOrbit& orbit, const Vector3d& first, Points& positions) {
  for (std::size_t k = 0; k < orbit.members.size(); ++k) {
    positions.row(orbit.members[k]) = orbit.motions[k](first).transpose();
  }
}

int close_gaps(ImagePairs& pairs, const std::vector<PlaceOrbit>& orbits, const GapWeights& weights, double reach,
               const Places& places, Points& positions, const RunContext& context) {
  const auto wanted = open_probes(pairs, orbits, weights.free, places.neighbours.size());
  if (std::ranges::none_of(wanted, [](const auto& probes) { return std::ranges::find(probes, 1) != probes.end(); })) {
    return 0;
  }
  const std::size_t most = std::max<std::size_t>(1, kMaxTerms / pairs.demands().size());
  Step step(orbits, weights, positions.rows());
  const Points start = positions;
  std::vector<char> averaged(static_cast<std::size_t>(positions.rows()), 0);
  for (std::size_t o = 0; o < orbits.size(); ++o) {
    if (!orbits[o].complete || weights.free[o] == 0) continue;
    for (const int member : orbits[o].members) averaged[static_cast<std::size_t>(member)] = 1;
  }
  const double scale = diagonal(positions);
  int iterations = 0;
  for (const double stiffness : kStiffness) {
    double last = std::numeric_limits<double>::infinity();
    for (int iteration = 0; iteration < kMaxIterations; ++iteration, ++iterations) {
      context.progress("surface", 0.5);
      const std::vector<Term> terms =
          gap_terms(step, pairs, pairs.match(positions, &wanted, context, reach, most), weights, positions);
      const std::vector<StrainedEdge> edges =
          strained_edges(step, places, start, averaged, weights.stiff, stiffness, positions);
      double sum = 0;
      for (const Term& term : terms) sum += term.weight * term.gap.squaredNorm();
      for (const StrainedEdge& edge : edges) sum += edge.weight * edge.strain.squaredNorm();
      if (terms.empty() || sum > kStalled * last) break;
      last = sum;
      const Points displacements = step.solve(terms, edges);
      double largest = 0;
      for (std::size_t o = 0; o < orbits.size(); ++o) {
        const Vector3d displacement = displacements.row(static_cast<Index>(o));
        if (weights.free[o] == 0 || displacement.isZero(0)) continue;
        const Vector3d first = positions.row(orbits[o].members.front());
        const Vector3d target = stabilised(orbits[o], first + free_directions(orbits[o]) * displacement);
        largest = std::max(largest, (target - first).norm());
        place_images(orbits[o], target, positions);
      }
      if (largest < kStill * scale) break;
    }
  }
  return iterations;
}

}  // namespace orbifit
