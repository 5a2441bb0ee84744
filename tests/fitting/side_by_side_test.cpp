#include "side_by_side.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "orbifit/model/errors.h"

namespace orbifit {
namespace {

class SideBySide : public testing::TestWithParam<int> {
 protected:
  SideBySide() {
    context_.threads = GetParam();
    context_.on_message = [this](std::string_view text) { told_.emplace_back(text); };
  }

  RunContext context_;
  std::vector<std::string> told_;
};

TEST_P(SideBySide, RunsAllAndTellsTheirMessagesInTheirOrder) {
  std::vector<int> done(3, 0);
  std::vector<SideTask> tasks;
  for (std::size_t i = 0; i < done.size(); ++i) {
    tasks.emplace_back([&done, i](const RunContext& own) {
      own.message(std::to_string(i) + ", first");
      own.message(std::to_string(i) + ", second");
      done[i] = 1;
    });
  }
  side_by_side(tasks, context_);
  EXPECT_EQ(done, (std::vector<int>{1, 1, 1}));
  EXPECT_EQ(told_,
            (std::vector<std::string>{"0, first", "0, second", "1, first", "1, second", "2, first", "2, second"}));
}

TEST_P(SideBySide, ThrowsWhatATaskThrew) {
  const std::vector<SideTask> tasks{[](const RunContext& own) { own.message("said before"); },
                                    [](const RunContext&) { throw NoResultError("nothing"); }};
  EXPECT_THROW(side_by_side(tasks, context_), NoResultError);
  EXPECT_EQ(told_, std::vector<std::string>{"said before"});
}

TEST_P(SideBySide, OneTaskTellsItsProgress) {
  int told = 0;
  context_.on_progress = [&](std::string_view, double) { ++told; };
  const SideTask task = [](const RunContext& own) { own.progress("stage", 0.5); };
  side_by_side({task, task}, context_);
  EXPECT_EQ(told, GetParam() == 1 ? 2 : 1);
}

INSTANTIATE_TEST_SUITE_P(Threads, SideBySide, testing::Values(1, 2));

}  // namespace
}  // namespace orbifit
