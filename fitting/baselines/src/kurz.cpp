#include "orbifit/baselines/kurz.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>
#include <utility>

#include "orbifit/fitting/alignment.h"
#include "orbifit/fitting/correspondences.h"
#include "orbifit/fitting/scan_preparation.h"
#include "orbifit/model/errors.h"

#include "fit_assessment.h"
#include "kurz_normal.h"
#include "kurz_terms.h"
#include "pulls.h"
#include "thin_plate.h"

namespace orbifit {

namespace {

constexpr double kHold = 1e-6;  // weight by which what nothing determines stays where it is

void require(bool holds, const std::string& field, double value, const std::string& rule) {
  if (!holds) throw UsageError(field + " is " + std::to_string(value) + "; it must be " + rule);
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// The template with a longest side of 1 about the origin, and the scan as it is placed.
struct UnitInput {
  Similarity unit;  // template -> unit template
  Similarity pose;  // unit template -> scan
  Mesh mesh;
  SymmetryAnnotation annotation;
  PreparedScan scan;      // in the scan's frame
  Points points, normals;  // the scan's, in the unit template's frame
};

Points moved(const Similarity& similarity, const Points& points) {
  Points result(points.rows(), 3);
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    result.row(i) = similarity(points.row(i).transpose()).transpose();
  }
  return result;
}

UnitInput unit_input(const FitInput& input, const KurzOptions& options, const RunContext& context) {
  UnitInput result;
  const Points& vertices = input.mesh.vertices;
  const double length = (vertices.colwise().maxCoeff() - vertices.colwise().minCoeff()).maxCoeff();
  if (!(length > 0)) throw InputError("", "template", "has no extent");
  const Eigen::Vector3d centre = bounding_box_centre(vertices);
  result.unit = {1 / length, Eigen::Matrix3d::Identity(), -centre / length};
  result.mesh = input.mesh;
  result.mesh.vertices = moved(result.unit, vertices);
  result.annotation = transformed(input.annotation, result.unit);
  Similarity pose = input.pose;
  if (!input.landmarks.empty()) pose = align_landmarks(input.mesh, input.landmarks);
  if (input.scan.points.rows() > 0) {
    ScanPreparationOptions preparation;
    preparation.most_points = options.scan_points;
    result.scan = prepare_scan(input.scan, preparation, context);
    if (options.align && input.landmarks.empty() && input.handles.empty()) {
      pose = align_rigidly(input.mesh, result.scan, pose, context);
    }
    result.points = moved(result.unit, to_template(pose, result.scan.points));
    result.normals = normals_to_template(pose, result.scan.normals);
  } else if (input.handles.empty() && input.landmarks.empty()) {
    throw InputError("", "scan", "has no points, and there are no handles");
  }
  result.pose = pose * inverse(result.unit);
  return result;
}

class KurzFit {
 public:
  KurzFit(const FitInput& input, const UnitInput& unit, const KurzOptions& options, const RunContext& context)
      : input_(input),
        unit_(unit),
        options_(options),
        context_(context),
        size_(diagonal(unit.mesh.vertices)),
        demands_(symmetry_demands(unit.mesh, unit.annotation, options.quadrature_points,
                                  options.symmetry_weight > 0 ? options.mode : GroupMode::fixed, context)),
        deformed_(unit.mesh),
        surface_(MatchSurface::of_moving(deformed_)) {
    if (options.symmetry_weight == 0) demands_.demands.clear();
    state_.carriers = Points::Zero(demands_.carriers, 3);
    state_.rotations.assign(unit.annotation.regions.size(), Eigen::Matrix3d::Identity());
  }

