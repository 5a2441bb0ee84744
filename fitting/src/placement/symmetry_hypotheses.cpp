#include "placement/symmetry_hypotheses.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <Eigen/Geometry>

namespace orbifit {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// The plane of a reflection; none for other motions.
std::optional<SymmetryElement> plane_of(const Motion& motion) {
  constexpr double kRounding = 1e-6;
  if (motion.linear.determinant() > 0 || std::abs(motion.linear.trace() - 1) > kRounding) return std::nullopt;
  const Vector3d normal = axis_angle(motion.linear).axis;
  return SymmetryElement{SymmetryElement::Kind::plane, motion.translation / 2, normal, 1};
}

bool same_plane(const SymmetryElement& a, const SymmetryElement& b, double size) {
  constexpr double kSame = 0.01;  // radians, of the size
  return a.direction.cross(b.direction).norm() < kSame && std::abs(a.direction.dot(b.point - a.point)) < kSame * size;
}

// A point as a plane or an axis has it: how far it is, and a frame of the element's direction and of the normal's part
// along the plane, or of the direction from the axis to the point.
struct Sighting {
  double distance;  // signed over a plane
  Matrix3d frame;
};

// None where the normal or the distance says too little.
std::optional<Sighting> sighting(const SymmetryElement& element, const Vector3d& point, const Vector3d& normal,
                                 double least) {
  constexpr double kMinTurn = 0.3;
  const Vector3d arm = point - element.point;
  const double along = element.direction.dot(arm);
  Sighting result;
  Vector3d across;
  if (element.kind == SymmetryElement::Kind::plane) {
    result.distance = along;
    across = normal - element.direction.dot(normal) * element.direction;
    if (across.norm() < kMinTurn) return std::nullopt;
  } else {
    across = arm - along * element.direction;
    result.distance = across.norm();
  }
  if (std::abs(result.distance) < least) return std::nullopt;
  result.frame.col(0) = element.direction;
  result.frame.col(1) = across.normalized();
  result.frame.col(2) = result.frame.col(0).cross(result.frame.col(1));
  return result;
}

}  // namespace

std::vector<SymmetryElement> template_symmetries(const Mesh& mesh, const SymmetryAnnotation& annotation) {
  constexpr double kMinMirrored = 0.4;  // of the area
  constexpr double kMinTurned = 0.15;
  const double size = diagonal(mesh.vertices);
  const Eigen::VectorXd areas = face_areas(mesh);
  std::vector<SymmetryElement> result;
  const auto known = [&](const SymmetryElement& element, const std::vector<Motion>& elements) {
    return std::ranges::any_of(result, [&](const SymmetryElement& other) {
      if (other.kind != element.kind) return false;
      return same_plane(other, element, size) || std::ranges::any_of(elements, [&](const Motion& motion) {
               return same_plane({other.kind, motion(other.point), motion.linear * other.direction, 1}, element, size);
             });
    });
  };
  for (const Region& region : annotation.regions) {
    const double share = areas(region.faces).sum() / areas.sum();
    if (region.group.continuous() && region.group.has_axis() && share >= kMinTurned) {
      result.push_back({SymmetryElement::Kind::axis, region.centre, region.axis, 1});
    }
    if (share < kMinMirrored) continue;
    for (const Motion& motion : region.elements) {
      const std::optional<SymmetryElement> plane = plane_of(motion);
      if (plane && !known(*plane, region.elements)) result.push_back(*plane);
    }
  }
  return result;
}

SymmetryHypotheses::SymmetryHypotheses(const SurfaceSamples& samples, std::vector<SymmetryElement> own)
    : samples_(samples), own_(std::move(own)), least_(0.04 * diagonal(samples.points)) {}

void SymmetryHypotheses::propose(const SymmetryElement& of_scan, const Vector3d& p, const Vector3d& p_normal, int most,
                                 Random& random, const std::function<void(const Similarity&)>& take) const {
  constexpr int kLooks = 8;             // for each pose
  constexpr double kCompatible = 0.92;  // cosine of the normals
  const std::optional<Sighting> there = sighting(of_scan, p, p_normal, 0);
  if (!there || std::abs(there->distance) <= 0) return;
  for (const SymmetryElement& own : own_) {
    if (own.kind != of_scan.kind) continue;
    int taken = 0;
    for (int look = 0; look < kLooks * most && taken < most; ++look) {
      const auto i = static_cast<Eigen::Index>(random.below(static_cast<std::uint64_t>(samples_.points.rows())));
      const Vector3d point = samples_.points.row(i);
      const Vector3d normal = samples_.normals.row(i);
      const std::optional<Sighting> here = sighting(own, point, normal, least_);
      if (!here) continue;
      const double scale = std::abs(there->distance / here->distance);
      // A plane's normal is turned so that the point lies on the right side; an axis may go either way. In a plane the
      // normals' parts may agree with either sign.
      const bool plane = own.kind == SymmetryElement::Kind::plane;
      for (const double sign : {1.0, -1.0}) {
        const double first = plane ? (there->distance * here->distance > 0 ? 1.0 : -1.0) : sign;
        const double second = plane ? sign : 1.0;
        const Matrix3d rotation =
            there->frame * Vector3d(first, second, first * second).asDiagonal() * here->frame.transpose();
        if (std::abs((rotation * normal).dot(p_normal)) < kCompatible) continue;
        take({scale, rotation, p - scale * (rotation * point)});
        ++taken;
      }
    }
  }
}

}  // namespace orbifit
