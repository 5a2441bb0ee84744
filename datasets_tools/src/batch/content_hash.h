#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

namespace orbifit::batch {

/// 128 bits of XXH3 (`xxhsum -H2`). It runs at the memory's speed, so that a file is hashed in the time it takes to
/// read it, and two of 10^8 different files have the same one with a probability of 10^16 / 2^129 = 1.5e-23. It tells
/// files apart that nobody made to be taken for one another; it is no signature.
struct Hash {
  std::uint64_t high = 0, low = 0;

  auto operator<=>(const Hash&) const = default;
  std::string text() const;                            ///< 32 hexadecimal digits
  static bool parse(std::string_view text, Hash& to);  ///< \return whether it is the text of a hash
};

Hash hash_of(std::string_view bytes);

/// Hashes what comes in pieces.
class Hasher {
 public:
  Hasher();
  ~Hasher();
  Hasher(const Hasher&) = delete;
  Hasher& operator=(const Hasher&) = delete;
  Hasher(Hasher&&) = delete;
  Hasher& operator=(Hasher&&) = delete;

  void add(std::string_view bytes);
  Hash hash() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// What is known of a file for telling whether it is the same as another time.
struct FileIdentity {
  enum class Kind { content, missing, folder, special, unreadable, too_large };
  Kind kind = Kind::missing;
  Hash hash;                ///< of the content, or of the kind (and size) where that is not read
  std::uint64_t bytes = 0;  ///< size of a regular file
};

/// Reads the file in pieces; never waits for a pipe or a device.
/// \param most_bytes  larger files are not read: a sparse file of 10 GB costs nothing on the disk and all of the memory
FileIdentity identify(const std::filesystem::path& file, std::uint64_t most_bytes = UINT64_MAX);

}  // namespace orbifit::batch
