#include "consistency/group_place.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <Eigen/Geometry>
#include <Eigen/SVD>

namespace orbifit {

namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using Family = PointGroup::Family;

constexpr double kTurn = 1;  // radian: no finite rotation about the axis
constexpr double kFar = std::numeric_limits<double>::infinity();

bool spherical(const PointGroup& group) {
  return group.family == Family::K || group.family == Family::Kh;
}

// Whether a continuous group about an axis fixes one point of it.
bool has_centre(const PointGroup& group) {
  return group.family == Family::Cinfh || group.family == Family::Dinf || group.family == Family::Dinfh;
}

GroupPlace turned(const GroupPlace& place, const VectorXd& x, double reach) {
  GroupPlace result = place;
  const Vector3d turn = x.head<3>() / reach;
  const double angle = turn.norm();
  if (angle > 0) result.frame = axis_rotation(turn / angle, angle) * place.frame;
  result.centre = place.centre + x.tail<3>();
  return result;
}

// The difference of two motions on an extent, as lengths.
void add_difference(const Motion& a, const Motion& b, const Extent& extent, std::vector<double>& rows) {
  const Matrix3d linear = extent.reach * (a.linear - b.linear);
  const Vector3d moved = a(extent.centre) - b(extent.centre);
  rows.insert(rows.end(), linear.data(), linear.data() + 9);
  rows.insert(rows.end(), moved.data(), moved.data() + 3);
}

int nearest(const Motion& motion, const std::vector<Motion>& among, const Extent& extent, double& best) {
  int found = -1;
  best = kFar;
  for (std::size_t i = 0; i < among.size(); ++i) {
    const double d = distance(motion, among[i], extent);
    if (d < best) {
      best = d;
      found = static_cast<int>(i);
    }
  }
  return found;
}

// The element of a continuous group nearest to a matrix that turns or mirrors; nothing where none of its components
// does alike.
std::optional<Matrix3d> nearest_of_continuous(const GroupPlace& place, const Matrix3d& linear) {
  const bool proper = linear.determinant() > 0;
  const Family family = place.group.family;
  if (family == Family::Kh || (family == Family::K && proper)) return linear;
  if (family == Family::K) return std::nullopt;
  const Matrix3d local = place.frame.transpose() * linear * place.frame;
  const bool upright = local(2, 2) > 0;
  const bool has = [&] {
    if (upright && proper) return true;
    if (upright) return family == Family::Cinfv || family == Family::Dinfh;
    if (proper) return family == Family::Dinf || family == Family::Dinfh;
    return family == Family::Cinfh || family == Family::Dinfh;
  }();
  if (!has) return std::nullopt;
  const double side = proper == upright ? 1 : -1;  // of the plane across the axis: turned, or mirrored
  const double angle = std::atan2(local(1, 0) - side * local(0, 1), local(0, 0) + side * local(1, 1));
  Matrix3d result = Matrix3d::Zero();
  result << std::cos(angle), -side * std::sin(angle), 0, std::sin(angle), side * std::cos(angle), 0, 0, 0,
      upright ? 1 : -1;
  return place.frame * result * place.frame.transpose();
}

// From a motion to the nearest element of a group. \param among  its elements, of a finite one
double distance_from(const Motion& motion, const GroupPlace& place, const std::vector<Motion>& among,
                     const Extent& extent) {
  double best = kFar;
  if (place.group.continuous()) {
    const std::optional<Matrix3d> linear = nearest_of_continuous(place, motion.linear);
    if (linear) best = distance(motion, Motion::about(*linear, place.centre), extent);
  } else {
    nearest(motion, among, extent, best);
  }
  return best;
}

struct Match {
  const Tie* tie;
  std::size_t mark;
  std::size_t member;
};

Motion way_of(const Tie& tie, const GroupPlace& place) {
  if (tie.own < 0) return tie.before * tie.after;
  return tie.before * marks(place)[static_cast<std::size_t>(tie.own)] * tie.after;
}

VectorXd as_vector(const std::vector<double>& rows) {
  return Eigen::Map<const VectorXd>(rows.data(), static_cast<Index>(rows.size()));
}

// A direction that a mark of the place takes to another, or to its opposite.
struct TurnedDirection {
  std::size_t mark;
  Vector3d from, to;
};

std::vector<TurnedDirection> turned_directions(const GroupPlace& place, const std::vector<Vector3d>& directions,
                                               const Extent& extent, double near) {
  std::vector<TurnedDirection> result;
  const std::vector<Motion> all = marks(place);
  for (std::size_t m = 0; m < all.size(); ++m) {
    for (const Vector3d& from : directions) {
      for (const Vector3d& to : directions) {
        for (const double sign : {1.0, -1.0}) {
          if (extent.reach * (all[m].linear * from - sign * to).norm() <= near) result.push_back({m, from, sign * to});
        }
      }
    }
  }
  return result;
}

// Nothing where a tie takes a mark to no member.
std::optional<std::vector<Match>> matches_of(const std::vector<Tie>& ties, const GroupPlace& place, double near) {
  std::vector<Match> result;
  for (const Tie& tie : ties) {
    const Motion way = way_of(tie, place);
    const std::vector<Motion> among = members(tie.to ? *tie.to : place);
    const std::vector<Motion> from = marks(tie.from ? *tie.from : place);
    for (std::size_t m = 0; m < from.size(); ++m) {
      double best = 0;
      const int member = nearest(conjugate(way, from[m]), among, tie.extent, best);
      if (best > near) return std::nullopt;
      result.push_back({&tie, m, static_cast<std::size_t>(member)});
    }
  }
  return result;
}

// A motion, and the member of the place's group that is to be it.
using Aim = std::pair<Motion, std::size_t>;

std::vector<Aim> aims_of(const GroupPlace& place, const std::vector<GroupPlace>& wanted, const Extent& extent,
                         double near) {
  std::vector<Aim> result;
  const std::vector<Motion> among = members(place);
  const auto add = [&](const GroupPlace& aim) {
    for (const Motion& mark : marks(aim)) {
      double best = 0;
      const int member = nearest(mark, among, extent, best);
      if (best <= 2 * near) result.emplace_back(mark, static_cast<std::size_t>(member));
    }
  };
  add(place);
  for (const GroupPlace& aim : wanted) add(aim);
  return result;
}

}  // namespace

