#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <embree3/rtcore.h>

#include "orbifit/apps/render.h"

namespace orbifit {

struct Ray {
  Eigen::Vector3f origin;
  Eigen::Vector3f direction;  ///< unit
};

/// A point of a surface as the shading needs it; scene units.
struct SurfaceHit {
  float distance = 0;
  Eigen::Vector3f position;
  Eigen::Vector3f lifted;            ///< position on the smooth surface that the corner normals describe (Hanika 2021)
  Eigen::Vector3f geometric_normal;  ///< unit, towards the viewer
  Eigen::Vector3f normal;            ///< unit, smooth except across creases, towards the viewer
  Eigen::Vector3f colour;            ///< linear
  float opacity = 1;
};

struct MarkHit {
  float distance = 0;
  Eigen::Vector3f normal;  ///< unit, towards the viewer
  Eigen::Vector3f colour;  ///< linear
};

/// The scene in Embree's trees, moved and scaled so that its diagonal is 1. Opaque surfaces cast shadows; glass and
/// marks (points, segments) do not.
class RayScene {
 public:
  /// \param frame box whose diagonal becomes 1 and whose centre the origin, 2 by 3
  /// \param beside how far from a mark `near_mark` still finds it; scene units
  RayScene(const Scene& scene, const Eigen::Matrix<double, 2, 3>& frame, float beside);
  ~RayScene();
  RayScene(const RayScene&) = delete;
  RayScene& operator=(const RayScene&) = delete;

  std::optional<SurfaceHit> surface(const Ray& ray, float up_to) const;

  /// Visits what the ray crosses of glass nearer than `up_to`, nearest first, at most so many sheets (of 32 with those
  /// that coincide). One walk through the tree finds them all.
  void glass(const Ray& ray, float up_to, int most, const std::function<void(const SurfaceHit&)>& visit) const;
  std::optional<MarkHit> mark(const Ray& ray, float up_to) const;

  /// Whether the ray comes near a mark, behind whatever it may be.
  bool near_mark(const Ray& ray) const;

  /// Which of `count` directions from `origin` (at most 8) meet an opaque surface within `reach`: one bit each.
  unsigned occluded(const Eigen::Vector3f& origin, const Eigen::Vector3f* directions, int count, float reach) const;

  bool has_glass() const { return glass_.scene != nullptr; }
  bool has_marks() const { return marks_.scene != nullptr; }
  bool draws_edges() const { return draws_edges_; }

  /// Width of a pixel at distance 1, by which drawn edges stay about a pixel wide.
  float pixel_width = 0;

 private:
  struct Layer {  // one geometry, in the order of Embree's numbers
    const SurfaceLayer* surface = nullptr;
    std::vector<Eigen::Vector3f> corner_normals;  // 3 a face
    std::vector<std::uint8_t> drawn_edges;        // bit k: the edge from corner k is drawn
    std::vector<Eigen::Vector3f> face_colours;    // #F or one for all, linear
    Eigen::Vector3f colour;                       // of marks, linear
  };
  struct Part {
    RTCScene scene = nullptr;
    std::vector<Layer> layers;
  };

  void add_surface(Part& part, const SurfaceLayer& layer);
  void add_points(Part& part, const PointLayer& layer, double radius);
  void add_segments(Part& part, const SegmentLayer& layer, double radius);
  void attach(Part& part, RTCGeometry geometry, Layer layer);
  SurfaceHit hit_of(const Part& part, const Ray& ray, const RTCRayHit& query) const;
  Eigen::Vector3f to_scene(const Eigen::RowVector3d& point) const;

  RTCDevice device_ = nullptr;
  Eigen::RowVector3d centre_;
  double scale_ = 1;
  bool draws_edges_ = false;
  Part opaque_, glass_, marks_, thick_marks_;
};

/// sRGB to linear light.
Eigen::Vector3f linear_colour(const Colour& colour);

}  // namespace orbifit
