#include "orbifit/fitting/alignment.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/SVD>

#include "orbifit/fitting/correspondences.h"

namespace orbifit {

namespace {

constexpr int kIterations = 60;
constexpr int kFewestPairs = 6;
constexpr double kFirstReach = 0.25;       // of the diagonal: pairs farther apart are not the same place
constexpr double kDirectionNoise = 0.003;  // of the diagonal
constexpr double kRobustDecay = 0.92;      // an iteration: what is far at first may be near later
constexpr double kLeastRobust = 0.004;     // of the diagonal
constexpr double kStill = 1e-6;            // of the diagonal: ICP stops at smaller steps

}  // namespace

Similarity align_landmarks(const Mesh& mesh, const std::vector<Landmark>& landmarks) {
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
    return {1, Eigen::Matrix3d::Identity(), to_mean - from_mean};
  }
  const Eigen::Matrix4d found = Eigen::umeyama(from, to, true);
  const double scale = found.topLeftCorner<3, 1>().norm();
  return {scale, nearest_orthogonal(found.topLeftCorner<3, 3>()), found.topRightCorner<3, 1>()};
}

Similarity align_rigidly(const Mesh& mesh, const PreparedScan& scan, const Similarity& start,
                         const RunContext& context) {
  const MatchSurface surface(mesh);
  const double size = diagonal(mesh.vertices);
  const Eigen::Vector3d pivot = bounding_box_centre(mesh.vertices);
  Similarity pose = start;
  double robust = 0.05 * size;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    context.progress("alignment", double(iteration) / kIterations);
    CorrespondenceOptions options;
    options.max_distance = kFirstReach * size;
    options.direction_noise = kDirectionNoise * size;
    options.robust_scale = robust;
    options.trim = 0.95;
    const Points points = to_template(pose, scan.points);
    const auto pairs = find_correspondences(surface, points, normals_to_template(pose, scan.normals), options, context);
    if (static_cast<int>(pairs.size()) < kFewestPairs) return start;
    Eigen::Matrix<double, 6, 6> normal = Eigen::Matrix<double, 6, 6>::Zero();
    Eigen::Matrix<double, 6, 1> right = Eigen::Matrix<double, 6, 1>::Zero();
    for (const Correspondence& pair : pairs) {
      const Eigen::Vector3d s = points.row(pair.scan_point);
      const Eigen::Vector3d foot = mesh.vertices(mesh.faces.row(pair.face), Eigen::all).transpose() * pair.barycentric;
      Eigen::Matrix<double, 6, 1> row;
      row << (s - pivot).cross(pair.normal) / size, pair.normal;
      normal += pair.weight * row * row.transpose();
      right += pair.weight * row * pair.normal.dot(foot - s);
    }
    // What the scan leaves open, such as a turn about a lathe part's axis, stays.
    normal.diagonal().array() += 1e-6 * normal.trace();
    const Eigen::Matrix<double, 6, 1> step = normal.ldlt().solve(right);
    const Motion motion = small_motion(step.head<3>() / size, step.tail<3>(), pivot);
    // The motion moves the scan in the template's frame: pose^-1 becomes motion pose^-1.
    pose = pose * Similarity{1, motion.linear.transpose(), -(motion.linear.transpose() * motion.translation)};
    robust = std::max(kLeastRobust * size, kRobustDecay * robust);
    if (step.norm() < kStill * size && robust <= kLeastRobust * size) break;
  }
  return pose;
}

Similarity align_with_scale(const Mesh& mesh, const MatchSurface& surface, const PreparedScan& scan,
                            const std::vector<int>& points, const Similarity& start,
                            const ScaledAlignmentOptions& options) {
  constexpr double kNormalCosine = 0.7;
  constexpr double kReach = 3;            // robust scales
  constexpr double kScaleDamping = 0.02;  // a scan of little else than a plane says nothing of the scale
  using Vector7 = Eigen::Matrix<double, 7, 1>;
  const double size = diagonal(mesh.vertices);
  const Eigen::Vector3d pivot = bounding_box_centre(mesh.vertices);
  Similarity pose = start;
  for (int iteration = 0; iteration < options.iterations; ++iteration) {
    const double progress = double(iteration) / std::max(1, options.iterations - 1);
    const double robust = size * options.first_robust * std::pow(options.last_robust / options.first_robust, progress);
    const Similarity back = inverse(pose);
    Eigen::Matrix<double, 7, 7> normal = Eigen::Matrix<double, 7, 7>::Zero();
    Vector7 right = Vector7::Zero();
    for (const int point : points) {
      const Eigen::Vector3d s = back(scan.points.row(point));
      const Eigen::Vector3d facing = back.linear * scan.normals.row(point).transpose();
      const auto near = surface.index.nearest_facing(s, facing, kNormalCosine, kReach * robust, true);
      if (near.face < 0) continue;
      const Eigen::Vector3d n = surface.normals.row(near.face);
      const double ratio = near.distance / robust;
      const double weight = 1 / ((1 + ratio * ratio) * (1 + ratio * ratio));
      Vector7 row;
      row << (s - pivot).cross(n) / size, n, n.dot(s - pivot) / size;
      normal += weight * row * row.transpose();
      right += weight * row * n.dot(near.point - s);
    }
    const double trace = normal.trace();
    if (!(trace > 0)) return pose;
    normal.diagonal().array() += 1e-6 * trace;
    normal(6, 6) += kScaleDamping * trace;
    const Vector7 step = normal.ldlt().solve(right);
    const Motion motion = small_motion(step.head<3>() / size, step.segment<3>(3), pivot);
    const double growth = std::clamp(1 + step[6] / size, 0.8, 1.25);
    // The scan moves and grows about the pivot in the template's frame: pose^-1 becomes (growth, motion) pose^-1.
    const Similarity moved{growth, motion.linear, motion(pivot) - growth * (motion.linear * pivot)};
    pose = pose * inverse(moved);
  }
  return pose;
}

Motion small_motion(const Eigen::Vector3d& rotation, const Eigen::Vector3d& translation, const Eigen::Vector3d& pivot) {
  const double angle = rotation.norm();
  const Eigen::Matrix3d linear =
      angle > 0 ? axis_rotation(rotation / angle, angle) : Eigen::Matrix3d(Eigen::Matrix3d::Identity());
  return {linear, pivot - linear * pivot + translation};
}

Points to_template(const Similarity& pose, const Points& points) {
  const Similarity back = inverse(pose);
  return (back.scale * (points * back.linear.transpose())).rowwise() + back.translation.transpose();
}

Points normals_to_template(const Similarity& pose, const Points& normals) {
  return normals * pose.linear;
}

}  // namespace orbifit
