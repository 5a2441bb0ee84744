#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <set>
#include <string>
#include <thread>

#include <gtest/gtest.h>
#include <unistd.h>

#include "orbifit/model/errors.h"

#include "batch/batch_run.h"
#include "batch/results_file.h"
#include "files/file.h"
#include "temporary_folder.h"

// GCC has a macro for it, Clang a question.
#if defined(__SANITIZE_ADDRESS__)
#define ORBIFIT_ADDRESS_SANITIZER
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define ORBIFIT_ADDRESS_SANITIZER
#endif
#endif

namespace orbifit::batch {
namespace {

// What an item's id says is what happens to it.
Outcome misbehave(const Item& item, const std::filesystem::path& folder) {
  if (item.id == "crash") ::raise(SIGSEGV);
  if (item.id == "abort") std::abort();
  if (item.id == "exit") ::_exit(5);
  if (item.id == "killed") ::raise(SIGKILL);
  if (item.id == "hang") std::this_thread::sleep_for(std::chrono::hours(1));
  if (item.id == "bomb") {
    std::vector<std::string> all;
    while (true) all.emplace_back(std::size_t{1} << 20, 'x');
  }
  if (item.id == "throw") throw std::runtime_error("what it says");
  if (item.id == "loud") {
    for (int i = 0; i < 1000; ++i) std::puts("noise");
    std::fflush(stdout);
  }
  write_file(folder / "item.json", item.id + "\n");
  Outcome outcome;
  outcome.summary = R"({"seen":true})";
  if (item.id == "bad") outcome.status = Status::bad_input;
  if (item.id == "none") outcome.status = Status::no_symmetry;
  if (item.id == "full") {
    outcome.status = Status::bad_input;
    outcome.no_room = true;
    outcome.message = "the disk is full";
  }
  return outcome;
}

class Batch : public testing::Test {
 protected:
  Batch() {
    options.task = "detect";
    options.settings = "version 1";
    options.out = folder.file("out");
    options.limits.seconds = 0.5;
    options.limits.memory = std::uint64_t{64} << 20;
    options.kinds = {".json", "+more.json"};
    folder.write("mesh.obj", "v 0 0 0\n");
  }

  BatchCounts run(const std::vector<std::string>& ids, const Task& task = misbehave, const RunContext& context = {}) {
    std::string lines;
    for (const std::string& id : ids) lines += manifest_line({id, "mesh.obj", {}, {}, {}}) + "\n";
    const auto file = folder.write("manifest.jsonl", lines);
    return run_batch(Manifest::from_lines(file, options.shard), options, task, context);
  }

  std::map<std::string, Record> records() const {
    std::map<std::string, Record> result;
    for_each_record(options.out / "results-1.jsonl",
                    [&](const Record& record, std::uint64_t) { result[record.id] = record; });
    return result;
  }

