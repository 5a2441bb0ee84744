#include "batch/content_hash.h"

#include <array>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <vector>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

// The code stands in the header, so that the program needs no other library.
#define XXH_INLINE_ALL
#include <xxhash.h>

namespace orbifit::batch {

namespace {

constexpr std::size_t kPiece = std::size_t{1} << 18;  // bytes; fits the second-level cache

Hash to_hash(XXH128_hash_t value) {
  return {value.high64, value.low64};
}

FileIdentity without_content(FileIdentity::Kind kind, std::uint64_t bytes = 0) {
  const std::string words = "file kind " + std::to_string(static_cast<int>(kind)) + " " + std::to_string(bytes);
  return {kind, hash_of(words), bytes};
}

}  // namespace

std::string Hash::text() const {
  std::array<char, 33> digits;
  std::snprintf(digits.data(), digits.size(), "%016llx%016llx", static_cast<unsigned long long>(high),
                static_cast<unsigned long long>(low));
  return digits.data();
}

bool Hash::parse(std::string_view text, Hash& to) {
  if (text.size() != 32) return false;
  const auto half = [&](std::size_t at, std::uint64_t& value) {
    const char* end = text.data() + at + 16;
    const auto result = std::from_chars(text.data() + at, end, value, 16);
    return result.ec == std::errc() && result.ptr == end;
  };
  return half(0, to.high) && half(16, to.low);
}

Hash hash_of(std::string_view bytes) {
  return to_hash(XXH3_128bits(bytes.data(), bytes.size()));
}

struct Hasher::State {
  XXH3_state_t* state = XXH3_createState();
};

Hasher::Hasher() : state_(std::make_unique<State>()) {
  XXH3_128bits_reset(state_->state);
}

Hasher::~Hasher() {
  XXH3_freeState(state_->state);
}

void Hasher::add(std::string_view bytes) {
  XXH3_128bits_update(state_->state, bytes.data(), bytes.size());
}

Hash Hasher::hash() const {
  return to_hash(XXH3_128bits_digest(state_->state));
}

FileIdentity identify(const std::filesystem::path& file, std::uint64_t most_bytes) {
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) {
    return without_content(errno == ENOENT || errno == ENOTDIR ? FileIdentity::Kind::missing
                                                               : FileIdentity::Kind::unreadable);
  }
  struct stat status {};
  FileIdentity result;
  if (::fstat(descriptor, &status) != 0) {
    result = without_content(FileIdentity::Kind::unreadable);
  } else if (S_ISDIR(status.st_mode)) {
    result = without_content(FileIdentity::Kind::folder);
  } else if (!S_ISREG(status.st_mode)) {
    result = without_content(FileIdentity::Kind::special);
  } else if (static_cast<std::uint64_t>(status.st_size) > most_bytes) {
    result = without_content(FileIdentity::Kind::too_large, static_cast<std::uint64_t>(status.st_size));
  } else {
    result.kind = FileIdentity::Kind::content;
    Hasher hasher;
    std::vector<char> piece(kPiece);
    while (true) {
      const ssize_t count = ::read(descriptor, piece.data(), piece.size());
      if (count < 0 && errno == EINTR) continue;
      if (count < 0) result = without_content(FileIdentity::Kind::unreadable);
      if (count <= 0) break;
      hasher.add({piece.data(), static_cast<std::size_t>(count)});
      result.bytes += static_cast<std::uint64_t>(count);
    }
    if (result.kind == FileIdentity::Kind::content) result.hash = hasher.hash();
  }
  ::close(descriptor);
  return result;
}

}  // namespace orbifit::batch