  // The iterations with one kind of basis functions, which begin from the surface as it is.
  void run(GridBasis basis, int most) {
    const Grid grid = grid_around(unit_.mesh.vertices, options_.spacing, basis);
    terms_ = kurz_terms(grid, demands_);
    terms_.symmetry_weight = options_.symmetry_weight * options_.scan_points;
    terms_.hold = kHold;
    terms_.pulls = pull_term();
    state_.nodes = Points::Zero(grid.node_count(), 3);
    plate_ = thin_plate(grid);
    vertex_values_ = basis_values(grid, unit_.mesh.vertices);
    KurzNormal normal(terms_, plate_);
    stopped_because_ = "the iterations allowed are used up";
    for (int i = 0; i < most; ++i) {
      context_.progress("fit", double(i) / most);
      const int stiff = basis == GridBasis::linear && !demands_alone() ? options_.stiff_iterations : 0;
      terms_.thin_plate = options_.thin_plate_weight;
      if (i < stiff) {
        terms_.thin_plate *= std::pow(options_.first_thin_plate / options_.thin_plate_weight, 1 - double(i) / stiff);
      }
      iterate(normal, i == 0);
      if (i >= stiff && iterations_.back().change < options_.still * 1 / size_) {
        stopped_because_ = "settled: no vertex moves by more than " + std::to_string(options_.still);
        break;
      }
    }
    if (options_.condition) condition_ = normal.condition();
  }

  FitResult result() &&;

 private:
  bool demands_alone() const { return unit_.points.rows() == 0; }

