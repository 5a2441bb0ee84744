#include "thumbnail.h"

#include <algorithm>
#include <functional>
#include <vector>

namespace orbifit {

namespace {

constexpr int kWidth = 192, kHeight = 144;  // pixels
constexpr int kRays = 4;                    // a pixel

}  // namespace

Image thumbnail(const Mesh& mesh, const SymmetryAnnotation& annotation, const Eigen::Vector3d& up,
                const RunContext& run) {
  std::vector<const Region*> by_size;
  for (const Region& region : annotation.regions) by_size.push_back(&region);
  std::ranges::stable_sort(by_size, std::ranges::greater{}, [](const Region* region) { return region->faces.size(); });
  Scene scene;
  SurfaceLayer& surface = scene.surfaces.emplace_back();
  surface.mesh = mesh;
  surface.face_colours.assign(static_cast<std::size_t>(mesh.faces.rows()), Colour(0.75F, 0.75F, 0.75F));
  for (const Region* region : by_size) {
    for (const int face : region->faces)
      surface.face_colours[static_cast<std::size_t>(face)] = region_colour(region->id);
  }
  ViewOptions view;
  view.width = kWidth;
  view.height = kHeight;
  view.samples = kRays;
  view.up = up;
  return render(scene, view, run);
}

}  // namespace orbifit
