#include "orbifit/subspace/shared_axes.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "orbifit/subspace/orbit.h"

namespace orbifit {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// A region's group as a frame at a centre, with its extent.
struct Placement {
  Vector3d centre;
  GroupFrame frame;
  std::vector<Motion> elements;  // for a continuous group some of them, which fix the same points
  double reach = 0;
};

// Elements that share the fixed points of a continuous group and none of the arbitrary mirrors.
std::vector<Motion> stand_in(const Region& region) {
  using Family = PointGroup::Family;
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

std::vector<Vector3d> directions(const std::vector<Motion>& elements) {
  std::vector<Vector3d> result;
  for (const Motion& element : elements) {
    const Vector3d axis = axis_angle(element.linear).axis;
    if (axis.norm() > 0.5) result.push_back(axis);
  }
  return result;
}

// The smallest rotation that takes a direction of `own` onto one of `others`, up to sign, if below `most` radians.
Matrix3d smallest_turn(const std::vector<Vector3d>& own, const std::vector<Vector3d>& others, double most) {
  double best = most;
  Matrix3d turn = Matrix3d::Identity();
  for (const Vector3d& from : own) {
    for (Vector3d to : others) {
      if (to.dot(from) < 0) to = -to;
      const Vector3d cross = from.cross(to);
      const double angle = std::atan2(cross.norm(), from.dot(to));
      if (angle >= best) continue;
      best = angle;
      turn = angle > 1e-15 ? axis_rotation(cross.normalized(), angle) : Matrix3d(Matrix3d::Identity());
    }
  }
  return turn;
}

double angle_of(const Matrix3d& turn) {
  return axis_angle(turn).angle;
}

// Turns `placement` so that its main axis, then a direction across it, are among those of `around`.
void share_directions(Placement& placement, const std::vector<Vector3d>& around, bool has_axis, double most) {
  std::vector<Vector3d> own = directions(placement.elements);
  std::vector<Vector3d> main = has_axis ? std::vector<Vector3d>{placement.frame.col(2)} : own;
  const Matrix3d first = smallest_turn(main, around, most);
  placement.frame = first * placement.frame;
  if (!has_axis) return;
  const auto across = [&](const std::vector<Vector3d>& all, const Matrix3d& turn) {
    std::vector<Vector3d> result;
    for (const Vector3d& direction : all) {
      const Vector3d flat = turn * direction - placement.frame.col(2) * placement.frame.col(2).dot(turn * direction);
      if (flat.norm() > std::cos(most)) result.push_back(flat.normalized());
    }
    return result;
  };
  placement.frame = smallest_turn(across(own, first), across(around, Matrix3d::Identity()), most) * placement.frame;
}

// Moves a placement onto the elements of `around` that nearly fix its centre.
void share_with(const Placement& around, bool has_axis, double tolerance, Placement& placement) {
  std::vector<Motion> stabiliser;
  for (const Motion& element : around.elements) {
    if ((element(placement.centre) - placement.centre).norm() <= 2 * tolerance) stabiliser.push_back(element);
  }
  if (stabiliser.size() < 2) return;
  placement.centre = fixed_point(placement.centre, stabiliser);
  share_directions(placement, directions(stabiliser), has_axis, tolerance / std::max(placement.reach, tolerance));
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

// The region rebuilt at the new place, or as it was if that is farther than allowed.
Region moved(const Region& region, const Placement& before, const Placement& after, double tolerance, double size) {
  const double distance =
      (after.centre - before.centre).norm() + before.reach * angle_of(after.frame * before.frame.transpose());
  if (distance > 2 * tolerance) return region;
  Region result = make_region(region.group, after.centre, after.frame, region.faces, region.name);
  result.id = region.id;
  result.parent = region.parent;
  result.residual = {region.residual.rms + distance / size, region.residual.max + distance / size};
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

SymmetryAnnotation share_axes(const Mesh& mesh, const SymmetryAnnotation& annotation, double tolerance) {
  const double size = diagonal(mesh.vertices);
  const double reach = tolerance * size;
  SymmetryAnnotation result = annotation;
  std::vector<std::optional<Placement>> placements;
  for (std::size_t b = 0; b < result.regions.size(); ++b) {
    Region& region = result.regions[b];
    const std::optional<Placement> before = placement_of(mesh, region);
    placements.push_back(before);
    if (!before) continue;
    Placement after = *before;
    for (std::size_t a = 0; a < b; ++a) {
      if (placements[a] && overlap(result.regions[a].faces, region.faces)) {
        share_with(*placements[a], region.group.has_axis(), reach, after);
      }
    }
    region = moved(region, *before, after, reach, size);
    if (const auto image = image_of_earlier(result.regions, placements, b, *before, reach)) region = *image;
    placements[b] = placement_of(mesh, region);
  }
  return result;
}

}  // namespace orbifit
