#include "region_colours.h"

#include <algorithm>
#include <functional>

#include "orbifit/apps/render.h"

namespace orbifit {

Points region_face_colours(const Mesh& mesh, const std::vector<Region>& regions) {
  constexpr double kClay = 0.75;
  Points colours = Points::Constant(mesh.faces.rows(), 3, kClay);
  std::vector<const Region*> by_size;
  for (const Region& region : regions) by_size.push_back(&region);
  std::ranges::stable_sort(by_size, std::ranges::greater{}, [](const Region* region) { return region->faces.size(); });
  for (const Region* region : by_size) {
    const Eigen::RowVector3d colour = region_colour(region->id).cast<double>();
    for (const int face : region->faces) colours.row(face) = colour;
  }
  return colours;
}

}  // namespace orbifit
