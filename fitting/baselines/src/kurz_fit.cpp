#include "kurz_fit.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "kurz_ceres.h"
#include "registration/alignment.h"
#include "solver/outward_faces.h"
#include "solver/pulls.h"
#include "symmetry/lattice.h"
#include "thin_plate.h"

namespace orbifit {

namespace {

constexpr double kHold = 1e-6;  // weight by which what nothing determines stays where it is
constexpr double kUnlimited = 1e9;

}  // namespace

KurzFit::KurzFit(const FitInput& input, const UnitInput& unit, const KurzOptions& options, const RunContext& context)
    : input_(input),
      unit_(unit),
      options_(options),
      context_(context),
      size_(diagonal(unit.mesh.vertices)),
      demands_(symmetry_demands(unit.mesh, unit.annotation, options.quadrature_points,
                                options.symmetry_weight > 0 ? options.mode : GroupMode::fixed, context)),
      signed_normals_(options.signed_normals && unit.scan.normals_oriented &&
                      faces_outwards(unit.mesh, MovingSurface(unit.mesh), context)),
      deformed_(unit.mesh),
      surface_(deformed_) {
  if (options.symmetry_weight == 0) demands_.demands.clear();
  state_.carriers = Points::Zero(demands_.carriers, 3);
  state_.rotations.assign(unit.annotation.regions.size(), Eigen::Matrix3d::Identity());
}

void KurzFit::begin(GridBasis basis) {
  const Grid grid = grid_around(unit_.mesh.vertices, options_.spacing, basis);
  terms_ = kurz_terms(grid, demands_);
  terms_.symmetry_weight = options_.symmetry_weight * options_.scan_points;
  terms_.hold = kHold;
  terms_.pulls = pull_term();
  state_.nodes = Points::Zero(grid.node_count(), 3);
  plate_ = thin_plate(grid);
  vertex_values_ = basis_values(grid, unit_.mesh.vertices);
}

// From stiff to soft by equal factors.
double KurzFit::thin_plate_at(int iteration) const {
  const bool stiff =
      terms_.grid.basis == GridBasis::linear && !handles_alone() && iteration < options_.stiff_iterations;
  if (!stiff) return options_.thin_plate_weight;
  const double left = 1 - double(iteration) / options_.stiff_iterations;
  return options_.thin_plate_weight * std::pow(options_.first_thin_plate / options_.thin_plate_weight, left);
}

void KurzFit::run(GridBasis basis, int most) {
  const auto start = std::chrono::steady_clock::now();
  begin(basis);
  KurzNormal normal(terms_, plate_);
  const std::chrono::duration<double> begun = std::chrono::steady_clock::now() - start;
  if (basis == GridBasis::linear) stopped_because_ = "the iterations allowed are used up";
  for (int i = 0; i < most; ++i) {
    context_.progress("fit", double(i) / most);
    terms_.thin_plate = thin_plate_at(i);
    iterate(normal, i == 0);
    if (i == 0) iterations_.back().seconds += begun.count();
    if (terms_.thin_plate == options_.thin_plate_weight && iterations_.back().change < options_.still / size_) {
      stopped_because_ =
          "converged: no vertex moves by more than " + std::to_string(options_.still) + " of the longest side";
      break;
    }
  }
  if (options_.condition && options_.solver == KurzSolver::normal_equations) condition_ = normal.condition();
}

PullTerm KurzFit::pull_term() const {
  const auto pulls = pulls_towards(input_, unit_.pose * unit_.unit, options_.handle_weight);
  PullTerm term;
  Points places(static_cast<Eigen::Index>(pulls.size()), 3);
  term.offsets.resize(places.rows(), 3);
  term.weights.resize(places.rows());
  for (Eigen::Index i = 0; i < places.rows(); ++i) {
    const Pull& pull = pulls[static_cast<std::size_t>(i)];
    places.row(i) = unit_.mesh.vertices.row(pull.vertex);
    term.offsets.row(i) = unit_.unit(pull.target).transpose() - places.row(i);
    term.weights[i] = pull.weight;
  }
  term.values = basis_values(terms_.grid, places);
  return term;
}

std::vector<Correspondence> KurzFit::match() {
  if (handles_alone()) return {};
  CorrespondenceOptions options;
  options.max_distance = kUnlimited;
  options.min_normal_cosine = options_.min_normal_cosine;
  options.signed_normals = signed_normals_;
  options.trim = options_.trim;
  options.never_trim = options_.never_trim;
  options.direction_noise = kDirectionNoise;
  options.robust_scale = kUnlimited;
  return find_correspondences(surface_, unit_.points, unit_.normals, options, context_, &likely_);
}

DataTerm KurzFit::data_term(const std::vector<Correspondence>& pairs) const {
  const auto count = static_cast<Eigen::Index>(pairs.size());
  DataTerm term;
  Points places(count, 3);
  term.offsets.resize(count, 3);
  term.normals.resize(count, 3);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Correspondence& pair = pairs[static_cast<std::size_t>(i)];
    const auto corners = unit_.mesh.faces.row(pair.face);
    places.row(i) = pair.barycentric.transpose() * unit_.mesh.vertices(corners, Eigen::all);
    term.offsets.row(i) = unit_.points.row(pair.scan_point) - places.row(i);
    term.normals.row(i) = pair.normal.transpose();
  }
  const double points = std::max(1.0, static_cast<double>(unit_.points.rows()));
  term.weights.setConstant(count, options_.data_weight * options_.scan_points / points);
  term.values = basis_values(terms_.grid, places);
  return term;
}

