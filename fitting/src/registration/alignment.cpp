#include "registration/alignment.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "base/dense.h"
#include "registration/correspondences.h"

namespace orbifit {

namespace {

constexpr int kIterations = 60;
constexpr int kMinPairs = 6;
constexpr double kFarthestPair = 0.25;  // of the diagonal: pairs farther apart are not the same place
constexpr double kRobustDecay = 0.92;   // an iteration: what is far at first may be near later
constexpr double kMinRobust = 0.004;    // of the diagonal
constexpr double kSmallestStep = 1e-6;  // of the diagonal: ICP stops at smaller steps
constexpr double kScaleDamping = 0.02;  // a scan of little else than a plane says nothing of the scale

// Point-to-plane offsets as a linear system in a small similarity of the scan in the template's frame: a rotation about
// the pivot and the growth times the template's diagonal, and a translation.
class PoseSystem {
 public:
  PoseSystem(double size, const Eigen::Vector3d& pivot) : size_(size), pivot_(pivot) {}

  // A scan point, the surface's normal near it, and how far along the normal the surface is.
  void add(const Eigen::Vector3d& point, const Eigen::Vector3d& normal, double offset, double weight) {
    const Eigen::Vector3d arm = point - pivot_;
    Vector7 row;
    row << arm.cross(normal) / size_, normal, normal.dot(arm) / size_;
    matrix_ += weight * row * row.transpose();
    side_ += weight * offset * row;
  }

  struct Step {
    Similarity scan;  // to apply to the scan in the template's frame
    double length;    // template units
  };

  // What the scan leaves open, such as a turn about a lathe part's axis, stays.
  Step rigid() const {
    Matrix6d matrix = matrix_.topLeftCorner<6, 6>();
    matrix.diagonal().array() += kOpen * matrix.trace();
    Vector7 step = Vector7::Zero();
    step.head<6>() = solve_semidefinite(matrix, side_.head<6>());
    return step_of(step);
  }

  Step scaled() const {
    Eigen::MatrixXd matrix = matrix_;
    const double trace = matrix.trace();
    matrix.diagonal().array() += kOpen * trace;
    matrix(6, 6) += kScaleDamping * trace;
    return step_of(solve_semidefinite(matrix, side_));
  }

 private:
  using Vector7 = Eigen::Matrix<double, 7, 1>;
  static constexpr double kOpen = 1e-6;

  Step step_of(const Vector7& step) const {
    const Motion motion = small_motion(step.head<3>() / size_, step.segment<3>(3), pivot_);
    const double growth = std::clamp(1 + step[6] / size_, 0.8, 1.25);
    return {{growth, motion.linear, motion(pivot_) - growth * (motion.linear * pivot_)}, step.norm()};
  }

  double size_;
  Eigen::Vector3d pivot_;
  Eigen::Matrix<double, 7, 7> matrix_ = Eigen::Matrix<double, 7, 7>::Zero();
  Vector7 side_ = Vector7::Zero();
};

}  // namespace

Similarity align_landmarks(const Mesh& mesh, const std::vector<Landmark>& landmarks,
                           const std::optional<double>& scale) {
  Eigen::Matrix3Xd from(3, static_cast<Eigen::Index>(landmarks.size()));
  Eigen::Matrix3Xd to(3, from.cols());
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    from.col(static_cast<Eigen::Index>(i)) = mesh.vertices.row(landmarks[i].vertex).transpose();
    to.col(static_cast<Eigen::Index>(i)) = landmarks[i].target;
  }
  const Eigen::Vector3d from_mean = from.rowwise().mean();
  const Eigen::Vector3d to_mean = to.rowwise().mean();
  // The second singular value is the spread off a line.
  const Eigen::VectorXd spread = Eigen::JacobiSVD<Eigen::MatrixXd>(from.colwise() - from_mean).singularValues();
  if (from.cols() < 3 || spread[1] < 1e-6 * diagonal(mesh.vertices)) {
    const double known = scale.value_or(1);
    return {known, Eigen::Matrix3d::Identity(), to_mean - known * from_mean};
  }
  const Eigen::Matrix4d found = Eigen::umeyama(from, to, true);
  const Eigen::Matrix3d linear = nearest_orthogonal(found.topLeftCorner<3, 3>());
  if (scale) return {*scale, linear, to_mean - *scale * (linear * from_mean)};
  return {found.topLeftCorner<3, 1>().norm(), linear, found.topRightCorner<3, 1>()};
}

