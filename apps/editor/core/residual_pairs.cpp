#include "residual_pairs.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

namespace orbifit::editor {

namespace {

constexpr std::size_t kPairs = 600;  // of a region, about

}  // namespace

ResidualPairs::ResidualPairs(const Mesh& mesh, const SymmetryAnnotation& annotation, const SymmetricImages& images)
    : rest_(mesh), shape_(mesh) {
  const double size = diagonal(mesh.vertices);
  if (size > 0) size_ = size;
  for (std::size_t r = 0; r < annotation.regions.size(); ++r) {
    const std::vector<int>& faces = faces_.emplace_back(annotation.regions[r].faces);
    const std::vector<Motion>& motions = images.motions(static_cast<int>(r));
    const std::vector<int> vertices = vertices_of_faces(mesh, faces);
    first_.push_back(pairs_.size());
    const std::size_t all = motions.size() * vertices.size();
    std::size_t step = std::max<std::size_t>(1, all / kPairs);
    while (motions.size() > 1 && step % motions.size() == 0) ++step;  // would meet one motion only
    const std::size_t first_motion = motions_.size();
    motions_.insert(motions_.end(), motions.begin(), motions.end());
    for (std::size_t k = 0; k < all; k += step) {
      pairs_.push_back({vertices[k / motions.size()], static_cast<int>(first_motion + k % motions.size())});
    }
  }
  first_.push_back(pairs_.size());
  images_.resize(static_cast<Eigen::Index>(pairs_.size()), 3);
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    const Eigen::Vector3d position = mesh.vertices.row(pairs_[i].vertex);
    images_.row(static_cast<Eigen::Index>(i)) = motions_[static_cast<std::size_t>(pairs_[i].motion)](position);
  }
}

// \param distance  (region, pair) -> mesh units
template <class Distance>
std::vector<Residual> ResidualPairs::measure(const Distance& distance) const {
  std::vector<Residual> result;
  for (std::size_t r = 0; r + 1 < first_.size(); ++r) {
    Residual& residual = result.emplace_back();
    double squares = 0;
    for (std::size_t i = first_[r]; i < first_[r + 1]; ++i) {
      const double share = distance(r, i) / size_;
      squares += share * share;
      residual.max = std::max(residual.max, share);
    }
    if (first_[r + 1] > first_[r]) residual.rms = std::sqrt(squares / static_cast<double>(first_[r + 1] - first_[r]));
  }
  return result;
}

std::vector<Residual> ResidualPairs::of_displacement(const Points& vertices, const Points& displacements) const {
  // y(g p) = g p + d(g p) is to be g(y(p) - t) + t: of d(g p) - G d(p) = (1 - G) t the least squares over t.
  const auto gap = [&](std::size_t i) -> Eigen::Vector3d {
    const Motion& motion = motions_[static_cast<std::size_t>(pairs_[i].motion)];
    const Eigen::Vector3d moved = vertices.row(pairs_[i].vertex) - rest_.vertices.row(pairs_[i].vertex);
    return displacements.row(static_cast<Eigen::Index>(i)).transpose() - motion.linear * moved;
  };
  const auto shift = [&](std::size_t i) -> Eigen::Matrix3d {
    return Eigen::Matrix3d::Identity() - motions_[static_cast<std::size_t>(pairs_[i].motion)].linear;
  };
  std::vector<Eigen::Vector3d> carried;
  for (std::size_t r = 0; r + 1 < first_.size(); ++r) {
    Eigen::Matrix3d system = 1e-12 * Eigen::Matrix3d::Identity();  // along a plane or an axis t is free
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (std::size_t i = first_[r]; i < first_[r + 1]; ++i) {
      system += shift(i).transpose() * shift(i);
      right += shift(i).transpose() * gap(i);
    }
    carried.emplace_back(system.ldlt().solve(right));
  }
  return measure([&](std::size_t r, std::size_t i) { return (gap(i) - shift(i) * carried[r]).norm(); });
}

std::vector<Residual> ResidualPairs::of_shape(const Points& vertices, const RunContext& context) {
  shape_.vertices = vertices;
  const bool first = surfaces_.empty();
  for (std::size_t r = 0; r < faces_.size(); ++r) {
    if (first) {
      surfaces_.emplace_back(shape_, faces_[r]);
    } else {
      surfaces_[r].move(shape_, context);
    }
  }
  return measure([&](std::size_t r, std::size_t i) {
    const Eigen::Vector3d position = vertices.row(pairs_[i].vertex);
    return surfaces_[r].nearest(motions_[static_cast<std::size_t>(pairs_[i].motion)](position)).distance;
  });
}

}  // namespace orbifit::editor
