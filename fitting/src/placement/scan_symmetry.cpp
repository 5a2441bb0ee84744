#include "placement/scan_symmetry.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <Eigen/Geometry>

#include "base/dense.h"
#include "base/random.h"
#include "geometry/point_index.h"

namespace orbifit {

namespace {

using Eigen::Vector3d;

/// Some of a scan's points, about their mean and in units of the scan's extent.
struct ScanSample {
  Points points, normals;
  Vector3d centre;  // scan units
  double extent;
  bool oriented;

  Eigen::Index size() const { return points.rows(); }
  Vector3d point(Eigen::Index i) const { return points.row(i); }
  Vector3d normal(Eigen::Index i) const { return normals.row(i); }
};

ScanSample sample_of(const PreparedScan& scan, const std::vector<int>& order, double extent) {
  constexpr std::size_t kMaxPoints = 500;
  const std::vector<int> some(order.begin(),
                              order.begin() + static_cast<std::ptrdiff_t>(std::min(kMaxPoints, order.size())));
  ScanSample result;
  result.extent = extent;
  result.oriented = scan.normals_oriented;
  result.points = scan.points(some, Eigen::all);
  result.normals = scan.normals(some, Eigen::all);
  result.centre = result.points.colwise().mean().transpose();
  result.points = (result.points.rowwise() - result.centre.transpose()) / extent;
  return result;
}

// The points x with direction . x = offset.
struct MirrorPlane {
  Vector3d direction;
  double offset = 0;
  double worth = 0;

