#include "registration/alignment.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "base/dense.h"
#include "registration/correspondences.h"
#include "registration/pose_system.h"

namespace orbifit {

namespace {

constexpr int kIterations = 60;
constexpr int kMinPairs = 6;
constexpr double kFarthestPair = 0.25;  // of the diagonal: pairs farther apart are not the same place
constexpr double kRobustDecay = 0.92;   // an iteration: what is far at first may be near later
constexpr double kMinRobust = 0.004;    // of the diagonal
constexpr double kSmallestStep = 1e-6;  // of the diagonal: ICP stops at smaller steps

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
                            const Similarity& start, const ScaledAlignmentOptions& options, const RunContext& context) {
  constexpr double kNormalCosine = 0.7;
  constexpr double kReach = 3;  // robust scales
  constexpr std::size_t kMinShare = 100;
  const double size = diagonal(surface.mesh().vertices);
  const Eigen::Vector3d pivot = bounding_box_centre(surface.mesh().vertices);
  Similarity pose = start;
  std::vector<int> likely(points.size(), -1);
  std::vector<SurfaceIndex::Nearest> nearest(points.size());
  for (int iteration = 0; iteration < options.iterations; ++iteration) {
    const double progress = double(iteration) / std::max(1, options.iterations - 1);
    const double robust = size * options.first_robust * std::pow(options.last_robust / options.first_robust, progress);
    const Similarity back = inverse(pose);
    parallel_for(
        context, points.size(),
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t i = begin; i < end; ++i) {
            const Eigen::Vector3d facing = back.linear * scan.normals.row(points[i]).transpose();
            nearest[i] = surface.index.nearest_facing(back(scan.points.row(points[i])), facing, kNormalCosine,
                                                      kReach * robust, true, likely[i]);
            likely[i] = nearest[i].place;
          }
        },
        kMinShare);
    PoseSystem system(size, pivot);
    bool any = false;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const SurfaceIndex::Nearest& near = nearest[i];
      if (near.face < 0) continue;
      const Eigen::Vector3d s = back(scan.points.row(points[i]));
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
