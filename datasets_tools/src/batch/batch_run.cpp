#include "batch/batch_run.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <ctime>
#include <memory>
#include <system_error>

#include <nlohmann/json.hpp>
#include <unistd.h>

#include "orbifit/model/errors.h"

#include "batch/item_names.h"
#include "batch/results_file.h"
#include "files/file.h"

namespace orbifit::batch {

namespace fs = std::filesystem;
using Clock = ItemProcess::Clock;

namespace {

constexpr auto kProgressStep = std::chrono::milliseconds(200);
constexpr auto kLongestWait = std::chrono::milliseconds(500);  // how late an interruption may be noticed
constexpr double kRateWindow = 60;  // seconds over which the rate is told; recent items say most about the next ones
constexpr std::string_view kStem = "item";

[[noreturn]] void refuse(const fs::path& path, const std::error_code& code) {
  throw InputError(path.string(), "", "cannot be written: " + code.message());
}

void make_folders(const fs::path& folder) {
  std::error_code code;
  fs::create_directories(folder, code);
  std::error_code reason;
  if (!fs::is_directory(folder, reason)) {
    if (!code) code = reason ? reason : std::make_error_code(std::errc::not_a_directory);
    refuse(folder, code);
  }
  if (::access(folder.c_str(), W_OK) != 0) refuse(folder, std::make_error_code(std::errc::permission_denied));
}

std::string name_of(const Shard& shard) {
  return std::to_string(shard.index);
}

fs::path note_file(const fs::path& folder, const Shard& shard) {
  return folder / ("results-" + name_of(shard) + ".shard");
}

ShardNote read_note(const fs::path& file) {
  try {
    const auto value = nlohmann::json::parse(read_file(file));
    ShardNote note;
    note.task = value.at("task").get<std::string>();
    note.shard = {value.at("shard").get<int>(), value.at("shards").get<int>()};
    note.items = value.at("items").get<std::uint64_t>();
    return note;
  } catch (const nlohmann::json::exception& error) {
    throw InputError(file.string(), "", std::string("is no note of a batch: ") + error.what());
  }
}

// Results of another task, or items divided otherwise, would be mixed with these.
void refuse_other_batch(const BatchOptions& options) {
  for (const ShardNote& note : read_shard_notes(options.out)) {
    if (note.task != options.task) {
      throw InputError(
          options.out.string(), "",
          "holds results of " + note.task + ", not of " + options.task + "; name another folder with --out");
    }
    if (note.shard.count != options.shard.count) {
      throw InputError(options.out.string(), "",
                       "was begun in " + std::to_string(note.shard.count) + " shards, not " +
                           std::to_string(options.shard.count) + "; name another folder with --out");
    }
  }
}

// SIGCHLD waits to be asked for while this lives.
class ChildSignals {
 public:
  ChildSignals() {
    sigemptyset(&set_);
    sigaddset(&set_, SIGCHLD);
    ::sigprocmask(SIG_BLOCK, &set_, &before_);
  }
  ~ChildSignals() { ::sigprocmask(SIG_SETMASK, &before_, nullptr); }
  ChildSignals(const ChildSignals&) = delete;
  ChildSignals& operator=(const ChildSignals&) = delete;
  ChildSignals(ChildSignals&&) = delete;
  ChildSignals& operator=(ChildSignals&&) = delete;

  // Until a child ends, a signal comes or the time is over.
  void wait(Clock::duration longest) const {
    const auto nanoseconds =
        std::max<std::int64_t>(0, std::chrono::duration_cast<std::chrono::nanoseconds>(longest).count());
    const timespec time{nanoseconds / 1000000000, nanoseconds % 1000000000};
    ::sigtimedwait(&set_, nullptr, &time);
  }

 private:
  sigset_t set_{}, before_{};
};

// The shard's folder for files that are not complete yet; what a killed batch left there goes.
class WorkFolder {
 public:
  explicit WorkFolder(fs::path path) : path_(std::move(path)) {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
    make_folders(path_);
  }
  ~WorkFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  WorkFolder(const WorkFolder&) = delete;
  WorkFolder& operator=(const WorkFolder&) = delete;
  WorkFolder(WorkFolder&&) = delete;
  WorkFolder& operator=(WorkFolder&&) = delete;

