#pragma once

#include <memory>
#include <vector>

#include "orbifit/model/mesh.h"

namespace orbifit {

/// Neighbours among points in space, by FLANN's exact k-d tree in double precision. Results are ordered by distance,
/// then by number. Const calls may run on several threads.
class PointIndex {
 public:
  explicit PointIndex(const Points& points);
  ~PointIndex();
  PointIndex(PointIndex&&) noexcept;
  PointIndex& operator=(PointIndex&&) noexcept;

  struct Neighbour {
    int index = -1;
    double distance = 0;
  };

  std::vector<Neighbour> nearest(const Eigen::Vector3d& point, int count) const;
  std::vector<Neighbour> within(const Eigen::Vector3d& point, double radius) const;

  /// The first of nearest(); index -1 where there are no points.
  Neighbour nearest(const Eigen::Vector3d& point) const;
  /// Whether within() has any: ends with the first that is met.
  bool any_within(const Eigen::Vector3d& point, double radius) const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace orbifit
