#include "symmetry/turning_group.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <vector>

#include <Eigen/Geometry>

#include "geometry/point_index.h"

namespace orbifit {

namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using Family = PointGroup::Family;

constexpr int kFinest = 256;
constexpr Index kTrials = 200;
constexpr Index kMirrorTrials = 64;
// Of a turn's distance from the centre: places that near the axis may be on it.
constexpr double kFixed = 0.02;
constexpr double kSame = 1e-6;  // directions, angles, and lengths relative to the part
constexpr double kClosed = 0.9;
constexpr double kAsGood = 1.25;  // times the least error

// Places about the centre, to see how well a linear map takes them onto places.
class Turned {
 public:
  Turned(const Points& places, const Vector3d& centre)
      : points_(places.rowwise() - centre.transpose()), index_(points_) {
    const Index step = std::max<Index>(1, points_.rows() / kTrials);
    for (Index i = 0; i < points_.rows(); i += step) trials_.push_back(i);
  }

  const Points& points() const { return points_; }
  const std::vector<Index>& trials() const { return trials_; }

  Index image(const Matrix3d& linear, Index point) const {
    return index_.nearest(linear * points_.row(point).transpose()).index;
  }

  /// Root mean square distance of images from places; infinite where a place is its own image without being fixed:
  /// small turns leave every place near itself.
  double error(const Matrix3d& linear) const {
    double sum = 0;
    for (const Index i : trials_) {
      const Vector3d point = points_.row(i);
      const auto image = index_.nearest(linear * point);
      if (image.index == i && image.distance > kFixed * point.norm()) return std::numeric_limits<double>::infinity();
      sum += image.distance * image.distance;
    }
    return std::sqrt(sum / static_cast<double>(trials_.size()));
  }

  /// Whether `order` turns take nearly every place through as many others back to itself.
  bool closes(const Matrix3d& turn, int order) const {
    std::size_t closed = 0;
    for (const Index i : trials_) {
      Index at = i;
      for (int step = 0; step < order; ++step) at = image(turn, at);
      if (at == i) ++closed;
    }
    return static_cast<double>(closed) >= kClosed * static_cast<double>(trials_.size());
  }

 private:
  Points points_;
  PointIndex index_;
  std::vector<Index> trials_;
};

// Turns the plane through the axis and `along` into itself the other way round: a mirror, or a half turn about `along`.
Matrix3d flip(const Vector3d& axis, const Vector3d& along, bool half_turn) {
  if (half_turn) return 2 * along * along.transpose() - Matrix3d::Identity();
  const Vector3d normal = axis.cross(along);
  return Matrix3d::Identity() - 2 * normal * normal.transpose();
}

// A direction across the axis along which a flip disturbs the places least, averaged over the pairs it makes.
Vector3d flip_direction(const Vector3d& axis, const Turned& turned, bool half_turn) {
  const Vector3d right = axis.unitOrthogonal();
  const Vector3d up = axis.cross(right);
  const auto across = [&](Index i) {
    const Vector3d point = turned.points().row(i);
    return std::complex<double>(point.dot(right), point.dot(up));
  };
  const auto direction = [&](double angle) -> Vector3d { return std::cos(angle) * right + std::sin(angle) * up; };
  double widest = 0;
  for (const Index i : turned.trials()) widest = std::max(widest, std::abs(across(i)));
  double best = std::numeric_limits<double>::infinity();
  double angle = 0;
  const std::size_t step = std::max<std::size_t>(1, turned.trials().size() / kMirrorTrials);
  for (std::size_t t = 0; t < turned.trials().size(); t += step) {
    const std::complex<double> place = across(turned.trials()[t]);
    if (std::abs(place) < 0.1 * widest) continue;
    const double error = turned.error(flip(axis, direction(std::arg(place)), half_turn));
    if (error >= best) continue;
    best = error;
    angle = std::arg(place);
  }
  // Place and image lie at angles whose mean is the direction's.
  std::complex<double> sum = 0;
  const Matrix3d found = flip(axis, direction(angle), half_turn);
  for (const Index i : turned.trials()) sum += across(i) * across(turned.image(found, i));
  return direction(std::arg(sum) / 2);
}

// The same of a known motion that flips the region about its axis.
std::optional<Vector3d> known_direction(const Region& region, const std::vector<Motion>& known, bool half_turn,
                                        double scale) {
  for (const Motion& motion : known) {
    if ((motion(region.centre) - region.centre).norm() > kSame * scale) continue;
    const AxisAngle turn = axis_angle(motion.linear);
    const bool flips = half_turn == (turn.determinant > 0) && std::abs(turn.angle - std::numbers::pi) < kSame;
    if (!flips || std::abs(turn.axis.dot(region.axis)) > kSame) continue;
    return half_turn ? turn.axis : Vector3d(region.axis.normalized().cross(turn.axis).normalized());
  }
  return std::nullopt;
}

// The region with the finite counterpart of an order of its group. \param other_direction  of its flips, given whether
// they are half turns, where none is known
template <typename Direction>
Region turned_region(const Region& region, int order, const std::vector<Motion>& known, double scale,
                     const Direction& other_direction) {
  const Vector3d axis = region.axis.normalized();
  const PointGroup group = finite_counterpart(region.group, order);
  GroupFrame frame = frame_about(axis);
  if (group.family != Family::Cn && group.family != Family::Cnh) {
    const bool half_turn = group.family == Family::Dn;
    const std::optional<Vector3d> told = known_direction(region, known, half_turn, scale);
    const Vector3d along = told ? *told : other_direction(half_turn);
    frame = frame_about(axis, group.family == Family::Cnv ? Vector3d(axis.cross(along)) : along);
  }
  Region result = make_region(group, region.centre, frame, region.faces, region.name);
  result.id = region.id;
  result.parent = region.parent;
  return result;
}

}  // namespace

