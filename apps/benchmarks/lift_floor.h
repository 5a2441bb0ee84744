#pragma once

#include <cstddef>

#include "stopwatch.h"

namespace orbifit::benchmarks {

/// What a lift would cost if it were nothing but memory traffic: the time to sum up `read` bytes and to write
/// `written` bytes, by `threads` threads that each take their share, in milliseconds. Passes follow each other, so the
/// caches hold as much of the bytes as they do of a lift that is repeated.
double stream_ms(std::size_t read, std::size_t written, int threads, const TimingOptions& options);

}  // namespace orbifit::benchmarks
