#include "solver/pulls.h"

namespace orbifit {

std::vector<Pull> pulls_towards(const FitInput& input, const Similarity& pose, double weight) {
  const Similarity back = inverse(pose);
  std::vector<Pull> pulls;
  for (const Landmark& landmark : input.landmarks) pulls.push_back({landmark.vertex, back(landmark.target), weight});
  for (const Handle& handle : input.handles) {
    const double each = weight * 3 / static_cast<double>(handle.vertices.size());
    for (const int vertex : handle.vertices) {
      const Eigen::Vector3d place = input.pose(handle.motion(input.mesh.vertices.row(vertex).transpose()));
      pulls.push_back({vertex, back(place), each});
    }
  }
  return pulls;
}

}  // namespace orbifit
