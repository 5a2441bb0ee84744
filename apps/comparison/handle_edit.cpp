#include "handle_edit.h"

#include <chrono>
#include <cmath>

#include "orbifit/subspace/deformer.h"

namespace orbifit {

namespace {

double handle_rms(const FitInput& input, const Mesh& deformed) {
  double squares = 0;
  double count = 0;
  for (const Handle& handle : input.handles) {
    for (const int vertex : handle.vertices) {
      const Eigen::Vector3d target = handle.motion(input.mesh.vertices.row(vertex).transpose());
      squares += (deformed.vertices.row(vertex).transpose() - target).squaredNorm();
      count += 1;
    }
  }
  return count > 0 ? std::sqrt(squares / count) : 0;
}

}  // namespace

FitResult edit_by_handles(const FitInput& input, const FitOptions& options, const RunContext& context) {
  using Clock = std::chrono::steady_clock;
  constexpr double kAlpha = 100;  // paper, section 6
  constexpr int kIterations = 10;
  const auto seconds = [](Clock::time_point from, Clock::time_point to) {
    return std::chrono::duration<double>(to - from).count();
  };
  const auto start = Clock::now();
  const Subspace subspace = build_subspace(input.mesh, input.annotation, options.subspace, context);
  Deformer deformer(subspace, input.mesh, {}, context);
  deformer.set_handles(input.handles, kAlpha);
  const auto prepared = Clock::now();
  std::vector<Motion> motions;
  for (const Handle& handle : input.handles) motions.push_back(handle.motion);
  const Deformation found = deformer.solve(motions, kIterations);
  const auto solved = Clock::now();

  FitResult result;
  result.pose = input.pose;
  result.q = found.state.q;
  result.samples = static_cast<int>(subspace.sampling.points.rows());
  result.degrees_of_freedom = subspace.degrees_of_freedom();
  result.fitted = input.mesh;
  result.fitted.vertices += vertex_displacements(subspace, found.state, context);
  result.rest_annotation = input.annotation;
  result.annotation = carried_annotation(input.annotation, subspace, found.state, result.fitted);
  const double size = diagonal(input.mesh.vertices);
  result.landmark_rms = handle_rms(input, result.fitted) / size;
  FitIteration last;
  last.change = found.last_change / size;
  last.seconds = seconds(prepared, solved) / kIterations;
  result.iterations.assign(kIterations, last);
  result.iterations_in_all = kIterations;
  result.converged = true;
  result.stopped_because = "the iterations asked for";
  result.times = {{"prepare", seconds(start, prepared)}, {"fit", seconds(prepared, solved)}};
  for (Eigen::Index v = 0; v < result.fitted.vertices.rows(); ++v) {
    result.fitted.vertices.row(v) = result.pose(result.fitted.vertices.row(v).transpose()).transpose();
  }
  result.annotation = transformed(result.annotation, result.pose);
  return result;
}

}  // namespace orbifit