  fs::path slot(int number) const {
    fs::path folder = path_ / std::to_string(number);
    make_folders(folder);
    return folder;
  }
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

// Made in the work folder and then renamed: a batch that is killed meanwhile leaves nothing anywhere else.
void write_note(const BatchOptions& options, const WorkFolder& work, std::uint64_t items) {
  const nlohmann::ordered_json note{{"format", "orbifit-batch"},     {"version", 1},
                                    {"task", options.task},          {"shard", options.shard.index},
                                    {"shards", options.shard.count}, {"items", items}};
  const fs::path unfinished = work.path() / "note", file = note_file(options.out, options.shard);
  write_file(unfinished, note.dump() + "\n");
  std::error_code code;
  fs::rename(unfinished, file, code);
  if (code) throw InputError(file.string(), "", "cannot be written: " + code.message());
}

class Run {
 public:
  Run(const Manifest& manifest, const BatchOptions& options, const Task& task, const RunContext& context)
      : manifest_(manifest),
        options_(options),
        task_(task),
        context_(context),
        results_(options.out / ("results-" + name_of(options.shard) + ".jsonl")),
        work_(options.out / (".work-" + name_of(options.shard))) {
    const auto most = std::min(static_cast<std::size_t>(options.jobs), std::max<std::size_t>(1, manifest.size()));
    for (std::size_t s = 0; s < most; ++s) {
      slots_.push_back(std::make_unique<ItemProcess>(work_.slot(static_cast<int>(s))));
    }
  }

  BatchCounts run() {
    write_note(options_, work_, manifest_.size());
    begin_ = Clock::now();
    while (fill() > 0) {
      tell();
      signals_.wait(next_wait());
      const Clock::time_point now = Clock::now();
      for (const auto& slot : slots_) {
        if (slot->running() && slot->ended(now)) keep(*slot);
      }
    }
    tell();
    return counts_;
  }

 private:
  // Starts items in idle slots. Returns how many run.
  int fill() {
    int running = 0;
    for (const auto& slot : slots_) {
      while (!slot->running() && next_ < manifest_.size()) {
        Item item = manifest_.item(next_++);
        const ResultsFile::Done* done = results_.find(item.id);
        const bool again = done != nullptr && (!done->hashed || options_.retry.contains(done->status));
        const KnownHash known = done != nullptr && !again ? KnownHash(done->hash) : std::nullopt;
        slot->start(std::move(item), {task_, options_.limits, options_.settings, known});
      }
      if (slot->running()) ++running;
    }
    return running;
  }

  Clock::duration next_wait() const {
    const Clock::time_point now = Clock::now();
    Clock::duration wait = kLongestWait;
    for (const auto& slot : slots_) {
      if (slot->running()) wait = std::min(wait, slot->deadline() - now);
    }
    if (context_.deadline) wait = std::min<Clock::duration>(wait, *context_.deadline - now);
    // A process that was killed for its time goes at once; one whose time is over is asked soon.
    return std::max<Clock::duration>(wait, std::chrono::milliseconds(2));
  }

  void keep(ItemProcess& slot) {
    ItemProcess::End end = slot.take();
    if (end.no_room) throw InputError("", "", end.record.message);
    Status status = end.record.status;
    if (end.unchanged) {
      status = results_.find(slot.item().id)->status;
      ++counts_.skipped;
    } else {
      move_results(slot, end.record);
      results_.append(end.record);
      ++counts_.done;
    }
    ++counts_.by_status[static_cast<std::size_t>(status)];
  }

  // The results of an item that was not done go; what an earlier run left of it too.
  void move_results(const ItemProcess& slot, const Record& record) {
    std::set<std::string> left(options_.kinds.begin(), options_.kinds.end());
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(slot.folder())) files.push_back(entry.path());
    for (const fs::path& file : files) {
      const std::string name = file.filename().string();
      const bool kept =
          (record.status == Status::ok || record.status == Status::no_symmetry) && name.starts_with(kStem);
      std::error_code code;
      if (!kept) {
        fs::remove_all(file, code);
        continue;
      }
      const std::string kind = name.substr(kStem.size());
      const fs::path place = options_.out / place_of(record.id, kind);
      if (place.parent_path() != options_.out) make_folders(place.parent_path());
      fs::rename(file, place, code);
      if (code) refuse(place, code);
      left.erase(kind);
    }
    std::error_code ignored;
    for (const std::string& kind : left) fs::remove(options_.out / place_of(record.id, kind), ignored);
  }

