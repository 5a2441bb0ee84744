#pragma once

#include <functional>
#include <initializer_list>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "orbifit/model/mesh.h"

#include "models/primitives.h"

namespace orbifit {

/// Fineness of a capped skin.
struct SkinCounts {
  int sectors = 6;  ///< of its caps: the mesh maps onto itself under the turns and mirrors of so many sectors; >= 3
  int cap = 2;      ///< rings of each cap; the sides have sectors * cap points around
  int rings = 1;    ///< pieces of the sides from cap to cap
};

/// A point of a skin: `share` runs from 0 at the first pole to 1 at the last, the direction around is (cosine, sine).
using SkinPoint = std::function<Eigen::Vector3d(double share, double cosine, double sine)>;

/// A closed surface with the topology of a sphere whose caps gain points ring by ring, so that its triangles are even
/// up to the poles. Rings are equally far apart in `share`.
Mesh capped_skin(const SkinCounts& counts, const SkinPoint& point);

/// A line by its arc length.
class Curve {
 public:
  explicit Curve(std::vector<Eigen::Vector3d> points);
  explicit Curve(const std::vector<Eigen::Vector2d>& profile);  ///< radius and height become x and z

  double length() const { return reached_.back(); }
  /// \param share of the length; beyond 0 and 1 the line goes on straight
  Eigen::Vector3d operator()(double share) const;
  Eigen::Vector3d tangent(double share) const;

 private:
  std::size_t piece(double share) const;
  std::vector<Eigen::Vector3d> points_;
  std::vector<double> reached_;
};

/// A smooth line through the points (centripetal differences, cubic pieces).
Curve smooth_curve(const std::vector<Eigen::Vector3d>& through);

/// A smooth function through (place, value), constant beyond its ends. \pre ascending places
double smooth_table(std::initializer_list<std::pair<double, double>> entries, double place);

/// The point of the curve |x|^k + |y|^k = 1 in the direction (cosine, sine): a circle for 2, a rounded square for more.
Eigen::Vector2d rounded_square(double cosine, double sine, double exponent);

/// Turned about z by a profile from the axis to the axis, its radius varied by `lobes` (share, angle's cosine and
/// sine).
Mesh turned(const SkinCounts& counts, const std::vector<Eigen::Vector2d>& profile,
            const std::function<double(double share, double cosine, double sine)>& lobes = {});

/// A round-ended tube along a line in a plane, mirror-symmetric about that plane.
/// \param normal unit normal of the plane
/// \param radius over the share of the line's length
Mesh tube(const SkinCounts& counts, const Curve& path, const Eigen::Vector3d& normal,
          const std::function<double(double share)>& radius);

/// cos(n angle) from the angle's cosine and sine.
double cosine_of_multiple(int n, double cosine, double sine);

}  // namespace orbifit