Similarity align_rigidly(const MatchSurface& surface, const PreparedScan& scan, const Similarity& start,
                         const RunContext& context) {
  const Mesh& mesh = surface.mesh();
  const double size = diagonal(mesh.vertices);
  const Eigen::Vector3d pivot = bounding_box_centre(mesh.vertices);
  Similarity pose = start;
  double robust = 0.05 * size;
  std::vector<int> likely;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    context.progress("alignment", double(iteration) / kIterations);
    CorrespondenceOptions options;
    options.max_distance = kFarthestPair * size;
    options.direction_noise = kDirectionNoise * size;
    options.robust_scale = robust;
    options.trim = 0.95;
    const Points points = to_template(pose, scan.points);
    const auto pairs =
        find_correspondences(surface, points, normals_to_template(pose, scan.normals), options, context, &likely);
    if (static_cast<int>(pairs.size()) < kMinPairs) return start;
    PoseSystem system(size, pivot);
    for (const Correspondence& pair : pairs) {
      const Eigen::Vector3d s = points.row(pair.scan_point);
      const Eigen::Vector3d foot = mesh.vertices(mesh.faces.row(pair.face), Eigen::all).transpose() * pair.barycentric;
      system.add(s, pair.normal, pair.normal.dot(foot - s), pair.weight);
    }
    const PoseSystem::Step step = system.rigid();
    pose = pose * inverse(step.scan);
    robust = std::max(kMinRobust * size, kRobustDecay * robust);
    if (step.length < kSmallestStep * size && robust <= kMinRobust * size) break;
  }
  return pose;
}

Similarity align_with_scale(const MatchSurface& surface, const PreparedScan& scan, const std::vector<int>& points,
                            const Similarity& start, const ScaledAlignmentOptions& options) {
  constexpr double kNormalCosine = 0.7;
  constexpr double kReach = 3;  // robust scales
  const double size = diagonal(surface.mesh().vertices);
  const Eigen::Vector3d pivot = bounding_box_centre(surface.mesh().vertices);
  Similarity pose = start;
  std::vector<int> likely(points.size(), -1);
  for (int iteration = 0; iteration < options.iterations; ++iteration) {
    const double progress = double(iteration) / std::max(1, options.iterations - 1);
    const double robust = size * options.first_robust * std::pow(options.last_robust / options.first_robust, progress);
    const Similarity back = inverse(pose);
    PoseSystem system(size, pivot);
    bool any = false;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Eigen::Vector3d s = back(scan.points.row(points[i]));
      const Eigen::Vector3d facing = back.linear * scan.normals.row(points[i]).transpose();
      const auto near = surface.index.nearest_facing(s, facing, kNormalCosine, kReach * robust, true, likely[i]);
      likely[i] = near.place;
      if (near.face < 0) continue;
      const Eigen::Vector3d n = surface.normal(near.face);
      system.add(s, n, n.dot(near.point - s), robust_weight(near.distance, robust));
      any = true;
    }
    if (!any) return pose;
    pose = pose * inverse((options.keep_scale ? system.rigid() : system.scaled()).scan);
  }
  return pose;
}

Similarity rescaled(const Similarity& pose, double scale, const Mesh& mesh) {
  const Eigen::Vector3d centre = bounding_box_centre(mesh.vertices);
  return {scale, pose.linear, pose(centre) - scale * (pose.linear * centre)};
}

Motion small_motion(const Eigen::Vector3d& rotation, const Eigen::Vector3d& translation, const Eigen::Vector3d& pivot) {
  const double angle = rotation.norm();
  const Eigen::Matrix3d linear =
      angle > 0 ? axis_rotation(rotation / angle, angle) : Eigen::Matrix3d(Eigen::Matrix3d::Identity());
  return {linear, pivot - linear * pivot + translation};
}

Points from_template(const Similarity& pose, const Points& points) {
  Points result(points.rows(), 3);
  for (Eigen::Index i = 0; i < points.rows(); ++i) result.row(i) = pose(points.row(i).transpose()).transpose();
  return result;
}

Points to_template(const Similarity& pose, const Points& points) {
  const Similarity back = inverse(pose);
  return (back.scale * (points * back.linear.transpose())).rowwise() + back.translation.transpose();
}

Points normals_to_template(const Similarity& pose, const Points& normals) {
  return normals * pose.linear;
}

}  // namespace orbifit
