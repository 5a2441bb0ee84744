#pragma once

#include <cstdint>
#include <filesystem>
#include <string_view>

namespace orbifit {

/// Uses of meshes that nested components may multiply to.
inline constexpr std::int64_t kMostThreeMfParts = 1'000'000;

/// Looks at how much a 3MF file holds and how often its components repeat that before lib3mf reads it, which would take
/// any memory and time for it.
/// \throw InputError where that is too much, or the zip archive or a model in it is damaged
void check_three_mf_bounds(const std::filesystem::path& file, std::string_view content);

}  // namespace orbifit
