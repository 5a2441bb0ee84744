#include "group/subgroups_within.h"

#include <algorithm>
#include <functional>

namespace orbifit {

std::vector<std::vector<char>> subgroups_within(const std::vector<Eigen::Matrix3d>& linear,
                                                const std::vector<std::vector<char>>& masks) {
  const std::size_t order = linear.size();
  std::vector<std::vector<std::size_t>> product(order, std::vector<std::size_t>(order, 0));
  for (std::size_t a = 0; a < order; ++a) {
    for (std::size_t b = 0; b < order; ++b) {
      const Eigen::Matrix3d wanted = linear[a] * linear[b];
      for (std::size_t c = 0; c < order; ++c) {
        if ((linear[c] - wanted).cwiseAbs().maxCoeff() < 1e-6) product[a][b] = c;
      }
    }
  }
  std::vector<std::vector<char>> found;
  for (const std::vector<char>& mask : masks) {
    for (std::size_t a = 1; a < order; ++a) {
      for (std::size_t b = a; b < order; ++b) {
        if (mask[a] == 0 || mask[b] == 0) continue;
        std::vector<char> members(order, 0);
        members[0] = 1;
        std::vector<std::size_t> open{0};
        bool inside = true;
        while (!open.empty() && inside) {
          const std::size_t last = open.back();
          open.pop_back();
          for (const std::size_t next : {product[a][last], product[b][last]}) {
            if (members[next] != 0) continue;
            inside = inside && mask[next] != 0;
            members[next] = 1;
            open.push_back(next);
          }
        }
        if (inside && std::ranges::find(found, members) == found.end()) found.push_back(members);
      }
    }
  }
  std::ranges::stable_sort(found, std::greater<>(),
                           [](const std::vector<char>& m) { return std::ranges::count(m, 1); });
  return found;
}

}  // namespace orbifit
