#include "files/file.h"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <mutex>
#include <set>
#include <system_error>

#include <fcntl.h>
#include <unistd.h>

#include "orbifit/model/errors.h"

namespace orbifit {

namespace fs = std::filesystem;

namespace {

// A file descriptor that closes itself; errors of the last write show only at close().
class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  Descriptor(Descriptor&&) = delete;
  Descriptor& operator=(Descriptor&&) = delete;

  int number() const { return number_; }
  bool close() {
    const int number = number_;
    number_ = -1;
    return ::close(number) == 0;
  }

 private:
  int number_;
};

std::string system_reason(int code) {
  return std::generic_category().message(code);
}

bool write_all(int descriptor, std::string_view content) {
  while (!content.empty()) {
    const ssize_t count = ::write(descriptor, content.data(), content.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    content.remove_prefix(static_cast<std::size_t>(count));
  }
  return true;
}

[[noreturn]] void refuse_writing(const fs::path& file, const std::string& reason) {
  throw InputError(file.string(), "", "cannot be written: " + reason);
}

// Errors name `file`, whatever the name it is written under.
void write_directly(const fs::path& name, const fs::path& file, std::string_view content) {
  Descriptor descriptor(::open(name.c_str(), O_WRONLY | O_CLOEXEC));
  if (descriptor.number() < 0 || !write_all(descriptor.number(), content) || !descriptor.close()) {
    refuse_writing(file, system_reason(errno));
  }
}

// The process's own: whoever ends it must know of all of them.
struct Unfinished {
  std::recursive_mutex mutex;  // a MemoryLimit may end the process on a thread that holds it
  std::set<fs::path> names;

  static Unfinished& all() {
    static Unfinished unfinished;
    return unfinished;
  }
};

fs::path temporary_name(const fs::path& file) {
  static std::atomic<unsigned> counter{0};
  return file.parent_path() /
         ("." + file.filename().string() + "." + std::to_string(::getpid()) + "-" + std::to_string(counter++) + ".tmp");
}

// Files of /proc, pipes and files that grow meanwhile hold more than their size says; read to the end whatever it is.
std::string read_all(int descriptor, std::size_t expected, const std::string& name) {
  std::string content(expected, '\0');
  std::size_t filled = 0;
  while (true) {
    if (filled == content.size()) content.resize(content.size() + (expected > 0 ? 0 : content.size()) + 4096);
    const ssize_t count = ::read(descriptor, content.data() + filled, content.size() - filled);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) throw InputError(name, "", "cannot be read: " + system_reason(errno));
    if (count == 0) break;
    filled += static_cast<std::size_t>(count);
  }
  content.resize(filled);
  return content;
}

}  // namespace

bool is_standard_stream(const fs::path& file) {
  const std::string& name = file.native();
  return name == "-" || (name.starts_with("-.") && name.find('/') == std::string::npos);
}

std::string read_file(const fs::path& file) {
  if (is_standard_stream(file)) {
    std::string content = read_all(STDIN_FILENO, 0, "standard input");
    if (content.empty()) throw InputError("standard input", "", "is empty, or was read before");
    return content;
  }
  std::error_code code;
  const fs::file_status status = fs::status(file, code);
  if (status.type() == fs::file_type::not_found) throw InputError(file.string(), "", "no such file");
  if (fs::is_directory(status)) throw InputError(file.string(), "", "is a folder, not a file");
  Descriptor descriptor(::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (descriptor.number() < 0) throw InputError(file.string(), "", "cannot be read: " + system_reason(errno));
  if (!fs::is_regular_file(status)) throw InputError(file.string(), "", "is not a regular file");
  const std::uintmax_t size = fs::file_size(file, code);
  std::string content = read_all(descriptor.number(), code ? 0 : size, file.string());
  if (content.empty()) throw InputError(file.string(), "", "is empty");
  return content;
}

void write_file(const fs::path& file, std::string_view content) {
  if (is_standard_stream(file)) {
    if (!write_all(STDOUT_FILENO, content)) refuse_writing("standard output", system_reason(errno));
    return;
  }
  std::error_code code;
  const fs::file_status status = fs::status(file, code);
  if (fs::is_directory(status)) refuse_writing(file, "it is a folder");
  if (fs::exists(status) && !fs::is_regular_file(status))
    return write_directly(file, file, content);  // /dev/stdout, a pipe

  // A link stays a link: what it points to is replaced.
  const fs::path target = fs::is_symlink(fs::symlink_status(file, code)) ? fs::weakly_canonical(file, code) : file;
  const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
  if (!fs::is_directory(folder, code)) refuse_writing(file, "the folder " + folder.string() + " does not exist");

  UnfinishedFile unfinished(target);
  write_directly(unfinished.name(), file, content);
  unfinished.complete();
}

UnfinishedFile::UnfinishedFile(fs::path target) : target_(std::move(target)), name_(temporary_name(target_)) {
  const std::lock_guard lock(Unfinished::all().mutex);
  const auto entry = Unfinished::all().names.insert(name_).first;  // before there is a file that is to be removed
  const Descriptor descriptor(::open(name_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
  if (descriptor.number() >= 0) return;
  const int reason = errno;
  Unfinished::all().names.erase(entry);
  refuse_writing(target_, system_reason(reason));
}

UnfinishedFile::~UnfinishedFile() {
  if (name_.empty()) return;
  const std::lock_guard lock(Unfinished::all().mutex);
  ::unlink(name_.c_str());
  Unfinished::all().names.erase(name_);
}

void UnfinishedFile::complete() {
  const std::lock_guard lock(Unfinished::all().mutex);
  std::error_code code;
  fs::rename(name_, target_, code);
  if (code) refuse_writing(target_, code.message());  // the destructor removes it
  Unfinished::all().names.erase(name_);
  name_.clear();
}

void abandon_unfinished_files() {
  Unfinished& unfinished = Unfinished::all();
  unfinished.mutex.lock();  // for good
  for (const fs::path& name : unfinished.names) ::unlink(name.c_str());
}

std::string lower_extension(const fs::path& file) {
  const std::string& name = file.native();
  std::string ending = is_standard_stream(file) ? name.substr(1) : file.extension().string();
  std::ranges::transform(ending, ending.begin(), [](char c) { return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c; });
  return ending;
}

}  // namespace orbifit