std::optional<Region> conjugated_region(const Region& from, const Region& to, const std::vector<Motion>& known,
                                        double scale) {
  for (const Motion& motion : known) {
    if ((motion.linear * from.axis).cross(to.axis).norm() > kSame) continue;
    if ((motion(from.centre) - to.centre).cross(to.axis).norm() > kSame * scale) continue;
    Region result = to;
    result.group = from.group;
    for (std::vector<Motion>* list : {&result.generators, &result.elements}) list->clear();
    for (const Motion& generator : from.generators) result.generators.push_back(conjugate(motion, generator));
    for (const Motion& element : from.elements) result.elements.push_back(conjugate(motion, element));
    return result;
  }
  return std::nullopt;
}

std::optional<Region> turning_region(const Region& region, const Points& places, double reach,
                                     const std::vector<Motion>& known) {
  if (!region.group.has_axis() || places.rows() < 3) return std::nullopt;
  const Turned turned(places, region.centre);
  const Vector3d axis = region.axis.normalized();
  const auto turn = [&](int n) { return axis_rotation(axis, 2 * std::numbers::pi / n); };
  std::vector<double> errors;
  for (int n = 3; n <= kFinest; ++n) errors.push_back(turned.error(turn(n)));
  const double least = *std::ranges::min_element(errors);
  if (!(least <= reach)) return std::nullopt;
  const double enough = kAsGood * least + 1e-9 * diagonal(turned.points());
  int order = kFinest;
  while (order >= 3 && !(errors[static_cast<std::size_t>(order - 3)] <= enough && turned.closes(turn(order), order))) {
    --order;
  }
  if (order < 3) return std::nullopt;
  return turned_region(region, order, known, diagonal(turned.points()),
                       [&](bool half_turn) { return flip_direction(axis, turned, half_turn); });
}

std::optional<Region> even_region(const Region& region, double scale, const std::vector<Motion>& known) {
  constexpr int kOrder = 24;
  if (!region.group.has_axis()) return std::nullopt;
  return turned_region(region, kOrder, known, scale,
                       [&](bool /*half_turn*/) -> Vector3d { return region.axis.unitOrthogonal(); });
}

}  // namespace orbifit
