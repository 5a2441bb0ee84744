#pragma once

#include <concepts>
#include <functional>
#include <vector>

#include "orbifit/model/mesh.h"
#include "orbifit/model/motion.h"
#include "orbifit/model/run_context.h"

#include "geometry/point_index.h"
#include "geometry/sampling.h"

namespace orbifit {

/// A surface that may hide things: SurfaceIndex or MovingSurface, kept by reference.
class Occluder {
 public:
  template <typename Surface>
  requires(!std::same_as<Surface, Occluder>)
      Occluder(const Surface& surface)  // NOLINT(google-explicit-constructor): either surface is to serve as it is
      : occluded_([&surface](const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double least,
                             double most) { return surface.occluded(origin, direction, least, most); }) {}

  /// Whether anything lies between these distances along the ray.
  bool occluded(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double least, double most) const {
    return occluded_(origin, direction, least, most);
  }

 private:
  std::function<bool(const Eigen::Vector3d&, const Eigen::Vector3d&, double, double)> occluded_;
};

/// What a scan's viewpoints see, and so what of a posed template they should have seen.
class SeenSurface {
 public:
  /// Where the viewpoints have nothing at more than this share of the samples seen, points have been cut off the scan,
  /// with other things or as noise, and that viewpoints do not see the template there says nothing of it.
  static constexpr double kCutOff = 0.15;

  /// \param scan    all of it: what its viewpoints saw \param points  those to which distances are measured
  SeenSurface(const PointCloud& scan, const Points& points);

  /// A point of the template that should have been seen, and the point of the scan nearest to it.
  struct Missed {
    int sample = -1;
    int point = -1;
    double distance = 0;   ///< scan units
    bool through = false;  ///< something farther away was seen there; else nothing was, or what was has been cut off
  };
  struct Look {
    std::vector<Missed> missed;
    int seen = 0;  ///< samples at which the scan has points
  };

  /// The samples, on a surface of the template's, that a viewpoint has before it, where it saw through to something
  /// farther away, or to nothing: the surface cannot be there. None where no viewpoint is known.
  /// \param surface  the template's, in its frame as the samples \param pose template -> scan
  /// \param reach  scan units: nearer to a point of the scan a sample is seen
  Look look(const SurfaceSamples& samples, const Occluder& surface, const Similarity& pose, double reach,
            const RunContext& context) const;

  /// Samples of the template's surface that the viewpoints have before them, neither behind the template itself nor
  /// behind something else: what the scan has there. Of all samples, which then are seen or nothing, where no viewpoint
  /// is known.
  struct Coverage {
    int samples = 0;  ///< in all
    int seen = 0;     ///< the scan has points
    int through = 0;  ///< something farther away was seen
    int nothing = 0;  ///< the scan has nothing, neither there nor behind

    /// Share of those that are seen; less where little of the template is seen at all.
    double share() const;
    /// Share of those that must be taken for cut off; 0 where they are few, or the template lies elsewhere.
    double cut_off() const;
    /// The same samples without those that are cut off.
    Coverage without_cut_off() const;
  };
  /// \param samples, surface  the template's \param pose template -> scan \param reach scan units
  Coverage coverage(const SurfaceSamples& samples, const Occluder& surface, const Similarity& pose, double reach) const;

  /// Whether a viewpoint saw something behind a point, or no farther in front of it than `reach`, scan units: nothing
  /// that hides can be there.
  bool through(const Eigen::Vector3d& point, double reach) const;

  const PointIndex& points() const { return index_; }  ///< those to which distances are measured

  bool knows_viewpoints() const { return !views_.empty(); }

 private:
  /// A picture of depths: in each pixel the least and the largest distance of a point from the viewpoint.
  struct View {
    Eigen::Vector3d eye;
    Eigen::Matrix3d frame;  ///< columns: right, up, forwards
    double half_width;      ///< of the picture at distance 1
    int pixels;             ///< along each side
    std::vector<float> nearest, farthest;

    int pixel_of(const Eigen::Vector3d& point) const;  ///< -1 outside
  };
  enum class Sight { hidden, nothing, through };  // what a view has where a point is that it should have seen
  Sight look(const View& view, const Eigen::Vector3d& point, double reach) const;
  Sight expected(const Eigen::Vector3d& own, const Eigen::Vector3d& normal, const Occluder& surface,
                 const Similarity& pose, double reach, double same) const;

  std::vector<View> views_;
  PointIndex index_;
};

}  // namespace orbifit