  Vector3d image(const Vector3d& x) const { return x - 2 * (direction.dot(x) - offset) * direction; }
  Vector3d turned(const Vector3d& normal) const { return normal - 2 * direction.dot(normal) * direction; }
};

// The same plane has two normals: the sense of `other` that is nearer.
MirrorPlane towards(const Vector3d& direction, const MirrorPlane& other) {
  MirrorPlane result = other;
  if (direction.dot(other.direction) < 0) {
    result.direction = -other.direction;
    result.offset = -other.offset;
  }
  return result;
}

bool like_normals(const Vector3d& a, const Vector3d& b, bool oriented, double cosine) {
  return (oriented ? a.dot(b) : std::abs(a.dot(b))) >= cosine;
}

std::vector<MirrorPlane> proposed_planes(const ScanSample& sample, Random& random) {
  constexpr int kPairs = 60000;
  constexpr std::size_t kMaxPlanes = 2500;
  constexpr double kMinApart = 0.1;   // of the extent
  constexpr double kMinAcross = 0.2;  // cosine of a normal with the plane's: others are mirrored in any such plane
  constexpr double kLike = 0.96;
  std::vector<MirrorPlane> result;
  for (int k = 0; k < kPairs && result.size() < kMaxPlanes; ++k) {
    const auto p = static_cast<Eigen::Index>(random.below(static_cast<std::uint64_t>(sample.size())));
    const auto q = static_cast<Eigen::Index>(random.below(static_cast<std::uint64_t>(sample.size())));
    const Vector3d line = sample.point(q) - sample.point(p);
    const double length = line.norm();
    if (length < kMinApart) continue;
    MirrorPlane plane{line / length};
    if (std::abs(plane.direction.dot(sample.normal(p))) < kMinAcross) continue;
    if (!like_normals(plane.turned(sample.normal(p)), sample.normal(q), sample.oriented, kLike)) continue;
    plane.offset = plane.direction.dot(sample.point(p) + sample.point(q)) / 2;
    result.push_back(plane);
  }
  return result;
}

bool near_planes(const MirrorPlane& a, const MirrorPlane& b, double cosine, double offset) {
  const MirrorPlane there = towards(a.direction, b);
  return a.direction.dot(there.direction) > cosine && std::abs(a.offset - there.offset) < offset;
}

// Each of which no earlier one is near.
std::vector<MirrorPlane> distinct(const std::vector<MirrorPlane>& planes, std::size_t most, double cosine,
                                  double offset) {
  std::vector<MirrorPlane> result;
  for (const MirrorPlane& each : planes) {
    if (result.size() == most) break;
    const auto known = [&](const MirrorPlane& other) { return near_planes(other, each, cosine, offset); };
    if (std::ranges::none_of(result, known)) result.push_back(each);
  }
  return result;
}

// Planes on which votes crowd, each the mean of its votes; most votes first.
std::vector<MirrorPlane> crowded(const std::vector<MirrorPlane>& votes) {
  constexpr std::size_t kMaxCrowds = 48;
  constexpr double kNearCosine = 0.9925;  // 7 degrees
  constexpr double kNearOffset = 0.025;   // of the extent
  std::vector<MirrorPlane> crowds(votes.size());
  for (std::size_t i = 0; i < votes.size(); ++i) {
    MirrorPlane sum{Vector3d::Zero()};
    for (const MirrorPlane& other : votes) {
      if (!near_planes(votes[i], other, kNearCosine, kNearOffset)) continue;
      const MirrorPlane there = towards(votes[i].direction, other);
      sum.direction += there.direction;
      sum.offset += there.offset;
      sum.worth += 1;
    }
    crowds[i] = {sum.direction.normalized(), sum.offset / sum.worth, sum.worth};
  }
  std::ranges::stable_sort(crowds, std::greater<>(), &MirrorPlane::worth);
  return distinct(crowds, kMaxCrowds, kNearCosine, kNearOffset);
}

// The share of what a plane mirrors across itself that has its image on the scan; what was seen through counts against.
double mirrored_share(const MirrorPlane& plane, const ScanSample& sample, const PointIndex& scan,
                      const PreparedScan& all, const SeenSurface& seen) {
  constexpr Eigen::Index kLooks = 250;
  constexpr double kNear = 0.025;  // of the extent
  constexpr double kOff = 0.03;    // nearer to the plane a point is its own image
  constexpr double kLike = 0.8;
  double mirrored = 0;
  double weights = 0;
  for (Eigen::Index i = 0; i < std::min(kLooks, sample.size()); ++i) {
    const Vector3d x = sample.point(i);
    if (std::abs(plane.direction.dot(x) - plane.offset) < kOff) continue;
    const double weight = std::pow(plane.direction.dot(sample.normal(i)), 2);
    weights += weight;
    const Vector3d image = sample.centre + sample.extent * plane.image(x);
    const PointIndex::Neighbour near = scan.nearest(image);
    if (near.distance < kNear * sample.extent) {
      const Vector3d normal = all.normals.row(near.index);
      if (like_normals(plane.turned(sample.normal(i)), normal, sample.oriented, kLike)) mirrored += weight;
    } else if (seen.through(image, kNear * sample.extent)) {
      mirrored -= weight;
    }
  }
  return weights > 0 ? mirrored / weights : 0;
}

void add_planes(const ScanSample& sample, const PreparedScan& all, const SeenSurface& seen, const RunContext& context,
                std::vector<SymmetryElement>& result) {
  constexpr std::size_t kMax = 6;
  constexpr double kMin = 0.1;          // share
  constexpr double kSameCosine = 0.97;  // 14 degrees
  constexpr double kSameOffset = 0.06;  // of the extent
  Random random(context.seed, "mirrors of a scan");
  std::vector<MirrorPlane> planes = crowded(proposed_planes(sample, random));
  const PointIndex scan(all.points);
  parallel_for(context, planes.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) planes[i].worth = mirrored_share(planes[i], sample, scan, all, seen);
  });
  std::ranges::stable_sort(planes, std::greater<>(), &MirrorPlane::worth);
  for (const MirrorPlane& plane : distinct(planes, kMax, kSameCosine, kSameOffset)) {
    if (plane.worth < kMin) break;
    const Vector3d foot = sample.centre + sample.extent * plane.offset * plane.direction;
    result.push_back({SymmetryElement::Kind::plane, foot, plane.direction, plane.worth});
  }
}

// Points c + s direction.
struct Axis {
  Vector3d point, direction;
  double worth = 0;
};

// The sine of a normal's angle out of the plane of its point and the axis, and how much that says.
struct Miss {
  double sine = 1, weight = 0;
};
Miss miss_of(const Axis& axis, const Vector3d& x, const Vector3d& normal) {
  constexpr double kOff = 0.02;  // of the extent: nearer to the axis any normal meets it
  const Vector3d arm = x - axis.point;
  const Vector3d round = axis.direction.cross(arm);
  const double radius = round.norm();
  if (radius < kOff) return {};
  const double along = axis.direction.dot(normal);
  return {std::abs(normal.dot(round)) / radius, 1 - along * along};
}

// The rotation whose field the points slide along, in the weighted mean: the axis that their normals meet.
bool slippage_axis(const ScanSample& sample, const std::vector<Eigen::Index>& points,
                   const std::vector<double>& weights, Axis& axis) {
  Matrix6d matrix = Matrix6d::Zero();
  Vector3d centre = Vector3d::Zero();
  for (const Eigen::Index i : points) centre += sample.point(i) / static_cast<double>(points.size());
  for (std::size_t k = 0; k < points.size(); ++k) {
    Vector6d row;
    row << (sample.point(points[k]) - centre).cross(sample.normal(points[k])), sample.normal(points[k]);
    matrix += weights[k] * row * row.transpose();
  }
  const Vector6d least = Eigen::SelfAdjointEigenSolver<Matrix6d>(matrix).eigenvectors().col(0);
  const Vector3d turn = least.head<3>();
  if (turn.norm() < 0.3) return false;  // mostly a translation
  axis.direction = turn.normalized();
  axis.point = centre + turn.cross(least.tail<3>()) / turn.squaredNorm();
  return axis.point.norm() < 1;
}

