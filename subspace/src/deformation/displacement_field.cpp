#include "orbifit/subspace/displacement_field.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <numeric>
#include <optional>
#include <utility>

#include "basis/plain_lift.h"
#include "basis/subspace_parts.h"
#include "deformation/surface_detail.h"
#include "domains/vertex_sets.h"
#include "geometry/vertex_grid.h"

namespace orbifit {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kMet = 1e-13;  // of the diagonal: a vertex this near an image is the image, but for rounding

// Evaluates the field at one point after another.
class FieldEvaluator {
 public:
  FieldEvaluator(const Subspace& subspace, const SubspaceState& state, const RunContext& context)
      : subspace_(subspace),
        basis_(basis_of(subspace, state)),
        words_(*subspace->words),
        plain_(subspace->sampling, *subspace->regions, subspace->lift_kind == LiftKind::orbit),
        samples_(sample_displacements(subspace, state)),
        detail_(state.detail) {
    carriers_ = basis_.carried * state.q;
    if (carriers_.size() > 0) carriers_ += basis_.carried_offset;
    closure_.doublet = kDoublet * subspace->diagonal;
    closure_.context = &context;
    transports_ = basis_.transports;
  }

  /// Points of all orbits evaluated so far.
  std::size_t points_seen() const { return points_seen_; }

  Vector3d operator()(const Vector3d& point, int set) {
    if (subspace_->lift_kind == LiftKind::paper) return paper(point);
    const Orbit orbit = snapped_orbit_of(point, set, *subspace_->regions, words_, closure_);
    points_seen_ += orbit.points.size();
    if (static_cast<std::size_t>(words_.count()) != transports_.words.size()) add_new_words();
    const Vector3d start = orbit.points.front().position;
    Vector3d u = Vector3d::Zero();
    for (const OrbitPoint& place : orbit.points) {
      if (detail_) {
        u += transports_.words[static_cast<std::size_t>(place.word)].frame.transpose() * detail(place.position) /
             static_cast<double>(orbit.points.size());
      }
      plain_.terms(place.position, place.set, scratch_);
      for (const LiftTerm& term : scratch_.terms) {
        const Seen& seen = look(term, place.word);
        const double weight = term.weight / static_cast<double>(orbit.points.size());
        u += weight * seen.displacement;
        if (basis_.rotations.empty()) continue;
        Vector3d arm = -seen.position;
        if (is_position(static_cast<LiftAtom::Kind>(term.kind))) arm += start;
        u += weight * (seen.rotation * arm - arm);
      }
    }
    Vector3d around = Vector3d::Zero();  // how what lies between the point and the one it is snapped to turns along
    if (!basis_.rotations.empty()) {
      const int region = innermost_region(*subspace_->regions, set);
      const Vector3d offset = point - (orbit.turned_by < 0 ? start : orbit.turn(start));
      if (region >= 0) around = basis_.rotations[static_cast<std::size_t>(region)] * offset - offset;
    }
    if (!orbit.constraints.empty()) {
      std::vector<WordPair> pairs;
      for (const OrbitConstraint& constraint : orbit.constraints) {
        pairs.push_back({orbit.points[static_cast<std::size_t>(constraint.point)].word, constraint.word});
      }
      std::ranges::sort(pairs);
      pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
      const Binding binding = binding_of(pairs, transports_);
      Vector3d bound = binding.kept * u + binding.slope * start + binding.offset;
      add_carried(binding.bound, bound);
      u = bound;
    }
    if (orbit.turned_by < 0) return u + around;
    const Transport rest = step_transport(*subspace_->regions, orbit.turned_by, -1, orbit.turn, floating());
    Transport now = rest;
    if (!basis_.rotations.empty()) {
      now = step_transport(*subspace_->regions, orbit.turned_by, -1, orbit.turn, floating(),
                           basis_.rotations[static_cast<std::size_t>(orbit.turned_by)]);
    }
    Vector3d turned = now.frame * (start + u) + now.shift - (rest.frame * start + rest.shift);
    add_carried(now.carried, turned);
    return turned + around;
  }

 private:
  struct Seen {
    Vector3d displacement, position;
    Matrix3d rotation;
  };

  bool floating() const { return subspace_->mode != GroupMode::fixed; }

  // Points bring new words; the samples' stay as they are.
  void add_new_words() {
    words_.append_transports(basis_.rotations, transports_.words);
    if (!basis_.rotations.empty()) words_.append_transports({}, transports_.rest_words);
  }

