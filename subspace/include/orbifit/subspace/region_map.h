#pragma once

#include <vector>

#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/motion.h"
#include "orbifit/model/run_context.h"
#include "orbifit/model/surface_index.h"

namespace orbifit {

/// The regions S_i of an annotated mesh as the subspace needs them: their finite groups and who lies in which.
/// Regions are numbered by their place in the annotation.
class RegionMap {
 public:
  /// Continuous groups are replaced by their largest finite subgroup under which the region's vertices map onto
  /// vertices (12-fold where there is none), which is said in a message.
  RegionMap(const Mesh& mesh, const SymmetryAnnotation& annotation, const RunContext& context);

  int count() const { return static_cast<int>(groups_.size()); }

  /// All elements of G_i, the identity first.
  const std::vector<Motion>& elements(int region) const { return groups_[static_cast<std::size_t>(region)]; }

  const std::string& name(int region) const { return names_[static_cast<std::size_t>(region)]; }

  /// Regions that hold the face, ascending.
  const std::vector<int>& regions_of_face(int face) const { return regions_of_face_[static_cast<std::size_t>(face)]; }

  /// Regions that hold the point of S_region nearest to `point`; `region` is among them.
  const std::vector<int>& regions_near(const Eigen::Vector3d& point, int region) const;

  /// Whether the region holds every face.
  bool whole(int region) const { return whole_[static_cast<std::size_t>(region)]; }

 private:
  std::vector<std::vector<Motion>> groups_;
  std::vector<std::string> names_;
  std::vector<std::vector<int>> regions_of_face_;
  std::vector<char> whole_;
  std::vector<std::vector<int>> common_regions_;  ///< of all its faces, where they agree; else empty
  std::vector<SurfaceIndex> surfaces_;            ///< one a region, only where common_regions_ is empty
  std::vector<int> surface_of_region_;
};

}  // namespace orbifit
