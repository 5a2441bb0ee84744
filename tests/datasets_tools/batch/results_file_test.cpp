#include "batch/results_file.h"

#include <csignal>
#include <string>

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "orbifit/model/errors.h"

#include "files/file.h"
#include "temporary_folder.h"

namespace orbifit::batch {
namespace {

Record record(const std::string& id, Status status) {
  Record result;
  result.id = id;
  result.status = status;
  result.message = "it's \xFF";
  result.hash = hash_of(id + "content");
  result.summary = R"({"regions":[{"group":"C2v"}]})";
  return result;
}

TEST(ResultsFile, KeepsTheLastLineOfEachItem) {
  const TemporaryFolder folder;
  const auto file = folder.file("results-1.jsonl");
  {
    ResultsFile results(file);
    EXPECT_EQ(results.find("a"), nullptr);
    results.append(record("a", Status::timeout));
    results.append(record("b\n", Status::ok));
    results.append(record("a", Status::ok));
  }
  const ResultsFile again(file);
  ASSERT_NE(again.find("a"), nullptr);
  EXPECT_EQ(again.find("a")->status, Status::ok);
  EXPECT_EQ(again.find("b\n")->hash, hash_of("b\ncontent"));
  EXPECT_EQ(again.find("c"), nullptr);
}

TEST(ResultsFile, CutsOffWhatAKilledBatchLeftOfALine) {
  const TemporaryFolder folder;
  const auto file = folder.file("results-1.jsonl");
  const std::string whole = to_line(record("a", Status::ok)) + "\n";
  for (std::size_t cut = 0; cut < whole.size(); cut += 7) {
    folder.write("results-1.jsonl", whole + to_line(record("b", Status::ok)).substr(0, cut));
    const ResultsFile results(file);
    EXPECT_NE(results.find("a"), nullptr);
    EXPECT_EQ(results.find("b"), nullptr);
    EXPECT_EQ(read_file(file), whole);
  }
}

TEST(ResultsFile, SkipsLinesThatAreNone) {
  const TemporaryFolder folder;
  const auto file = folder.write("results-1.jsonl", "{}\nrubbish\n" + to_line(record("a", Status::ok)) + "\n");
  EXPECT_NE(ResultsFile(file).find("a"), nullptr);
}

TEST(ResultsFile, IsHeldByOneProcess) {
  const TemporaryFolder folder;
  const ResultsFile first(folder.file("results-1.jsonl"));
  EXPECT_THROW(ResultsFile(folder.file("results-1.jsonl")), InputError);
}

TEST(ResultsFile, IsAsBeforeWhereTheDiskIsFull) {
  const TemporaryFolder folder;
  const auto file = folder.file("results-1.jsonl");
  const pid_t child = ::fork();
  if (child == 0) {
    ::signal(SIGXFSZ, SIG_IGN);
    ResultsFile results(file);
    results.append(record("a", Status::ok));
    const auto size = std::filesystem::file_size(file);
    const rlimit limit{size + 20, size + 20};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    try {
      results.append(record("b", Status::ok));
    } catch (const InputError& error) {
      ::_exit(std::string(error.what()).find("cannot be written") != std::string::npos ? 0 : 2);
    }
    ::_exit(1);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
  EXPECT_EQ(read_file(file), to_line(record("a", Status::ok)) + "\n");
}

TEST(Record, ComesBackFromItsLine) {
  const Record before = record("a/\n\"", Status::crash);
  const Record after = parse_record(to_line(before));
  EXPECT_EQ(after.id, before.id);
  EXPECT_EQ(after.status, before.status);
  EXPECT_EQ(after.hash, before.hash);
  EXPECT_EQ(after.summary, before.summary);
  EXPECT_EQ(to_line(before).find('\n'), std::string::npos);
}

}  // namespace
}  // namespace orbifit::batch
