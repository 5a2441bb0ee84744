#pragma once

#include <functional>

namespace orbifit::benchmarks {

/// How often an operation is timed.
struct TimingOptions {
  int repetitions = 7;          ///< batches of which the median is taken, >= 1
  double batch_seconds = 2e-3;  ///< an operation that is shorter is run several times in a batch
  double most_seconds = 10;     ///< a slow operation is repeated less often, but once at least
};

double seconds_now();

/// Median time of one run of `operation`, in milliseconds. The first run is a warm-up and is left out where the
/// operation is run more than once.
double median_ms(const std::function<void()>& operation, const TimingOptions& options);

}  // namespace orbifit::benchmarks
