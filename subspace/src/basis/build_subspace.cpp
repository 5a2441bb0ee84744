#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "orbifit/model/errors.h"
#include "orbifit/subspace/subspace.h"

#include "basis/rest_basis.h"
#include "basis/subspace_parts.h"
#include "sampling/sharp_features.h"
#include "sampling/symmetric_sampler.h"

namespace orbifit {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Where groups make many samples of few degrees of freedom, thin parts need them; searched for from fewer.
constexpr int kMaxDefaultSamples = 2400;
constexpr int kFirstSamples = 1200;
constexpr int kDefaultDegreesOfFreedom = 200;
constexpr int kSearchRounds = 6;

// Vertices nearer to an image than this are the image: as for doublet samples (paper, section 5), but well below the
// edges' length.
double place_tolerance(const Mesh& mesh) {
  const double size = diagonal(mesh.vertices);
  const double edge = std::sqrt(2 * face_areas(mesh).sum() / static_cast<double>(mesh.faces.rows()));
  return std::clamp(0.03 * edge, 1e-6 * size, 1e-4 * size);
}

CarriedTransports transports_of(const SymmetricSampling& sampling, const RegionMap& regions, const GroupWords& words,
                                const std::vector<Matrix3d>& rotations) {
  CarriedTransports result;
  result.words = words.transports(rotations);
  result.samples = sample_transports(sampling, regions, result.words, words.floating(), rotations);
  if (rotations.empty()) return result;
  result.rest_words = words.transports({});
  result.rest_samples = sample_transports(sampling, regions, result.rest_words, words.floating());
  return result;
}

int freedom_of(const SymmetricSampling& sampling, const RegionMap& regions, const GroupWords& words) {
  const int carriers = words.floating() ? regions.carriers() : 0;
  return symmetric_basis(sampling, transports_of(sampling, regions, words, {}), carriers, {}).degrees_of_freedom();
}

SamplingOptions sampling_options(const Mesh& mesh, const SubspaceOptions& options, double radius) {
  SamplingOptions sampling;
  sampling.radius = radius;
  if (options.relative_radii.size() > 0) sampling.radius_field = radius * options.relative_radii;
  if (options.sharp_features_first) sampling.first = sharp_feature_samples(mesh, {radius, 40});
  return sampling;
}

// Samples with the radius asked for, or with one found by a few rounds of secant steps on n ~ r^-2.
SymmetricSampling choose_sampling(const Mesh& mesh, const AnnotatedSurface& surface, GroupWords& words,
                                  const SubspaceOptions& options, const RunContext& context) {
  const RegionMap& regions = surface.regions;
  const SymmetricSampler sampler(mesh, regions, surface.borders);
  if (options.radius > 0) return sampler.sample(words, sampling_options(mesh, options, options.radius), context);
  const double target = options.samples > 0 ? options.samples : kMaxDefaultSamples;
  const double first = options.samples > 0 ? options.samples : kFirstSamples;
  double radius = std::sqrt(face_areas(mesh).sum() / (0.7 * first));
  SymmetricSampling best;
  double best_error = 0;
  for (int round = 0; round < kSearchRounds; ++round) {
    SamplingOptions sampling = sampling_options(mesh, options, radius);
    sampling.most_samples = 20 * static_cast<int>(target) + 4000;
    SymmetricSampling current = sampler.sample(words, sampling, context);
    double excess = static_cast<double>(current.points.rows()) / target;
    if (options.samples == 0) {
      excess = std::max(excess, double(freedom_of(current, regions, words)) / kDefaultDegreesOfFreedom);
    }
    const double error = std::abs(std::log(excess));
    if (round == 0 || error < best_error) {
      best = std::move(current);
      best_error = error;
    }
    if (error < std::log(1.08)) break;
    radius *= std::clamp(std::sqrt(excess), 0.5, 2.0);
  }
  return best;
}

void add_atoms(const SubspaceParts& subspace, ConjugatedBasis& basis, const RunContext& context) {
  constexpr Eigen::Index kAtomsBetweenChecks = 1024;  // a few milliseconds
  const auto count = static_cast<Eigen::Index>(subspace.lift.atoms.size());
  const bool floating = subspace.mode != GroupMode::fixed;
  const Eigen::SparseMatrix<double, Eigen::RowMajor> rows(basis.columns);
  std::vector<Eigen::Triplet<double>> entries;
  basis.atom_offset = Eigen::VectorXd::Zero(3 * count);
  for (Eigen::Index a = 0; a < count; ++a) {
    if (a % kAtomsBetweenChecks == 0) context.check();
    const LiftAtom& atom = subspace.lift.atoms[static_cast<std::size_t>(a)];
    const AtomMap map =
        atom_map(atom, subspace.sampling, *subspace.regions, basis.transports, floating, basis.rotations);
    basis.atom_offset.segment<3>(3 * a) = map.offset;
    if (map.orbit >= 0) {
      const Eigen::Index seed = 3 * Eigen::Index{subspace.sampling.first_sample[static_cast<std::size_t>(map.orbit)]};
      basis.atom_offset.segment<3>(3 * a) += map.frame * basis.offset.segment<3>(seed);
      for (int c = 0; c < 3; ++c) {
        for (decltype(basis.atoms)::InnerIterator it(rows, seed + c); it; ++it) {
          for (int i = 0; i < 3; ++i) {
            const double value = map.frame(i, c) * it.value();
            if (std::abs(value) > 1e-14) entries.emplace_back(3 * a + i, it.col(), value);
          }
        }
      }
    }
    for (const auto& [carrier, matrix] : map.carried) {
      if (basis.carried.rows() == 0) break;
      basis.atom_offset.segment<3>(3 * a) += matrix * basis.carried_offset.segment<3>(3 * carrier);
      const Eigen::MatrixXd block = matrix * basis.carried.middleRows<3>(3 * carrier);
      for (Eigen::Index j = 0; j < block.cols(); ++j) {
        for (int i = 0; i < 3; ++i) {
          if (std::abs(block(i, j)) > 1e-14) entries.emplace_back(3 * a + i, j, block(i, j));
        }
      }
    }
    if (basis.rotations.empty()) continue;
    Matrix3d rotation = Matrix3d::Identity();
    const int set = atom.sample >= 0 ? subspace.sampling.sets[static_cast<std::size_t>(atom.sample)] : -1;
    const int region = atom.sample >= 0 ? innermost_region(*subspace.regions, set) : atom.place;
    if (region >= 0) rotation = basis.rotations[static_cast<std::size_t>(region)];
    const auto word = static_cast<std::size_t>(atom.word);
    basis.atom_positions.push_back(map.position);
    basis.atom_rotations.push_back(basis.transports.words[word].frame.transpose() * rotation *
                                   basis.transports.rest_words[word].frame);
  }
  basis.atoms.resize(3 * count, basis.columns.cols());
  basis.atoms.setFromTriplets(entries.begin(), entries.end());
}

void add_transports(const SubspaceParts& subspace, const std::vector<Matrix3d>& rotations, ConjugatedBasis& basis) {
  basis.rotations = rotations;
  basis.transports = transports_of(subspace.sampling, *subspace.regions, *subspace.words, rotations);
  for (const BoundPoint& bound : subspace.orbits.bindings) {
    basis.bindings.push_back(binding_of(bound.words, basis.transports));
  }
}

ConjugatedBasis basis_without_atoms(const SubspaceParts& subspace, const std::vector<Matrix3d>& rotations) {
  ConjugatedBasis basis;
  add_transports(subspace, rotations, basis);
  const int carriers = subspace.mode == GroupMode::fixed ? 0 : subspace.regions->carriers();
  static_cast<SymmetricBasis&>(basis) =
      symmetric_basis(subspace.sampling, basis.transports, carriers, subspace.orbits.bindings);
  return basis;
}

}  // namespace

