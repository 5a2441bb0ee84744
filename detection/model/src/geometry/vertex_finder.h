#pragma once

#include <vector>

#include "orbifit/model/mesh.h"

#include "geometry/vertex_grid.h"

namespace orbifit {

/// Which vertex lies at a place. Const calls may run on several threads.
class VertexFinder {
 public:
  static constexpr int kNone = -1;     ///< no vertex lies there
  static constexpr int kSeveral = -2;  ///< ask grid() which

  /// \param vertices  kept by reference \param tolerance  how near is there, mesh units
  VertexFinder(const Points& vertices, double tolerance) : vertices_(vertices), grid_(vertices, tolerance) {}
  VertexFinder(const VertexFinder&) = delete;
  VertexFinder& operator=(const VertexFinder&) = delete;

  const VertexGrid& grid() const { return grid_; }

  /// The vertex there, or kNone, or kSeveral. O(1), on average.
  int at(const Eigen::Vector3d& place) const;

  /// Finds out which vertices have no other near them: without that, walks are not sooner than at(). O(#V)
  void prepare_walks();

  /// Asks of many places, such as images of vertices in turn. Neighbours have neighbouring numbers mostly, and so have
  /// their images: the next one's is looked for beside the last one's first. The answers are those of at().
  class Walk {
   public:
    explicit Walk(const VertexFinder& of) : of_(of) {}

    /// \param number  of what lies there, ascending from one call to the next
    int at(int number, const Eigen::Vector3d& place);

   private:
    const VertexFinder& of_;
    int number_ = 0;  // the last one at whose place a vertex was, and that
    int vertex_ = kNone;
    int direction_ = 1;
  };

 private:
  // Whether a vertex, if there is one of that number, lies at a place, and surely no other.
  bool alone_at(int vertex, const Eigen::Vector3d& place) const;

  const Points& vertices_;
  VertexGrid grid_;
  std::vector<char> lone_;  // whether no other vertex lies near each, once that was found out
};

}  // namespace orbifit
