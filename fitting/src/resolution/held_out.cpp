#include "resolution/held_out.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>

#include "base/random.h"

namespace orbifit {

namespace {

constexpr double kHeldOut = 0.1;  // of the scan
constexpr double kSure = 2;       // standard errors of what held-out points gain

}  // namespace

std::vector<char> some_patches(const Points& points, double width, std::uint64_t seed) {
  std::map<std::array<double, 3>, char> chosen;  // by cell
  Random random(seed, "held out");
  std::vector<char> result;
  for (const auto& point : points.rowwise()) {
    const auto cell = [&](int c) { return std::floor(point[c] / width); };
    const auto [entry, added] = chosen.try_emplace({cell(0), cell(1), cell(2)}, char{0});
    if (added) entry->second = random.uniform(0, 1) < kHeldOut ? 1 : 0;
    result.push_back(entry->second);
  }
  return result;
}

std::vector<double> of_chosen(const std::vector<double>& of_points, const std::vector<char>& chosen) {
  std::vector<double> result;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    if (chosen[i] != 0) result.push_back(of_points[i]);
  }
  return result;
}

double root_mean(const std::vector<double>& squares) {
  return std::sqrt(std::accumulate(squares.begin(), squares.end(), 0.0) / static_cast<double>(squares.size()));
}

bool smaller(const std::vector<double>& before, const std::vector<double>& after) {
  const auto count = static_cast<double>(before.size());
  double sum = 0, squares = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const double gain = before[i] - after[i];
    sum += gain;
    squares += gain * gain;
  }
  const double mean = sum / count;
  return mean > kSure * std::sqrt(std::max(0.0, squares / count - mean * mean) / count);
}

}  // namespace orbifit
