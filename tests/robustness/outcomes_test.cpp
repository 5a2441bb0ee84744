#include <fstream>
#include <map>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "reading.h"
#include "temporary_folder.h"

namespace orbifit {
namespace {

// Name and outcome of each file, as write_bad_input prints them and somebody has found them right.
std::map<std::string, std::string> expected_outcomes() {
  std::map<std::string, std::string> result;
  std::ifstream stream(ORBIFIT_OUTCOMES);
  for (std::string line; std::getline(stream, line);) {
    const std::size_t tab = line.find('\t');
    result[line.substr(0, tab)] = line.substr(tab + 1);
  }
  return result;
}

std::vector<BadInput> all_files(const ReadingContext& context) {
  std::vector<BadInput> files = bad_input();
  for (BadInput& basis : damaged_bases(context.basis)) files.push_back(std::move(basis));
  return files;
}

TEST(BadInput, EachFileIsReadOrRefusedAsItShould) {
  const TemporaryFolder folder;
  const ReadingContext context;
  const auto expected = expected_outcomes();
  std::set<std::string> names;
  for (const BadInput& file : all_files(context)) {
    SCOPED_TRACE(file.name);
    EXPECT_TRUE(names.insert(file.name).second);
    const auto outcome = expected.find(file.name);
    if (outcome == expected.end()) {
      ADD_FAILURE() << "not in " << ORBIFIT_OUTCOMES;
      continue;
    }
    folder.write(file.name, file.content);
    EXPECT_EQ(reading_of(file.kind, folder.file(file.name), context), outcome->second);
  }
  EXPECT_EQ(names.size(), expected.size()) << "outcomes of files that there are not";
}

TEST(BadInput, EveryRefusalNamesFileAndReason) {
  for (const auto& [name, outcome] : expected_outcomes()) {
    if (outcome.starts_with("read: ")) continue;
    EXPECT_TRUE(outcome.starts_with(name + ": ")) << outcome;
    EXPECT_GT(outcome.size(), name.size() + 8) << outcome;
    EXPECT_LT(outcome.size(), 400U) << outcome;
  }
}

}  // namespace
}  // namespace orbifit
