#include "orbifit/subspace/shared_axes.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "orbifit/model/dense.h"
#include "orbifit/subspace/orbit.h"

namespace orbifit {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Family = PointGroup::Family;

// A region's group as a frame at a centre, with its extent.
struct Placement {
  Vector3d centre;
  GroupFrame frame;
  std::vector<Motion> elements;  // for a continuous group some of them, which fix the same points
  double reach = 0;
};

// Elements that share the fixed points of a continuous group and none of the arbitrary mirrors.
std::vector<Motion> stand_in(const Region& region) {
  const Family family = region.group.family;
  PointGroup group{Family::Cn, 8};
  if (family == Family::Cinfh || family == Family::Dinf || family == Family::Dinfh) group.family = Family::Cnh;
  if (family == Family::K || family == Family::Kh) group = {Family::Ci, 1};
  const GroupFrame frame = group.has_axis() ? frame_about(region.axis) : GroupFrame::Identity();
  return make_region(group, region.centre, frame, {}, "").elements;
}

std::optional<Placement> placement_of(const Mesh& mesh, const Region& region) {
  Placement placement;
  placement.centre = region.centre;
  if (region.group.continuous()) {
    placement.frame = region.group.has_axis() ? frame_about(region.axis) : GroupFrame::Identity();
    placement.elements = stand_in(region);
  } else {
    std::vector<Matrix3d> linear;
    for (const Motion& element : region.elements) linear.push_back(element.linear);
    const auto classified = classify(linear);
    if (!classified || classified->group != region.group) return std::nullopt;
    placement.frame = classified->frame;
    placement.elements = region.elements;
  }
  for (const int face : region.faces) {
    for (const int vertex : mesh.faces.row(face)) {
      placement.reach = std::max(placement.reach, (mesh.vertices.row(vertex).transpose() - placement.centre).norm());
    }
  }
  return placement;
}

struct Direction {
  Vector3d axis;  // unit, of either sign
  AxisAngle turn;
};

constexpr double kNoTurn = 1e-6;

std::vector<Direction> directions(const std::vector<Motion>& elements) {
  std::vector<Direction> result;
  for (const Motion& element : elements) {
    const AxisAngle turn = axis_angle(element.linear);
    if (turn.angle > kNoTurn) result.push_back({turn.axis, turn});  // else its axis is rounding's
  }
  return result;
}

Matrix3d cross_matrix(const Vector3d& v) {
  Matrix3d result;
  result << 0, -v[2], v[1], v[2], 0, -v[0], -v[1], v[0], 0;
  return result;
}

// The smallest rotation w after which every motion of the stabiliser maps the group's axes onto its axes, so that the
// two close together: Gauss-Newton on O_h exp[w] d = +-exp[w] d', d' being the axis of the same kind nearest to O_h d.
Matrix3d settling_turn(const std::vector<Direction>& own, const std::vector<Motion>& stabiliser, double most) {
  constexpr int kRounds = 6;
  constexpr double kPinnedRank = 1e-6;
  Matrix3d total = Matrix3d::Identity();
  for (int round = 0; round < kRounds; ++round) {
    Matrix3d normal = Matrix3d::Zero();
    Vector3d side = Vector3d::Zero();
    for (const Motion& motion : stabiliser) {
      for (const Direction& from : own) {
        const Vector3d axis = total * from.axis;
        const Vector3d image = motion.linear * axis;
        Vector3d nearest = Vector3d::Zero();
        double best = std::cos(most);
        for (const Direction& to : own) {
          if (to.turn.determinant != from.turn.determinant || std::abs(to.turn.angle - from.turn.angle) > 1e-6)
            continue;
          const Vector3d other = total * to.axis;
          const double cosine = image.dot(other);
          if (std::abs(cosine) <= best) continue;
          best = std::abs(cosine);
          nearest = cosine > 0 ? other : Vector3d(-other);
        }
        if (nearest.isZero(0)) continue;
        const Matrix3d slope = cross_matrix(nearest) - motion.linear * cross_matrix(axis);
        normal += slope.transpose() * slope;
        side -= slope.transpose() * (image - nearest);
      }
    }
    const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(normal);
    Vector3d w = Vector3d::Zero();
    for (int k = 0; k < 3; ++k) {
      if (solver.eigenvalues()[k] < kPinnedRank * std::max(1.0, solver.eigenvalues()[2])) continue;
      w += solver.eigenvectors().col(k) * solver.eigenvectors().col(k).dot(side) / solver.eigenvalues()[k];
    }
    if (w.norm() > 0) total = axis_rotation(w.normalized(), w.norm()) * total;
    if (w.norm() < 1e-15) break;
  }
  return total;
}

double angle_of(const Matrix3d& turn) {
  return axis_angle(turn).angle;
}

bool overlap(const std::vector<int>& a, const std::vector<int>& b) {
  auto i = a.begin();
  auto j = b.begin();
  while (i != a.end() && j != b.end()) {
    if (*i == *j) return true;
    *i < *j ? ++i : ++j;
  }
  return false;
}

// Projects onto the directions in which the group's centre is determined: a mirror's plane and a polar axis leave it
// free along them.
Matrix3d pinned(const Region& region) {
  const Vector3d axis = region.axis.normalized();
  switch (region.group.family) {
    case Family::Cs:
      return axis * axis.transpose();
    case Family::Cn:
    case Family::Cnv:
    case Family::Cinf:
    case Family::Cinfv:
      return Matrix3d::Identity() - axis * axis.transpose();
    default:
      return Matrix3d::Identity();
  }
}

// Whether the motion takes the group's fixed points to themselves, to `tolerance` at the centre and `most` radians.
bool keeps_fixed_points(const Motion& motion, const Region& region, double tolerance, double most) {
  const Matrix3d across = pinned(region);
  const Vector3d moved = motion(region.centre) - region.centre;
  if ((across * moved).norm() > tolerance) return false;
  if (across.isIdentity(0)) return true;
  const Vector3d axis = region.axis.normalized();
  return std::abs(axis.dot(motion.linear * axis)) > std::cos(most);
}

// The region rebuilt at the new place, `distance` away as a fraction of the diagonal.
Region moved(const Region& region, const Placement& now, double distance) {
  Region result = make_region(region.group, now.centre, now.frame, region.faces, region.name);
  result.id = region.id;
  result.parent = region.parent;
  result.residual = {region.residual.rms + distance, region.residual.max + distance};
  return result;
}

// Whether two regions have the same group at the same place, to `tolerance` on their extent.
bool nearly_the_same(const Region& a, const Region& b, double reach, double tolerance) {
  if (a.group.has_axis() && a.axis.cross(b.axis).norm() * reach > 2 * tolerance) return false;
  return std::ranges::all_of(a.elements, [&](const Motion& m) {
    return std::ranges::any_of(b.elements,
                               [&](const Motion& n) { return (m.linear - n.linear).norm() * reach < 2 * tolerance; });
  });
}

// Region `number` as the exact image of an earlier one of its group under an element of a third that overlaps it.
std::optional<Region> image_of_earlier(const std::vector<Region>& regions,
                                       const std::vector<std::optional<Placement>>& placements, std::size_t number,
                                       const Placement& before, double tolerance) {
  const Region& region = regions[number];
  for (std::size_t c = 0; c < number; ++c) {
    const Region& other = regions[c];
    if (!placements[c] || other.group != region.group || other.faces.size() != region.faces.size()) continue;
    for (std::size_t a = 0; a < number; ++a) {
      if (!placements[a] || a == c || !overlap(regions[a].faces, other.faces)) continue;
      for (const Motion& element : placements[a]->elements) {
        const Vector3d centre = element(placements[c]->centre);
        if ((centre - before.centre).norm() > tolerance) continue;
        GroupFrame frame = element.linear * placements[c]->frame;
        if (frame.determinant() < 0) frame.col(1) = -frame.col(1);
        Region image = make_region(region.group, centre, frame, region.faces, region.name);
        if (!nearly_the_same(image, region, before.reach, tolerance)) continue;
        image.id = region.id;
        image.parent = region.parent;
        image.residual = region.residual;
        return image;
      }
    }
  }
  return std::nullopt;
}

}  // namespace