void judge_axis(const ScanSample& sample, Axis& axis) {
  constexpr double kMeets = 0.15;  // sine
  double meeting = 0;
  double weights = 0;
  for (Eigen::Index i = 0; i < sample.size(); ++i) {
    const Miss miss = miss_of(axis, sample.point(i), sample.normal(i));
    weights += miss.weight;
    if (miss.sine < kMeets) meeting += miss.weight;
  }
  axis.worth = weights > 0 ? meeting / weights * std::min(1.0, 4 * weights / static_cast<double>(sample.size())) : 0;
}

// Once more through all whose normals nearly meet it.
void refine_axis(const ScanSample& sample, Axis& axis) {
  constexpr double kNearly = 0.3;
  std::vector<Eigen::Index> points;
  std::vector<double> weights;
  for (Eigen::Index i = 0; i < sample.size(); ++i) {
    const Miss miss = miss_of(axis, sample.point(i), sample.normal(i));
    if (miss.sine > kNearly || miss.weight == 0) continue;
    points.push_back(i);
    weights.push_back(miss.weight * std::pow(1 - std::pow(miss.sine / kNearly, 2), 2));
  }
  Axis better = axis;
  if (points.size() < 12 || !slippage_axis(sample, points, weights, better)) return;
  judge_axis(sample, better);
  if (better.worth > axis.worth) axis = better;
}

void add_axes(const ScanSample& sample, const RunContext& context, std::vector<SymmetryElement>& result) {
  constexpr int kTries = 600;
  constexpr int kAtOnce = 10;  // points
  constexpr std::size_t kRefined = 20;
  constexpr std::size_t kMax = 3;
  constexpr double kMin = 0.35;
  constexpr double kSameCosine = 0.97;
  constexpr double kSameOffset = 0.06;  // of the extent
  Random random(context.seed, "axes of a scan");
  const std::vector<double> alike(kAtOnce, 1.0);
  std::vector<Axis> axes;
  for (int k = 0; k < kTries; ++k) {
    const Vector3d seed =
        sample.point(static_cast<Eigen::Index>(random.below(static_cast<std::uint64_t>(sample.size()))));
    const double reach = random.uniform(0.1, 0.5);
    std::vector<Eigen::Index> points;
    for (int t = 0; t < 20 * kAtOnce && points.size() < kAtOnce; ++t) {
      const auto i = static_cast<Eigen::Index>(random.below(static_cast<std::uint64_t>(sample.size())));
      if ((sample.point(i) - seed).norm() < reach) points.push_back(i);
    }
    Axis axis;
    if (points.size() < kAtOnce || !slippage_axis(sample, points, alike, axis)) continue;
    judge_axis(sample, axis);
    axes.push_back(axis);
  }
  std::ranges::stable_sort(axes, std::greater<>(), &Axis::worth);
  if (axes.size() > kRefined) axes.resize(kRefined);
  for (Axis& axis : axes) {
    for (int round = 0; round < 3; ++round) refine_axis(sample, axis);
  }
  std::ranges::stable_sort(axes, std::greater<>(), &Axis::worth);
  std::vector<Axis> kept;
  for (const Axis& axis : axes) {
    if (kept.size() == kMax || axis.worth < kMin) break;
    const bool known = std::ranges::any_of(kept, [&](const Axis& other) {
      return std::abs(other.direction.dot(axis.direction)) > kSameCosine &&
             other.direction.cross(axis.point - other.point).norm() < kSameOffset;
    });
    if (known) continue;
    kept.push_back(axis);
    result.push_back(
        {SymmetryElement::Kind::axis, sample.centre + sample.extent * axis.point, axis.direction, axis.worth});
  }
}

}  // namespace

std::vector<SymmetryElement> scan_symmetries(const PreparedScan& scan, const std::vector<int>& points,
                                             const SeenSurface& seen, double extent, const RunContext& context) {
  const ScanSample sample = sample_of(scan, points, extent);
  std::vector<SymmetryElement> result;
  add_planes(sample, scan, seen, context, result);
  add_axes(sample, context, result);
  return result;
}

}  // namespace orbifit
