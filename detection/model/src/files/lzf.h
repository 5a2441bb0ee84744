#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace orbifit {

/// Undoes LZF compression (Lehmann's liblzf, as PCD files use it); nothing unless exactly `size` bytes come out.
std::optional<std::string> lzf_decompress(std::string_view input, std::size_t size);

}  // namespace orbifit