  TemporaryFolder folder;
  BatchOptions options;
};

TEST_F(Batch, AnItemCostsItselfAlone) {
#ifdef ORBIFIT_ADDRESS_SANITIZER
  GTEST_SKIP() << "AddressSanitizer catches a segmentation fault itself, and maps more memory than the item's limit";
#endif
  for (const int jobs : {1, 3}) {
    options.jobs = jobs;
    options.out = folder.file("out" + std::to_string(jobs));
    const BatchCounts counts =
        run({"a", "crash", "abort", "exit", "killed", "hang", "bomb", "throw", "loud", "bad", "none", "z"});
    EXPECT_EQ(counts.done, 12U);
    EXPECT_EQ(counts.unsuccessful(), 8U);
    const auto result = records();
    const std::map<std::string, Status> expected{
        {"a", Status::ok},       {"crash", Status::crash},   {"abort", Status::crash},      {"exit", Status::crash},
        {"killed", Status::oom}, {"hang", Status::timeout},  {"bomb", Status::oom},         {"throw", Status::failed},
        {"loud", Status::ok},    {"bad", Status::bad_input}, {"none", Status::no_symmetry}, {"z", Status::ok}};
    for (const auto& [id, status] : expected) {
      EXPECT_EQ(to_string(result.at(id).status), to_string(status)) << id << ": " << result.at(id).message;
    }
    EXPECT_EQ(result.at("throw").message, "what it says");
    EXPECT_EQ(result.at("crash").message.substr(0, 12), "Segmentation");
    EXPECT_EQ(read_file(options.out / "a.json"), "a\n");
    EXPECT_FALSE(std::filesystem::exists(options.out / "bad.json"));
    EXPECT_FALSE(std::filesystem::exists(options.out / ".work-1"));
    EXPECT_GE(result.at("hang").seconds, 0.5);
    EXPECT_GT(result.at("a").peak_memory, 100000U);
  }
}

TEST_F(Batch, SkipsWhatIsDoneForTheSameHash) {
  const std::vector<std::string> ids{"a", "hang", "bad"};
  EXPECT_EQ(run(ids).done, 3U);
  const BatchCounts again = run(ids);
  EXPECT_EQ(again.done, 0U);
  EXPECT_EQ(again.skipped, 3U);
  EXPECT_EQ(again.of(Status::timeout), 1U);
  options.retry = {Status::timeout, Status::crash};
  EXPECT_EQ(run(ids).done, 1U);
  options.retry.clear();
  options.settings = "version 2";
  EXPECT_EQ(run(ids).done, 3U);
  folder.write("mesh.obj", "v 0 0 1\n");
  EXPECT_EQ(run(ids).done, 3U);
  EXPECT_EQ(run(ids).done, 0U);
}

TEST_F(Batch, TakesAwayWhatAnEarlierRunLeftOfAnItem) {
  run({"a"}, [](const Item&, const std::filesystem::path& to) {
    write_file(to / "item.json", "1");
    write_file(to / "item+more.json", "1");
    return Outcome{};
  });
  EXPECT_TRUE(std::filesystem::exists(options.out / "a+more.json"));
  options.settings = "other";
  run({"a"}, [](const Item&, const std::filesystem::path&) -> Outcome { throw std::runtime_error("no"); });
  EXPECT_FALSE(std::filesystem::exists(options.out / "a.json"));
  EXPECT_FALSE(std::filesystem::exists(options.out / "a+more.json"));
}

TEST_F(Batch, StopsWhereNothingCanBeWritten) {
  options.jobs = 1;
  EXPECT_THROW(run({"a", "full", "b"}), InputError);
  EXPECT_EQ(records().size(), 1U);  // and the item is not taken for done
}

TEST_F(Batch, RefusesAFolderOfAnotherTaskOrNumberOfShards) {
  run({"a"});
  options.task = "fit";
  EXPECT_THROW(run({"a"}), InputError);
  options.task = "detect";
  options.shard = {1, 2};
  EXPECT_THROW(run({"a"}), InputError);
}

TEST_F(Batch, AnInterruptionLeavesWhatIsDone) {
  std::atomic<bool> interrupted{false};
  RunContext context;
  context.interrupted = &interrupted;
  context.on_progress = [&](std::string_view, double fraction) { interrupted = fraction > 0; };
  options.limits.seconds = 100;
  EXPECT_THROW(run({"a", "hang"}, misbehave, context), InterruptedError);
  EXPECT_EQ(records().count("hang"), 0U);
  EXPECT_FALSE(std::filesystem::exists(options.out / ".work-1"));
}

TEST_F(Batch, IdsOfAnyKindHaveFiles) {
  const std::vector<std::string> ids{"a/b", "a", "a.json", "../../escape", "new\nline", std::string(300, 'l'), "."};
  EXPECT_EQ(run(ids).of(Status::ok), ids.size());
  std::set<std::string> contents;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(options.out)) {
    if (entry.path().extension() == ".json") contents.insert(read_file(entry.path()));
  }
  EXPECT_EQ(contents.size(), ids.size());
  EXPECT_FALSE(std::filesystem::exists(folder.path().parent_path() / "escape.json"));
}

}  // namespace
}  // namespace orbifit::batch
