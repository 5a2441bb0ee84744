#include "surface/repeated_parts.h"

#include <algorithm>
#include <functional>
#include <set>
#include <utility>
#include <vector>

#include "base/disjoint_sets.h"

namespace orbifit {

namespace {

constexpr std::size_t kMaxHosts = 24;

using Pair = std::pair<int, int>;

std::vector<Pair> neighbours(const PreparedMesh& prepared) {
  std::set<Pair> pairs;
  const auto piece_of = [&](int face) { return prepared.components.component_of_face[static_cast<std::size_t>(face)]; };
  for (const Edge& edge : welded_edges(prepared.mesh, prepared.weld)) {
    for (const int f : edge.faces) {
      for (const int g : edge.faces) {
        if (piece_of(f) < piece_of(g)) pairs.emplace(piece_of(f), piece_of(g));
      }
    }
  }
  return {pairs.begin(), pairs.end()};
}

// The parts that the pieces make up without the host.
DisjointSets parts_without(const std::vector<char>& host, const std::vector<Pair>& pairs) {
  DisjointSets sets(host.size());
  for (const auto& [a, b] : pairs) {
    if (host[static_cast<std::size_t>(a)] == 0 && host[static_cast<std::size_t>(b)] == 0) sets.unite(a, b);
  }
  return sets;
}

// Area in parts of which there are at least three of about equal area, by numbers of their own.
double repeated_area(DisjointSets& sets, const std::vector<char>& host, const std::vector<double>& areas) {
  constexpr double kEqual = 0.03;
  constexpr std::size_t kMin = 3;
  std::vector<double> of_root(areas.size(), 0);
  for (std::size_t p = 0; p < areas.size(); ++p) {
    if (host[p] == 0) of_root[static_cast<std::size_t>(sets.root(static_cast<int>(p)))] += areas[p];
  }
  std::erase_if(of_root, [](double area) { return area <= 0; });
  std::ranges::sort(of_root, std::greater<>());
  double result = 0;
  for (std::size_t first = 0; first < of_root.size();) {
    std::size_t end = first;
    double sum = 0;
    for (; end < of_root.size() && of_root[end] >= (1 - kEqual) * of_root[first]; ++end) sum += of_root[end];
    if (end - first >= kMin) result += sum;
    first = end;
  }
  return result;
}

// Takes pieces into the host or out of it, one at a time, as long as more repeats then.
void improve(std::vector<char>& host, double best, const std::vector<int>& largest, const std::vector<Pair>& pairs,
             const std::vector<double>& areas) {
  constexpr int kRounds = 12;
  constexpr std::size_t kMaxTried = 200;
  for (int round = 0; round < kRounds; ++round) {
    int better = -1;
    for (std::size_t k = 0; k < std::min(kMaxTried, largest.size()); ++k) {
      char& in = host[static_cast<std::size_t>(largest[k])];
      in ^= 1;
      DisjointSets sets = parts_without(host, pairs);
      const double repeated = repeated_area(sets, host, areas);
      in ^= 1;
      if (repeated <= 1.01 * best) continue;
      best = repeated;
      better = largest[k];
    }
    if (better < 0) return;
    host[static_cast<std::size_t>(better)] ^= 1;
  }
}

}  // namespace

Components repeated_parts(const PreparedMesh& prepared) {
  const std::vector<Pair> pairs = neighbours(prepared);
  std::vector<double> areas;
  std::vector<int> largest;
  for (std::size_t p = 0; p < prepared.components.faces.size(); ++p) {
    areas.push_back(area_of(prepared, prepared.components.faces[p]));
    largest.push_back(static_cast<int>(p));
  }
  std::ranges::stable_sort(largest, std::greater<>(), [&](int p) { return areas[static_cast<std::size_t>(p)]; });
  std::vector<char> host(areas.size(), 0);
  std::vector<char> best_host = host;
  double best = 0;
  for (std::size_t k = 0; k < std::min(kMaxHosts, largest.size()); ++k) {
    host[static_cast<std::size_t>(largest[k])] = 1;
    DisjointSets sets = parts_without(host, pairs);
    const double repeated = repeated_area(sets, host, areas);
    if (repeated <= 1.01 * best) continue;
    best = repeated;
    best_host = host;
  }
  improve(best_host, best, largest, pairs, areas);
  DisjointSets sets = parts_without(best_host, pairs);
  Components result;
  std::vector<int> number(areas.size(), -1);
  for (const int piece : prepared.components.component_of_face) {
    int& of_root = number[static_cast<std::size_t>(sets.root(piece))];
    if (of_root < 0) {
      of_root = static_cast<int>(result.faces.size());
      result.faces.emplace_back();
    }
    result.faces[static_cast<std::size_t>(of_root)].push_back(static_cast<int>(result.component_of_face.size()));
    result.component_of_face.push_back(of_root);
  }
  return result;
}

}  // namespace orbifit
