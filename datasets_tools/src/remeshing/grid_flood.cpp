#include "remeshing/grid_flood.h"

#include <algorithm>

namespace orbifit {

namespace {

constexpr std::uint8_t kSeen = 2;  // a bit beside inner or outer

class Flood {
 public:
  Flood(std::vector<std::uint8_t>& inside, const std::array<int, 3>& nodes)
      : inside_(inside), nodes_(nodes), strides_{1, nodes[0], static_cast<std::ptrdiff_t>(nodes[0]) * nodes[1]} {}

  // Marks all nodes like `first` that can be reached from it, and lists them.
  const std::vector<std::ptrdiff_t>& from(std::ptrdiff_t first) {
    reached_.assign(1, first);
    const std::uint8_t kind = at(first);
    at(first) |= kSeen;
    for (std::size_t next = 0; next < reached_.size(); ++next) {
      const std::ptrdiff_t node = reached_[next];
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::ptrdiff_t place = node / strides_[axis] % nodes_[axis];
        if (place > 0) visit(node - strides_[axis], kind);
        if (place + 1 < nodes_[axis]) visit(node + strides_[axis], kind);
      }
    }
    return reached_;
  }

 private:
  std::uint8_t& at(std::ptrdiff_t node) { return inside_[static_cast<std::size_t>(node)]; }

  void visit(std::ptrdiff_t node, std::uint8_t kind) {
    if (at(node) != kind) return;
    at(node) |= kSeen;
    reached_.push_back(node);
  }

  std::vector<std::uint8_t>& inside_;
  const std::array<int, 3>& nodes_;
  std::array<std::ptrdiff_t, 3> strides_;
  std::vector<std::ptrdiff_t> reached_;
};

}  // namespace

void fill_voids(std::vector<std::uint8_t>& inside, const std::array<int, 3>& nodes) {
  Flood(inside, nodes).from(0);
  for (std::uint8_t& node : inside) node = node == kSeen ? 0 : 1;
}

void drop_crumbs(std::vector<std::uint8_t>& inside, const std::array<int, 3>& nodes, std::size_t least) {
  Flood flood(inside, nodes);
  std::vector<std::ptrdiff_t> crumbs;
  for (std::size_t node = 0; node < inside.size(); ++node) {
    if (inside[node] != 1) continue;
    const auto& piece = flood.from(static_cast<std::ptrdiff_t>(node));
    if (piece.size() < least) crumbs.insert(crumbs.end(), piece.begin(), piece.end());
  }
  for (std::uint8_t& node : inside) node &= 1;
  for (const std::ptrdiff_t node : crumbs) inside[static_cast<std::size_t>(node)] = 0;
}

}  // namespace orbifit
