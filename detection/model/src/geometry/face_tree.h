#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <vector>

#include <Eigen/Core>

namespace orbifit {

/// A ray in a tree's frame, single precision; `far` is negative where occluded() has met something.
struct TreeRay {
  Eigen::Vector3f origin, direction;  ///< unit direction
  float near = 0, far = 0;
};

struct TreeHit {
  unsigned face = 0;
  float distance = 0;
  float u = 0, v = 0;  ///< weights of the second and the third corner
};

/// What a search does with a face that it comes to: may lower the radius within which the search goes on. \return
/// whether it did
using MeasureFace = bool (*)(void* search, unsigned face, float& radius);

/// The corners of a face; the tree's frame has all of them within a few units of its origin.
using TreeFace = std::array<Eigen::Vector3f, 3>;

/// Embree's tree (face_tree_embree.cpp).
class EmbreeTree {
 public:
  explicit EmbreeTree(const std::vector<TreeFace>& faces);
  ~EmbreeTree();
  EmbreeTree(const EmbreeTree&) = delete;
  EmbreeTree& operator=(const EmbreeTree&) = delete;

  /// Calls measure() for each face whose box is within the radius, in whatever order.
  void search(const Eigen::Vector3f& point, float radius, MeasureFace measure, void* search) const;
  bool cast(const TreeRay& ray, TreeHit& hit) const;  ///< the first face
  bool occluded(const TreeRay& ray) const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// The same where Embree is not, as in WebAssembly: a full binary tree of boxes over the faces in the order in which
/// they are given, which is to have neighbours in space near one another.
class BoxTree {
 public:
  explicit BoxTree(const std::vector<TreeFace>& faces);

  void search(const Eigen::Vector3f& point, float radius, MeasureFace measure, void* search) const;
  bool cast(const TreeRay& ray, TreeHit& hit) const;
  bool occluded(const TreeRay& ray) const;

 private:
  struct Box {
    Eigen::Vector3f low, high;
  };
  std::size_t first_face(std::size_t leaf) const { return faces_.size() * leaf / leaves_; }
  template <class Reach, class Visit>
  void walk(const Reach& reach, const Visit& visit) const;
  bool meet(const TreeRay& ray, std::size_t face, TreeHit& hit) const;

  std::vector<TreeFace> faces_;
  std::size_t leaves_ = 0;  // a power of two
  std::vector<Box> boxes_;  // the children of node i are 2 i + 1 and 2 i + 2; the leaves come last
};

#ifdef ORBIFIT_PORTABLE
using FaceTree = BoxTree;
#else
using FaceTree = EmbreeTree;
#endif

}  // namespace orbifit
