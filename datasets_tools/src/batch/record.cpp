#include "batch/record.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <nlohmann/json.hpp>

namespace orbifit::batch {

using nlohmann::ordered_json;

std::string to_string(Status status) {
  return kStatusNames[static_cast<std::size_t>(status)];
}

std::optional<Status> parse_status(std::string_view text) {
  const auto found = std::ranges::find(kStatusNames, text);
  if (found == kStatusNames.end()) return std::nullopt;
  return static_cast<Status>(found - kStatusNames.begin());
}

std::string to_line(const Record& record) {
  ordered_json line{{"id", record.id},
                    {"status", to_string(record.status)},
                    {"message", record.message},
                    {"seconds", std::round(1000 * record.seconds) / 1000},
                    {"peak_memory", record.peak_memory},
                    {"hash", record.hash ? ordered_json(record.hash->text()) : ordered_json(nullptr)}};
  line.update(ordered_json::parse(record.summary));
  // A message may quote bytes of a file.
  return line.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
}

Record parse_record(const std::string& text) {
  try {
    ordered_json line = ordered_json::parse(text);
    Record record;
    record.id = line.at("id").get<std::string>();
    const std::string name = line.at("status").get<std::string>();
    const auto status = parse_status(name);
    if (!status) throw std::invalid_argument("unknown status '" + name + "'");
    record.status = *status;
    record.message = line.at("message").get<std::string>();
    record.seconds = line.at("seconds").get<double>();
    record.peak_memory = line.at("peak_memory").get<std::uint64_t>();
    if (!line.at("hash").is_null()) {
      Hash hash;
      if (!Hash::parse(line.at("hash").get<std::string>(), hash)) throw std::invalid_argument("hash is none");
      record.hash = hash;
    }
    for (const char* key : {"id", "status", "message", "seconds", "peak_memory", "hash"}) line.erase(key);
    record.summary = line.dump();
    return record;
  } catch (const nlohmann::json::exception& error) {
    throw std::invalid_argument(error.what());
  }
}

}  // namespace orbifit::batch