  Vector3d paper(const Vector3d& point) {
    plain_.terms(point, 0, scratch_);
    Vector3d u = detail_ ? detail(point) : Vector3d::Zero();
    for (const LiftTerm& term : scratch_.terms) u += term.weight * samples_.row(term.sample).transpose();
    return u;
  }

  Vector3d detail(const Vector3d& point) {
    detail_->surface->parts_at(point, parts_);
    Vector3d sum = Vector3d::Zero();
    for (const auto& [vertex, weight] : parts_) sum += weight * detail_->vectors.row(vertex).transpose();
    return sum;
  }

  void add_carried(const Carried& carried, Vector3d& u) const {
    if (carriers_.size() == 0) return;
    for (const auto& [carrier, matrix] : carried) u += matrix * carriers_.segment<3>(3 * carrier);
  }

  const Seen& look(const LiftTerm& term, int word) {
    const std::array<int, 4> key{word, term.sample, static_cast<int>(term.kind), term.place};
    const auto [entry, added] = seen_.try_emplace(key);
    if (!added) return entry->second;
    const LiftAtom atom{term.sample, word, static_cast<LiftAtom::Kind>(term.kind), term.place};
    const AtomMap map =
        atom_map(atom, subspace_->sampling, *subspace_->regions, transports_, floating(), basis_.rotations);
    Seen& seen = entry->second;
    seen.position = map.position;
    seen.displacement = map.offset;
    seen.rotation.setIdentity();
    if (map.orbit >= 0) {
      const int seed = subspace_->sampling.first_sample[static_cast<std::size_t>(map.orbit)];
      seen.displacement += map.frame * samples_.row(seed).transpose();
    }
    add_carried(map.carried, seen.displacement);
    if (basis_.rotations.empty()) return seen;
    const int region =
        atom.sample >= 0
            ? innermost_region(*subspace_->regions, subspace_->sampling.sets[static_cast<std::size_t>(atom.sample)])
            : atom.place;
    if (region >= 0) seen.rotation = basis_.rotations[static_cast<std::size_t>(region)];
    seen.rotation = transports_.words[static_cast<std::size_t>(word)].frame.transpose() * seen.rotation *
                    transports_.rest_words[static_cast<std::size_t>(word)].frame;
    return seen;
  }

  const Subspace& subspace_;
  const ConjugatedBasis& basis_;
  GroupWords words_;
  PlainLift plain_;
  Points samples_;
  Eigen::VectorXd carriers_;
  CarriedTransports transports_;
  ClosureOptions closure_;
  std::size_t points_seen_ = 0;
  PlainLift::Scratch scratch_;
  std::map<std::array<int, 4>, Seen> seen_;
  std::shared_ptr<const SurfaceDetail> detail_;  // null: none
  std::vector<SurfaceVectors::Part> parts_;      // of one point
};

// A mesh's vertices in a state, for any number of threads.
struct VertexField {
  VertexField(const Subspace& of, const Mesh& its_mesh, const SubspaceState& state, const RunContext& context)
      : subspace(of),
        mesh(its_mesh),
        baked(vertex_displacements(of, state, context)),
        near(its_mesh.vertices, kMet * of->diagonal) {
    if (of->lift_kind != LiftKind::orbit) return;
    for (int v = 0; v < static_cast<int>(mesh.vertices.rows()); ++v) sets.push_back(set_of_vertex(of->orbits, v));
  }

  int set_of(int vertex) const { return sets.empty() ? 0 : sets[static_cast<std::size_t>(vertex)]; }

  const Subspace& subspace;
  const Mesh& mesh;
  Points baked;           // displacements
  VertexGrid near;        // vertices that may be images
  std::vector<int> sets;  // of the vertices; empty where the lift knows none
};

// Pairs of a point and its image by one motion of a place, and how far the field is from carrying one to the other.
class PairResidual {
 public:
  PairResidual(const VertexField& vertices, FieldEvaluator& field)
      : vertices_(vertices), subspace_(vertices.subspace), mesh_(vertices.mesh), field_(field) {}

