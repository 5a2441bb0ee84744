#include <csignal>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "support/program.h"

namespace orbifit {
namespace {

// Each takes longer than the moments below.
class StoppedWork : public testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    ASSERT_EQ(program_.run("generate chair -o .").code, 0);
    ASSERT_EQ(program_.run("scan chair.ply --views 3 -o scan.ply").code, 0);
    before_ = program_.folder().listing();
  }

  void expect_stopped(const ProgramResult& result, int code, const std::string& said) {
    EXPECT_EQ(result.code, code) << result.errors;
    EXPECT_NE(result.errors.find("orbifit: " + said), std::string::npos) << result.errors;
    EXPECT_EQ(program_.folder().listing(), before_);
  }

  Program program_;
  std::set<std::string> before_;
};

TEST_P(StoppedWork, LeavesNothingAtAnyMoment) {
  for (const double seconds : {0.0, 0.02, 0.1}) {
    for (const int signal : {SIGINT, SIGTERM}) {
      expect_stopped(program_.run_and_signal(GetParam(), signal, seconds), 130, "interrupted");
    }
  }
}

TEST_P(StoppedWork, KeepsToTheTimeAllowed) {
  expect_stopped(program_.run(GetParam() + " --timeout 0.1"), 4, "stopped after 0.1 s (--timeout)");
}

INSTANTIATE_TEST_SUITE_P(Commands, StoppedWork,
                         testing::Values("detect chair.ply -o out.json",
                                         "subspace chair.ply chair.annotation.json --samples 9000 -o out.basis",
                                         "scan chair.ply --views 60 --width 4096 --height 4096 -o out.ply",
                                         "render chair.ply --width 4096 --height 4096 -o out.png",
                                         "fit chair.ply scan.ply -o out.obj --report out.json"),
                         [](const auto& command) { return command.param.substr(0, command.param.find(' ')); });

}  // namespace
}  // namespace orbifit
