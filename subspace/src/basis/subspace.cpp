#include "orbifit/subspace/subspace.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "orbifit/model/errors.h"

#include "basis/conjugated_regions.h"
#include "basis/subspace_parts.h"
#include "deformation/surface_detail.h"
#include "kernels/kernels.h"

namespace orbifit {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Rows of three as rows of four, the last zero.
std::vector<double> padded_by_four(const Eigen::VectorXd& stacked) {
  const auto count = static_cast<std::size_t>(stacked.size() / 3);
  std::vector<double> padded(4 * count, 0.0);
  for (std::size_t k = 0; k < count; ++k) {
    for (std::size_t c = 0; c < 3; ++c) padded[4 * k + c] = stacked[static_cast<Eigen::Index>(3 * k + c)];
  }
  return padded;
}

// Displacement of a point when its word goes from rest to now, the displacement where the word starts being u.
Vector3d carried_by(const Transport& now, const Transport* rest, const Vector3d& start, const Vector3d& u,
                    const Eigen::VectorXd& carriers) {
  Vector3d result = now.frame * u;
  for (const auto& [carrier, matrix] : now.carried) result += matrix * carriers.segment<3>(3 * carrier);
  if (rest != nullptr) result += (now.frame - rest->frame) * start + now.shift - rest->shift;
  return result;
}

void bind(const Binding& binding, const Vector3d& position, const Eigen::VectorXd& carriers, Vector3d& u) {
  Vector3d bound = binding.kept * u + binding.slope * position + binding.offset;
  for (const auto& [carrier, matrix] : binding.bound) bound += matrix * carriers.segment<3>(3 * carrier);
  u = bound;
}

// The part of the lift that turns with the regions (docs/method.md 2.2): the sum of w (R - 1) (p - x), each atom
// turning the point about itself. Linear in each, so that it does not matter by which of several words an atom is seen.
void add_turned_rest(const Subspace& subspace, const ConjugatedBasis& basis, int representative, Vector3d& u) {
  const Vector3d start = subspace->orbits.positions.row(representative).transpose();
  subspace->lift.visit(representative, [&](int atom, double weight) {
    const auto a = static_cast<std::size_t>(atom);
    Vector3d arm = -basis.atom_positions[a];
    if (is_position(subspace->lift.atoms[a].kind)) arm += start;
    u += weight * (basis.atom_rotations[a] * arm - arm);
  });
}

// Everything that one lift needs of the state.
struct LiftState {
  std::vector<double> atoms;  // four doubles each
  Eigen::VectorXd carriers;
  std::vector<double> copiers;  // sixteen doubles a word: frame's columns and shift
};

LiftState lift_state(const ConjugatedBasis& basis, const SubspaceState& state) {
  const bool turned = !basis.rotations.empty();
  LiftState result;
  Eigen::VectorXd atoms = basis.atoms * state.q;
  result.carriers = basis.carried * state.q;
  if (turned) {
    atoms += basis.atom_offset;
    result.carriers += basis.carried_offset;
  }
  result.atoms = padded_by_four(atoms);
  const std::vector<Transport>& words = basis.transports.words;
  result.copiers.assign(16 * words.size(), 0.0);
  for (std::size_t w = 0; w < words.size(); ++w) {
    double* copier = result.copiers.data() + 16 * w;
    for (Eigen::Index c = 0; c < 3; ++c) Eigen::Map<Vector3d>(copier + 4 * c) = words[w].frame.col(c);
    Eigen::Map<Vector3d>(copier + 12) = carried_by(words[w], turned ? &basis.transports.rest_words[w] : nullptr,
                                                   Vector3d::Zero(), Vector3d::Zero(), result.carriers);
  }
  return result;
}

// What the copy of a vertex lacks: how its word turns the place itself, the turn on its circle, and how what lies
// between that place and the vertex turns along.
Vector3d finished(const Subspace& subspace, const ConjugatedBasis& basis, int vertex, const Eigen::VectorXd& carriers,
                  const Vector3d& copied) {
  const bool turned = !basis.rotations.empty();
  const VertexOrbits::Follower& follower = subspace->orbits.followers[static_cast<std::size_t>(vertex)];
  const Vector3d start = subspace->orbits.positions.row(follower.representative).transpose();
  Vector3d u = copied;
  Vector3d around = Vector3d::Zero();
  if (turned) {
    const auto word = static_cast<std::size_t>(follower.word);
    u += (basis.transports.words[word].frame - basis.transports.rest_words[word].frame) * start;
    const auto& [offset, region] = subspace->orbits.offsets[static_cast<std::size_t>(vertex)];
    if (region >= 0) around = basis.rotations[static_cast<std::size_t>(region)] * offset - offset;
  }
  if (follower.turn < 0) return u + around;
  const auto& [place, motion] = subspace->orbits.turns[static_cast<std::size_t>(follower.turn)];
  const bool floating = subspace->mode != GroupMode::fixed;
  const Transport rest = step_transport(*subspace->regions, place, -1, motion, floating);
  const Transport now = turned ? step_transport(*subspace->regions, place, -1, motion, floating,
                                                basis.rotations[static_cast<std::size_t>(place)])
                               : rest;
  return around + carried_by(now, turned ? &rest : nullptr, subspace->words->motion(follower.word)(start), u, carriers);
}

}  // namespace

