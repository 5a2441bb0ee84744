#include "symmetry/generating_set.h"

#include <algorithm>
#include <cstddef>

namespace orbifit {

namespace {

constexpr double kSameElement = 1e-6;

// Number of the element whose linear part is `linear`: within a point group that says which it is. -1: none.
int find_element(const std::vector<Motion>& elements, const Eigen::Matrix3d& linear) {
  for (std::size_t e = 0; e < elements.size(); ++e) {
    if ((elements[e].linear - linear).cwiseAbs().maxCoeff() < kSameElement) return static_cast<int>(e);
  }
  return -1;
}

// Marks all products of the generators.
std::vector<char> generated(const std::vector<Motion>& elements, const std::vector<Motion>& generators) {
  std::vector<char> reached(elements.size(), 0);
  std::vector<std::size_t> queue{0};
  reached[0] = 1;
  for (std::size_t head = 0; head < queue.size(); ++head) {
    for (const Motion& generator : generators) {
      const int product = find_element(elements, generator.linear * elements[queue[head]].linear);
      if (product < 0 || reached[static_cast<std::size_t>(product)] != 0) continue;
      reached[static_cast<std::size_t>(product)] = 1;
      queue.push_back(static_cast<std::size_t>(product));
    }
  }
  return reached;
}

}  // namespace

std::vector<Motion> generating_set(const Region& region) {
  // The elements' own copies of the generators: those are what is checked.
  std::vector<Motion> result;
  for (const Motion& generator : region.generators) {
    const int element = find_element(region.elements, generator.linear);
    if (element > 0) result.push_back(region.elements[static_cast<std::size_t>(element)]);
  }
  if (region.elements.empty()) return result;
  std::vector<char> reached = generated(region.elements, result);
  for (std::size_t e = 1; e < region.elements.size(); ++e) {
    if (reached[e] != 0) continue;
    result.push_back(region.elements[e]);
    reached = generated(region.elements, result);
  }
  return result;
}

}  // namespace orbifit
