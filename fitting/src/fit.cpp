#include "orbifit/fitting/fit.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>

#include "orbifit/fitting/alignment.h"
#include "orbifit/fitting/clutter.h"
#include "orbifit/fitting/correspondences.h"
#include "orbifit/fitting/scan_preparation.h"
#include "orbifit/model/errors.h"
#include "orbifit/model/point_index.h"
#include "orbifit/model/random.h"
#include "orbifit/model/sampling.h"
#include "orbifit/model/surface_index.h"
#include "orbifit/subspace/displacement_field.h"

#include "fit_system.h"
#include "seen_surface.h"

namespace orbifit {

namespace {

constexpr double kFirstReach = 0.15;       // of the diagonal: correspondences farther apart are none, at the start
constexpr double kLastReach = 0.04;        // and at the end
constexpr double kDirectionNoise = 0.003;  // of the diagonal
// Offsets far above the robust scale hardly count. It shrinks last: parts that the soft template has yet to reach
// would be taken for outliers. Fractions of the diagonal: at the start, when softest, and at the end.
constexpr double kFirstRobust = 0.05;
constexpr double kSoftRobust = 0.02;
constexpr double kLastRobust = 0.007;
constexpr double kRobustDecay = 0.8;  // an iteration, from the soft to the last
// Share of explained points of a scan from which what is not the template's has been taken: a scan of something else,
// onto which the template was put as well as can be, leaves more.
constexpr double kLeastOfPlaced = 0.8;
constexpr double kSilhouetteFrom = 0.3;  // of the levels: the pose is settled by then
constexpr double kStill = 1e-4;          // of the diagonal: the fit has settled when no sample moves more,
constexpr double kSameRms = 5e-3;        // or when the rms changes by less than this share
constexpr int kSameIterations = 4;       // in so many iterations

class Stopwatch {
 public:
  explicit Stopwatch(std::vector<StageTime>& times) : times_(times) {}

  void finished(const std::string& stage) {
    const auto now = std::chrono::steady_clock::now();
    times_.push_back({stage, std::chrono::duration<double>(now - last_).count()});
    last_ = now;
  }