std::optional<GroupPlace> place_of(const Region& region) {
  GroupPlace place{region.group, region.centre, GroupFrame::Identity()};
  if (region.group.continuous()) {
    if (region.group.has_axis()) place.frame = frame_about(region.axis.normalized());
    return place;
  }
  std::vector<Matrix3d> linear;
  for (const Motion& element : region.elements) linear.push_back(element.linear);
  const auto classified = classify(linear);
  if (!classified || !(classified->group == region.group)) return std::nullopt;
  place.frame = classified->frame;
  return place;
}

std::vector<Motion> marks(const GroupPlace& place) {
  std::vector<Motion> result;
  if (!place.group.continuous()) {
    for (const Matrix3d& linear : generators(place.group, place.frame)) {
      result.push_back(Motion::about(linear, place.centre));
    }
    return result;
  }
  if (spherical(place.group)) return {Motion::about(-Matrix3d::Identity(), place.centre)};
  result.push_back(Motion::rotation(place.frame.col(2), kTurn, place.centre));
  if (has_centre(place.group)) result.push_back(Motion::reflection(place.frame.col(2), place.centre));
  return result;
}

std::vector<Motion> members(const GroupPlace& place) {
  std::vector<Motion> result;
  if (!place.group.continuous()) {
    for (const Matrix3d& linear : elements(place.group, place.frame)) {
      result.push_back(Motion::about(linear, place.centre));
    }
    return result;
  }
  result = marks(place);
  if (!spherical(place.group)) result.push_back(Motion::rotation(place.frame.col(2), -kTurn, place.centre));
  return result;
}

std::vector<Motion> movers(const GroupPlace& place) {
  switch (place.group.family) {
    case Family::Cinf:
    case Family::Cinfv:
    case Family::K:
      return {};
    case Family::Kh:
      return {Motion::about(-Matrix3d::Identity(), place.centre)};
    case Family::Cinfh:
    case Family::Dinfh:
      return {Motion::reflection(place.frame.col(2), place.centre)};
    case Family::Dinf:
      return {Motion::rotation(place.frame.col(0), std::numbers::pi, place.centre)};
    default:
      return marks(place);
  }
}

GroupPlace turning_part(const GroupPlace& place) {
  return {{spherical(place.group) ? Family::K : Family::Cinf, 1}, place.centre, place.frame};
}

GroupPlace image_of(const GroupPlace& place, const Motion& motion) {
  GroupPlace result{place.group, motion(place.centre), motion.linear * place.frame};
  if (result.frame.determinant() < 0) result.frame.col(1) = -result.frame.col(1);
  return result;
}

double group_distance(const GroupPlace& from, const Motion& way, const GroupPlace& to, const Extent& extent) {
  if (!(from.group == to.group)) return kFar;
  const std::vector<Motion> among = members(to);
  double worst = 0;
  for (const Motion& mark : marks(from)) {
    double best = 0;
    nearest(conjugate(way, mark), among, extent, best);
    worst = std::max(worst, best);
  }
  return worst;
}

double distance_from_within(const GroupPlace& inner, const GroupPlace& outer, const Extent& extent) {
  if (inner.group.continuous() && !outer.group.continuous()) return kFar;
  if (spherical(inner.group) && !spherical(outer.group)) return kFar;
  std::vector<Motion> asked = marks(inner);
  const std::vector<Motion> moving = movers(inner);
  asked.insert(asked.end(), moving.begin(), moving.end());
  if (inner.group.family == Family::Cinfv || inner.group.family == Family::Dinfh) {
    asked.push_back(Motion::reflection(inner.frame.col(0), inner.centre));
  }
  const std::vector<Motion> among = outer.group.continuous() ? std::vector<Motion>{} : members(outer);
  double worst = 0;
  for (const Motion& motion : asked) worst = std::max(worst, distance_from(motion, outer, among, extent));
  return worst;
}

