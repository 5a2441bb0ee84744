#include "orbifit/subspace/subspace.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "orbifit/model/errors.h"

namespace orbifit {

namespace {

constexpr int kDefaultSamples = 600;
constexpr int kDefaultDegreesOfFreedom = 200;
constexpr double kVertexOntoVertex = 1e-6;  // of the diagonal
constexpr int kSearchRounds = 6;
constexpr Eigen::Index kMostResidualPairs = 20000;

// Samples with the radius asked for, or with one found by a few rounds of secant steps on n ~ r^-2.
SymmetricSampling choose_sampling(const Mesh& mesh, const RegionMap& regions, const SubspaceOptions& options,
                                  const RunContext& context) {
  SamplingOptions sampling;
  sampling.floating = options.mode == GroupMode::floating;
  if (options.radius > 0) {
    sampling.radius = options.radius;
    return sample_symmetrically(mesh, regions, sampling, context);
  }
  const double target = options.samples > 0 ? options.samples : kDefaultSamples;
  sampling.radius = std::sqrt(face_areas(mesh).sum() / (0.7 * target));
  sampling.most_samples = 20 * static_cast<int>(target) + 2000;
  SymmetricSampling best;
  double best_error = 0;
  for (int round = 0; round < kSearchRounds; ++round) {
    SymmetricSampling current = sample_symmetrically(mesh, regions, sampling, context);
    double excess = static_cast<double>(current.points.rows()) / target;
    if (options.samples == 0) {
      const int dof = symmetric_basis(current, regions.count(), sampling.floating).degrees_of_freedom();
      excess = std::max(excess, double(dof) / kDefaultDegreesOfFreedom);
    }
    const double error = std::abs(std::log(excess));
    if (round == 0 || error < best_error) {
      best = std::move(current);
      best_error = error;
    }
    if (error < std::log(1.08)) break;
    sampling.radius *= std::sqrt(excess);
  }
  return best;
}

}  // namespace

std::string to_string(GroupMode mode) {
  return mode == GroupMode::fixed ? "fixed" : "floating";
}

void SubspaceOptions::validate() const {
  if (!(radius >= 0) || !std::isfinite(radius)) {
    throw UsageError("radius is " + std::to_string(radius) + "; it must be positive, or 0 to have it chosen");
  }
  if (samples != 0 && samples < 4) {
    throw UsageError("samples is " + std::to_string(samples) + "; it must be at least 4, or 0 to have it chosen");
  }
}

Subspace build_subspace(const Mesh& mesh, const SymmetryAnnotation& annotation, const SubspaceOptions& options,
                        const RunContext& context) {
  options.validate();
  if (!(face_areas(mesh).sum() > 0)) throw InputError("", "mesh", "its faces have no area");
  Subspace subspace;
  subspace.mode = options.mode;
  subspace.regions = std::make_shared<RegionMap>(mesh, annotation, context);
  subspace.sampling = choose_sampling(mesh, *subspace.regions, options, context);
  subspace.basis = symmetric_basis(subspace.sampling, subspace.regions->count(), options.mode == GroupMode::floating);
  context.progress("lift", 0);
  subspace.lift = lift_weights(mesh.vertices, subspace.sampling.points, subspace.sampling.radius, context);
  subspace.orbits = vertex_orbits(mesh, *subspace.regions, kVertexOntoVertex * diagonal(mesh.vertices));
  context.progress("lift", 1);
  return subspace;
}

Points sample_displacements(const Subspace& subspace, const Eigen::VectorXd& q) {
  const Eigen::VectorXd stacked = subspace.basis.columns * q;
  return Eigen::Map<const Points>(stacked.data(), stacked.size() / 3, 3);
}

Eigen::Vector3d carried_translation(const Subspace& subspace, const Eigen::VectorXd& q, int region) {
  if (subspace.basis.carried.rows() == 0) return Eigen::Vector3d::Zero();
  return subspace.basis.carried.middleRows<3>(3 * region) * q;
}

Points vertex_displacements(const Subspace& subspace, const Eigen::VectorXd& q) {
  Points displacements = subspace.lift * sample_displacements(subspace, q);
  if (subspace.orbits.region >= 0) {
    symmetrise(subspace.orbits, *subspace.regions, carried_translation(subspace, q, subspace.orbits.region),
               displacements);
  }
  return displacements;
}

Points displacement_field(const Subspace& subspace, const Eigen::VectorXd& q, const Points& points,
                          const RunContext& context) {
  return lift_weights(points, subspace.sampling.points, subspace.sampling.radius, context) *
         sample_displacements(subspace, q);
}

SymmetryAnnotation carried_annotation(const SymmetryAnnotation& annotation, const Subspace& subspace,
                                      const Eigen::VectorXd& q, const Mesh& deformed) {
  SymmetryAnnotation result = annotation;
  result.mesh_diagonal = diagonal(deformed.vertices);
  for (std::size_t i = 0; i < result.regions.size(); ++i) {
    Region& region = result.regions[i];
    const Motion shift{Eigen::Matrix3d::Identity(), carried_translation(subspace, q, static_cast<int>(i))};
    const auto move = [&](Motion& motion) { motion = conjugate(shift, motion); };
    region.centre = shift(region.centre);
    std::ranges::for_each(region.generators, move);
    std::ranges::for_each(region.elements, move);
  }
  return result;
}

Residual field_residual(const Subspace& subspace, const Mesh& mesh, const Region& region, int region_number,
                        const Eigen::VectorXd& q, const RunContext& context) {
  Mesh part = submesh(mesh, region.faces);
  const auto order = static_cast<Eigen::Index>(subspace.regions->elements(region_number).size());
  const Eigen::Index step = 1 + part.vertices.rows() * order / kMostResidualPairs;
  part.vertices = Points(part.vertices(Eigen::seq(0, Eigen::last, step), Eigen::all));
  const Eigen::Vector3d t = carried_translation(subspace, q, region_number);
  const Points here = displacement_field(subspace, q, part.vertices, context);
  Residual residual;
  double squares = 0;
  double count = 0;
  for (const Motion& element : subspace.regions->elements(region_number)) {
    const Points images = (part.vertices * element.linear.transpose()).rowwise() + element.translation.transpose();
    const Points there = displacement_field(subspace, q, images, context);
    const Points expected = ((here.rowwise() - t.transpose()) * element.linear.transpose()).rowwise() + t.transpose();
    const Eigen::VectorXd errors = (there - expected).rowwise().norm() / diagonal(mesh.vertices);
    if (errors.size() > 0) residual.max = std::max(residual.max, errors.maxCoeff());
    squares += errors.squaredNorm();
    count += static_cast<double>(errors.size());
  }
  if (count > 0) residual.rms = std::sqrt(squares / count);
  return residual;
}

}  // namespace orbifit
