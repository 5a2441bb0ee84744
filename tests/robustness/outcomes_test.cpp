#include <algorithm>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

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

// What a file is not named for: any bytes may come under any name.
TEST(BadInput, EveryReaderStaysSoundOnEveryFile) {
  const TemporaryFolder folder;
  const ReadingContext context;
  const std::vector<std::pair<BadInputKind, std::string>> readers{
      {BadInputKind::mesh, "a.obj"},     {BadInputKind::mesh, "a.off"},       {BadInputKind::mesh, "a.ply"},
      {BadInputKind::mesh, "a.stl"},     {BadInputKind::mesh, "a.gltf"},      {BadInputKind::mesh, "a.glb"},
      {BadInputKind::mesh, "a.3mf"},     {BadInputKind::scan, "a.ply"},       {BadInputKind::scan, "a.pcd"},
      {BadInputKind::scan, "a.xyz"},     {BadInputKind::scan, "a.pts"},       {BadInputKind::annotation, "a.json"},
      {BadInputKind::handles, "a.json"}, {BadInputKind::landmarks, "a.json"}, {BadInputKind::radius_field, "a.json"},
      {BadInputKind::basis, "a.basis"},  {BadInputKind::manifest, "a.jsonl"}};
  for (const BadInput& file : all_files(context)) {
    if (file.content.size() > 200'000) continue;
    SCOPED_TRACE(file.name);
    for (const auto& [kind, name] : readers) {
      SCOPED_TRACE(name);
      folder.write(name, file.content);
      EXPECT_NO_THROW(reading_of(kind, folder.file(name), context));
    }
  }
}

// An STL's triangles have corners of their own: its annotation may count the places where these meet.
TEST(BadInput, AnnotationsOfAMeshWhoseFacesShareNoVertexAreReadAsThoseOfOneWhoseFacesDo) {
  const TemporaryFolder folder;
  ReadingContext soup;
  const Mesh cube = std::exchange(soup.mesh, {});
  soup.mesh.vertices.resize(3 * cube.faces.rows(), 3);
  soup.mesh.faces.resize(cube.faces.rows(), 3);
  for (Eigen::Index corner = 0; corner < cube.faces.size(); ++corner) {
    soup.mesh.vertices.row(corner) = cube.vertices.row(cube.faces.data()[corner]);
    soup.mesh.faces.data()[corner] = static_cast<int>(corner);
  }
  const auto expected = expected_outcomes();
  int read = 0;
  for (const BadInput& file : bad_input()) {
    if (file.kind != BadInputKind::annotation) continue;
    SCOPED_TRACE(file.name);
    folder.write(file.name, file.content);
    const std::string outcome = reading_of(file.kind, folder.file(file.name), soup);
    read += outcome.starts_with("read: ") ? 1 : 0;
    const std::string& of_cube = expected.at(file.name);
    if (of_cube.find("mesh.vertices") == std::string::npos) {
      EXPECT_EQ(outcome, of_cube);
    } else {
      EXPECT_NE(outcome.find("mesh.vertices"), std::string::npos) << outcome;
    }
  }
  EXPECT_GT(read, 0);
}

class FalseNumbers : public testing::TestWithParam<bool> {};

// Behind the checksums: numbers of a basis that are not what was written, one by one.
TEST_P(FalseNumbers, OfABasisAreReadSoundlyOrRefused) {
  const TemporaryFolder folder;
  const ReadingContext context = GetParam() ? ReadingContext::columns() : ReadingContext();
  folder.write("a.basis", with_right_checksums(context.basis));
  ASSERT_TRUE(reading_of(BadInputKind::basis, folder.file("a.basis"), context).starts_with("read: "));
  const std::vector<std::uint64_t> values{0, 1ULL << 40U, ~0ULL, 0x7ff8ULL << 48U};  // the last one as a real: none
  int refused = 0;
  int read = 0;
  for (std::size_t at = 32; at < context.basis.size(); at += 8 * (1 + at / 2000)) {
    for (const std::uint64_t value : values) {
      std::string content = context.basis;
      std::memcpy(content.data() + at, &value, std::min(sizeof value, content.size() - at));
      folder.write("a.basis", with_right_checksums(std::move(content)));
      const std::string outcome = reading_of(BadInputKind::basis, folder.file("a.basis"), context);
      ++(outcome.starts_with("read: ") ? read : refused);
    }
  }
  EXPECT_GT(refused, 100);
  EXPECT_GT(read, 0);
}

INSTANTIATE_TEST_SUITE_P(BadInput, FalseNumbers, testing::Bool(),
                         [](const auto& instance) { return instance.param ? "Columns" : "Cube"; });

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
