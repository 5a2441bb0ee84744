#include <atomic>
#include <chrono>
#include <cstddef>
#include <numeric>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "orbifit/model/errors.h"
#include "orbifit/model/run_context.h"

namespace orbifit {
namespace {

class ParallelFor : public testing::TestWithParam<int> {
 protected:
  ParallelFor() { context_.threads = GetParam(); }
  RunContext context_;
};

TEST_P(ParallelFor, VisitsEachItemOnce) {
  for (const std::size_t count : {0U, 1U, 2U, 63U, 64U, 65U, 1000U}) {
    std::vector<int> visits(count, 0);
    parallel_for(context_, count, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) ++visits[i];
    });
    EXPECT_EQ(visits, std::vector<int>(count, 1));
  }
}

TEST_P(ParallelFor, LoopsWithinLoopsVisitEachItemOnce) {
  constexpr std::size_t kOuter = 40;
  constexpr std::size_t kInner = 300;
  std::vector<std::vector<std::size_t>> values(kOuter, std::vector<std::size_t>(kInner));
  parallel_for(context_, kOuter, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      parallel_for(context_, kInner, [&, i](std::size_t from, std::size_t to) {
        for (std::size_t k = from; k < to; ++k) values[i][k] += i * kInner + k;
      });
    }
  });
  std::size_t expected = 0;
  for (const std::vector<std::size_t>& row : values) {
    for (const std::size_t value : row) EXPECT_EQ(value, expected++);
  }
}

TEST_P(ParallelFor, ChunksDoNotDependOnTheThreads) {
  std::vector<std::size_t> ends(1000, 0);
  parallel_for(context_, ends.size(), [&](std::size_t begin, std::size_t end) { ends[begin] = end; });
  std::vector<std::size_t> expected(1000, 0);
  parallel_for(RunContext{}, expected.size(), [&](std::size_t begin, std::size_t end) { expected[begin] = end; });
  EXPECT_EQ(ends, expected);
}

TEST_P(ParallelFor, RethrowsWhatTheLowestChunkThrew) {
  const auto body = [](std::size_t begin, std::size_t) { throw std::runtime_error(std::to_string(begin)); };
  try {
    parallel_for(context_, 500, body);
    FAIL() << "nothing was thrown";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "0");
  }
}

TEST_P(ParallelFor, AnExceptionOfAnInnerLoopReachesTheOutermost) {
  const auto body = [&](std::size_t, std::size_t) {
    parallel_for(context_, 100, [](std::size_t begin, std::size_t) {
      if (begin > 50) throw UsageError("of the inner loop");
    });
  };
  EXPECT_THROW(parallel_for(context_, 100, body), UsageError);
}

TEST_P(ParallelFor, StopsWhereTheTimeHasPassed) {
  context_.deadline = std::chrono::steady_clock::now() - std::chrono::seconds(1);
  std::atomic<int> calls = 0;
  EXPECT_THROW(parallel_for(context_, 1000, [&](std::size_t, std::size_t) { ++calls; }), TimeoutError);
  EXPECT_EQ(calls, 0);
}

INSTANTIATE_TEST_SUITE_P(Threads, ParallelFor, testing::Values(1, 2, 3, 8));

// One context after another, and one within the other's loop, as tests and services have them.
TEST(ParallelForContexts, MayDifferInTheirThreads) {
  std::vector<int> sums(20, 0);
  RunContext two;
  two.threads = 2;
  RunContext four;
  four.threads = 4;
  parallel_for(two, sums.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      std::vector<int> parts(100, 0);
      parallel_for(four, parts.size(), [&](std::size_t from, std::size_t to) {
        for (std::size_t k = from; k < to; ++k) parts[k] = static_cast<int>(k);
      });
      sums[i] = std::accumulate(parts.begin(), parts.end(), 0);
    }
  });
  EXPECT_EQ(sums, std::vector<int>(20, 4950));
}

}  // namespace
}  // namespace orbifit
