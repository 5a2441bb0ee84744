#include "files/json_text.h"

#include <algorithm>

#include "orbifit/model/errors.h"

namespace orbifit {

using Json = nlohmann::json;

namespace {

// Of the parser's text what comes after its own names of things; bytes that are no ASCII may be no UTF-8 either.
std::string reason(const Json::exception& error) {
  std::string_view what = error.what();
  const std::size_t syntax = what.find("syntax error");
  const std::size_t name = what.find("] ");
  what.remove_prefix(syntax != std::string_view::npos ? syntax : name != std::string_view::npos ? name + 2 : 0);
  // A long value that is quoted would hide the rest.
  std::string text(what.size() <= 250 ? what : what.substr(0, 250));
  if (what.size() > 250) text += "...";
  std::ranges::replace_if(
      text, [](char c) { return static_cast<unsigned char>(c) >= 0x80 || c == '\n'; }, '?');
  return text;
}

}  // namespace

Json parse_json(const std::string& file, std::string_view text) {
  try {
    return Json::parse(text);
  } catch (const Json::parse_error& error) {
    const std::size_t end = std::min(error.byte, text.size());
    const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(end), '\n');
    throw InputError(file, "line " + std::to_string(line), "is not JSON: " + reason(error));
  } catch (const Json::exception& error) {
    throw InputError(file, "", "is not JSON: " + reason(error));
  }
}

}  // namespace orbifit