  /// Images at vertices are measured at once, others by finish().
  /// \param motion that of element number `element` of the place, or with a rotation of its continuum after it
  /// \param carried where the motion has gone
  void add(int vertex, const Motion& motion, const Motion& carried, int from_place, int element) {
    const Vector3d place = mesh_.vertices.row(vertex).transpose();
    const Vector3d image = motion(place);
    const int image_set =
        vertices_.sets.empty() ? 0 : subspace_->regions->carried_set(vertices_.set_of(vertex), from_place, element);
    int met = -1;
    const auto& followers = subspace_->orbits.followers;
    const int own = followers[static_cast<std::size_t>(vertex)].representative;
    vertices_.near.visit(image, [&](int other) {
      if (met >= 0 || followers[static_cast<std::size_t>(other)].representative != own) return;
      if (vertices_.set_of(other) == image_set) met = other;  // of parts that touch, the one that it is on
    });
    if (met < 0) {
      off_vertices_.push_back({vertex, motion, carried, from_place, element});
      return;
    }
    measure(vertices_.baked.row(vertex).transpose(), vertices_.baked.row(met).transpose(), place, motion, carried);
  }

  /// Measures images off the vertices, at most `most` of them, evenly spread: each is worth thousands at vertices.
  /// Where orbits are large it measures fewer.
  void finish(std::size_t most, const RunContext& context) {
    constexpr std::size_t kMin = 2;
    constexpr std::size_t kMaxOfOrbits = 30000;  // of their orbits
    const std::size_t count = off_vertices_.size();
    // An odd stride near the golden section spreads every beginning of the sequence.
    auto stride = static_cast<std::size_t>(0.618 * static_cast<double>(count));
    while (std::gcd(++stride, count) > 1) continue;
    const std::size_t seen_before = field_.points_seen();
    for (std::size_t i = 0; i < std::min(most, count); ++i) {
      if (i >= kMin && field_.points_seen() - seen_before > kMaxOfOrbits) break;
      const std::size_t k = i * stride % count;
      context.check();
      const Pair& pair = off_vertices_[k];
      const Vector3d place = mesh_.vertices.row(pair.vertex).transpose();
      const Vector3d image = pair.motion(place);
      const int set = vertices_.set_of(pair.vertex);
      const int image_set = subspace_->regions->carried_set(set, pair.from_place, pair.element);
      measure(field_(place, set), field_(image, image_set), place, pair.motion, pair.carried);
    }
  }

  /// Of what was measured.
  Residual result() const {
    Residual result = residual_;
    if (count_ > 0) result.rms = std::sqrt(squares_ / count_);
    return result;
  }

 private:
  struct Pair {
    int vertex;
    Motion motion, carried;
    int from_place, element;
  };

  // The rest shape's own residual is not the displacement's: y(g p) - g' y(p) less the same at rest.
  void measure(const Vector3d& here, const Vector3d& there, const Vector3d& place, const Motion& motion,
               const Motion& carried) {
    const double error = (there - (carried(place + here) - motion(place))).norm() / subspace_->diagonal;
    residual_.max = std::max(residual_.max, error);
    squares_ += error * error;
    count_ += 1;
  }

  const VertexField& vertices_;
  const Subspace& subspace_;
  const Mesh& mesh_;
  FieldEvaluator& field_;
  std::vector<Pair> off_vertices_;
  Residual residual_;
  double squares_ = 0, count_ = 0;
};

constexpr int kPatternPairs = 20000;

// Of images off the vertices, which cost more, fewer are measured.
std::size_t most_off_vertices(int pairs) {
  return static_cast<std::size_t>(std::max(pairs / 20, std::min(pairs, 200)));
}

Residual residual_of(const VertexField& vertices_in, FieldEvaluator& field, const Region& region, int region_number,
                     const SubspaceState& state, const RunContext& context, int pairs) {
  const Subspace& subspace = vertices_in.subspace;
  PairResidual residual(vertices_in, field);
  const std::vector<int> vertices = vertices_of_faces(vertices_in.mesh, region.faces);
  const std::vector<Motion> elements = subspace->regions->test_elements(region_number);
  const std::size_t components = subspace->regions->elements(region_number).size();
  const std::size_t step = 1 + vertices.size() * elements.size() / static_cast<std::size_t>(std::max(1, pairs));
  const Motion carried = region_motion(subspace, state, region_number);
  for (std::size_t v = 0; v < vertices.size(); v += step) {
    context.check();
    for (std::size_t e = 0; e < elements.size(); ++e) {
      residual.add(vertices[v], elements[e], conjugate(carried, elements[e]), region_number,
                   static_cast<int>(e % components));
    }
  }
  residual.finish(most_off_vertices(pairs), context);
  return residual.result();
}

// One evaluator for each thread that asks for one at a time: what it has seen makes the next points cheaper.
class FieldEvaluators {
 public:
  explicit FieldEvaluators(std::function<std::unique_ptr<FieldEvaluator>()> made) : made_(std::move(made)) {}

