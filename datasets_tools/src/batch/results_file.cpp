#include "batch/results_file.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <thread>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "orbifit/model/errors.h"

namespace orbifit::batch {

namespace {

constexpr auto kLockPatience = std::chrono::seconds(3);  // the processes of a batch that was killed go within one
constexpr std::size_t kTail = 4096;                      // bytes read at once while looking for the last line's begin

[[noreturn]] void refuse(const std::filesystem::path& file) {
  throw InputError(file.string(), "", std::string("cannot be written: ") + std::strerror(errno));
}

// Where the last whole line ends.
off_t whole_lines(int descriptor) {
  std::string piece(kTail, '\0');
  for (off_t end = ::lseek(descriptor, 0, SEEK_END); end > 0;) {
    const off_t begin = std::max<off_t>(0, end - static_cast<off_t>(kTail));
    const ssize_t count = ::pread(descriptor, piece.data(), static_cast<std::size_t>(end - begin), begin);
    if (count <= 0) return 0;
    const std::size_t at = std::string_view(piece.data(), static_cast<std::size_t>(count)).rfind('\n');
    if (at != std::string_view::npos) return begin + static_cast<off_t>(at) + 1;
    end = begin;
  }
  return 0;
}

}  // namespace

ResultsFile::ResultsFile(const std::filesystem::path& file)
    : file_(file), descriptor_(::open(file.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666)) {
  if (descriptor_ < 0) refuse(file_);
  try {
    lock();
    if (::ftruncate(descriptor_, whole_lines(descriptor_)) != 0) refuse(file_);
    read();
  } catch (...) {
    ::close(descriptor_);
    throw;
  }
}

ResultsFile::~ResultsFile() {
  ::close(descriptor_);
}

void ResultsFile::lock() const {
  const auto begin = std::chrono::steady_clock::now();
  while (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
    // File systems without locks: nobody else then writes a shard's file as long as every shard is run once.
    if (errno != EWOULDBLOCK && errno != EINTR) return;
    if (std::chrono::steady_clock::now() - begin > kLockPatience) {
      throw InputError(file_.string(), "", "another batch is writing it");
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

void ResultsFile::read() {
  for_each_record(file_, [&](const Record& record, std::uint64_t) {
    done_.push_back({hash_of(record.id), record.hash.value_or(Hash{}), record.hash.has_value(), record.status});
  });
  // The last of each id first, then alone.
  std::ranges::reverse(done_);
  std::ranges::stable_sort(done_, {}, &Done::id);
  const auto same = [](const Done& a, const Done& b) { return a.id == b.id; };
  done_.erase(std::unique(done_.begin(), done_.end(), same), done_.end());
}

const ResultsFile::Done* ResultsFile::find(const std::string& id) const {
  const Hash hash = hash_of(id);
  const auto found = std::ranges::lower_bound(done_, hash, {}, &Done::id);
  return found != done_.end() && found->id == hash ? &*found : nullptr;
}

void ResultsFile::append(const Record& record) {
  const std::string line = to_line(record) + "\n";
  struct stat before {};
  if (::fstat(descriptor_, &before) != 0) refuse(file_);
  std::string_view rest = line;
  while (!rest.empty()) {
    const ssize_t count = ::write(descriptor_, rest.data(), rest.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) {
      const int reason = errno;
      // Making a file shorter needs no room.
      if (::ftruncate(descriptor_, before.st_size) == 0) errno = reason;
      refuse(file_);
    }
    rest.remove_prefix(static_cast<std::size_t>(count));
  }
}

std::size_t for_each_record(const std::filesystem::path& file,
                            const std::function<void(const Record&, std::uint64_t begin)>& body) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw InputError(file.string(), "", std::string("cannot be read: ") + std::strerror(errno));
  std::size_t others = 0;
  std::uint64_t begin = 0;
  std::string line;
  while (std::getline(stream, line) && !stream.eof()) {
    const std::uint64_t at = begin;
    begin += line.size() + 1;
    Record record;
    try {
      record = parse_record(line);
    } catch (const std::invalid_argument&) {
      ++others;
      continue;
    }
    body(record, at);
  }
  return others;
}

}  // namespace orbifit::batch
