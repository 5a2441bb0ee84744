#pragma once

#include <vector>

#include <Eigen/Core>

#include "orbifit/model/mesh.h"

#include "symmetry/region_map.h"

namespace orbifit {

/// A point on a border of places, and all places on any side of it.
struct BorderPoint {
  Eigen::Vector3d position;
  int face;  ///< one of those around
  int set;
};

/// The borders on which places meet without overlapping: lines, and corners where such lines meet, of whose sides none
/// lies in all the places around. A field that is symmetric on every side and continuous has all their symmetries
/// there, so samples must stand on them: no sample elsewhere has.
class AbuttingPlaces {
 public:
  AbuttingPlaces(const Mesh& mesh, const RegionMap& regions);

  bool empty() const { return corners_.empty() && lines_.empty(); }

  /// The corners, then points on the lines at most `spacing` apart; the same for the same mesh.
  std::vector<BorderPoint> points(double spacing) const;

  /// The places around an image, which motions carry `carried` to, of a point on a border: those of a border through
  /// it; -1 where it lies on none that has all of `carried`.
  /// \param tolerance how far off the places' surfaces it may be, mesh units
  int set_at(const Eigen::Vector3d& image, int carried, double tolerance) const;

 private:
  struct Line {
    Eigen::Vector3d start, end;
    int face, set;
  };

  const RegionMap& regions_;
  std::vector<BorderPoint> corners_;
  std::vector<Line> lines_;
  std::vector<int> sets_;  // of corners and lines, without repeats, those of most places first
};

}  // namespace orbifit
