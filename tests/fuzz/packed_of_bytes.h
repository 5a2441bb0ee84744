#pragma once

#include <cstdint>
#include <span>

namespace orbifit {

/// Packs the bytes as the model of a 3MF, with all else as it should be, and reads that as a mesh: mutated themselves,
/// compressed files seldom get past their checksums.
/// \throw std::logic_error where an unsound mesh is read
void read_three_mf_of_bytes(std::span<const std::uint8_t> bytes);

/// Decodes the bytes as Draco's. \throw std::logic_error where an unsound mesh comes out
void decode_draco_of_bytes(std::span<const std::uint8_t> bytes);

}  // namespace orbifit
