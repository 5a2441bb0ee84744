#pragma once

#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

namespace orbifit {

/// The value that a file's text holds. \throw InputError naming the file, the line and what was expected there
nlohmann::json parse_json(const std::string& file, std::string_view text);

}  // namespace orbifit
