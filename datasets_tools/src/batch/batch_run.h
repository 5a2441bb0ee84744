#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <set>
#include <string>

#include "orbifit/model/run_context.h"

#include "batch/item_process.h"
#include "batch/manifest.h"
#include "batch/record.h"
#include "batch/shard.h"

namespace orbifit::batch {

struct BatchOptions {
  std::string task;           ///< its name; a folder of results belongs to one task
  std::string settings;       ///< what results depend on beside the items: task, default options, seed, version
  std::filesystem::path out;  ///< folder of results; made where it does not exist
  Shard shard;
  int jobs = 1;  ///< items at a time, >= 1
  ItemLimits limits;
  std::set<Status> retry;  ///< items that ended so are done again
  /// Every kind of file that the task may leave ("*.json" has the kind ".json"): those of an earlier result go when an
  /// item is done anew.
  std::vector<std::string> kinds;

  /// \throw UsageError naming the field, its value and the rule
  void validate() const;
};

struct BatchCounts {
  std::array<std::uint64_t, kStatusNames.size()> by_status{};  ///< by Status, of the shard's items as they now stand
  std::uint64_t skipped = 0;                                   ///< of these: done before with the same hash
  std::uint64_t done = 0;                                      ///< of these: done by this run

  std::uint64_t of(Status status) const { return by_status[static_cast<std::size_t>(status)]; }
  std::uint64_t unsuccessful() const;  ///< neither ok nor no_symmetry
};

/// Does the items of a shard, several at a time, each in a process of its own. An item's results are moved to
/// `out` once they are complete (place_of), then its line is appended to results-I.jsonl; so after an end at any moment
/// another run does what has no line yet, and both together leave what one would have left, but for times and memory.
/// Must be called by a process that has one thread.
/// \param context  an interruption or its deadline ends all items, whose lines are then missing
/// \throw InputError where nothing can be written any more or another batch has the shard, InterruptedError,
///        TimeoutError
BatchCounts run_batch(const Manifest& manifest, const BatchOptions& options, const Task& task,
                      const RunContext& context);

/// What a folder of results says of itself; each shard writes a file of its own (results-I.shard, JSON).
struct ShardNote {
  std::string task;
  Shard shard;
  std::uint64_t items = 0;
};
/// Of all shards that have begun, by number. \throw InputError for a file that is none
std::vector<ShardNote> read_shard_notes(const std::filesystem::path& folder);

}  // namespace orbifit::batch
