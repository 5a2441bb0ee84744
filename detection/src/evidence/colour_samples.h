#pragma once

#include <optional>
#include <vector>

#include "orbifit/detection/surface_colours.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/motion.h"
#include "orbifit/model/run_context.h"

#include "geometry/point_index.h"
#include "geometry/sampling.h"

namespace orbifit {

/// Points spread over a surface, each with the mean colour around it. A point belongs to one side of the surface:
/// colours of faces that look the other way, as those of a sheet's back, are none of its own.
class ColourSamples {
 public:
  /// \param coloured  the mesh of the colours, in its own order \param face_of  by face of `mesh`, its number there
  /// \param reach  mesh units, > 0: what is finer is averaged, and how far an image may be from the place that it means
  ColourSamples(const Mesh& mesh, const SurfaceColours& colours, const Mesh& coloured, const std::vector<int>& face_of,
                double reach, const RunContext& context);

  /// Those on faces of which `on_face` is 1; at most `count`, evenly spread.
  std::vector<int> chosen(const std::vector<char>& on_face, int count) const;

  Eigen::Vector3d point(int sample) const { return samples_.points.row(sample).transpose(); }
  const Eigen::Vector3d& colour(int sample) const { return colours_[static_cast<std::size_t>(sample)]; }

  /// The least difference between a sample's colour and one within reach of its image, as a distance in sRGB from 0 to
  /// the root of 3; nothing where no sample is near.
  /// \param on_face  as above: where the image may be
  std::optional<double> difference(int sample, const Motion& motion, const std::vector<char>& on_face) const;

 private:
  std::vector<int> near(const Eigen::Vector3d& point, const Eigen::Vector3d& normal,
                        const std::vector<char>& on_face) const;

  double reach_;
  SurfaceSamples samples_;
  PointIndex index_;
  std::vector<Eigen::Vector3d> colours_;
};

}  // namespace orbifit
