#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"

#include "remeshing/closed_parts.h"

namespace orbifit {

/// Where a line of the grid passes through the union's outer surface.
struct Crossing {
  double place = 0;  ///< along the line, in cells from its first node
  int face = -1;     ///< of the parts' mesh
  bool leaves = false;
};

/// The union of closed parts as a grid of unit cells sees it.
class UnionScan {
 public:
  /// \param vertices  of the parts' mesh in the grid's frame: nodes are at whole numbers from 0
  /// \param nodes     along each axis; the parts lie within the outermost nodes
  UnionScan(const ClosedParts& parts, const Points& vertices, const std::array<int, 3>& nodes, RunContext& context);

  const std::array<int, 3>& nodes() const { return nodes_; }
  bool inside(int x, int y, int z) const { return inside_[node(x, y, z)] != 0; }

  /// The crossing of the edge from a node to the next one along `axis`. \pre one of them is inside
  Crossing crossing(int axis, const std::array<int, 3>& from) const;

  /// #F: whether lines met the face, but only inside of other parts.
  const std::vector<bool>& hidden() const { return hidden_; }

  /// #F: whether the face's corners run clockwise as seen from outside the union.
  const std::vector<bool>& turned() const { return turned_; }

 private:
  std::size_t node(int x, int y, int z) const {
    return static_cast<std::size_t>(x) +
           static_cast<std::size_t>(nodes_[0]) *
               (static_cast<std::size_t>(y) + static_cast<std::size_t>(nodes_[1]) * static_cast<std::size_t>(z));
  }

  std::array<int, 3> nodes_;
  std::vector<std::uint8_t> inside_;                // of each node
  std::array<std::vector<Crossing>, 3> crossings_;  // of the lines along each axis
  std::array<std::vector<int>, 3> first_of_line_;   // #lines + 1
  std::vector<bool> hidden_, turned_;
};

}  // namespace orbifit
