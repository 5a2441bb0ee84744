#pragma once

#include <limits>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"

#include "rest_shape/vertex_matching.h"
#include "symmetry/moving_surface.h"

namespace orbifit {

/// A place of a region seen from one side: where faces meet at an edge of two sheets, each has its normal there.
struct Probe {
  int place;
  Eigen::Vector3d normal;  ///< unit, of the region's surface at rest; zero where it has none
};

/// On what a region is measured: the images of its probes under motions, against its own surface.
struct RegionDemand {
  std::vector<Probe> probes;
  std::vector<Motion> motions;  ///< without the identity
  std::vector<int> faces;       ///< of the region
  bool of_finite_group = true;  ///< false: rotations picked out of a continuous group
};

/// All elements of a finite group, or as many of them, spread evenly, as make some 200 000 pairs. Of a continuous group
/// for which no finite one stands, some rotations.
/// \param finite the region with its finite group, or with the one that stands for its continuous one
/// \param any_turn  the surface is to lie on itself after other rotations as well, though vertices do not
RegionDemand region_demand(const Mesh& mesh, const Places& places, const Region& region,
                           const std::optional<Region>& finite, bool any_turn);

/// The point of a region's surface that is nearest to the image of a probe.
struct SurfaceMatch {
  int face = -1;                                      ///< -1: not asked for
  Eigen::Vector3d weights = Eigen::Vector3d::Zero();  ///< barycentric
  double distance = 0;                                ///< mesh units
};

/// Every pair of a probe and a motion of every region.
class ImagePairs {
 public:
  struct Pair {
    int region, place;
    const Motion* motion;
  };

  ImagePairs(const Mesh& mesh, const Places& places, std::vector<RegionDemand> demands);
  ImagePairs(const ImagePairs&) = delete;
  ImagePairs& operator=(const ImagePairs&) = delete;

  std::size_t count() const { return first_.back(); }
  const std::vector<RegionDemand>& demands() const { return demands_; }
  Pair operator[](std::size_t pair) const;
  int region_of(std::size_t pair) const;

  int faces() const { return static_cast<int>(mesh_.faces.rows()); }  ///< of the mesh

  /// The places at the corners of a face.
  Eigen::RowVector3i corners(int face) const { return mesh_.faces.row(face); }

  /// Puts the places at `positions` (#P by 3) and tells where the images lie then. Where the nearest face looks the
  /// other way than the image does, as in thin parts, the nearest one that does not, if one is near. \param wanted by
  /// region and probe; null: all pairs \param reach  mesh units: no match where the surface is farther away
  std::vector<SurfaceMatch> match(const Points& positions, const std::vector<std::vector<char>>* wanted,
                                  const RunContext& context, double reach = std::numeric_limits<double>::infinity(),
                                  std::size_t most = std::numeric_limits<std::size_t>::max());

 private:
  std::vector<RegionDemand> demands_;
  std::vector<std::size_t> first_;       // pair of each region; count() last
  Mesh mesh_;                            // of places
  std::vector<MovingSurface> surfaces_;  // of each region, kept by reference to mesh_
};

}  // namespace orbifit
