#include "remeshing/fundamental_domain.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

namespace orbifit {

namespace {

using Eigen::Vector3d;

constexpr int kDirections = 24;     // on the sphere, of which some give the same domain
constexpr double kTouching = 1e-9;  // area of a plane within the unit cube: such a plane only touches the domain
constexpr double kSameNormal = 1e-9;
constexpr double kFixed = 1e-3;  // times the nearest a generic point could be to its image: too near

// A square in the plane, cut by the other planes: what of the plane bounds the domain, within two units of the centre.
double bounding_area(const std::vector<Vector3d>& normals, std::size_t which) {
  const Vector3d u = normals[which].unitOrthogonal();
  const Vector3d v = normals[which].cross(u);
  std::vector<Vector3d> polygon{u + v, v - u, -u - v, u - v};
  for (std::size_t other = 0; other < normals.size(); ++other) {
    if (other == which) continue;
    std::vector<Vector3d> kept;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Vector3d& a = polygon[i];
      const Vector3d& b = polygon[(i + 1) % polygon.size()];
      const double da = normals[other].dot(a);
      const double db = normals[other].dot(b);
      if (da <= 0) kept.push_back(a);
      if ((da < 0 && db > 0) || (da > 0 && db < 0)) kept.push_back(a + da / (da - db) * (b - a));
    }
    polygon = std::move(kept);
  }
  Vector3d area = Vector3d::Zero();
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
    area += (polygon[i] - polygon[0]).cross(polygon[i + 1] - polygon[0]) / 2;
  }
  return area.norm();
}

Vector3d halving(const Motion& element, const Vector3d& normal) {
  const AxisAngle turn = axis_angle(element.linear);
  return turn.determinant > 0 ? normal.cross(turn.axis).normalized().eval() : normal.unitOrthogonal().eval();
}

bool same_walls(const FundamentalDomain& a, const FundamentalDomain& b) {
  return std::ranges::equal(a.walls, b.walls, [](const Wall& x, const Wall& y) {
    return x.element == y.element && (x.normal - y.normal).norm() < kSameNormal;
  });
}

}  // namespace

FundamentalDomain dirichlet_domain(const FiniteGroup& group, const Vector3d& direction) {
  std::vector<Vector3d> normals;
  for (int e = 1; e < group.order(); ++e) {
    normals.push_back((group.elements[static_cast<std::size_t>(e)].linear * direction - direction).normalized());
  }
  FundamentalDomain domain{group.centre, {}};
  std::vector<int> wall_of(static_cast<std::size_t>(group.order()), -1);
  for (int e = 1; e < group.order(); ++e) {
    const int inverse = group.inverses[static_cast<std::size_t>(e)];
    const auto row = static_cast<std::size_t>(e - 1);
    if (bounding_area(normals, static_cast<std::size_t>(std::min(e, inverse) - 1)) <= kTouching) continue;
    Wall wall;
    wall.element = e;
    wall.normal = normals[row];
    const Motion& element = group.elements[static_cast<std::size_t>(e)];
    wall.mirror = (element.linear - (Eigen::Matrix3d::Identity() - 2 * wall.normal * wall.normal.transpose())).norm() <
                  kSameNormal;
    if (inverse == e && !wall.mirror) wall.half = halving(element, wall.normal);
    wall_of[static_cast<std::size_t>(e)] = static_cast<int>(domain.walls.size());
    domain.walls.push_back(wall);
  }
  for (Wall& wall : domain.walls) {
    wall.partner = wall_of[static_cast<std::size_t>(group.inverses[static_cast<std::size_t>(wall.element)])];
  }
  return domain;
}

std::vector<FundamentalDomain> candidate_domains(const FiniteGroup& group) {
  std::vector<FundamentalDomain> domains;
  for (int i = 0; i < kDirections; ++i) {
    // Fibonacci's spiral, turned so that no direction is an axis of the usual frames.
    const double z = 1 - (2.0 * i + 1) / kDirections;
    const double angle = 0.7 + i * std::numbers::pi * (3 - std::sqrt(5.0));
    const Vector3d spiral(std::sqrt(1 - z * z) * std::cos(angle), std::sqrt(1 - z * z) * std::sin(angle), z);
    const Vector3d direction = axis_rotation(Vector3d(1, 2, 3).normalized(), 0.4) * spiral;
    const double nearest = kFixed / group.order();
    const bool generic = std::all_of(group.elements.begin() + 1, group.elements.end(), [&](const Motion& element) {
      return (element.linear * direction - direction).norm() > nearest;
    });
    if (!generic) continue;
    FundamentalDomain domain = dirichlet_domain(group, direction);
    const bool known = std::ranges::any_of(domains, [&](const auto& other) { return same_walls(domain, other); });
    if (!known) domains.push_back(std::move(domain));
  }
  return domains;
}

}  // namespace orbifit
