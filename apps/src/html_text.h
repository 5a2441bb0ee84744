#pragma once

#include <string>

namespace orbifit {

/// Text as HTML and SVG show it: markup in it is none.
std::string escaped(const std::string& text);

}  // namespace orbifit