 private:
  std::vector<StageTime>& times_;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

void require(bool holds, const std::string& field, double value, const std::string& rule) {
  if (!holds) throw UsageError(field + " is " + std::to_string(value) + "; it must be " + rule);
}

Mesh deformed_template(const Mesh& mesh, const Subspace& subspace, const Eigen::VectorXd& q) {
  Mesh result = mesh;
  result.vertices += vertex_displacements(subspace, q);
  return result;
}

// Whether the faces look outwards, so that a scan's oriented normals must agree with theirs in sign: a ray into the
// body meets its far side from within.
bool faces_outwards(const Mesh& mesh, const RunContext& context) {
  constexpr int kSamples = 400;
  constexpr double kNearlyAll = 0.85;
  Random random(context.seed, "outwards");
  const SurfaceSamples samples = sample_surface(mesh, kSamples, random);
  const SurfaceIndex surface(mesh);
  const Points normals = face_normals(mesh);
  const double start = 1e-5 * diagonal(mesh.vertices);
  int outwards = 0;
  for (Eigen::Index i = 0; i < samples.points.rows(); ++i) {
    const Eigen::Vector3d inwards = -samples.normals.row(i);
    const auto hit = surface.cast(samples.points.row(i), inwards, start);
    if (hit && normals.row(hit->face).dot(inwards) > 0) ++outwards;
  }
  return outwards >= kNearlyAll * static_cast<double>(samples.points.rows());
}

std::vector<Pull> pulls_towards(const FitInput& input, const Similarity& pose, double weight) {
  const Similarity back = inverse(pose);
  std::vector<Pull> pulls;
  for (const Landmark& landmark : input.landmarks) pulls.push_back({landmark.vertex, back(landmark.target), weight});
  for (const Handle& handle : input.handles) {
    const double each = weight * 3 / static_cast<double>(handle.vertices.size());
    for (const int vertex : handle.vertices) {
      const Eigen::Vector3d place = input.pose(handle.motion(input.mesh.vertices.row(vertex).transpose()));
      pulls.push_back({vertex, back(place), each});
    }
  }
  return pulls;
}

// \param settling iterations since the stiffness is at its last value
double robust_scale(double progress, int settling) {
  if (settling <= 0) return kFirstRobust * std::pow(kSoftRobust / kFirstRobust, progress);
  return std::max(kLastRobust, kSoftRobust * std::pow(kRobustDecay, settling));
}

bool same_rms(const std::vector<FitIteration>& iterations) {
  if (iterations.size() <= kSameIterations) return false;
  const double now = iterations.back().rms;
  return std::all_of(iterations.end() - kSameIterations - 1, iterations.end(),
                     [&](const FitIteration& other) { return std::abs(other.rms - now) <= kSameRms * now; });
}

// Pose and coordinates, improved in place; the loop of the fit.
struct Iterate {
  Similarity pose;
  Eigen::VectorXd q;
};

/// Points of the template that the scan should have seen: where it saw through them they are pulled to what it saw.
class SilhouettePulls {
 public:
  SilhouettePulls(const Mesh& mesh, const PointCloud& cloud, const PreparedScan& scan, const RunContext& context)
      : mesh_(mesh), scan_(scan), seen_(cloud, scan.points) {
    constexpr int kSamples = 1500;
    Random random(context.seed, "silhouette");
    samples_ = sample_surface(mesh, kSamples, random);
    for (Eigen::Index i = 0; i < samples_.points.rows(); ++i) {
      const auto corner = [&](int k) -> Eigen::Vector3d {
        return mesh.vertices.row(mesh.faces(samples_.faces[static_cast<std::size_t>(i)], k));
      };
      barycentric_.push_back(nearest_on_triangle(samples_.points.row(i), corner(0), corner(1), corner(2)));
    }
  }

  bool knows_viewpoints() const { return seen_.knows_viewpoints(); }

  /// \param surface of the deformed mesh \param points  the scan's, in the template's frame
  void add(const Mesh& deformed, const MatchSurface& surface, const Points& points, const Similarity& pose,
           double robust, std::vector<Correspondence>& pairs, const RunContext& context) {
    constexpr double kReach = 0.012;  // of the diagonal
    constexpr double kWeight = 2;     // there are fewer samples than points of the scan
    const double size = diagonal(mesh_.vertices);
    for (Eigen::Index i = 0; i < samples_.points.rows(); ++i) {
      const auto s = static_cast<std::size_t>(i);
      samples_.points.row(i) =
          barycentric_[s].transpose() * deformed.vertices(deformed.faces.row(samples_.faces[s]), Eigen::all);
      samples_.normals.row(i) = surface.normals.row(samples_.faces[s]);
    }
    const double reach = std::max(kReach * size * pose.scale, 1.5 * scan_.spacing);
    for (const SeenSurface::Missed& each : seen_.missed(samples_, surface.index, pose, reach, context)) {
      const Eigen::Vector3d own = samples_.points.row(each.sample);
      const Eigen::Vector3d offset = points.row(each.point).transpose() - own;
      const double distance = offset.norm();
      if (!(distance > 0) || distance > 0.15 * size) continue;
      const double ratio = distance / std::max(robust, 0.03 * size);
      Correspondence pair;
      pair.scan_point = each.point;
      pair.face = samples_.faces[static_cast<std::size_t>(each.sample)];
      pair.barycentric = barycentric_[static_cast<std::size_t>(each.sample)];
      pair.normal = offset / distance;
      pair.distance = distance;
      pair.weight = kWeight / ((1 + ratio * ratio) * (1 + ratio * ratio));
      pairs.push_back(pair);
    }
  }

