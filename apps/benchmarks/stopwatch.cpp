#include "stopwatch.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <vector>

namespace orbifit::benchmarks {

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double median_ms(const std::function<void()>& operation, const TimingOptions& options) {
  const auto time = [&](int runs) {
    const double start = seconds_now();
    for (int i = 0; i < runs; ++i) operation();
    return (seconds_now() - start) / runs;
  };
  const double first = time(1);
  if (first * options.repetitions > options.most_seconds && 2 * first > options.most_seconds) return 1e3 * first;
  // The first run is often slower than the others: what it takes to fill a batch is asked of the second.
  const double second = time(1);
  const int runs = static_cast<int>(std::clamp(std::ceil(options.batch_seconds / std::max(second, 1e-9)), 1.0, 1e6));
  const double affordable = options.most_seconds / std::max(second * runs, 1e-9);
  const int batches = static_cast<int>(std::clamp(affordable, 1.0, double(options.repetitions)));
  std::vector<double> times;
  for (int i = 0; i < batches; ++i) times.push_back(time(runs));
  std::ranges::sort(times);
  const std::size_t half = times.size() / 2;
  return 1e3 * (times.size() % 2 == 1 ? times[half] : 0.5 * (times[half - 1] + times[half]));
}

}  // namespace orbifit::benchmarks