void KurzFit::iterate(KurzNormal& normal, bool first) {
  const auto start = std::chrono::steady_clock::now();
  const std::vector<Correspondence> pairs = match();
  const DataTerm data = data_term(pairs);
  FitIteration record;
  record.stiffness = terms_.thin_plate;
  record.correspondences = static_cast<int>(pairs.size());
  record.rms = weighted_rms(pairs) / size_;
  const KurzState before = state_;
  if (options_.solver == KurzSolver::ceres) {
    solve_with_ceres(terms_, data, state_);
  } else {
    normal.solve(data, state_);
  }
  // A stage has no coefficients before its first step, and being linear needs none.
  const KurzEnergy energy = kurz_energy(terms_, plate_, data, first ? state_ : before);
  record.energy = energy.sum() / (options_.scan_points * size_ * size_);
  if (options_.mode == GroupMode::moving) turn_symmetries(terms_, state_);
  const Points places = unit_.mesh.vertices + vertex_values_ * state_.nodes;
  record.change = (places - deformed_.vertices).rowwise().norm().maxCoeff() / size_;
  deformed_.vertices = places;
  if (!handles_alone()) surface_.move(deformed_, context_);
  record.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  iterations_.push_back(record);
}

void KurzFit::carry_pattern(std::size_t number, Pattern& pattern) const {
  const int first = demands_.first_carrier_of_pattern[number];
  if (first < 0) return;
  const Lattice lattice = lattice_of(unit_.mesh, pattern);
  for (std::size_t i = 0; i < pattern.instances.size(); ++i) {
    Motion& motion = pattern.instances[i].motion;
    motion = lattice.motions[i];
    for (const auto& [variable, matrix] : lattice.shifts[i]) {
      motion.translation += matrix * state_.carriers.row(first + variable).transpose();
    }
  }
  if (!lattice.regular) return;
  for (std::size_t g = 0; g < pattern.generators.size(); ++g) {
    pattern.generators[g].translation += state_.carriers.row(first + static_cast<int>(g)).transpose();
  }
}

// The unit template's annotation with its symmetries as they were carried.
SymmetryAnnotation KurzFit::carried() const {
  SymmetryAnnotation result = unit_.annotation;
  for (std::size_t r = 0; r < result.regions.size(); ++r) {
    const int carrier = demands_.carrier_of_region[r];
    if (carrier < 0) continue;
    SymmetryAnnotation alone = empty_annotation(unit_.mesh, result.tolerance);
    alone.regions.push_back(result.regions[r]);
    const Eigen::Vector3d centre = result.regions[r].centre;
    const Eigen::Matrix3d& rotation = state_.rotations[r];
    const Eigen::Vector3d shift = state_.carriers.row(carrier);
    result.regions[r] = transformed(alone, {1, rotation, centre + shift - rotation * centre}).regions.front();
  }
  for (std::size_t p = 0; p < result.patterns.size(); ++p) carry_pattern(p, result.patterns[p]);
  return result;
}

FitResult KurzFit::result() && {
  FitResult result;
  result.pose = unit_.pose * unit_.unit;
  result.fitted = input_.mesh;
  result.fitted.vertices = from_template(unit_.pose, deformed_.vertices);
  result.rest_annotation = input_.annotation;
  result.annotation = transformed(carried(), unit_.pose);
  result.annotation.mesh_diagonal = diagonal(result.fitted.vertices);
  result.samples = terms_.grid.node_count();
  result.degrees_of_freedom = 3 * (result.samples + demands_.carriers);
  result.condition = condition_;
  result.iterations = std::move(iterations_);
  result.iterations_in_all = static_cast<int>(result.iterations.size());
  result.stopped_because = stopped_because_;
  for (std::size_t d = 0; d < demands_.demands.size(); ++d) {
    const double worst = symmetry_differences(terms_, d, state_).rowwise().norm().maxCoeff();
    result.field_residual = std::max(result.field_residual, worst / size_);
  }
  return result;
}

}  // namespace orbifit