std::string to_string(GroupMode mode) {
  return mode == GroupMode::fixed ? "fixed" : mode == GroupMode::floating ? "floating" : "moving";
}

std::string to_string(LiftKind kind) {
  return kind == LiftKind::paper ? "paper" : "orbit";
}

GroupMode Subspace::mode() const {
  return parts_->mode;
}

LiftKind Subspace::lift_kind() const {
  return parts_->lift_kind;
}

int Subspace::degrees_of_freedom() const {
  return parts_->degrees_of_freedom();
}

int Subspace::regions() const {
  return parts_->regions->count();
}

const Points& Subspace::samples() const {
  return parts_->sampling.points;
}

double Subspace::radius() const {
  return parts_->sampling.radius;
}

double Subspace::diagonal() const {
  return parts_->diagonal;
}

const ConjugatedBasis& basis_of(const Subspace& subspace, const SubspaceState& state) {
  return state.basis ? *state.basis : subspace->basis;
}

Points sample_displacements(const Subspace& subspace, const SubspaceState& state) {
  const ConjugatedBasis& basis = basis_of(subspace, state);
  Eigen::VectorXd stacked = basis.columns * state.q;
  if (!basis.rotations.empty()) stacked += basis.offset;
  return Eigen::Map<const Points>(stacked.data(), stacked.size() / 3, 3);
}

Points sample_displacements(const Subspace& subspace, const Eigen::VectorXd& q) {
  return sample_displacements(subspace, SubspaceState{q, nullptr});
}

Motion region_motion(const Subspace& subspace, const SubspaceState& state, int region) {
  const ConjugatedBasis& basis = basis_of(subspace, state);
  if (basis.carried.rows() == 0) return {};
  Motion motion;
  const Vector3d& centre = subspace->regions->centre(region);
  if (!basis.rotations.empty()) {
    motion = Motion::about(basis.rotations[static_cast<std::size_t>(region)], centre);
  }
  motion.translation += basis.carried.middleRows<3>(3 * region) * state.q + basis.carried_offset.segment<3>(3 * region);
  return motion;
}

Vector3d region_translation(const Subspace& subspace, const Eigen::VectorXd& q, int region) {
  return region_motion(subspace, {q, nullptr}, region).translation;
}

Points region_centres(const Subspace& subspace, const SubspaceState& state) {
  Points centres(subspace->regions->count(), 3);
  for (int i = 0; i < subspace->regions->count(); ++i) {
    centres.row(i) = region_motion(subspace, state, i)(subspace->regions->centre(i)).transpose();
  }
  return centres;
}

