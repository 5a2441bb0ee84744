#include "evidence/colour_samples.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/random.h"
#include "evidence/policy.h"
#include "geometry/surface_index.h"

namespace orbifit {

namespace {

using Eigen::Index;
using Eigen::Vector3d;

SurfaceSamples spread(const Mesh& mesh, double reach, const RunContext& context) {
  const double discs = face_areas(mesh).sum() / (std::numbers::pi * reach * reach);
  Random random(context.seed, "colours");
  const double count =
      std::clamp(kColourPolicy.samples_of_disc * discs, kColourPolicy.least_samples, kColourPolicy.most_samples);
  return sample_surface(mesh, static_cast<int>(count), random);
}

}  // namespace

ColourSamples::ColourSamples(const Mesh& mesh, const SurfaceColours& colours, const Mesh& coloured,
                             const std::vector<int>& face_of, double reach, const RunContext& context)
    : reach_(reach), samples_(spread(mesh, reach, context)), index_(samples_.points) {
  std::vector<Vector3d> own;
  for (std::size_t i = 0; i < samples_.faces.size(); ++i) {
    const int f = face_of[static_cast<std::size_t>(samples_.faces[i])];
    const auto corner = [&](int k) -> Vector3d { return coloured.vertices.row(coloured.faces(f, k)).transpose(); };
    own.push_back(colours.at(f, nearest_on_triangle(samples_.points.row(static_cast<Index>(i)).transpose(), corner(0),
                                                    corner(1), corner(2))));
  }
  colours_.resize(own.size());
  parallel_for(
      context, own.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          const std::vector<int> around =
              near(point(static_cast<int>(i)), samples_.normals.row(static_cast<Index>(i)).transpose(), {});
          Vector3d sum = Vector3d::Zero();
          for (const int other : around) sum += own[static_cast<std::size_t>(other)];
          colours_[i] = around.empty() ? own[i] : (sum / static_cast<double>(around.size())).eval();
        }
        context.check();
      },
      1000);
}

std::vector<int> ColourSamples::chosen(const std::vector<char>& on_face, int count) const {
  std::vector<int> all;
  for (std::size_t i = 0; i < samples_.faces.size(); ++i) {
    if (on_face[static_cast<std::size_t>(samples_.faces[i])] != 0) all.push_back(static_cast<int>(i));
  }
  if (all.size() <= static_cast<std::size_t>(count)) return all;
  std::vector<int> result;
  for (int i = 0; i < count; ++i) {
    result.push_back(all[all.size() * static_cast<std::size_t>(i) / static_cast<std::size_t>(count)]);
  }
  return result;
}

// Samples within reach on the side that the normal tells; of a surface of which sides cannot be told, on any.
std::vector<int> ColourSamples::near(const Vector3d& point, const Vector3d& normal,
                                     const std::vector<char>& on_face) const {
  std::vector<int> same_side;
  std::vector<int> any_side;
  for (const PointIndex::Neighbour& neighbour : index_.within(point, reach_)) {
    const auto sample = static_cast<std::size_t>(neighbour.index);
    if (!on_face.empty() && on_face[static_cast<std::size_t>(samples_.faces[sample])] == 0) continue;
    any_side.push_back(neighbour.index);
    if (samples_.normals.row(neighbour.index).dot(normal) >= kColourPolicy.same_side)
      same_side.push_back(neighbour.index);
  }
  return same_side.empty() ? any_side : same_side;
}

std::optional<double> ColourSamples::difference(int sample, const Motion& motion,
                                                const std::vector<char>& on_face) const {
  const Vector3d normal = motion.linear * samples_.normals.row(sample).transpose();
  double least = std::numeric_limits<double>::infinity();
  for (const int other : near(motion(point(sample)), normal, on_face)) {
    least = std::min(least, (colour(other) - colour(sample)).norm());
  }
  if (!std::isfinite(least)) return std::nullopt;
  return least;
}

}  // namespace orbifit
