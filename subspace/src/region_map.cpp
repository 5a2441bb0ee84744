#include "orbifit/subspace/region_map.h"

#include <algorithm>
#include <numeric>
#include <string>

#include "finite_subgroup.h"

namespace orbifit {

RegionMap::RegionMap(const Mesh& mesh, const SymmetryAnnotation& annotation, const RunContext& context)
    : regions_of_face_(static_cast<std::size_t>(mesh.faces.rows())) {
  for (const Region& region : annotation.regions) {
    const int number = static_cast<int>(groups_.size());
    names_.push_back(region.name.empty() ? "region " + std::to_string(region.id) : region.name);
    if (region.group.continuous()) {
      const PointGroup finite = finite_subgroup(mesh, region);
      groups_.push_back(subgroup_elements(mesh, region, finite));
      context.message("region \"" + names_.back() + "\": " + region.group.symbol() + " is kept as " + finite.symbol());
    } else {
      groups_.push_back(region.elements);
    }
    whole_.push_back(static_cast<Eigen::Index>(region.faces.size()) == mesh.faces.rows() ? 1 : 0);
    for (const int face : region.faces) regions_of_face_[static_cast<std::size_t>(face)].push_back(number);
  }
  for (const Region& region : annotation.regions) {
    const bool alike = std::ranges::all_of(
        region.faces, [&](int face) { return regions_of_face(face) == regions_of_face(region.faces.front()); });
    common_regions_.push_back(alike && !region.faces.empty() ? regions_of_face(region.faces.front())
                                                             : std::vector<int>{});
    surface_of_region_.push_back(common_regions_.back().empty() ? static_cast<int>(surfaces_.size()) : -1);
    if (common_regions_.back().empty()) surfaces_.emplace_back(mesh, region.faces);
  }
}

const std::vector<int>& RegionMap::regions_near(const Eigen::Vector3d& point, int region) const {
  const auto number = static_cast<std::size_t>(region);
  if (!common_regions_[number].empty()) return common_regions_[number];
  const SurfaceIndex& surface = surfaces_[static_cast<std::size_t>(surface_of_region_[number])];
  return regions_of_face(surface.nearest(point).face);
}

}  // namespace orbifit