 private:
  const Mesh& mesh_;
  const PreparedScan& scan_;
  SeenSurface seen_;
  SurfaceSamples samples_;
  std::vector<Eigen::Vector3d> barycentric_;
};

// Whether a placement says that the scan is about where it was said to be, in the template's units: then its scale is
// that of the shapes, which differ, and not of the units.
bool near_given(const Mesh& mesh, const Similarity& found, const Similarity& given) {
  constexpr double kTurn = 0.3;     // radians
  constexpr double kOffset = 0.15;  // of the diagonal
  constexpr double kScale = 0.35;   // of its logarithm
  const Eigen::Vector3d centre = bounding_box_centre(mesh.vertices);
  return std::abs(std::log(found.scale / given.scale)) < kScale &&
         axis_angle(found.linear * given.linear.transpose()).angle < kTurn &&
         (found(centre) - given(centre)).norm() < kOffset * given.scale * diagonal(mesh.vertices);
}

// The share of the scan's points that stand where points were kept; planes that were taken out leave none.
double share_near(const PointCloud& cloud, const PreparedScan& kept, const RunContext& context) {
  constexpr std::uint64_t kLooks = 4000;
  const PointIndex index(kept.points);
  Random random(context.seed, "share of a scan");
  int near = 0;
  for (std::uint64_t i = 0; i < kLooks; ++i) {
    const auto row = static_cast<Eigen::Index>(random.below(static_cast<std::uint64_t>(cloud.points.rows())));
    near += index.nearest(cloud.points.row(row), 1).front().distance <= 2 * kept.spacing ? 1 : 0;
  }
  return near / static_cast<double>(kLooks);
}

// Finds the template, and leaves of the scan what may be its.
PreparedScan placed_scan(const FitInput& input, const FitOptions& options, ScanPreparationOptions preparation,
                         const RunContext& context, Similarity& pose, FitResult& result) {
  constexpr double kNear = 0.12;  // of the diagonal
  constexpr int kMore = 2;        // points, since planes among them go
  constexpr Eigen::Index kFewestNear = 10;
  result.placements = find_placements(input.mesh, input.scan, options.placement, context, input.pose);
  if (result.placements.empty()) return prepare_scan(input.scan, preparation, context);
  pose = result.placements.front().pose;
  const SurfaceIndex surface(input.mesh);
  const double size = diagonal(input.mesh.vertices);
  const PointCloud near = points_near(surface, size, input.scan, pose, kNear, context);
  PreparedScan scan;
  if (near.points.rows() >= kFewestNear && diagonal(near.points) > 0) {
    preparation.most_points *= kMore;
    scan =
        without_planes(surface, size, prepare_scan(near, preparation, context), pose, options.placement.reach, context);
  }
  if (scan.points.rows() < kFewestNear) {
    result.placements.clear();  // all of it was of something else
    pose = input.pose;
    return prepare_scan(input.scan, preparation, context);
  }
  result.used_fraction = share_near(input.scan, scan, context);
  if (near_given(input.mesh, pose, input.pose)) pose = align_rigidly(input.mesh, scan, input.pose, context);
  return scan;
}

void iterate(const FitInput& input, const PreparedScan& scan, const Subspace& subspace, const FitOptions& options,
             const RunContext& context, Iterate& state, FitResult& result) {
  const double size = diagonal(input.mesh.vertices);
  FitSystem system(subspace, input.mesh, options.stretch);
  const bool signed_normals = scan.normals_oriented && faces_outwards(input.mesh, context);
  const int scheduled = options.levels * options.iterations;
  Points displacements = sample_displacements(subspace, state.q);
  SilhouettePulls silhouette(input.mesh, input.scan, scan, context);
  for (int i = 0; i < options.most_iterations; ++i) {
    context.progress("fit", double(i) / options.most_iterations);
    const double progress = std::min(1.0, double(i / options.iterations) / std::max(1, options.levels - 1));
    FitIteration record;
    record.stiffness = options.first_stiffness * std::pow(options.last_stiffness / options.first_stiffness, progress);

    CorrespondenceOptions matching;
    matching.max_distance = (kFirstReach + (kLastReach - kFirstReach) * progress) * size;
    matching.signed_normals = signed_normals;
    // Far points are left out while the template is far; in the end the robust weights judge each by itself.
    matching.trim = options.trim + (1 - options.trim) * progress;
    matching.never_trim = 0.005 * size;
    matching.direction_noise = kDirectionNoise * size;
    matching.robust_scale = robust_scale(progress, i - scheduled) * size;
    const Points points = to_template(state.pose, scan.points);
    const Mesh deformed = deformed_template(input.mesh, subspace, state.q);
    const MatchSurface surface(deformed);
    auto pairs =
        find_correspondences(surface, points, normals_to_template(state.pose, scan.normals), matching, context);
    record.correspondences = static_cast<int>(pairs.size());
    record.rms = weighted_rms(pairs) / size;
    if (progress >= kSilhouetteFrom && silhouette.knows_viewpoints()) {
      silhouette.add(deformed, surface, points, state.pose, matching.robust_scale, pairs, context);
    }
    if (pairs.empty() && input.landmarks.empty() && input.handles.empty()) {
      result.stopped_because = "no point of the scan lies near the template";
      return;
    }
    const auto pulls = pulls_towards(input, state.pose, options.landmark_weight);
    const FitSystem::Solution solution = system.solve(pairs, points, pulls, record.stiffness, context);
    state.q = solution.q;
    const Motion back = inverse(solution.scan_step);
    state.pose = state.pose * Similarity{1, back.linear, back.translation};
    system.rotate(state.q);

    const Points next = sample_displacements(subspace, state.q);
    record.change = (next - displacements).rowwise().norm().maxCoeff() / size;
    displacements = next;
    record.energy = solution.energy;
    result.iterations.push_back(record);
    if (i + 1 < scheduled) continue;
    if (record.change < kStill) {
      result.stopped_because = "settled: no sample moves by more than 0.01 % of the diagonal";
      return;
    }
    if (same_rms(result.iterations)) {
      result.stopped_because = "settled: the distances to the scan no longer change";
      return;
    }
  }
  result.stopped_because = "the iterations allowed are used up";
}

// What the fitted surface explains of the scan, and what the scan saw of it.
void assess(const FitInput& input, const PreparedScan& scan, const FitOptions& options, FitResult& result) {
  const double size = diagonal(result.fitted.vertices);
  const SurfaceIndex surface(result.fitted);
  double squares = 0;
  int inliers = 0;
  for (Eigen::Index i = 0; i < scan.points.rows(); ++i) {
    const double distance = surface.nearest(scan.points.row(i).transpose()).distance / size;
    if (distance > options.inlier_distance) continue;
    ++inliers;
    squares += distance * distance;
  }
  result.inlier_fraction = double(inliers) / static_cast<double>(scan.points.rows());
  result.rms = inliers > 0 ? std::sqrt(squares / inliers) : 0;

  const PointIndex points(scan.points);
  const double near = std::max(2 * scan.spacing, options.inlier_distance * size);
  result.seen.resize(static_cast<std::size_t>(result.fitted.vertices.rows()));
  for (std::size_t v = 0; v < result.seen.size(); ++v) {
    const Eigen::Vector3d vertex = result.fitted.vertices.row(static_cast<Eigen::Index>(v));
    result.seen[v] = points.nearest(vertex, 1).front().distance <= near ? 1 : 0;
  }
  const Eigen::VectorXd areas = face_areas(result.fitted);
  double hidden = 0;
  for (Eigen::Index f = 0; f < areas.size(); ++f) {
    for (int k = 0; k < 3; ++k) {
      if (result.seen[static_cast<std::size_t>(result.fitted.faces(f, k))] == 0) hidden += areas[f] / 3;
    }
  }
  result.hidden_fraction = hidden / areas.sum();

  double missed = 0;
  const auto pulls = pulls_towards(input, result.pose, 1);
  for (const Pull& pull : pulls) {
    missed += (result.fitted.vertices.row(pull.vertex).transpose() - result.pose(pull.target)).squaredNorm();
  }
  if (!pulls.empty()) result.landmark_rms = std::sqrt(missed / static_cast<double>(pulls.size())) / size;
}

}  // namespace

void FitOptions::validate() const {
  subspace.validate();
  placement.validate();
  require(levels >= 1, "levels", levels, "at least 1");
  require(iterations >= 1, "iterations", iterations, "at least 1");
  require(most_iterations >= levels * iterations, "most_iterations", most_iterations,
          "at least levels * iterations = " + std::to_string(levels * iterations));
  require(last_stiffness > 0, "last_stiffness", last_stiffness, "positive");
  require(first_stiffness > last_stiffness, "first_stiffness", first_stiffness, "more than last_stiffness");
  require(stretch >= 0, "stretch", stretch, "0 or more");
  require(trim > 0 && trim <= 1, "trim", trim, "in (0, 1]");
  require(scan_points >= 10, "scan_points", scan_points, "at least 10");
  require(landmark_weight > 0, "landmark_weight", landmark_weight, "positive");
  require(inlier_distance > 0, "inlier_distance", inlier_distance, "positive");
  require(least_inliers >= 0 && least_inliers <= 1, "least_inliers", least_inliers, "in [0, 1]");
}

FitResult fit(const FitInput& input, const FitOptions& options, const RunContext& context) {
  options.validate();
  FitResult result;
  Stopwatch watch(result.times);

  ScanPreparationOptions preparation;
  preparation.most_points = options.scan_points;
  Iterate state{input.pose, {}};
  PreparedScan scan;
  if (options.place && input.landmarks.empty() && input.handles.empty()) {
    scan = placed_scan(input, options, preparation, context, state.pose, result);
  } else {
    scan = prepare_scan(input.scan, preparation, context);
  }
  watch.finished(result.placements.empty() ? "scan" : "placement");

  if (!input.landmarks.empty()) {
    state.pose = align_landmarks(input.mesh, input.landmarks);
  } else if (options.align && result.placements.empty() && input.handles.empty()) {
    state.pose = align_rigidly(input.mesh, scan, input.pose, context);
  }
  watch.finished("alignment");

  const Subspace subspace = build_subspace(input.mesh, input.annotation, options.subspace, context);
  state.q = Eigen::VectorXd::Zero(subspace.degrees_of_freedom());
  result.samples = static_cast<int>(subspace.sampling.points.rows());
  result.degrees_of_freedom = subspace.degrees_of_freedom();
  watch.finished("subspace");

  iterate(input, scan, subspace, options, context, state, result);
  watch.finished("fit");

  const Mesh deformed = deformed_template(input.mesh, subspace, state.q);
  result.pose = state.pose;
  result.q = state.q;
  result.fitted = deformed;
  for (Eigen::Index v = 0; v < deformed.vertices.rows(); ++v) {
    result.fitted.vertices.row(v) = state.pose(deformed.vertices.row(v).transpose()).transpose();
  }
  result.annotation = transformed(carried_annotation(input.annotation, subspace, state.q, deformed), state.pose);
  result.annotation.mesh_diagonal = diagonal(result.fitted.vertices);
  assess(input, scan, options, result);
  for (std::size_t i = 0; i < input.annotation.regions.size(); ++i) {
    const Residual residual =
        field_residual(subspace, input.mesh, input.annotation.regions[i], static_cast<int>(i), state.q, context);
    result.field_residual = std::max(result.field_residual, residual.max);
  }
  watch.finished("assessment");

  const double explained = result.inlier_fraction * result.used_fraction;
  result.converged = !result.iterations.empty() && explained >= options.least_inliers &&
                     (result.placements.empty() || result.inlier_fraction >= kLeastOfPlaced);
  if (!result.iterations.empty() && !result.converged) {
    result.stopped_because +=
        "; only " + std::to_string(static_cast<int>(100 * explained)) + " % of the scan is explained";
  }
  return result;
}

}  // namespace orbifit
