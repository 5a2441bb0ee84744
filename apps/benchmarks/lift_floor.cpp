#include "lift_floor.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <thread>
#include <vector>

namespace orbifit::benchmarks {

namespace {

// Long enough that starting threads does not count.
constexpr double kBatchSeconds = 0.02;

struct alignas(64) Line {
  std::array<std::uint64_t, 8> words;
};

// Compiled twice, the processor chooses.
__attribute__((target_clones("avx2", "default"), optimize("O3"))) std::uint64_t sum_up(const Line* data,
                                                                                       std::size_t count) {
  std::array<std::uint64_t, 16> sums{};
  for (std::size_t i = 0; i + 1 < count; i += 2) {
    for (std::size_t k = 0; k < 8; ++k) sums[k] += data[i].words[k];
    for (std::size_t k = 0; k < 8; ++k) sums[8 + k] += data[i + 1].words[k];
  }
  if (count % 2 == 1) sums[0] += data[count - 1].words[0];
  return std::accumulate(sums.begin(), sums.end(), std::uint64_t{0});
}

__attribute__((target_clones("avx2", "default"), optimize("O3"))) void fill(Line* data, std::size_t count,
                                                                            std::uint64_t value) {
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t k = 0; k < 8; ++k) data[i].words[k] = value;
  }
}

std::vector<Line> buffer(std::size_t bytes) {
  std::vector<Line> lines(std::max<std::size_t>(1, bytes / sizeof(Line)));
  fill(lines.data(), lines.size(), 1);
  return lines;
}

class Stream {
 public:
  Stream(std::size_t read, std::size_t written, int threads)
      : source_(buffer(read)), target_(buffer(written)), threads_(static_cast<std::size_t>(std::max(threads, 1))) {}

  // Seconds a pass over all bytes, of `passes` one after the other.
  double seconds(int passes) {
    const double start = seconds_now();
    {
      std::vector<std::jthread> workers;
      for (std::size_t part = 1; part < threads_; ++part) {
        workers.emplace_back([this, part, passes] { run(part, passes); });
      }
      run(0, passes);
    }
    return (seconds_now() - start) / passes;
  }

 private:
  void run(std::size_t part, int passes) {
    const auto share = [&](std::size_t count, std::size_t which) { return count * which / threads_; };
    const std::size_t read_from = share(source_.size(), part);
    const std::size_t read_to = share(source_.size(), part + 1);
    const std::size_t write_from = share(target_.size(), part);
    const std::size_t write_to = share(target_.size(), part + 1);
    std::uint64_t sum = 0;
    for (int pass = 0; pass < passes; ++pass) {
      sum += sum_up(source_.data() + read_from, read_to - read_from);
      fill(target_.data() + write_from, write_to - write_from, sum);
    }
    result_.fetch_add(sum, std::memory_order_relaxed);
  }

  std::vector<Line> source_, target_;
  std::size_t threads_;
  std::atomic<std::uint64_t> result_{0};  // so that no pass can be left out
};

}  // namespace

double stream_ms(std::size_t read, std::size_t written, int threads, const TimingOptions& options) {
  Stream stream(read, written, threads);
  stream.seconds(1);
  const double once = std::max(stream.seconds(2), 1e-8);
  const int passes = static_cast<int>(std::clamp(std::ceil(kBatchSeconds / once), 1.0, 1e6));
  std::vector<double> times;
  for (int i = 0; i < std::max(options.repetitions, 3); ++i) times.push_back(stream.seconds(passes));
  std::ranges::nth_element(times, times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2));
  return 1e3 * times[times.size() / 2];
}

}  // namespace orbifit::benchmarks