  PullTerm pull_term() const {
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

  std::vector<Correspondence> match() {
    if (demands_alone()) return {};
    CorrespondenceOptions options;
    options.max_distance = 10;  // no limit but the trimming
    options.min_normal_cosine = options_.min_normal_cosine;
    options.trim = options_.trim;
    options.never_trim = options_.never_trim;
    options.robust_scale = 1e9;  // no weights
    return find_correspondences(surface_, unit_.points, unit_.normals, options, context_, &likely_);
  }

  DataTerm data_term(const std::vector<Correspondence>& pairs) const {
    const auto count = static_cast<Eigen::Index>(pairs.size());
    DataTerm term;
    Points places(count, 3);
    term.offsets.resize(count, 3);
    term.normals.resize(count, 3);
    for (Eigen::Index i = 0; i < count; ++i) {
      const Correspondence& pair = pairs[static_cast<std::size_t>(i)];
      const auto& corners = unit_.mesh.faces.row(pair.face);
      places.row(i) = pair.barycentric.transpose() * unit_.mesh.vertices(corners, Eigen::all);
      term.offsets.row(i) = unit_.points.row(pair.scan_point) - places.row(i);
      term.normals.row(i) = unit_.normals.row(pair.scan_point);
    }
    const double points = std::max<double>(1, static_cast<double>(unit_.points.rows()));
    term.weights.setConstant(count, options_.data_weight * options_.scan_points / points);
    term.values = basis_values(terms_.grid, places);
    return term;
  }

  void iterate(KurzNormal& normal, bool fresh) {
    const auto start = std::chrono::steady_clock::now();
    const std::vector<Correspondence> pairs = match();
    const DataTerm data = data_term(pairs);
    FitIteration record;
    record.stiffness = terms_.thin_plate;
    record.correspondences = static_cast<int>(pairs.size());
    record.rms = weighted_rms(pairs) / size_;
    const KurzState before = state_;
    normal.solve(data, state_);
    // A stage's first step has no coefficients to begin with; a linear problem needs none.
    const KurzState& told = fresh ? state_ : before;
    record.energy = kurz_energy(terms_, plate_, data, told).sum() / (options_.scan_points * size_ * size_);
    if (options_.mode == GroupMode::moving) turn_symmetries(terms_, state_);
    const Points places = unit_.mesh.vertices + vertex_values_ * state_.nodes;
    record.change = (places - deformed_.vertices).rowwise().norm().maxCoeff() / size_;
    deformed_.vertices = places;
    if (!demands_alone()) surface_.index.move(deformed_, 0.01, context_);
    record.seconds = seconds_since(start);
    iterations_.push_back(record);
  }

  SymmetryAnnotation carried() const;

  const FitInput& input_;
  const UnitInput& unit_;
  const KurzOptions& options_;
  const RunContext& context_;
  double size_;  // the unit template's diagonal
  SymmetryDemands demands_;
  KurzState state_;
  KurzTerms terms_;
  Eigen::SparseMatrix<double> plate_;
  SparseRows vertex_values_;
  Mesh deformed_;
  MatchSurface surface_;  // of deformed_
  std::vector<int> likely_;
  std::vector<FitIteration> iterations_;
  std::string stopped_because_;
  double condition_ = 0;
};

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
  return result;
}

FitResult KurzFit::result() && {
  FitResult result;
  result.pose = unit_.pose * unit_.unit;
  result.fitted = input_.mesh;
  result.fitted.vertices = moved(unit_.pose, deformed_.vertices);
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

double rms_of_pulls(const FitInput& input, const FitResult& result) {
  const auto pulls = pulls_towards(input, result.pose, 1);
  double squares = 0;
  for (const Pull& pull : pulls) {
    squares += (result.fitted.vertices.row(pull.vertex).transpose() - result.pose(pull.target)).squaredNorm();
  }
  return std::sqrt(squares / static_cast<double>(pulls.size())) / diagonal(result.fitted.vertices);
}

}  // namespace

void KurzOptions::validate() const {
  require(handle_weight >= 0, "handle_weight", handle_weight, "0 or more");
  require(data_weight >= 0, "data_weight", data_weight, "0 or more");
  require(thin_plate_weight > 0, "thin_plate_weight", thin_plate_weight, "positive");
  require(symmetry_weight >= 0, "symmetry_weight", symmetry_weight, "0 or more");
  require(spacing > 0 && spacing <= 1, "spacing", spacing, "in (0, 1]");
  require(linear_iterations >= 1, "linear_iterations", linear_iterations, "at least 1");
  require(smooth_iterations >= 0, "smooth_iterations", smooth_iterations, "at least 0");
  require(stiff_iterations >= 0, "stiff_iterations", stiff_iterations, "at least 0");
  require(first_thin_plate >= thin_plate_weight, "first_thin_plate", first_thin_plate, "at least thin_plate_weight");
  require(still >= 0, "still", still, "0 or more");
  require(quadrature_points >= 64, "quadrature_points", quadrature_points, "at least 64");
  require(trim > 0 && trim <= 1, "trim", trim, "in (0, 1]");
  require(never_trim >= 0, "never_trim", never_trim, "0 or more");
  require(min_normal_cosine >= 0 && min_normal_cosine < 1, "min_normal_cosine", min_normal_cosine, "in [0, 1)");
  require(scan_points >= 10, "scan_points", scan_points, "at least 10");
  require(inlier_distance > 0, "inlier_distance", inlier_distance, "positive");
}

FitResult fit_kurz(const FitInput& input, const KurzOptions& options, const RunContext& context) {
  options.validate();
  auto start = std::chrono::steady_clock::now();
  const UnitInput unit = unit_input(input, options, context);
  KurzFit fit(input, unit, options, context);
  const double prepared = seconds_since(start);
  start = std::chrono::steady_clock::now();
  fit.run(GridBasis::linear, options.linear_iterations);
  const auto smooth = std::chrono::steady_clock::now();
  if (options.smooth_iterations > 0) fit.run(GridBasis::cubic, options.smooth_iterations);
  FitResult result = std::move(fit).result();
  result.times = {{"prepare", prepared}, {"fit", seconds_since(start)}, {"smooth", seconds_since(smooth)}};
  result.converged = true;
  if (unit.points.rows() == 0) {
    result.landmark_rms = rms_of_pulls(input, result);
    return result;
  }
  FitOptions assessment;
  assessment.inlier_distance = options.inlier_distance;
  assess_fit(input, unit.scan, assessment, context, result);
  result.converged = result.inlier_fraction >= assessment.least_inliers;
  return result;
}

}  // namespace orbifit