void SubspaceOptions::validate() const {
  require(radius >= 0 && std::isfinite(radius), "radius", radius, "positive, or 0 to have it chosen");
  require(samples == 0 || samples >= 4, "samples", samples, "at least 4, or 0 to have it chosen");
  if (relative_radii.size() > 0 && !(relative_radii.minCoeff() > 0 && relative_radii.allFinite())) {
    throw UsageError("relative_radii holds " + std::to_string(relative_radii.minCoeff()) + "; all must be positive");
  }
}

bool keeps_freedom(const Subspace& subspace, const std::vector<Matrix3d>& rotations, double tolerance) {
  const ConjugatedBasis basis = basis_without_atoms(*subspace, rotations);
  if (!(basis.conflict <= tolerance) || basis.columns.cols() < subspace->basis.columns.cols()) return false;
  for (std::size_t i = 0; i < basis.bindings.size(); ++i) {
    if (basis.bindings[i].kept.trace() < subspace->basis.bindings[i].kept.trace() - 0.5) return false;
  }
  return true;
}

ConjugatedBasis conjugated_basis(const Subspace& subspace, const std::vector<Matrix3d>& rotations) {
  ConjugatedBasis basis = basis_without_atoms(*subspace, rotations);
  add_atoms(*subspace, basis, RunContext{});
  return basis;
}

