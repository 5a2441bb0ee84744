#include "orbifit/subspace/subspace.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "lift_kernel.h"
#include "orbifit/model/errors.h"
#include "orbifit/subspace/carried_regions.h"

namespace orbifit {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Displacement of a point when its word goes from rest to now, the displacement where the word starts being u.
Vector3d carried_by(const Transport& now, const Transport* rest, const Vector3d& start, const Vector3d& u,
                    const Eigen::VectorXd& carriers) {
  Vector3d result = now.frame * u;
  for (const auto& [carrier, matrix] : now.carried) result += matrix * carriers.segment<3>(3 * carrier);
  if (rest != nullptr) result += (now.frame - rest->frame) * start + now.shift - rest->shift;
  return result;
}

void bind(const Binding& binding, const Vector3d& position, const Eigen::VectorXd& carriers, Eigen::Ref<Vector3d> u) {
  Vector3d bound = binding.kept * u + binding.slope * position + binding.offset;
  for (const auto& [carrier, matrix] : binding.bound) bound += matrix * carriers.segment<3>(3 * carrier);
  u = bound;
}

// A word's transport with the carriers put in: u -> frame u + slope x + shift.
struct Copier {
  Matrix3d frame, slope;
  Vector3d shift;
};

Copier copier_of(const Transport& now, const Transport* rest, const Eigen::VectorXd& carriers) {
  Copier copier{now.frame, Matrix3d::Zero(), Vector3d::Zero()};
  copier.shift = carried_by(now, rest, Vector3d::Zero(), Vector3d::Zero(), carriers);
  if (rest != nullptr) copier.slope = now.frame - rest->frame;
  return copier;
}

// The part of the lift that turns with the regions (method notes 2.2): (R - 1) (p - sum of w x), R blended.
void add_turned_rest(const Subspace& subspace, const CarriedBasis& basis, Eigen::Index representative,
                     Eigen::Ref<Vector3d> u) {
  const auto r = static_cast<std::size_t>(representative);
  Matrix3d blend = Matrix3d::Zero();
  for (std::int64_t e = subspace.lift.first[r]; e < subspace.lift.first[r + 1]; ++e) {
    const auto entry = static_cast<std::size_t>(e);
    blend += double{subspace.lift.weight[entry]} * basis.atom_rotations[subspace.lift.atom[entry]];
  }
  const Vector3d rest = subspace.lift.rest.row(representative).transpose();
  u += blended_rotation(blend) * rest - rest;
}

}  // namespace

std::string to_string(GroupMode mode) {
  return mode == GroupMode::fixed ? "fixed" : mode == GroupMode::floating ? "floating" : "moving";
}

std::string to_string(LiftKind kind) {
  return kind == LiftKind::paper ? "paper" : "orbit";
}

const CarriedBasis& basis_of(const Subspace& subspace, const SubspaceState& state) {
  return state.basis ? *state.basis : subspace.basis;
}

Points sample_displacements(const Subspace& subspace, const SubspaceState& state) {
  const CarriedBasis& basis = basis_of(subspace, state);
  Eigen::VectorXd stacked = basis.columns * state.q;
  if (!basis.rotations.empty()) stacked += basis.offset;
  return Eigen::Map<const Points>(stacked.data(), stacked.size() / 3, 3);
}

Points sample_displacements(const Subspace& subspace, const Eigen::VectorXd& q) {
  return sample_displacements(subspace, SubspaceState{q, nullptr});
}

Motion carried_motion(const Subspace& subspace, const SubspaceState& state, int region) {
  const CarriedBasis& basis = basis_of(subspace, state);
  if (basis.carried.rows() == 0) return {};
  Motion motion;
  const Vector3d& centre = subspace.regions->centre(region);
  if (!basis.rotations.empty()) {
    motion = Motion::about(basis.rotations[static_cast<std::size_t>(region)], centre);
  }
  motion.translation +=
      basis.carried.middleRows<3>(3 * region) * state.q + basis.carried_offset.segment<3>(3 * region);
  return motion;
}

Vector3d carried_translation(const Subspace& subspace, const Eigen::VectorXd& q, int region) {
  return carried_motion(subspace, {q, nullptr}, region).translation;
}

