#include "batch/collection.h"

#include <algorithm>
#include <fstream>
#include <stdexcept>

#include "orbifit/model/errors.h"

#include "batch/results_file.h"

namespace orbifit::batch {

namespace fs = std::filesystem;

Collection::Collection(const fs::path& folder) : folder_(folder) {
  std::error_code ignored;
  if (!fs::is_directory(folder, ignored)) throw InputError(folder.string(), "", "is no folder of results");
  shards_ = read_shard_notes(folder);
  for (const ShardNote& note : shards_) {
    const fs::path file = folder / ("results-" + std::to_string(note.shard.index) + ".jsonl");
    if (!fs::exists(file)) continue;
    const auto number = static_cast<std::uint32_t>(files_.size());
    files_.push_back(file);
    unreadable_ += for_each_record(file, [&](const Record& record, std::uint64_t begin) {
      entries_.push_back({record.id, begin, number});
    });
  }
  if (shards_.empty()) throw InputError(folder.string(), "", "holds no results of a batch");
  // Of several lines of an item the last one counts: first after the reversal.
  std::ranges::reverse(entries_);
  std::ranges::stable_sort(entries_, {}, &Entry::id);
  const auto same = [](const Entry& a, const Entry& b) { return a.id == b.id; };
  entries_.erase(std::unique(entries_.begin(), entries_.end(), same), entries_.end());
}

Record Collection::record(std::size_t number) const {
  const Entry& entry = entries_[number];
  std::ifstream stream(files_[entry.file], std::ios::binary);
  stream.seekg(static_cast<std::streamoff>(entry.begin));
  std::string line;
  std::getline(stream, line);
  try {
    return parse_record(line);
  } catch (const std::invalid_argument& error) {
    throw InputError(files_[entry.file].string(), "", std::string("has changed meanwhile: ") + error.what());
  }
}

CollectionStatus status_of(const Collection& collection) {
  CollectionStatus status;
  status.unreadable_lines = collection.unreadable_lines();
  for (const ShardNote& note : collection.shards()) {
    status.task = note.task;
    status.shards = note.shard.count;
    status.begun.push_back({note.shard, note.items, 0});
  }
  for (std::size_t i = 0; i < collection.size(); ++i) {
    const Record record = collection.record(i);
    ++status.by_status[static_cast<std::size_t>(record.status)];
    status.seconds += record.seconds;
    status.peak_memory = std::max(status.peak_memory, record.peak_memory);
    for (CollectionStatus::Part& part : status.begun) {
      if (part.shard.holds(record.id)) ++part.done;
    }
  }
  return status;
}

}  // namespace orbifit::batch
