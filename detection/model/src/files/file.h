#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace orbifit {

/// Whether the name stands for standard input or output: "-", or "-" and an ending that tells the format ("-.obj").
/// A file of that name is "./-".
bool is_standard_stream(const std::filesystem::path& file);

/// The whole file, or all of standard input. \throw InputError when it is missing, not a regular file, unreadable or
/// empty
std::string read_file(const std::filesystem::path& file);

/// Writes under a temporary name beside `file`, then renames: the file appears whole or not at all. To standard output
/// it writes at once.
/// \throw InputError when the folder does not exist or the disk refuses
void write_file(const std::filesystem::path& file, std::string_view content);

/// A file under a temporary name beside the one whose place it is to take. Without complete() nothing of it is left.
class UnfinishedFile {
 public:
  /// Makes it, empty. \throw InputError naming `target` where that cannot be
  explicit UnfinishedFile(std::filesystem::path target);
  ~UnfinishedFile();
  UnfinishedFile(const UnfinishedFile&) = delete;
  UnfinishedFile& operator=(const UnfinishedFile&) = delete;
  UnfinishedFile(UnfinishedFile&&) = delete;
  UnfinishedFile& operator=(UnfinishedFile&&) = delete;

  const std::filesystem::path& name() const { return name_; }
  /// Takes the target's place. \throw InputError
  void complete();

 private:
  std::filesystem::path target_, name_;
};

/// Removes every UnfinishedFile of this process. Whoever makes or completes one afterwards waits for ever: the caller
/// ends the process.
void abandon_unfinished_files();

/// The ending in lower case, with its dot; ".obj" for "A/B.OBJ" and for "-.obj".
std::string lower_extension(const std::filesystem::path& file);

}  // namespace orbifit
