#include "batch/item_names.h"

#include <set>
#include <string>

#include <gtest/gtest.h>

#include "orbifit/model/errors.h"

#include "batch/shard.h"

namespace orbifit::batch {
namespace {

TEST(ItemNames, KeepPlainIdsAndTheirFolders) {
  EXPECT_EQ(place_of("chair", ".json"), "chair.json");
  EXPECT_EQ(place_of("02691156/1a04e3", "+fitted.ply"), "02691156/1a04e3+fitted.ply");
}

TEST(ItemNames, DifferForDifferentIdsAndKinds) {
  const std::string ids[] = {"a",
                             "a+x",
                             "a%2Bx",
                             "a/b",
                             "a%2Fb",
                             "a.json/b",
                             "a.json",
                             "a%2Ejson/b",
                             ".",
                             "..",
                             "../a",
                             "/a",
                             "a/",
                             "a//b",
                             "a\nb",
                             "a b",
                             "~",
                             "",
                             ".hidden",
                             "-a",
                             "A",
                             std::string(300, 'x'),
                             std::string(301, 'x'),
                             std::string("a\0b", 3)};
  std::set<std::string> places;
  for (const std::string& id : ids) {
    if (id.empty()) continue;
    for (const char* kind : {".json", "+x.json"}) {
      const std::filesystem::path place = place_of(id, kind);
      EXPECT_TRUE(places.insert(place.native()).second) << id;
      EXPECT_FALSE(place.is_absolute()) << id;
      for (const auto& part : place) {
        EXPECT_NE(part, "..") << id;
        EXPECT_LT(part.native().size(), 200U) << id;
      }
    }
  }
  // No item's file is another's folder.
  for (const std::string& place : places) {
    for (const std::string& other : places) EXPECT_FALSE(other.starts_with(place + "/")) << place << " " << other;
  }
}

TEST(ItemNames, OfPathsAreUtf8) {
  EXPECT_EQ(id_of_path("a/b.obj"), "a/b.obj");
  EXPECT_EQ(id_of_path("st\xC3\xBChle.obj"), "st\xC3\xBChle.obj");
  EXPECT_EQ(id_of_path("a\xFF.obj"), "a%FF.obj");
  EXPECT_TRUE(is_utf8(id_of_path("\xED\xA0\x80\xC0\x80")));
  EXPECT_FALSE(is_utf8("\xED\xA0\x80"));
}

TEST(Shards, HoldEveryItemOnceAndAboutTheSameNumber) {
  int counts[7] = {};
  for (int i = 0; i < 7000; ++i) {
    int holders = 0;
    for (int s = 1; s <= 7; ++s) {
      if (!Shard{s, 7}.holds("item" + std::to_string(i))) continue;
      ++holders;
      ++counts[s - 1];
    }
    EXPECT_EQ(holders, 1);
  }
  // Binomial: 1000 with a deviation of 29.
  for (const int count : counts) EXPECT_NEAR(count, 1000, 150);
}

TEST(Shards, AreParsedOrRefused) {
  EXPECT_EQ(Shard::parse("3/64").index, 3);
  EXPECT_EQ(Shard::parse("3/64").count, 64);
  for (const char* text : {"", "1", "0/4", "5/4", "1/0", "-1/4", "1/4x", "1/", "/4", "a/b", "1/99999999999"}) {
    EXPECT_THROW(Shard::parse(text), UsageError) << text;
  }
}

}  // namespace
}  // namespace orbifit::batch
