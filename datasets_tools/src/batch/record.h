#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "batch/content_hash.h"

namespace orbifit::batch {

/// How an item ended.
enum class Status {
  ok,
  no_symmetry,  ///< it was done and there is none
  bad_input,    ///< a file or an option of the item cannot be used
  failed,       ///< it ran and has no answer, such as a fit that did not converge
  timeout,      ///< beyond its wall-clock time
  crash,        ///< ended by a signal
  oom           ///< beyond its memory, or ended by the system for want of it
};
inline constexpr std::array kStatusNames{"ok", "no_symmetry", "bad_input", "failed", "timeout", "crash", "oom"};

std::string to_string(Status status);
std::optional<Status> parse_status(std::string_view text);

/// One line of a file of results.
struct Record {
  std::string id;
  Status status = Status::failed;
  std::string message;            ///< one line; empty where there is nothing to say
  double seconds = 0;             ///< wall-clock time in the item's own process, to the millisecond
  std::uint64_t peak_memory = 0;  ///< bytes resident at most, with the program itself
  std::optional<Hash> hash;       ///< of input, options and version; none where the item ended before it was known
  std::string summary = "{}";     ///< a JSON object: what the task says of the result
};

/// The line without its end: the keys id, status, message, seconds, peak_memory, hash, and those of the summary.
std::string to_line(const Record& record);

/// \throw std::invalid_argument saying what is wrong with the line
Record parse_record(const std::string& line);

}  // namespace orbifit::batch
