#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "batch/batch_run.h"
#include "batch/record.h"

namespace orbifit::batch {

/// The results of all shards in a folder, whole or under way, in the order of their ids. Holds some 100 bytes an item;
/// records are read when they are asked for.
class Collection {
 public:
  /// \throw InputError when the folder holds no results
  explicit Collection(const std::filesystem::path& folder);

  const std::filesystem::path& folder() const { return folder_; }
  std::size_t size() const { return entries_.size(); }  ///< items that have a result
  Record record(std::size_t number) const;
  const std::vector<ShardNote>& shards() const { return shards_; }
  std::size_t unreadable_lines() const { return unreadable_; }

 private:
  struct Entry {
    std::string id;
    std::uint64_t begin = 0;
    std::uint32_t file = 0;
  };
  std::filesystem::path folder_;
  std::vector<ShardNote> shards_;
  std::vector<std::filesystem::path> files_;
  std::vector<Entry> entries_;  // ascending by id, one each
  std::size_t unreadable_ = 0;
};

/// What `batch status` says.
struct CollectionStatus {
  struct Part {
    Shard shard;
    std::uint64_t items = 0, done = 0;
  };
  std::string task;
  int shards = 0;           ///< that the collection was divided into
  std::vector<Part> begun;  ///< those that have begun
  std::array<std::uint64_t, kStatusNames.size()> by_status{};
  double seconds = 0;             ///< of all items together
  std::uint64_t peak_memory = 0;  ///< of the largest
  std::size_t unreadable_lines = 0;
};
CollectionStatus status_of(const Collection& collection);

}  // namespace orbifit::batch
