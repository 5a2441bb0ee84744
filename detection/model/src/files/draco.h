#pragma once

#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace orbifit::gltf {

/// An attribute that is asked for.
struct DracoRequest {
  std::int64_t id = 0;    ///< that the compressed data give it
  std::int64_t type = 0;  ///< Component as which its numbers are wanted
  int components = 3;     ///< at most 4
};

/// A triangle mesh as Draco gives it back.
struct DracoMesh {
  std::int64_t points = 0;
  std::vector<std::uint32_t> corners;   ///< three a face, each less than `points`
  std::vector<std::string> attributes;  ///< of each request the numbers, row by row, without gaps
};

/// Why it cannot be decoded.
struct DracoError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// \throw DracoError where the bytes are damaged, hold something else, or Draco is not there, as in WebAssembly
DracoMesh decode_draco(std::string_view bytes, std::span<const DracoRequest> requests);

}  // namespace orbifit::gltf
