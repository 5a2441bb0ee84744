#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "batch/shard.h"

namespace orbifit::batch {

/// One thing to do. Paths are as they can be opened: those of a manifest are taken from its own folder.
struct Item {
  std::string id;  ///< UTF-8, not empty, whatever else it holds
  std::filesystem::path mesh;
  std::vector<std::filesystem::path> scans;
  std::filesystem::path annotation;  ///< empty: none
  /// Name and value of the task's options, by name; the value as JSON.
  std::vector<std::pair<std::string, std::string>> options;
};

/// The items of a shard. Memory is 8 bytes an item of a manifest, and its path for one of a folder, none of which
/// children get (see UnforkedVector).
class Manifest {
 public:
  /// JSON lines: {"id": ..., "mesh": ..., "scans": [...], "annotation": ..., "options": {...}}, of which "scans" (or
  /// "scan"), "annotation" and "options" may be absent; other keys are ignored, as are blank lines.
  /// All lines are checked first, so that nothing is begun that cannot be finished.
  /// \throw InputError with file and line: no JSON, a missing or ill-typed key, an id that is empty or that an earlier
  ///        line has
  static Manifest from_lines(const std::filesystem::path& file, const Shard& shard);

  /// The files below a folder whose path from there fits the pattern, in the order of their names; ids are those paths.
  /// Links to folders are not followed. \param glob as fnmatch's, '*' also stands for '/'; empty: every mesh format
  /// \param without  a folder to leave out, since results go there
  /// \throw InputError when the folder cannot be listed or holds no such file
  static Manifest from_folder(const std::filesystem::path& folder, const std::string& glob, const Shard& shard,
                              const std::filesystem::path& without = {});

  ~Manifest();
  Manifest(Manifest&&) noexcept;
  Manifest& operator=(Manifest&&) noexcept;

  std::size_t size() const;             ///< items of the shard
  Item item(std::size_t number) const;  ///< reads it anew; \throw InputError when the file has changed meanwhile

 private:
  struct Implementation;
  explicit Manifest(std::unique_ptr<Implementation> implementation);
  std::unique_ptr<Implementation> implementation_;
};

/// One line of a manifest, without its end. Paths are written as they are. \pre ids and paths are UTF-8
std::string manifest_line(const Item& item);

}  // namespace orbifit::batch
