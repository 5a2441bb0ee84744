#include "batch/manifest.h"

#include <set>
#include <string>

#include <gtest/gtest.h>

#include "orbifit/model/errors.h"

#include "temporary_folder.h"

namespace orbifit::batch {
namespace {

std::string reason(const std::string& text) {
  const TemporaryFolder folder;
  const auto file = folder.write("m.jsonl", text);
  try {
    Manifest::from_lines(file, {});
  } catch (const InputError& error) {
    return std::string(error.what()).substr(file.native().size());
  }
  return "none";
}

TEST(Manifest, ReadsItemsOfItsShard) {
  const TemporaryFolder folder;
  const auto file =
      folder.write("m.jsonl",
                   "{\"id\": \"a\", \"mesh\": \"a.obj\"}\n\n"
                   "{\"id\": \"b/\\n\", \"mesh\": \"/b.obj\", \"scans\": [\"s.ply\", \"t.ply\"], \"annotation\": "
                   "\"b.json\", \"options\": {\"tolerance\": 0.01}, \"other\": 1}\r\n"
                   "{\"id\": \"c\", \"mesh\": \"c.obj\", \"scan\": \"u.ply\"}");
  const Manifest all = Manifest::from_lines(file, {});
  ASSERT_EQ(all.size(), 3U);
  EXPECT_EQ(all.item(0).mesh, folder.file("a.obj"));
  const Item b = all.item(1);
  EXPECT_EQ(b.id, "b/\n");
  EXPECT_EQ(b.mesh, "/b.obj");
  ASSERT_EQ(b.scans.size(), 2U);
  EXPECT_EQ(b.scans[1], folder.file("t.ply"));
  EXPECT_EQ(b.annotation, folder.file("b.json"));
  EXPECT_EQ(b.options, (std::vector<std::pair<std::string, std::string>>{{"tolerance", "0.01"}}));
  EXPECT_EQ(all.item(2).scans.size(), 1U);

  std::multiset<std::string> ids;
  for (int s = 1; s <= 2; ++s) {
    const Manifest part = Manifest::from_lines(file, {s, 2});
    for (std::size_t i = 0; i < part.size(); ++i) ids.insert(part.item(i).id);
  }
  EXPECT_EQ(ids, (std::multiset<std::string>{"a", "b/\n", "c"}));
}

TEST(Manifest, RefusesWithLineAndReason) {
  const std::string good = "{\"id\": \"a\", \"mesh\": \"a.obj\"}\n";
  EXPECT_NE(reason(good + "{\"id\": \"b\"").find(": line 2: is not JSON"), std::string::npos);
  EXPECT_EQ(reason(good + "{\"id\": \"b\"}"), ": line 2: has no mesh");
  EXPECT_EQ(reason(good + "{\"mesh\": \"b\"}"), ": line 2: has no id");
  EXPECT_EQ(reason(good + "{\"id\": \"\", \"mesh\": \"b\"}"), ": line 2: has no id");
  EXPECT_EQ(reason(good + "{\"id\": 7, \"mesh\": \"b\"}"), ": line 2: id must be a string");
  EXPECT_EQ(reason(good + "[]"), ": line 2: is no JSON object");
  EXPECT_EQ(reason(good + "{\"id\": \"b\", \"mesh\": \"b\", \"scans\": \"s\"}"),
            ": line 2: scans must be a list of file names");
  EXPECT_EQ(reason(good + "{\"id\": \"b\", \"mesh\": \"b\"}\n" + good + good),
            ": line 3: has the id of line 1; each item needs one of its own");
  EXPECT_EQ(reason("\n"), ": has no items");
}

TEST(Manifest, ListsAFolder) {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder.file("m/deep/model.obj"));
  std::filesystem::create_directory(folder.file("m/out"));
  for (const char* name : {"m/b.OBJ", "m/a.ply", "m/deep/c.glb", "m/note.txt", "m/out/result.ply"})
    folder.write(name, "x");
  const Manifest all = Manifest::from_folder(folder.file("m"), "", {}, folder.file("m/out"));
  ASSERT_EQ(all.size(), 3U);
  EXPECT_EQ(all.item(0).id, "a.ply");
  EXPECT_EQ(all.item(2).id, "deep/c.glb");
  EXPECT_EQ(all.item(2).mesh, folder.file("m/deep/c.glb"));
  EXPECT_EQ(Manifest::from_folder(folder.file("m"), "*.glb", {}).size(), 1U);
  EXPECT_THROW(Manifest::from_folder(folder.file("m"), "*.stl", {}), InputError);
  EXPECT_THROW(Manifest::from_folder(folder.file("none"), "", {}), InputError);
}

TEST(Manifest, LinesComeBack) {
  Item item;
  item.id = "a/\"\n";
  item.mesh = "/m.obj";
  item.scans = {"/s.ply"};
  item.options = {{"samples", "100"}};
  const TemporaryFolder folder;
  const Item read = Manifest::from_lines(folder.write("m.jsonl", manifest_line(item)), {}).item(0);
  EXPECT_EQ(read.id, item.id);
  EXPECT_EQ(read.scans, item.scans);
  EXPECT_EQ(read.options, item.options);
}

}  // namespace
}  // namespace orbifit::batch
