#pragma once

#include <filesystem>
#include <vector>

#include "orbifit/model/mesh.h"
#include "orbifit/model/motion.h"

namespace orbifit {

/// A pinhole camera without distortion. Its frame: x to the right, y down, z forwards, as in OpenCV.
struct DepthCamera {
  double fx = 0, fy = 0;       ///< focal lengths, pixels, > 0
  double cx = 0, cy = 0;       ///< principal point, pixels; the middle of the pixel at top left is (0, 0)
  double depth_scale = 0.001;  ///< length of one unit of depth, > 0: scans in metres from images in millimetres
  Motion pose = {};            ///< camera's frame -> the scan's frame
};

/// Reads a depth image, a PNG of 16 bits of grey: the pixel in column u and row v of depth d is the point
/// ((u - cx) d / fx, (v - cy) d / fy, d) of the camera's frame; 0 is no measurement. All points have the camera's place
/// as viewpoint.
/// \param mask  PNG of the same size whose pixels are 0 where the object is not; empty: all may be of it
/// \throw InputError with file and reason, also where no depth is within the mask or the principal point is outside the
///   image; UsageError for a camera that is none
PointCloud read_depth_image(const std::filesystem::path& file, const DepthCamera& camera,
                            const std::filesystem::path& mask = {});

/// Whether a file is a PNG, by its first bytes; a file that cannot be read is none.
bool is_depth_image(const std::filesystem::path& file);

/// Reads {"camera_to_world": [[[r, r, r, t], [r, r, r, t], [r, r, r, t]], ...]}: of each depth image, in their order,
/// the three (or four, the last one 0 0 0 1) rows of the motion from the camera's frame. \throw InputError with the key
std::vector<Motion> read_extrinsics(const std::filesystem::path& file);

}  // namespace orbifit
