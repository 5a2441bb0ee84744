#include <filesystem>
#include <functional>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "orbifit/datasets_tools/generate.h"
#include "orbifit/datasets_tools/truth.h"
#include "orbifit/model/annotation_io.h"
#include "orbifit/model/errors.h"

#include "files/file.h"

namespace orbifit {
namespace {

class TruthFile : public testing::Test {
 protected:
  TruthFile() : file_(std::filesystem::path(testing::TempDir()) / (name() + ".truth.json")) {
    GeneratedModel chair = generate("chair", {{"detail", 1}});
    mesh_ = std::move(chair.mesh);
    truth_.expected = std::move(chair.truth);
    // The last region and the pattern become optional ones.
    truth_.optional_regions.push_back(truth_.expected.regions.back());
    truth_.optional_regions.back().parent.reset();
    truth_.expected.regions.pop_back();
    truth_.optional_patterns.push_back(truth_.expected.patterns.back());
    truth_.expected.patterns.clear();
    truth_.also_accepted[0] = {{0, 1, 2, 7}, {5}};
    truth_.also_accepted[truth_.optional_regions.front().id] = {{3, 4}};
  }
  ~TruthFile() override { std::filesystem::remove(file_); }

  static std::string name() { return testing::UnitTest::GetInstance()->current_test_info()->name(); }

  // The file's text with one place replaced.
  void spoil(const std::string& from, const std::string& to) {
    std::string text = to_json(truth_);
    const std::size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    write_file(file_, text.replace(at, from.size(), to));
  }

  void expect_refusal(const std::string& what) {
    try {
      read_truth(file_, mesh_);
      FAIL() << "accepted";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(what), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find(file_.string()), std::string::npos) << error.what();
    }
  }

  std::filesystem::path file_;
  Mesh mesh_;
  DetectionTruth truth_;
};

TEST_F(TruthFile, ComesBackAsItWas) {
  write_truth(file_, truth_);
  const DetectionTruth read = read_truth(file_, mesh_);
  EXPECT_EQ(to_json(read), to_json(truth_));
  EXPECT_EQ(read.also_accepted, truth_.also_accepted);
  ASSERT_EQ(read.expected.regions.size(), truth_.expected.regions.size());
  ASSERT_EQ(read.optional_regions.size(), 1U);
  EXPECT_EQ(read.optional_regions.front().faces, truth_.optional_regions.front().faces);
  EXPECT_EQ(read.optional_regions.front().id, truth_.optional_regions.front().id);
  ASSERT_EQ(read.optional_patterns.size(), 1U);
  EXPECT_EQ(read.optional_patterns.front().instances.size(), truth_.optional_patterns.front().instances.size());
  EXPECT_TRUE(read.expected.patterns.empty());
}

TEST_F(TruthFile, IsAnAnnotationToOtherReaders) {
  write_truth(file_, truth_);
  EXPECT_EQ(to_json(read_annotation(file_, mesh_)), to_json(truth_.expected));
}

TEST_F(TruthFile, APlainAnnotationIsATruth) {
  write_annotation(file_, truth_.expected);
  const DetectionTruth read = read_truth(file_, mesh_);
  EXPECT_EQ(to_json(read.expected), to_json(truth_.expected));
  EXPECT_TRUE(read.optional_regions.empty());
  EXPECT_TRUE(read.optional_patterns.empty());
  EXPECT_TRUE(read.also_accepted.empty());
}

TEST_F(TruthFile, RefusesFaceSetsOutsideTheMesh) {
  spoil("[[[0,3],[7,1]],[[5,1]]]", "[[[0,3000000]]]");
  expect_refusal("regions[0].also_accept[0]: the run [0, 3000000] is outside the mesh");
}

TEST_F(TruthFile, RefusesFaceSetsThatAreNone) {
  spoil("[[[0,3],[7,1]],[[5,1]]]", "[[0,3]]");
  expect_refusal("regions[0].also_accept[0]: must hold runs");
  spoil("[[[0,3],[7,1]],[[5,1]]]", "3");
  expect_refusal("regions[0].also_accept: must be a list of face sets");
  spoil("[[[0,3],[7,1]],[[5,1]]]", "[[]]");
  expect_refusal("regions[0].also_accept[0]: must be a list of runs");
}

TEST_F(TruthFile, RefusesOptionalItemsAsItRefusesOthers) {
  spoil("\"optional_regions\": [", "\"optional_regions\": 5, \"rest\": [");
  expect_refusal("optional_regions: must be a list");
  spoil("\"optional_patterns\": [", "\"optional_patterns\": [{\"id\": 3},");
  expect_refusal("name: is missing");
  spoil("\"optional_regions\": [", "\"optional_regions\": [7,");
  expect_refusal("must be an object");
  write_file(file_, "{");
  expect_refusal("is not JSON");
}

TEST_F(TruthFile, DoesNotWriteWhatHasTwoMeanings) {
  DetectionTruth twice = truth_;
  twice.optional_regions.front().id = twice.expected.regions.front().id;
  EXPECT_THROW(to_json(twice), UsageError);
  DetectionTruth unknown = truth_;
  unknown.also_accepted[999] = {{0}};
  EXPECT_THROW(write_truth(file_, unknown), UsageError);
  EXPECT_FALSE(std::filesystem::exists(file_));
}

}  // namespace
}  // namespace orbifit
