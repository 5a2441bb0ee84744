#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "edit_of_bytes.h"
#include "files/file.h"
#include "group_of_bytes.h"
#include "packed_of_bytes.h"
#include "reading.h"
#include "temporary_folder.h"

namespace orbifit {
namespace {

namespace fs = std::filesystem;

struct Reader {
  BadInputKind kind;
  std::string ending;
};

// By the fuzzer's name, which is that of its folder in the corpus.
const std::map<std::string, Reader>& readers() {
  static const std::map<std::string, Reader> all{{"obj", {BadInputKind::mesh, ".obj"}},
                                                 {"off", {BadInputKind::mesh, ".off"}},
                                                 {"ply", {BadInputKind::mesh, ".ply"}},
                                                 {"stl", {BadInputKind::mesh, ".stl"}},
                                                 {"gltf", {BadInputKind::mesh, ".gltf"}},
                                                 {"glb", {BadInputKind::mesh, ".glb"}},
                                                 {"3mf", {BadInputKind::mesh, ".3mf"}},
                                                 {"ply_scan", {BadInputKind::scan, ".ply"}},
                                                 {"pcd", {BadInputKind::scan, ".pcd"}},
                                                 {"xyz", {BadInputKind::scan, ".xyz"}},
                                                 {"pts", {BadInputKind::scan, ".pts"}},
                                                 {"annotation", {BadInputKind::annotation, ".json"}},
                                                 {"handles", {BadInputKind::handles, ".json"}},
                                                 {"landmarks", {BadInputKind::landmarks, ".json"}},
                                                 {"radius_field", {BadInputKind::radius_field, ".json"}},
                                                 {"basis", {BadInputKind::basis, ".basis"}},
                                                 {"manifest", {BadInputKind::manifest, ".jsonl"}}};
  return all;
}

void replay(const std::string& fuzzer, const std::string& content, const ReadingContext& context,
            const TemporaryFolder& folder) {
  const std::span bytes(reinterpret_cast<const std::uint8_t*>(content.data()), content.size());
  if (fuzzer == "group") return classify_group_of_bytes(bytes);
  if (fuzzer == "edit") return edit_of_bytes(bytes);
  if (fuzzer == "3mf_model") return read_three_mf_of_bytes(bytes);
  if (fuzzer == "draco") return decode_draco_of_bytes(bytes);
  const Reader& reader = readers().at(fuzzer);
  const std::string file = "a" + reader.ending;
  folder.write(file, reader.kind == BadInputKind::basis ? with_right_checksums(content) : content);
  reading_of(reader.kind, folder.file(file), context);
}

// What fuzzers found once, and what they start from: tests/fuzz/corpus/FUZZER/FILE.
TEST(BadInput, TheFuzzersCorpusIsReadSoundlyOrRefused) {
  const TemporaryFolder folder;
  const ReadingContext context;
  int files = 0;
  for (const auto& entry : fs::recursive_directory_iterator(ORBIFIT_CORPUS)) {
    if (!entry.is_regular_file()) continue;
    SCOPED_TRACE(entry.path().string());
    ++files;
    EXPECT_NO_THROW(replay(entry.path().parent_path().filename().string(), read_file(entry.path()), context, folder));
  }
  EXPECT_GT(files, 20);
}

}  // namespace
}  // namespace orbifit