Points vertex_displacements(const Subspace& subspace, const SubspaceState& state, const RunContext& context) {
  const CarriedBasis& basis = basis_of(subspace, state);
  const bool turned = !basis.rotations.empty();
  const VertexOrbits& orbits = subspace.orbits;
  Eigen::VectorXd atoms = basis.atoms * state.q;
  Eigen::VectorXd carriers = basis.carried * state.q;
  if (turned) {
    atoms += basis.atom_offset;
    carriers += basis.carried_offset;
  }
  const std::vector<double> padded = padded_by_four(atoms);

  // Representatives.
  const auto representatives = static_cast<std::size_t>(orbits.representatives());
  Points sources(static_cast<Eigen::Index>(representatives), 3);
  parallel_for(context, representatives, [&](std::size_t begin, std::size_t end) {
    weighted_sums(subspace.lift, padded, begin, end, sources.data());
    for (std::size_t r = begin; r < end; ++r) {
      const int bound = orbits.bound[r];
      if (bound < 0 && !turned) continue;
      const auto row = static_cast<Eigen::Index>(r);
      Vector3d u = sources.row(row).transpose();
      if (turned) add_turned_rest(subspace, basis, row, u);
      if (bound >= 0) {
        bind(basis.bindings[static_cast<std::size_t>(bound)], orbits.positions.row(row).transpose(), carriers, u);
      }
      sources.row(row) = u.transpose();
    }
  });

  // Their images.
  const std::vector<Transport>& words = basis.transports.words;
  std::vector<Copier> copiers;
  copiers.reserve(words.size());
  for (std::size_t w = 0; w < words.size(); ++w) {
    copiers.push_back(copier_of(words[w], turned ? &basis.transports.rest_words[w] : nullptr, carriers));
  }
  Points displacements(static_cast<Eigen::Index>(orbits.followers.size()), 3);
  parallel_for(context, orbits.followers.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      const VertexOrbits::Follower& follower = orbits.followers[v];
      const double* source = sources.data() + 3 * static_cast<std::ptrdiff_t>(follower.representative);
      double* target = displacements.data() + 3 * static_cast<std::ptrdiff_t>(v);
      if (follower.word == 0 && follower.turn < 0) {
        std::copy(source, source + 3, target);
        continue;
      }
      const Copier& copier = copiers[static_cast<std::size_t>(follower.word)];
      Vector3d u = copier.frame * Eigen::Map<const Vector3d>(source) + copier.shift;
      if (turned) u += copier.slope * orbits.positions.row(follower.representative).transpose();
      if (follower.turn >= 0) {
        const auto& [place, motion] = orbits.turns[static_cast<std::size_t>(follower.turn)];
        const bool floating = subspace.mode != GroupMode::fixed;
        const Matrix3d rotation =
            turned ? basis.rotations[static_cast<std::size_t>(place)] : Matrix3d(Matrix3d::Identity());
        const Transport now = step_transport(*subspace.regions, place, -1, motion, floating, rotation);
        const Transport rest = step_transport(*subspace.regions, place, -1, motion, floating);
        const Vector3d canonical = subspace.words->motion(follower.word)(
            Vector3d(orbits.positions.row(follower.representative).transpose()));
        u = carried_by(now, turned ? &rest : nullptr, canonical, u, carriers);
      }
      std::copy(u.data(), u.data() + 3, target);
    }
  });
  return displacements;
}

Points vertex_displacements(const Subspace& subspace, const Eigen::VectorXd& q) {
  return vertex_displacements(subspace, SubspaceState{q, nullptr});
}

void add_vertex_row(const Subspace& subspace, int vertex, const Vector3d& direction,
                    Eigen::Ref<Eigen::RowVectorXd> row) {
  const CarriedBasis& basis = subspace.basis;
  const VertexOrbits::Follower& follower = subspace.orbits.followers[static_cast<std::size_t>(vertex)];
  Vector3d along = direction;
  const auto add_carried = [&](const Carried& carried) {
    for (const auto& [carrier, matrix] : carried) {
      row += along.transpose() * matrix * basis.carried.middleRows<3>(3 * carrier);
    }
  };
  if (follower.turn >= 0) {
    const auto& [place, motion] = subspace.orbits.turns[static_cast<std::size_t>(follower.turn)];
    const Transport step =
        step_transport(*subspace.regions, place, -1, motion, subspace.mode != GroupMode::fixed);
    add_carried(step.carried);
    along = step.frame.transpose() * along;
  }
  const Transport& word = basis.transports.words[static_cast<std::size_t>(follower.word)];
  add_carried(word.carried);
  along = word.frame.transpose() * along;
  const auto r = static_cast<std::size_t>(follower.representative);
  if (subspace.orbits.bound[r] >= 0) {
    const Binding& binding = basis.bindings[static_cast<std::size_t>(subspace.orbits.bound[r])];
    add_carried(binding.bound);
    along = binding.kept.transpose() * along;
  }
  for (std::int64_t e = subspace.lift.first[r]; e < subspace.lift.first[r + 1]; ++e) {
    const auto entry = static_cast<std::size_t>(e);
    for (int c = 0; c < 3; ++c) {
      const double factor = double{subspace.lift.weight[entry]} * along[c];
      for (decltype(basis.atoms)::InnerIterator it(basis.atoms, 3 * Eigen::Index{subspace.lift.atom[entry]} + c); it;
           ++it) {
        row[it.col()] += factor * it.value();
      }
    }
  }
}

SymmetryAnnotation carried_annotation(const SymmetryAnnotation& annotation, const Subspace& subspace,
                                      const SubspaceState& state, const Mesh& deformed) {
  SymmetryAnnotation result = annotation;
  result.mesh_diagonal = diagonal(deformed.vertices);
  const CarriedBasis& basis = basis_of(subspace, state);
  Eigen::VectorXd carriers = basis.carried * state.q;
  if (carriers.size() > 0) carriers += basis.carried_offset;
  for (std::size_t i = 0; i < result.regions.size(); ++i) {
    Region& region = result.regions[i];
    const Motion motion = carried_motion(subspace, state, static_cast<int>(i));
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
    const int first = subspace.regions->first_place_of_pattern(static_cast<int>(i));
    for (std::size_t a = 0; a < pattern.instances.size(); ++a) {
      pattern.instances[a].motion = subspace.regions->elements(first)[a];
      pattern.instances[a].motion.translation += moved(subspace.regions->instance_shift(first + static_cast<int>(a)));
    }
    for (std::size_t g = 0; g < pattern.generators.size(); ++g) {
      pattern.generators[g].translation += moved(subspace.regions->generator_shift(static_cast<int>(i), static_cast<int>(g)));
    }
  }
  return result;
}

SymmetryAnnotation carried_annotation(const SymmetryAnnotation& annotation, const Subspace& subspace,
                                      const Eigen::VectorXd& q, const Mesh& deformed) {
  return carried_annotation(annotation, subspace, SubspaceState{q, nullptr}, deformed);
}

}  // namespace orbifit
