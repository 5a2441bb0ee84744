#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"

namespace orbifit {

using Colour = Eigen::Vector3f;  ///< sRGB in [0, 1]

struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;  ///< 3 * width * height, top row first
};

/// What to draw; everything in one frame.
struct SurfaceLayer {
  Mesh mesh;
  std::vector<Colour> face_colours;    ///< #F, or one for all, or empty for the default clay
  std::vector<Colour> vertex_colours;  ///< #V, interpolated; takes precedence
  double opacity = 1;                  ///< below 1 it is drawn as glass over what is behind
  bool edges = false;                  ///< draw the mesh's edges
};
struct PointLayer {
  Points points;
  Colour colour{0.85F, 0.2F, 0.15F};
  double radius = 0.003;  ///< fraction of the scene's diagonal
};
struct SegmentLayer {  // axes, arrows, frames
  Points from, to;     ///< #S by 3 each
  Colour colour{0.1F, 0.1F, 0.1F};
  double radius = 0.002;  ///< fraction of the scene's diagonal
};
struct Scene {
  std::vector<SurfaceLayer> surfaces;
  std::vector<PointLayer> points;
  std::vector<SegmentLayer> segments;
};

struct ViewOptions {
  int width = 800, height = 600;  ///< pixels
  double azimuth = 35;            ///< degrees about `up`
  double elevation = 25;          ///< degrees
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  double field_of_view = 30;  ///< vertical, degrees
  int samples = 9;            ///< rays per pixel, a square number
  bool ground_shadow = true;  ///< soft shadow under the shape
  /// Points that the picture frames, #P by 3, or two opposite corners of a box; empty: the scene's own. Set it to keep
  /// two pictures at one scale; its diagonal then is the scene's.
  Points frame;
  /// The part of the picture that is drawn, as if enlarged: left, top, width and height as fractions of the whole.
  Eigen::Vector4d window{0, 0, 1, 1};
  Colour background{1, 1, 1};
};

/// Sets azimuth and elevation so that the picture is seen from there.
/// \param direction  from the scene to the eye, any
/// length; the view stays as it is where that is zero
void look_from(const Eigen::Vector3d& direction, ViewOptions& view);

/// Ray-cast picture with soft light and ambient occlusion; the same scene gives the same bytes with any number of
/// threads.
/// \throw UsageError naming the field of `view`, its value and the rule
Image render(const Scene& scene, const ViewOptions& view, const RunContext& context);

/// Distinct colours, one a region; the same number gives the same colour.
Colour region_colour(int number);

/// Blue (0) over white to red (1); grey for a value that is not a number.
Colour heat_colour(double value);

/// The mesh in grey, with a region's faces in its colour and its axis (or mirror plane's outline) drawn.
/// \param see_through  all but the region is glass
Scene region_scene(const Mesh& mesh, const Region& region, bool see_through = false);

/// Likewise, seen through where the view hides most of the region behind or inside the rest.
Scene visible_region_scene(const Mesh& mesh, const Region& region, const ViewOptions& view, const RunContext& context);

/// The mesh with an instance of each colour.
/// \param see_through  all else is glass
Scene pattern_scene(const Mesh& mesh, const Pattern& pattern, bool see_through = false);

/// Likewise, seen through where the view hides most of the instances behind or inside the rest.
Scene visible_pattern_scene(const Mesh& mesh, const Pattern& pattern, const ViewOptions& view,
                            const RunContext& context);

/// Small pictures side by side, in rows, with a caption each below: its first line is a title, further lines say more;
/// what is wider than the picture is cut.
/// \throw UsageError for another number of captions than images, fewer than one column, or an ill-formed image
Image contact_sheet(const std::vector<Image>& images, const std::vector<std::string>& captions, int columns);

std::string encode_png(const Image& image);
void write_png(const std::filesystem::path& file, const Image& image);  ///< whole or not at all

}  // namespace orbifit
