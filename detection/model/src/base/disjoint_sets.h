#pragma once

#include <algorithm>
#include <cstddef>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

namespace orbifit {

/// Union-find over 0 ... count - 1. The roots are the lowest members, so that the result does not depend on the order
/// of the unions. Finding a root halves paths: nearly constant time.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0); }

  int root(int member) {
    while (parent_[static_cast<std::size_t>(member)] != member) {
      int& parent = parent_[static_cast<std::size_t>(member)];
      parent = parent_[static_cast<std::size_t>(parent)];
      member = parent;
    }
    return member;
  }

  void unite(int a, int b) {
    const int root_a = root(a);
    const int root_b = root(b);
    parent_[static_cast<std::size_t>(std::max(root_a, root_b))] = std::min(root_a, root_b);
  }

  std::size_t size() const { return parent_.size(); }

  /// The members of each set, ascending, by the sets' roots.
  std::vector<std::vector<std::size_t>> sets() {
    std::map<int, std::vector<std::size_t>> by_root;
    for (std::size_t i = 0; i < size(); ++i) by_root[root(static_cast<int>(i))].push_back(i);
    std::vector<std::vector<std::size_t>> result;
    for (auto& [root, members] : by_root) result.push_back(std::move(members));
    return result;
  }

 private:
  std::vector<int> parent_;
};

}  // namespace orbifit
