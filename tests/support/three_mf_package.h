#pragma once

#include <filesystem>
#include <string>

namespace orbifit {

/// A 3MF file whose model is the given text, which need not be one.
void write_three_mf_of(const std::filesystem::path& file, const std::string& model);

}  // namespace orbifit
