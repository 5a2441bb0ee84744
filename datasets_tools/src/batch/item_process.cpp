#include "batch/item_process.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <fstream>
#include <new>
#include <stdexcept>

#include <fcntl.h>
#include <nlohmann/json.hpp>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "orbifit/model/errors.h"

namespace orbifit::batch {

namespace {

using nlohmann::ordered_json;

// How the item's process says how it ended.
constexpr int kReported = 0;
constexpr int kOutOfMemory = 70;
constexpr int kUnchanged = 77;

constexpr std::size_t kLongestMessage = 500;  // bytes

int memory_file(const char* name) {
  const int descriptor = ::memfd_create(name, MFD_CLOEXEC);
  if (descriptor < 0) throw InputError("", "", std::string("no file in memory: ") + std::strerror(errno));
  return descriptor;
}

std::string content(int descriptor) {
  std::string text;
  std::string piece(1 << 16, '\0');
  for (off_t at = 0;;) {
    const ssize_t count = ::pread(descriptor, piece.data(), piece.size(), at);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return text;
    text.append(piece, 0, static_cast<std::size_t>(count));
    at += count;
  }
}

void write_all(int descriptor, std::string_view text) {
  while (!text.empty()) {
    const ssize_t count = ::write(descriptor, text.data(), text.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return;
    text.remove_prefix(static_cast<std::size_t>(count));
  }
}

void clear(int descriptor) {
  if (::ftruncate(descriptor, 0) != 0 || ::lseek(descriptor, 0, SEEK_SET) != 0) {
    throw InputError("", "", std::string("a file in memory cannot be cleared: ") + std::strerror(errno));
  }
}

// Memory that the process has mapped already, in bytes.
rlim_t mapped_memory() {
  std::ifstream stream("/proc/self/statm");
  rlim_t pages = 0;
  stream >> pages;
  return pages * static_cast<rlim_t>(::sysconf(_SC_PAGESIZE));
}

void set_limit(__rlimit_resource resource, rlim_t value) {
  rlimit limit{};
  ::getrlimit(resource, &limit);
  limit.rlim_cur = std::min(value, limit.rlim_max);
  ::setrlimit(resource, &limit);
}

void limit_own_process(std::uint64_t memory) {
  const rlim_t mapped = mapped_memory();
  const rlim_t most = memory > RLIM_INFINITY - 1 - mapped ? RLIM_INFINITY : mapped + memory;
  set_limit(RLIMIT_AS, most);
  set_limit(RLIMIT_CORE, 0);
  std::ofstream("/proc/self/oom_score_adj") << 1000;
  // Nothing here goes on after a refused allocation, and what is thrown may be lost in a library on its way.
  std::set_new_handler([] { ::_exit(kOutOfMemory); });
}

std::string last_line(std::string text) {
  while (!text.empty() && (text.back() == '\n' || text.back() == '\r')) text.pop_back();
  const std::size_t at = text.find_last_of("\n\r");
  if (at != std::string::npos) text.erase(0, at + 1);
  if (text.size() > kLongestMessage) text.resize(kLongestMessage);
  return text;
}

std::string quantity(double bytes) {
  char buffer[32];
  bytes >= 1e9 ? std::snprintf(buffer, sizeof buffer, "%.3g GB", bytes / 1e9)
               : std::snprintf(buffer, sizeof buffer, "%.3g MB", bytes / 1e6);
  return buffer;
}

std::string seconds_text(double seconds) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.6g s", seconds);
  return buffer;
}

void report(int descriptor, const Outcome& outcome, double seconds) {
  const ordered_json object{{"status", to_string(outcome.status)},
                            {"message", outcome.message},
                            {"summary", ordered_json::parse(outcome.summary)},
                            {"no_room", outcome.no_room},
                            {"seconds", seconds}};
  write_all(descriptor, object.dump(-1, ' ', false, ordered_json::error_handler_t::replace));
}

}  // namespace

std::string own_output(int descriptor) {
  return content(descriptor);
}

void clear_own_output(int descriptor) {
  clear(descriptor);
}

Hash hash_of_item(const Item& item, const std::string& settings, std::uint64_t most_bytes,
                  std::optional<std::filesystem::path>& too_large) {
  Hasher hasher;
  // Every text with its length, so that no two lists of texts run together.
  const auto add = [&](std::string_view text) { hasher.add(std::to_string(text.size()) + ":" + std::string(text)); };
  add(settings);
  for (const auto& [name, value] : item.options) {
    add(name);
    add(value);
  }
  const auto add_file = [&](const char* role, const std::filesystem::path& file) {
    const FileIdentity identity = identify(file, most_bytes);
    if (identity.kind == FileIdentity::Kind::too_large && !too_large) too_large = file;
    add(role);
    // The format is told by the ending.
    add(file.extension().string());
    add(identity.hash.text());
  };
  add_file("mesh", item.mesh);
  for (const auto& scan : item.scans) add_file("scan", scan);
  if (!item.annotation.empty()) add_file("annotation", item.annotation);
  return hasher.hash();
}

ItemProcess::ItemProcess(std::filesystem::path folder)
    : folder_(std::move(folder)),
      output_(memory_file("output")),
      errors_(memory_file("errors")),
      report_(memory_file("report")) {}

ItemProcess::~ItemProcess() {
  if (running()) {
    ::kill(child_, SIGKILL);
    ::waitpid(child_, nullptr, 0);
  }
  for (const int descriptor : {output_, errors_, report_}) ::close(descriptor);
}

void ItemProcess::start(Item item, const Start& start) {
  item_ = std::move(item);
  limits_ = start.limits;
  for (const int descriptor : {output_, errors_, report_}) clear(descriptor);
  std::fflush(stdout);
  std::fflush(stderr);
  killed_ = false;
  begin_ = Clock::now();
  deadline_ = begin_ + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(limits_.seconds));
  const pid_t parent = ::getpid();
  const pid_t child = ::fork();
  if (child < 0) throw InputError("", "", std::string("no process for an item: ") + std::strerror(errno));
  if (child > 0) {
    child_ = child;
    return;
  }
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(1);
  run(start);
}