void complete_rest_basis(SubspaceParts& subspace) {
  add_transports(subspace, {}, subspace.basis);
  add_atoms(subspace, subspace.basis, RunContext{});
}

namespace {

// \param known  of another subspace of the same; null: none
Subspace built(const Mesh& mesh, const SymmetryAnnotation& annotation, const SubspaceOptions& options,
               std::shared_ptr<AnnotatedSurface> known, const RunContext& context) {
  options.validate();
  if (!(face_areas(mesh).sum() > 0)) throw InputError("", "mesh", "its faces have no area");
  if (options.relative_radii.size() > 0 && options.relative_radii.size() != mesh.vertices.rows()) {
    throw UsageError("relative_radii has " + std::to_string(options.relative_radii.size()) +
                     " entries; it must have one for each of the " + std::to_string(mesh.vertices.rows()) +
                     " vertices");
  }
  const auto parts = std::make_shared<SubspaceParts>();
  SubspaceParts& subspace = *parts;
  subspace.mode = options.mode;
  subspace.lift_kind = options.lift;
  subspace.diagonal = diagonal(mesh.vertices);
  subspace.surface = known ? std::move(known) : std::make_shared<AnnotatedSurface>(mesh, annotation, context);
  subspace.regions = std::shared_ptr<const RegionMap>(subspace.surface, &subspace.surface->regions);
  const auto words = std::make_shared<GroupWords>(*subspace.regions, options.mode != GroupMode::fixed);
  subspace.words = words;
  subspace.sampling = choose_sampling(mesh, *subspace.surface, *words, options, context);
  const bool averaged = options.lift == LiftKind::orbit;
  subspace.orbits = averaged ? vertex_orbits(mesh, *subspace.regions, *words, place_tolerance(mesh),
                                             subspace.surface->vertex_sets, context)
                             : lone_vertices(mesh);
  if (options.mode == GroupMode::moving)
    subspace.orbits.offsets = follower_offsets(mesh, *subspace.regions, subspace.orbits, *words);
  subspace.basis = basis_without_atoms(subspace, {});
  subspace.lift =
      orbit_lift(subspace.sampling, *subspace.regions, *words, subspace.basis, subspace.orbits, averaged, context);
  add_atoms(subspace, subspace.basis, context);
  context.progress("lift", 1);
  return Subspace(parts);
}

}  // namespace

Subspace build_subspace(const Mesh& mesh, const SymmetryAnnotation& annotation, const SubspaceOptions& options,
                        const RunContext& context) {
  return built(mesh, annotation, options, nullptr, context);
}

Subspace rebuilt_subspace(const Subspace& other, const Mesh& mesh, const SymmetryAnnotation& annotation,
                          const SubspaceOptions& options, const RunContext& context) {
  return built(mesh, annotation, options, other->surface, context);
}

}  // namespace orbifit
