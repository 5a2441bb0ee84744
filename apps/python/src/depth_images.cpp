#include <optional>

#include <pybind11/stl.h>

#include "orbifit/fitting/depth_image.h"

#include "meshes.h"
#include "verbs.h"

namespace orbifit::python {

void define_depth_images(py::module_& module) {
  module.def(
      "read_depth_image",
      [](const PathLike& file, const ArrayLike& intrinsics, double depth_scale, const std::optional<ArrayLike>& pose,
         const std::optional<PathLike>& mask) {
        const Eigen::VectorXd numbers = numbers_from(intrinsics, "intrinsics", 4);
        DepthCamera camera{numbers[0], numbers[1], numbers[2], numbers[3], depth_scale, Motion{}};
        if (pose) camera.pose = motion_from(*pose, "pose");
        const std::filesystem::path path = path_from(file);
        const std::filesystem::path inside = mask ? path_from(*mask) : std::filesystem::path();
        const py::gil_scoped_release release;
        return std::make_shared<PointCloud>(read_depth_image(path, camera, inside));
      },
      py::arg("file"), py::arg("intrinsics"), py::kw_only(), py::arg("depth_scale") = DepthCamera{}.depth_scale,
      py::arg("pose") = py::none(), py::arg("mask") = py::none(),
      "Reads a depth image, a PNG of 16 bits of grey: the pixel in column u and row v of depth d is the point\n"
      "((u - cx) d / fx, (v - cy) d / fy, d) of the camera's frame (x to the right, y down, z forwards); 0 is no\n"
      "measurement. The camera's place is the viewpoint of all points.\n\n"
      "Args:\n"
      "    intrinsics: (fx, fy, cx, cy), pixels; the middle of the pixel at top left is (0, 0).\n"
      "    depth_scale: length of one unit of depth; 0.001 makes metres of millimetres.\n"
      "    pose: camera's frame to the scan's, (3, 4) or (4, 4), a Euclidean motion.\n"
      "    mask: a PNG of the same size that is 0 where the object is not.\n\n"
      "Raises:\n"
      "    InputError: with file and reason.\n"
      "    UsageError: a camera that is none.");
  module.def(
      "read_extrinsics",
      [](const PathLike& file) {
        std::vector<DoubleArray> result;
        for (const Motion& motion : read_extrinsics(path_from(file))) {
          result.push_back(matrix_of({1, motion.linear, motion.translation}));
        }
        return result;
      },
      py::arg("file"),
      "Reads where the camera was for each depth image, as `orbifit fit --extrinsics` takes it: (4, 4) each, camera's\n"
      "frame to the scan's.\n\n"
      "Raises:\n"
      "    InputError: naming the file and the key.");
}

}  // namespace orbifit::python