Points vertex_displacements(const Subspace& subspace, const SubspaceState& state, const RunContext& context) {
  const ConjugatedBasis& basis = basis_of(subspace, state);
  const bool turned = !basis.rotations.empty();
  const VertexOrbits& orbits = subspace->orbits;
  const OrbitLift& lift = subspace->lift;
  const LiftState now = lift_state(basis, state);

  // Representatives. Sums take about half a microsecond a block, copies a few nanoseconds.
  constexpr std::size_t kMinBlocks = 100;
  constexpr std::size_t kMinCopies = 10000;
  constexpr std::size_t kLanes = OrbitLift::kLanes;
  const std::size_t blocks = lift.first.size() - 1;
  const std::unique_ptr<double[]> sources(new double[4 * kLanes * blocks]);
  parallel_for(
      context, blocks,
      [&](std::size_t begin, std::size_t end) {
        kernels().blocked_sums(lift.first.data(), lift.atom.data(), lift.weight.data(), now.atoms.data(), begin, end,
                               sources.get());
        const std::size_t last = std::min(end * kLanes, orbits.bound.size());
        for (std::size_t r = begin * kLanes; r < last; ++r) {
          const int bound = orbits.bound[r];
          if (bound < 0 && !turned && !state.detail) continue;
          Eigen::Map<Vector3d> source(sources.get() + 4 * r);
          Vector3d u = source;
          if (state.detail) u += state.detail->of_representatives.row(static_cast<Eigen::Index>(r)).transpose();
          if (turned) add_turned_rest(subspace, basis, static_cast<int>(r), u);
          if (bound >= 0) {
            bind(basis.bindings[static_cast<std::size_t>(bound)],
                 orbits.positions.row(static_cast<Eigen::Index>(r)).transpose(), now.carriers, u);
          }
          source = u;
        }
      },
      kMinBlocks);

  // Their images.
  static_assert(sizeof(VertexOrbits::Follower) == 3 * sizeof(int));
  Points displacements(static_cast<Eigen::Index>(orbits.followers.size()), 3);
  parallel_for(
      context, orbits.followers.size(),
      [&](std::size_t begin, std::size_t end) {
        kernels().carried_copies(&orbits.followers.data()->representative, sources.get(), now.copiers.data(), begin,
                                 end, displacements.data());
        if (!turned && orbits.turns.empty()) return;
        for (std::size_t v = begin; v < end; ++v) {
          const VertexOrbits::Follower& follower = orbits.followers[v];
          if (!turned && follower.turn < 0) continue;
          const auto row = static_cast<Eigen::Index>(v);
          displacements.row(row) =
              finished(subspace, basis, static_cast<int>(v), now.carriers, displacements.row(row).transpose())
                  .transpose();
        }
      },
      kMinCopies);
  return displacements;
}

Points vertex_displacements(const Subspace& subspace, const Eigen::VectorXd& q) {
  return vertex_displacements(subspace, SubspaceState{q, nullptr});
}

VertexWay vertex_way(const Subspace& subspace, const ConjugatedBasis& basis, int vertex) {
  const VertexOrbits::Follower& follower = subspace->orbits.followers[static_cast<std::size_t>(vertex)];
  VertexWay way{follower.representative, Matrix3d::Identity(), {}};
  const auto go_on = [&](const Carried& carried, const Matrix3d& frame) {
    way.carried = carried_sum(way.carried, way.along, carried);
    way.along = way.along * frame;
  };
  if (follower.turn >= 0) {
    const auto& [place, motion] = subspace->orbits.turns[static_cast<std::size_t>(follower.turn)];
    const bool floating = subspace->mode != GroupMode::fixed;
    const Transport step = basis.rotations.empty() ? step_transport(*subspace->regions, place, -1, motion, floating)
                                                   : step_transport(*subspace->regions, place, -1, motion, floating,
                                                                    basis.rotations[static_cast<std::size_t>(place)]);
    go_on(step.carried, step.frame);
  }
  const Transport& word = basis.transports.words[static_cast<std::size_t>(follower.word)];
  go_on(word.carried, word.frame);
  const int bound = subspace->orbits.bound[static_cast<std::size_t>(follower.representative)];
  if (bound >= 0) {
    const Binding& binding = basis.bindings[static_cast<std::size_t>(bound)];
    go_on(binding.bound, binding.kept);
  }
  return way;
}

