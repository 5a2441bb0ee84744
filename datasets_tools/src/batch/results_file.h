#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "batch/record.h"
#include "batch/unforked.h"

namespace orbifit::batch {

/// The results of one shard, a line an item; the last line of an item counts. Held by one process at a time.
class ResultsFile {
 public:
  /// Opens or begins the file and locks it (flock, held by the items' processes too, so that a batch that was killed
  /// has wholly gone when the next one gets it). What a killed batch left of a line is cut off.
  /// \throw InputError when it cannot be written or another process has it
  explicit ResultsFile(const std::filesystem::path& file);
  ~ResultsFile();
  ResultsFile(const ResultsFile&) = delete;
  ResultsFile& operator=(const ResultsFile&) = delete;
  ResultsFile(ResultsFile&&) = delete;
  ResultsFile& operator=(ResultsFile&&) = delete;

  struct Done {
    Hash id, hash;
    bool hashed;
    Status status;
  };
  /// What the file says of the item as it was opened; null: nothing.
  const Done* find(const std::string& id) const;

  /// Appends a line in one write. \throw InputError when the disk refuses; the file then is as it was before
  void append(const Record& record);

 private:
  void lock() const;
  void read();

  std::filesystem::path file_;
  int descriptor_;
  UnforkedVector<Done> done_;  // ascending by id, one each
};

/// Calls the function with every line that is a record, in their order, and where it begins; what is none is skipped.
/// \return the number of lines that are none; an unfinished last one does not count
std::size_t for_each_record(const std::filesystem::path& file,
                            const std::function<void(const Record&, std::uint64_t begin)>& body);

}  // namespace orbifit::batch
