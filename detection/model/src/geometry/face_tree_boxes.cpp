#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Geometry>

#include "geometry/face_tree.h"

namespace orbifit {

namespace {

constexpr std::size_t kLeaf = 4;    // faces, at most
constexpr std::size_t kDepth = 64;  // of the tree: more than a size_t of faces takes
constexpr float kNowhere = std::numeric_limits<float>::infinity();

// Rounding of where a ray meets a box or a face, in units of the tree's frame; several times the worst case.
constexpr float kSlack = 2e-6F;

}  // namespace

BoxTree::BoxTree(const std::vector<TreeFace>& faces) : faces_(faces), leaves_(1) {
  while (leaves_ * kLeaf < faces_.size()) leaves_ *= 2;
  boxes_.resize(2 * leaves_ - 1);
  for (std::size_t leaf = 0; leaf < leaves_; ++leaf) {
    Box& box = boxes_[leaves_ - 1 + leaf];
    box.low.setConstant(kNowhere);
    box.high.setConstant(-kNowhere);
    for (std::size_t i = first_face(leaf); i < first_face(leaf + 1); ++i) {
      for (const Eigen::Vector3f& corner : faces_[i]) {
        box.low = box.low.cwiseMin(corner);
        box.high = box.high.cwiseMax(corner);
      }
    }
  }
  for (std::size_t node = leaves_ - 1; node-- > 0;) {
    const Box& left = boxes_[2 * node + 1];
    const Box& right = boxes_[2 * node + 2];
    boxes_[node] = {left.low.cwiseMin(right.low), left.high.cwiseMax(right.high)};
  }
}

// Visits the faces of all leaves within reach, nearer nodes first. \param reach  of a box: how far away it is, infinity
// where it is of no use any more \param visit  of a face: false ends the walk
template <class Reach, class Visit>
void BoxTree::walk(const Reach& reach, const Visit& visit) const {
  std::array<std::size_t, kDepth> stack{};
  std::size_t count = 0;
  stack[count++] = 0;
  while (count > 0) {
    const std::size_t node = stack[--count];
    if (!(reach(boxes_[node]) < kNowhere)) continue;
    if (node >= leaves_ - 1) {
      const std::size_t leaf = node - (leaves_ - 1);
      for (std::size_t i = first_face(leaf); i < first_face(leaf + 1); ++i) {
        if (!visit(i)) return;
      }
      continue;
    }
    std::pair near{reach(boxes_[2 * node + 1]), 2 * node + 1};
    std::pair far{reach(boxes_[2 * node + 2]), 2 * node + 2};
    if (far.first < near.first) std::swap(near, far);
    if (far.first < kNowhere) stack[count++] = far.second;
    if (near.first < kNowhere) stack[count++] = near.second;
  }
}

void BoxTree::search(const Eigen::Vector3f& point, float radius, MeasureFace measure, void* search) const {
  const auto reach = [&](const Box& box) {
    const Eigen::Array3f outside = (box.low - point).array().max((point - box.high).array()).max(0.0F);
    const float distance = std::sqrt((outside * outside).sum());
    return distance <= radius ? distance : kNowhere;
  };
  walk(reach, [&](std::size_t face) {
    measure(search, static_cast<unsigned>(face), radius);
    return true;
  });
}

// Moeller and Trumbore 1997. \return whether the ray meets the face nearer than `hit`, which is then replaced
bool BoxTree::meet(const TreeRay& ray, std::size_t face, TreeHit& hit) const {
  const TreeFace& corners = faces_[face];
  const Eigen::Vector3d origin = ray.origin.cast<double>();
  const Eigen::Vector3d direction = ray.direction.cast<double>();
  const Eigen::Vector3d a = corners[0].cast<double>();
  const Eigen::Vector3d ab = corners[1].cast<double>() - a;
  const Eigen::Vector3d ac = corners[2].cast<double>() - a;
  const Eigen::Vector3d across = direction.cross(ac);
  const double determinant = ab.dot(across);
  if (determinant == 0) return false;
  const Eigen::Vector3d from = origin - a;
  // The slack closes the seams between faces.
  const double u = from.dot(across) / determinant;
  const Eigen::Vector3d beside = from.cross(ab);
  const double v = direction.dot(beside) / determinant;
  if (u < -kSlack || v < -kSlack || u + v > 1 + kSlack) return false;
  const auto distance = static_cast<float>(ac.dot(beside) / determinant);
  if (!(distance >= ray.near && distance < hit.distance)) return false;
  hit = {static_cast<unsigned>(face), distance, static_cast<float>(std::max(u, 0.0)),
         static_cast<float>(std::max(v, 0.0))};
  return true;
}

bool BoxTree::cast(const TreeRay& ray, TreeHit& hit) const {
  const Eigen::Array3f inverse = ray.direction.array().inverse();
  bool met = false;
  hit = TreeHit{0, ray.far, 0, 0};
  const auto reach = [&](const Box& box) {
    float begin = ray.near;
    float end = hit.distance;
    for (int k = 0; k < 3; ++k) {
      const float low = box.low[k] - kSlack - ray.origin[k];
      const float high = box.high[k] + kSlack - ray.origin[k];
      if (ray.direction[k] == 0) {
        if (low > 0 || high < 0) return kNowhere;
        continue;
      }
      const float first = low * inverse[k];
      const float second = high * inverse[k];
      begin = std::max(begin, std::min(first, second) - kSlack);
      end = std::min(end, std::max(first, second) + kSlack);
    }
    return begin <= end ? begin : kNowhere;
  };
  walk(reach, [&](std::size_t face) {
    met = meet(ray, face, hit) || met;
    return true;
  });
  return met;
}

bool BoxTree::occluded(const TreeRay& ray) const {
  TreeHit hit;
  return cast(ray, hit);
}

}  // namespace orbifit
