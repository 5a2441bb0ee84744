#include "thumbnail.h"

#include "region_colours.h"

namespace orbifit {

namespace {

constexpr int kWidth = 192, kHeight = 144;  // pixels
constexpr int kRays = 4;                    // a pixel

}  // namespace

Image thumbnail(const Mesh& mesh, const SymmetryAnnotation& annotation, const Eigen::Vector3d& up,
                const RunContext& run) {
  Scene scene;
  SurfaceLayer& surface = scene.surfaces.emplace_back();
  surface.mesh = mesh;
  const Points colours = region_face_colours(mesh, annotation.regions);
  for (const auto& colour : colours.rowwise()) surface.face_colours.emplace_back(colour.transpose().cast<float>());
  ViewOptions view;
  view.width = kWidth;
  view.height = kHeight;
  view.samples = kRays;
  view.up = up;
  return render(scene, view, run);
}

}  // namespace orbifit