void add_representative_rows(const Subspace& subspace, const ConjugatedBasis& basis, int representative,
                             Eigen::Ref<Eigen::Matrix3Xd> rows) {
  subspace->lift.visit(representative, [&](int atom, double weight) {
    for (int c = 0; c < 3; ++c) {
      for (decltype(basis.atoms)::InnerIterator it(basis.atoms, 3 * Eigen::Index{atom} + c); it; ++it) {
        rows(c, it.col()) += weight * it.value();
      }
    }
  });
}

void add_vertex_rows(const Subspace& subspace, const ConjugatedBasis& basis, int vertex,
                     Eigen::Ref<Eigen::Matrix3Xd> rows) {
  const VertexWay way = vertex_way(subspace, basis, vertex);
  for (const auto& [carrier, matrix] : way.carried) {
    rows.noalias() += matrix * basis.carried.middleRows<3>(3 * carrier);
  }
  Eigen::Matrix3Xd own = Eigen::Matrix3Xd::Zero(3, rows.cols());
  add_representative_rows(subspace, basis, way.representative, own);
  for (Eigen::Index j = 0; j < own.cols(); ++j) {
    if (!own.col(j).isZero(0)) rows.col(j) += way.along * own.col(j);
  }
}

SymmetryAnnotation deformed_annotation(const SymmetryAnnotation& annotation, const Subspace& subspace,
                                       const SubspaceState& state, const Mesh& deformed) {
  SymmetryAnnotation result = annotation;
  result.mesh_diagonal = diagonal(deformed.vertices);
  const ConjugatedBasis& basis = basis_of(subspace, state);
  Eigen::VectorXd carriers = basis.carried * state.q;
  if (carriers.size() > 0) carriers += basis.carried_offset;
  for (std::size_t i = 0; i < result.regions.size(); ++i) {
    Region& region = result.regions[i];
    const Motion motion = region_motion(subspace, state, static_cast<int>(i));
    const auto move = [&](Motion& element) { element = conjugate(motion, element); };
    region.centre = motion(region.centre);
    region.axis = motion.linear * region.axis;
    std::ranges::for_each(region.generators, move);
    std::ranges::for_each(region.elements, move);
    if (!region.elements.empty()) region.elements.front() = Motion{};
  }
  const auto moved = [&](const Carried& shift) {
    Vector3d sum = Vector3d::Zero();
    for (const auto& [carrier, matrix] : shift) {
      if (carriers.size() > 0) sum += matrix * carriers.segment<3>(3 * carrier);
    }
    return sum;
  };
  for (std::size_t i = 0; i < result.patterns.size(); ++i) {
    Pattern& pattern = result.patterns[i];
    const int first = subspace->regions->first_place_of_pattern(static_cast<int>(i));
    for (std::size_t a = 0; a < pattern.instances.size(); ++a) {
      pattern.instances[a].motion = subspace->regions->elements(first)[a];
      pattern.instances[a].motion.translation += moved(subspace->regions->instance_shift(first + static_cast<int>(a)));
    }
    for (std::size_t g = 0; g < pattern.generators.size(); ++g) {
      pattern.generators[g].translation +=
          moved(subspace->regions->generator_shift(static_cast<int>(i), static_cast<int>(g)));
    }
  }
  return result;
}

SymmetryAnnotation deformed_annotation(const SymmetryAnnotation& annotation, const Subspace& subspace,
                                       const Eigen::VectorXd& q, const Mesh& deformed) {
  return deformed_annotation(annotation, subspace, SubspaceState{q, nullptr}, deformed);
}

}  // namespace orbifit
