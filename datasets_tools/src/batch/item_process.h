#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <sys/types.h>

#include "batch/manifest.h"
#include "batch/record.h"

namespace orbifit::batch {

/// What a task says of an item, in the item's own process.
struct Outcome {
  Status status = Status::ok;
  std::string message;         ///< one line
  std::string summary = "{}";  ///< a JSON object, for the record
  bool no_room = false;        ///< its results could not be written, which is no fault of the item
};

/// Does an item and writes its results into the folder, as "item" followed by their kind ("item.json",
/// "item+fitted.ply"). Standard output and error are the item's own, in memory: see own_output().
using Task = std::function<Outcome(const Item& item, const std::filesystem::path& folder)>;

struct ItemLimits {
  double seconds = 600;                           ///< wall-clock
  std::uint64_t memory = std::uint64_t{4} << 30;  ///< bytes that the item may add to the program's own
};

/// What is done before by another run: its hash, to be compared with.
using KnownHash = std::optional<Hash>;

/// One item in a process of its own, forked from this one, which costs about a millisecond less than starting a
/// program and needs this process to have one thread. It dies with this one (PR_SET_PDEATHSIG), cannot take
/// more memory than allowed (RLIMIT_AS), leaves no core, and is the first to go where the system's memory runs out.
class ItemProcess {
 public:
  /// \param folder  for its results; exists and is empty
  explicit ItemProcess(std::filesystem::path folder);
  ~ItemProcess();  ///< kills it
  ItemProcess(const ItemProcess&) = delete;
  ItemProcess& operator=(const ItemProcess&) = delete;
  ItemProcess(ItemProcess&&) = delete;
  ItemProcess& operator=(ItemProcess&&) = delete;

  using Clock = std::chrono::steady_clock;  // which no setting of the time moves

  struct Start {
    const Task& task;
    const ItemLimits& limits;
    std::string settings;  ///< what the results depend on beside the item: task, its options, version
    KnownHash known;       ///< the item is left alone where its hash is this one
  };
  /// \pre !running() \throw InputError when the system gives no process
  void start(Item item, const Start& start);

  bool running() const { return child_ > 0; }
  Clock::time_point deadline() const { return deadline_; }
  const std::filesystem::path& folder() const { return folder_; }
  const Item& item() const { return item_; }

  /// Kills it where its time is over. \return whether it has ended
  bool ended(Clock::time_point now);

  struct End {
    Record record;
    bool unchanged = false;  ///< nothing was done: the hash is the known one
    bool no_room = false;    ///< see Outcome
  };
  /// \pre ended() has just returned true
  End take();

 private:
  [[noreturn]] void run(const Start& start);
  void interpret(End& end, const std::string& report) const;

  std::filesystem::path folder_;
  Item item_;
  ItemLimits limits_;
  pid_t child_ = 0;
  bool killed_ = false;
  int output_, errors_, report_;  // files in memory
  Clock::time_point begin_, deadline_;
  int status_ = 0;
  std::uint64_t peak_memory_ = 0;
};

/// What the item's process has written to its standard output (1) or error (2) so far. In that process.
std::string own_output(int descriptor);

/// Forgets that. \pre nothing is buffered
void clear_own_output(int descriptor);

/// Of everything that an item's result depends on: the files' contents, their roles, its options, the settings.
/// \param too_large  set to a file that is larger than `most_bytes`, which was not read
Hash hash_of_item(const Item& item, const std::string& settings, std::uint64_t most_bytes,
                  std::optional<std::filesystem::path>& too_large);

}  // namespace orbifit::batch