  void tell() {
    context_.check();
    const Clock::time_point now = Clock::now();
    const std::uint64_t all = counts_.done + counts_.skipped;
    if (now - told_ < kProgressStep && all < manifest_.size()) return;
    told_ = now;
    const double passed = std::chrono::duration<double>(now - begin_).count();
    // The rate of the last minute: items that were skipped or easy say nothing about the time left.
    if (passed - window_begin_ > kRateWindow) {
      window_begin_ = passed - kRateWindow / 2;
      window_items_ = all - (all - window_items_) / 2;
    }
    const double rate = static_cast<double>(all - window_items_) / std::max(1e-9, passed - window_begin_);
    context_.progress(progress_text(all, rate),
                      manifest_.size() == 0 ? 1 : static_cast<double>(all) / static_cast<double>(manifest_.size()));
  }

  std::string progress_text(std::uint64_t all, double rate) const {
    char buffer[96];
    const double seconds = rate > 0 ? static_cast<double>(manifest_.size() - all) / rate : 0;
    std::snprintf(buffer, sizeof buffer, "%llu/%zu, %.3g/s, %lld:%02lld:%02lld left;",
                  static_cast<unsigned long long>(all), manifest_.size(), rate, std::llround(seconds) / 3600,
                  std::llround(seconds) / 60 % 60, std::llround(seconds) % 60);
    std::string text = buffer;
    for (std::size_t s = 0; s < kStatusNames.size(); ++s) {
      if (counts_.by_status[s] > 0)
        text += std::string(" ") + kStatusNames[s] + " " + std::to_string(counts_.by_status[s]);
    }
    return text;
  }

  const Manifest& manifest_;
  const BatchOptions& options_;
  const Task& task_;
  const RunContext& context_;
  ResultsFile results_;  // before the work folder: who has its lock may clear that
  WorkFolder work_;
  ChildSignals signals_;
  std::vector<std::unique_ptr<ItemProcess>> slots_;  // last, so that they end first
  std::size_t next_ = 0;
  BatchCounts counts_;
  Clock::time_point begin_, told_;
  double window_begin_ = 0;
  std::uint64_t window_items_ = 0;
};

}  // namespace

void BatchOptions::validate() const {
  require(jobs >= 1 && jobs <= 4096, "--jobs", jobs, "from 1 to 4096");
  require(limits.seconds > 0 && limits.seconds <= 1e9, "--item-timeout", limits.seconds, "above 0 and at most 1e9 s");
  require(limits.memory >= (std::uint64_t{1} << 20), "--item-memory", static_cast<double>(limits.memory),
          "at least 1 MiB");
}

std::uint64_t BatchCounts::unsuccessful() const {
  std::uint64_t sum = 0;
  for (const std::uint64_t count : by_status) sum += count;
  return sum - of(Status::ok) - of(Status::no_symmetry);
}

BatchCounts run_batch(const Manifest& manifest, const BatchOptions& options, const Task& task,
                      const RunContext& context) {
  options.validate();
  make_folders(options.out);
  refuse_other_batch(options);
  // A limit on the size of files is to be an error, as a full disk is, not a signal.
  ::signal(SIGXFSZ, SIG_IGN);
  return Run(manifest, options, task, context).run();
}

std::vector<ShardNote> read_shard_notes(const fs::path& folder) {
  std::vector<ShardNote> notes;
  std::error_code code;
  for (const auto& entry : fs::directory_iterator(folder, code)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with("results-") || !name.ends_with(".shard")) continue;
    if (name.find_first_not_of("0123456789", 8) != name.size() - 6) continue;
    notes.push_back(read_note(entry.path()));
  }
  if (code) throw InputError(folder.string(), "", "cannot be listed: " + code.message());
  std::ranges::sort(notes, {}, [](const ShardNote& note) { return note.shard.index; });
  return notes;
}

}  // namespace orbifit::batch