SymmetryAnnotation share_axes(const Mesh& mesh, const SymmetryAnnotation& annotation, double tolerance, MayMove which) {
  constexpr double kMostTurn = 0.2;
  const double size = diagonal(mesh.vertices);
  const auto reach_of = [&](const Region& region, const Placement& placement) {
    constexpr double kOfSize = 0.002;
    constexpr double kOfMisfit = 5;
    // Regions move by twice that and their images by twice as much again: half the tolerance, or they no longer fit.
    constexpr double kOfTolerance = 0.125;
    if (which == MayMove::all) return tolerance * size;
    return std::min(kOfTolerance * tolerance * size,
                    kOfSize * placement.reach + kOfMisfit * region.residual.rms * size);
  };
  // Larger regions first: what is around a region stands before the region itself.
  std::vector<std::size_t> order(annotation.regions.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) {
    return annotation.regions[a].faces.size() > annotation.regions[b].faces.size();
  });
  std::vector<Region> regions;
  regions.reserve(order.size());
  for (const std::size_t number : order) regions.push_back(annotation.regions[number]);
  std::vector<std::optional<Placement>> placements;
  for (std::size_t b = 0; b < regions.size(); ++b) {
    Region& region = regions[b];
    const std::optional<Placement> before = placement_of(mesh, region);
    placements.push_back(before);
    if (!before) continue;
    const double reach = reach_of(region, *before);
    if (const auto image = image_of_earlier(regions, placements, b, *before, reach)) {
      region = *image;
    } else {
      Placement after = *before;
      std::vector<Motion> stabiliser;
      const double most = std::min(kMostTurn, 2 * reach / std::max(before->reach, reach));
      for (std::size_t a = 0; a < b; ++a) {
        if (!placements[a] || !overlap(regions[a].faces, region.faces)) continue;
        for (const Motion& element : placements[a]->elements) {
          if (keeps_fixed_points(element, region, 2 * reach, most)) stabiliser.push_back(element);
        }
      }
      const Matrix3d turn = settling_turn(directions(before->elements), stabiliser, most);
      after.frame = turn * before->frame;
      // Turned about the point of its axis or plane that comes nearest to being fixed; then moved across them.
      const Matrix3d across = pinned(region);
      const Matrix3d across_now = turn * across * turn.transpose();
      const Vector3d fixed = fixed_point(before->centre, stabiliser);
      const Vector3d pivot = fixed - across * (fixed - before->centre);
      const Vector3d centre = pivot + across_now * (fixed - pivot);
      after.centre = before->centre + across_now * (centre - before->centre);
      const double distance = (centre - pivot).norm() + before->reach * angle_of(turn);
      if (distance <= 2 * reach) region = moved(region, after, distance / size);
    }
    placements[b] = placement_of(mesh, region);
  }
  SymmetryAnnotation result = annotation;
  for (std::size_t i = 0; i < order.size(); ++i) result.regions[order[i]] = regions[i];
  return result;
}

}  // namespace orbifit
