#include "batch/item_names.h"

#include <charconv>

#include "orbifit/model/errors.h"

#include "batch/content_hash.h"

namespace orbifit::batch {

namespace {

constexpr std::size_t kLongestPart =
    120;  // bytes of the encoded name; file systems take 255, kinds and ".tmp" come on top

bool plain(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
}

void append_encoded(std::string& to, char c) {
  constexpr std::string_view digits = "0123456789ABCDEF";
  const auto byte = static_cast<unsigned char>(c);
  to += {'%', digits[byte >> 4], digits[byte & 15]};
}

std::string encoded_part(std::string_view part, bool folder) {
  std::string result;
  for (std::size_t i = 0; i < part.size(); ++i) {
    const bool dot = part[i] == '.' && !folder && i > 0;
    plain(part[i]) || dot ? result.push_back(part[i]) : append_encoded(result, part[i]);
  }
  // '~' and what is empty occur in no other name.
  if (result.empty()) return "~";
  if (result.size() > kLongestPart) return result.substr(0, kLongestPart - 33) + "~" + hash_of(part).text();
  return result;
}

// The length of the UTF-8 sequence that begins the text; 0: none does (RFC 3629).
std::size_t sequence_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const auto follows = [&](std::size_t i, unsigned low = 0x80, unsigned high = 0xBF) {
    return i < text.size() && byte(i) >= low && byte(i) <= high;
  };
  const unsigned first = byte(0);
  if (first < 0x80) return 1;
  if (first >= 0xC2 && first <= 0xDF) return follows(1) ? 2 : 0;
  if (first >= 0xE0 && first <= 0xEF) {
    return follows(1, first == 0xE0 ? 0xA0 : 0x80, first == 0xED ? 0x9F : 0xBF) && follows(2) ? 3 : 0;
  }
  if (first >= 0xF0 && first <= 0xF4) {
    return follows(1, first == 0xF0 ? 0x90 : 0x80, first == 0xF4 ? 0x8F : 0xBF) && follows(2) && follows(3) ? 4 : 0;
  }
  return 0;
}

}  // namespace

std::filesystem::path place_of(std::string_view id, std::string_view kind) {
  std::filesystem::path place;
  while (true) {
    const std::size_t slash = id.find('/');
    if (slash == std::string_view::npos) break;
    place /= encoded_part(id.substr(0, slash), true);
    id.remove_prefix(slash + 1);
  }
  return place / (encoded_part(id, false) + std::string(kind));
}

std::string id_of_path(const std::filesystem::path& below) {
  const std::string text = below.generic_string();
  std::string id;
  for (std::string_view rest = text; !rest.empty();) {
    const std::size_t length = sequence_length(rest);
    length == 0 ? append_encoded(id, rest.front()) : void(id.append(rest.substr(0, length)));
    rest.remove_prefix(length == 0 ? 1 : length);
  }
  return id;
}

bool is_utf8(std::string_view text) {
  while (!text.empty()) {
    const std::size_t length = sequence_length(text);
    if (length == 0) return false;
    text.remove_prefix(length);
  }
  return true;
}

Shard Shard::parse(const std::string& text) {
  Shard shard;
  const char* end = text.data() + text.size();
  const auto index = std::from_chars(text.data(), end, shard.index);
  const bool slash = index.ec == std::errc() && index.ptr != end && *index.ptr == '/';
  const auto count = slash ? std::from_chars(index.ptr + 1, end, shard.count)
                           : std::from_chars_result{end, std::errc::invalid_argument};
  if (count.ec != std::errc() || count.ptr != end || shard.index < 1 || shard.index > shard.count) {
    throw UsageError("--shard is '" + text + "': must be I/N with 1 <= I <= N");
  }
  return shard;
}

bool Shard::holds(std::string_view id) const {
  return hash_of(id).low % static_cast<std::uint64_t>(count) == static_cast<std::uint64_t>(index - 1);
}

}  // namespace orbifit::batch