std::size_t common_members(const GroupPlace& finite, const GroupPlace& other, const Extent& extent, double tolerance) {
  const std::vector<Motion> among = other.group.continuous() ? std::vector<Motion>{} : members(other);
  const std::vector<Motion> all = members(finite);
  return static_cast<std::size_t>(std::ranges::count_if(
      all, [&](const Motion& motion) { return distance_from(motion, other, among, extent) <= tolerance; }));
}

VectorXd nearest_solution(Index unknowns, const std::function<VectorXd(const VectorXd&)>& hard,
                          const std::function<VectorXd(const VectorXd&)>& soft, double scale) {
  constexpr int kRounds = 12;
  constexpr double kRank = 1e-4;    // of the largest singular value
  constexpr double kStep = 1e-5;    // of the scale, for derivatives
  constexpr double kStill = 1e-15;  // of the scale
  const auto derivative = [&](const auto& function, const VectorXd& x, Index rows) {
    MatrixXd result(rows, unknowns);
    for (Index k = 0; k < unknowns; ++k) {
      const VectorXd step = VectorXd::Unit(unknowns, k) * kStep * scale;
      result.col(k) = (function(x + step) - function(x - step)) / (2 * kStep * scale);
    }
    return result;
  };
  const auto solve = [&](const MatrixXd& matrix, const VectorXd& right, MatrixXd* free) {
    const Eigen::JacobiSVD<MatrixXd> svd(matrix, Eigen::ComputeThinU | Eigen::ComputeFullV);
    const VectorXd& values = svd.singularValues();
    VectorXd result = VectorXd::Zero(matrix.cols());
    Index rank = 0;
    while (rank < values.size() && values[rank] > kRank * std::max(values[0], kRank)) ++rank;
    for (Index k = 0; k < rank; ++k) result += svd.matrixV().col(k) * (svd.matrixU().col(k).dot(right) / values[k]);
    if (free != nullptr) *free = svd.matrixV().rightCols(matrix.cols() - rank);
    return result;
  };
  VectorXd x = VectorXd::Zero(unknowns);
  for (int round = 0; round < kRounds; ++round) {
    const VectorXd missed = hard(x);
    MatrixXd free = MatrixXd::Identity(unknowns, unknowns);
    VectorXd step = VectorXd::Zero(unknowns);
    if (missed.size() > 0) step = solve(derivative(hard, x, missed.size()), -missed, &free);
    // The last rounds only meet what is asked.
    if (round < kRounds - 3 && free.cols() > 0) {
      const VectorXd off = soft(x);
      const MatrixXd slope = derivative(soft, x, off.size());
      step += free * solve(slope * free, -(off + slope * step), nullptr);
    }
    x += step;
    if (step.norm() < kStill * scale) break;
  }
  return x;
}

std::optional<PlaceFit> fitted_place(const GroupPlace& start, const std::vector<GroupPlace>& wanted,
                                     const std::vector<Tie>& ties, const Extent& extent, double near,
                                     const std::vector<Vector3d>& directions) {
  const std::vector<TurnedDirection> turns = turned_directions(start, directions, extent, near);
  const std::optional<std::vector<Match>> matches = matches_of(ties, start, near);
  if (!matches) return std::nullopt;
  const std::vector<Aim> aims = aims_of(start, wanted, extent, near);
  const auto hard = [&](const VectorXd& x) {
    const GroupPlace now = turned(start, x, extent.reach);
    const std::vector<Motion> own_members = members(now);
    const std::vector<Motion> own_marks = marks(now);
    std::vector<double> rows;
    const Tie* last = nullptr;
    Motion way;
    std::vector<Motion> to_members, from_marks;
    for (const Match& match : *matches) {
      const Tie& tie = *match.tie;
      if (last != &tie) {
        way = way_of(tie, now);
        if (tie.to) to_members = members(*tie.to);
        if (tie.from) from_marks = marks(*tie.from);
        last = &tie;
      }
      const Motion image = conjugate(way, (tie.from ? from_marks : own_marks)[match.mark]);
      add_difference(image, (tie.to ? to_members : own_members)[match.member], tie.extent, rows);
    }
    for (const TurnedDirection& each : turns) {
      const Vector3d off = extent.reach * (own_marks[each.mark].linear * each.from - each.to);
      rows.insert(rows.end(), off.data(), off.data() + 3);
    }
    return as_vector(rows);
  };
  const auto soft = [&](const VectorXd& x) {
    const std::vector<Motion> own = members(turned(start, x, extent.reach));
    std::vector<double> rows;
    for (const auto& [motion, member] : aims) add_difference(motion, own[member], extent, rows);
    return as_vector(rows);
  };
  PlaceFit fit;
  if (matches->empty() && wanted.empty() && turns.empty()) {
    fit.place = start;
    return fit;
  }
  const VectorXd x = nearest_solution(6, hard, soft, extent.reach);
  fit.place = turned(start, x, extent.reach);
  const VectorXd missed = hard(x);
  if (missed.size() > 0) fit.unmet = missed.cwiseAbs().maxCoeff();
  return fit;
}

}  // namespace orbifit
