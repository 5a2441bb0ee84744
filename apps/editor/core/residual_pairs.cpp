#include "residual_pairs.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Dense>

namespace orbifit::editor {

namespace {

constexpr std::size_t kPairs = 600;  // of a region, about

}  // namespace

ResidualPairs::ResidualPairs(const Mesh& mesh, const SymmetryAnnotation& annotation, const SymmetricImages& images) {
  const double size = diagonal(mesh.vertices);
  if (size > 0) size_ = size;
  const double at_vertex = 1e-6 * size_;
  for (std::size_t r = 0; r < annotation.regions.size(); ++r) {
    const Region& region = annotation.regions[r];
    const std::vector<Motion>& motions = images.motions(static_cast<int>(r));
    const std::vector<int> vertices = vertices_of_faces(mesh, region.faces);
    const SurfaceIndex surface = images.surface().part(region.faces);
    parts_.push_back({pairs_.size(), motions_.size(), true});
    const std::size_t all = motions.size() * vertices.size();
    const std::size_t step = std::max<std::size_t>(1, all / kPairs) | 1U;
    const std::size_t first = motions_.size();
    motions_.insert(motions_.end(), motions.begin(), motions.end());
    for (std::size_t k = 0; k < all; k += step) {
      const int vertex = vertices[k / motions.size()];
      const Motion& motion = motions[k % motions.size()];
      const Eigen::Vector3d position = mesh.vertices.row(vertex);
      const SurfaceIndex::Nearest nearest = surface.nearest(motion(position));
      if (nearest.face < 0) continue;
      Pair pair;
      pair.vertex = vertex;
      pair.motion = static_cast<int>(first + k % motions.size());
      pair.weights = nearest.barycentric;
      for (int c = 0; c < 3; ++c) pair.corners[static_cast<std::size_t>(c)] = mesh.faces(nearest.face, c);
      // To the very vertex where there is one.
      Eigen::Index corner = 0;
      pair.weights.maxCoeff(&corner);
      const Eigen::Vector3d met = mesh.vertices.row(pair.corners[static_cast<std::size_t>(corner)]);
      if ((met - motion(position)).norm() <= at_vertex) {
        pair.weights = Eigen::Vector3d::Unit(corner);
      } else {
        parts_.back().at_vertices = false;
      }
      pair.offset = image(mesh.vertices, pair) - motion(position);
      pairs_.push_back(pair);
    }
  }
  parts_.push_back({pairs_.size(), motions_.size(), true});
}

Eigen::Vector3d ResidualPairs::image(const Points& vertices, const Pair& pair) const {
  Eigen::Vector3d result = Eigen::Vector3d::Zero();
  for (int c = 0; c < 3; ++c) {
    // A weight of 0 is left out: its corner may be anywhere.
    if (pair.weights[c] != 0) {
      result += pair.weights[c] * vertices.row(pair.corners[static_cast<std::size_t>(c)]).transpose();
    }
  }
  return result;
}

// \param difference  (region, pair) -> vector
template <class Difference>
std::vector<ResidualPairs::Answer> ResidualPairs::measure(const Difference& difference) const {
  std::vector<Answer> result;
  for (std::size_t r = 0; r + 1 < parts_.size(); ++r) {
    Answer answer;
    answer.at_vertices = parts_[r].at_vertices;
    const std::size_t begin = parts_[r].first, end = parts_[r + 1].first;
    double sum = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const double squared = difference(r, pairs_[i]).squaredNorm();
      sum += squared;
      answer.residual.max = std::max(answer.residual.max, squared);
    }
    answer.residual.max = std::sqrt(answer.residual.max) / size_;
    if (end > begin) answer.residual.rms = std::sqrt(sum / static_cast<double>(end - begin)) / size_;
    result.push_back(answer);
  }
  return result;
}

std::vector<ResidualPairs::Answer> ResidualPairs::of_deformation(const Points& vertices,
                                                                 const std::vector<Motion>& carried) const {
  std::vector<Motion> motions = motions_;
  for (std::size_t r = 0; r + 1 < parts_.size(); ++r) {
    for (std::size_t m = parts_[r].first_motion; m < parts_[r + 1].first_motion; ++m) {
      motions[m] = conjugate(carried[r], motions[m]);
    }
  }
  return measure([&](std::size_t r, const Pair& pair) -> Eigen::Vector3d {
    const Motion& motion = motions[static_cast<std::size_t>(pair.motion)];
    const Eigen::Vector3d position = vertices.row(pair.vertex);
    return image(vertices, pair) - motion(position) - carried[r].linear * pair.offset;
  });
}

std::vector<ResidualPairs::Answer> ResidualPairs::of_free_deformation(const Points& vertices) const {
  // y(g p) - g(y(p) - t) - t is least over t.
  std::vector<Motion> carried(parts_.size());
  for (std::size_t r = 0; r + 1 < parts_.size(); ++r) {
    Eigen::Matrix3d system = 1e-12 * Eigen::Matrix3d::Identity();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (std::size_t i = parts_[r].first; i < parts_[r + 1].first; ++i) {
      const Pair& pair = pairs_[i];
      const Motion& motion = motions_[static_cast<std::size_t>(pair.motion)];
      const Eigen::Matrix3d rows = Eigen::Matrix3d::Identity() - motion.linear;
      const Eigen::Vector3d position = vertices.row(pair.vertex);
      system += rows.transpose() * rows;
      right += rows.transpose() * (image(vertices, pair) - motion(position) - pair.offset);
    }
    carried[r].translation = system.ldlt().solve(right);
  }
  return of_deformation(vertices, carried);
}

std::vector<ResidualPairs::Answer> ResidualPairs::of_shape(const Points& vertices) const {
  return measure([&](std::size_t, const Pair& pair) -> Eigen::Vector3d {
    const Eigen::Vector3d position = vertices.row(pair.vertex);
    return image(vertices, pair) - motions_[static_cast<std::size_t>(pair.motion)](position);
  });
}

}  // namespace orbifit::editor