  std::unique_ptr<FieldEvaluator> take() {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (idle_.empty()) return made_();
    std::unique_ptr<FieldEvaluator> one = std::move(idle_.back());
    idle_.pop_back();
    return one;
  }

  void give_back(std::unique_ptr<FieldEvaluator> one) {
    const std::lock_guard<std::mutex> lock(mutex_);
    idle_.push_back(std::move(one));
  }

 private:
  std::function<std::unique_ptr<FieldEvaluator>()> made_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<FieldEvaluator>> idle_;
};

}  // namespace

Points displacement_field(const Subspace& subspace, const SubspaceState& state, const Points& points,
                          const std::vector<int>& sets, const RunContext& context) {
  FieldEvaluator field(subspace, state, context);
  Points result(points.rows(), 3);
  for (Eigen::Index p = 0; p < points.rows(); ++p) {
    if (p % 256 == 0) context.check();
    result.row(p) = field(points.row(p).transpose(), sets[static_cast<std::size_t>(p)]).transpose();
  }
  return result;
}

Residual field_residual(const Subspace& subspace, const Mesh& mesh, const Region& region, int region_number,
                        const SubspaceState& state, const RunContext& context, int pairs) {
  FieldEvaluator field(subspace, state, context);
  return residual_of({subspace, mesh, state, context}, field, region, region_number, state, context, pairs);
}

Residual field_residual(const Subspace& subspace, const Mesh& mesh, const Region& region, int region_number,
                        const Eigen::VectorXd& q, const RunContext& context) {
  return field_residual(subspace, mesh, region, region_number, SubspaceState{q, nullptr}, context);
}

std::vector<Residual> field_residuals(const Subspace& subspace, const Mesh& mesh, const SymmetryAnnotation& annotation,
                                      const SubspaceState& state, const RunContext& context, int pairs) {
  const VertexField vertices(subspace, mesh, state, context);
  FieldEvaluators evaluators([&] { return std::make_unique<FieldEvaluator>(subspace, state, context); });
  std::vector<Residual> result(annotation.regions.size());
  context.progress("residuals", 0);
  const auto measure = [&](std::size_t begin, std::size_t end) {
    std::unique_ptr<FieldEvaluator> field = evaluators.take();
    for (std::size_t i = begin; i < end; ++i) {
      result[i] = residual_of(vertices, *field, annotation.regions[i], static_cast<int>(i), state, context, pairs);
    }
    evaluators.give_back(std::move(field));
  };
  parallel_for(context, result.size(), measure);
  return result;
}

double worst_field_residual(const Subspace& subspace, const Mesh& mesh, const SymmetryAnnotation& annotation,
                            const SubspaceState& state, const RunContext& context) {
  double worst = 0;
  constexpr int kPairs = 2000;  // of each region: a field that is not exact shows in the first few
  for (const Residual& each : field_residuals(subspace, mesh, annotation, state, context, kPairs)) {
    worst = std::max(worst, each.max);
  }
  return worst;
}

Residual pattern_residual(const Subspace& subspace, const Mesh& mesh, const Pattern& pattern, int pattern_number,
                          const SubspaceState& state, const RunContext& context) {
  const RegionMap& regions = *subspace->regions;
  const int first = regions.first_place_of_pattern(pattern_number);
  const ConjugatedBasis& basis = basis_of(subspace, state);
  Eigen::VectorXd carriers = basis.carried * state.q;
  if (carriers.size() > 0) carriers += basis.carried_offset;
  const VertexField vertices(subspace, mesh, state, context);
  FieldEvaluator field(subspace, state, context);
  PairResidual residual(vertices, field);
  for (const int vertex : vertices_of_faces(mesh, pattern.instances.front().faces)) {
    context.check();
    for (std::size_t a = 1; a < pattern.instances.size(); ++a) {
      Motion carried = regions.elements(first)[a];
      for (const auto& [carrier, matrix] : regions.instance_shift(first + static_cast<int>(a))) {
        if (carriers.size() > 0) carried.translation += matrix * carriers.segment<3>(3 * carrier);
      }
      residual.add(vertex, regions.elements(first)[a], carried, first, static_cast<int>(a));
    }
  }
  residual.finish(most_off_vertices(kPatternPairs), context);
  return residual.result();
}

}  // namespace orbifit