void ItemProcess::run(const Start& start) {
  ::setpgid(0, 0);  // a terminal's interrupt is for the parent, which ends this one
  sigset_t none;
  sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
  const int nothing = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
  ::dup2(nothing, STDIN_FILENO);
  ::dup2(output_, STDOUT_FILENO);
  ::dup2(errors_, STDERR_FILENO);
  limit_own_process(limits_.memory);
  Outcome outcome;
  try {
    std::optional<std::filesystem::path> too_large;
    const Hash hash = hash_of_item(item_, start.settings, limits_.memory, too_large);
    write_all(report_, hash.text());
    if (start.known == hash) ::_exit(kUnchanged);
    if (too_large) {
      outcome.status = Status::oom;
      outcome.message = too_large->string() + " is larger than the memory of an item, " +
                        quantity(static_cast<double>(limits_.memory));
    } else {
      outcome = start.task(item_, folder_);
    }
  } catch (const std::bad_alloc&) {
    ::_exit(kOutOfMemory);
  } catch (const std::exception& error) {
    outcome.status = Status::failed;
    outcome.message = error.what();
  }
  const double seconds = std::chrono::duration<double>(Clock::now() - begin_).count();
  report(report_, outcome, seconds);
  ::_exit(kReported);
}

bool ItemProcess::ended(Clock::time_point now) {
  rusage usage{};
  const pid_t child = ::wait4(child_, &status_, WNOHANG, &usage);
  if (child == child_) {
    child_ = 0;
    peak_memory_ = static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
    return true;
  }
  if (now >= deadline_ && !killed_) {
    killed_ = true;
    ::kill(child_, SIGKILL);
  }
  return false;
}

ItemProcess::End ItemProcess::take() {
  End end;
  end.record.id = item_.id;
  end.record.peak_memory = peak_memory_;
  end.record.seconds = std::chrono::duration<double>(Clock::now() - begin_).count();
  std::string text = content(report_);
  Hash hash;
  if (Hash::parse(std::string_view(text).substr(0, 32), hash)) {
    end.record.hash = hash;
    text.erase(0, 32);
  }
  interpret(end, text);
  std::ranges::replace(end.record.message, '\n', ' ');
  if (end.record.message.size() > kLongestMessage) end.record.message.resize(kLongestMessage);
  return end;
}

void ItemProcess::interpret(End& end, const std::string& text) const {
  Record& record = end.record;
  const auto say = [&](Status status, std::string message) {
    record.status = status;
    record.message = std::move(message);
  };
  const int code = WIFEXITED(status_) ? WEXITSTATUS(status_) : -1;
  if (code == kReported && !text.empty()) {
    const ordered_json object = ordered_json::parse(text);
    say(parse_status(object.at("status").get<std::string>()).value_or(Status::failed), object.at("message"));
    record.summary = object.at("summary").dump();
    record.seconds = object.at("seconds");
    end.no_room = object.at("no_room");
  } else if (code == kUnchanged) {
    end.unchanged = true;
  } else if (code == kOutOfMemory) {
    say(Status::oom, "needs more memory than an item may have, " + quantity(static_cast<double>(limits_.memory)));
  } else if (killed_) {
    say(Status::timeout, "not done within " + seconds_text(limits_.seconds));
  } else if (WIFSIGNALED(status_) && WTERMSIG(status_) == SIGKILL) {
    say(Status::oom, "killed from outside, as the system does where memory runs out");
  } else {
    const std::string said = last_line(content(errors_));
    const std::string how = WIFSIGNALED(status_) ? std::string(::strsignal(WTERMSIG(status_)))
                                                 : "ended by itself with code " + std::to_string(code);
    say(Status::crash, how + (said.empty() ? "" : ": " + said));
  }
}

}  // namespace orbifit::batch
