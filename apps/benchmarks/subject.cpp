#include "subject.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "orbifit/datasets_tools/symmetry_residual.h"
#include "orbifit/subspace/displacement_field.h"

#include "basis/lift.h"
#include "basis/subspace_parts.h"
#include "geometry/point_index.h"

namespace orbifit::benchmarks {

namespace {

constexpr double kWithin = 0.05;  // of the number of samples asked for: the search may stop
constexpr int kSearchRounds = 40;

SubspaceOptions options_of(double radius, GroupMode mode) {
  SubspaceOptions options;
  options.mode = mode;
  options.radius = radius;
  return options;
}

}  // namespace

double radius_for_samples(const BenchmarkModel& model, int samples, GroupMode mode, const RunContext& context) {
  const RegionMap regions(model.mesh, model.annotation, context);
  GroupWords words(regions, mode != GroupMode::fixed);
  SamplingOptions sampling;
  double best = 0;
  double best_error = HUGE_VAL;
  double radius = std::sqrt(face_areas(model.mesh).sum() / (0.7 * samples));
  // Secant steps on samples ~ radius^-2 come near; orbits make the count jump there, so radii close by are tried too.
  for (int round = 0; round < kSearchRounds && best_error > std::log1p(kWithin); ++round) {
    sampling.radius = round < 8 ? radius : best * (1 + 0.004 * (round - 7) * (round % 2 == 0 ? 1 : -1));
    const auto count =
        static_cast<double>(sample_symmetrically(model.mesh, regions, words, sampling, context).points.rows());
    const double error = std::abs(std::log(count / samples));
    if (error < best_error) {
      best = sampling.radius;
      best_error = error;
    }
    radius *= std::sqrt(count / samples);
  }
  return best;
}

HandleRows handle_rows(const BenchmarkModel& model, const Subspace& subspace, const RunContext& context) {
  const PointIndex index(subspace->sampling.points);
  std::vector<int> vertices;
  std::vector<double> weights;
  std::vector<Eigen::Vector3d> targets;
  for (const Handle& handle : model.handles) {
    std::vector<char> near(static_cast<std::size_t>(subspace->sampling.points.rows()), 0);
    for (const int vertex : handle.vertices) {
      const Eigen::Vector3d rest = model.mesh.vertices.row(vertex);
      for (const auto& sample : index.within(rest, subspace->sampling.radius)) {
        near[static_cast<std::size_t>(sample.index)] = 1;
      }
      vertices.push_back(vertex);
      targets.emplace_back(handle.motion(rest) - rest);
    }
    const double total = std::max(3.0, static_cast<double>(std::ranges::count(near, 1)));
    weights.insert(weights.end(), handle.vertices.size(), total / static_cast<double>(handle.vertices.size()));
  }
  HandleRows result;
  const Points points = model.mesh.vertices(vertices, Eigen::all);
  result.rows = lift_weights(points, subspace->sampling.points, subspace->sampling.radius, context);
  result.weights = Eigen::Map<const Eigen::VectorXd>(weights.data(), static_cast<Eigen::Index>(weights.size()));
  result.targets.resize(points.rows(), 3);
  for (std::size_t i = 0; i < targets.size(); ++i) result.targets.row(static_cast<Eigen::Index>(i)) = targets[i];
  return result;
}

SoftSampling soft_sampling(const Subspace& subspace) {
  const SymmetricSampling& sampling = subspace->sampling;
  SoftSampling result{sampling.points, sampling.radius, {}, static_cast<int>(subspace->basis.carried.rows() / 3)};
  for (int orbit = 0; orbit < sampling.orbits(); ++orbit) {
    const int seed = sampling.first_sample[static_cast<std::size_t>(orbit)];
    for (int s = seed + 1; s < sampling.first_sample[static_cast<std::size_t>(orbit) + 1]; ++s) {
      const Transport& transport = subspace->basis.transports.samples[static_cast<std::size_t>(s)];
      result.pairs.push_back({s, seed, transport.frame, transport.carried});
    }
  }
  for (const SymmetricSampling::Constraint& constraint : sampling.constraints) {
    const int seed = sampling.first_sample[static_cast<std::size_t>(constraint.orbit)];
    const Transport& left = subspace->basis.transports.words[static_cast<std::size_t>(constraint.left)];
    const Transport& right = subspace->basis.transports.words[static_cast<std::size_t>(constraint.right)];
    SymmetryPair pair{-1, seed, left.frame - right.frame,
                      carried_sum(left.carried, -Eigen::Matrix3d::Identity(), right.carried)};
    result.pairs.push_back(std::move(pair));
  }
  return result;
}

Subject::Subject(const BenchmarkModel& model, double radius, GroupMode mode, const RunContext& context)
    : model_(model),
      context_(context),
      subspace_(build_subspace(model.mesh, model.annotation, options_of(radius, mode), context)) {
  for (const Handle& handle : model.handles) motions_.push_back(handle.motion);
}

void Subject::start_editing() {
  deformer_ = std::make_unique<Deformer>(subspace_, model_.mesh);
}

void Subject::prefactor() {
  deformer_->set_handles(model_.handles, kAlpha);
}

void Subject::solve5() {
  deformation_ = deformer_->solve(motions_, kIterations);
}

void Subject::lift() {
  displacements_ = vertex_displacements(subspace_, deformation_.state, context_);
}

Subject::Traffic Subject::lift_traffic() const {
  const OrbitLift& lift = subspace_->lift;
  const std::size_t vertices = subspace_->orbits.followers.size();
  // Representatives are summed up in whole blocks, then copied to their images: written and read once each.
  const std::size_t sources = 4 * OrbitLift::kLanes * (lift.first.size() - 1) * sizeof(double);
  return {lift.bytes() + lift.first.size() * sizeof(lift.first[0]) +
              subspace_->orbits.bound.size() * sizeof(subspace_->orbits.bound[0]) + sources +
              vertices * sizeof(VertexOrbits::Follower),
          sources + 3 * vertices * sizeof(double)};
}

double Subject::field_residual() const {
  double worst = 0;
  for (std::size_t i = 0; i < model_.annotation.regions.size(); ++i) {
    const Residual residual = orbifit::field_residual(subspace_, model_.mesh, model_.annotation.regions[i],
                                                      static_cast<int>(i), deformation_.state, context_);
    worst = std::max(worst, residual.max);
  }
  return worst;
}

double Subject::mesh_residual() const {
  Mesh deformed = model_.mesh;
  deformed.vertices += vertex_displacements(subspace_, deformation_.state, context_);
  RunContext context = context_;
  const auto motions = subspace_->mode == GroupMode::fixed ? CarriedMotions::fixed : CarriedMotions::floating;
  return symmetry_residual(model_.mesh, model_.annotation, &deformed, motions, context).worst_excess;
}

double Subject::handle_error() const {
  return deformation_.handle_error / diagonal(model_.mesh.vertices);
}

}  // namespace orbifit::benchmarks
