#include "editor_page.h"

#include "orbifit/model/errors.h"

#include "html_text.h"

// The file itself, between two names (CMakeLists.txt says where it is).
__asm__(
    ".section .rodata\n"
    ".global orbifit_editor_page\n"
    "orbifit_editor_page:\n"
    ".incbin \"" ORBIFIT_EDITOR_PAGE
    "\"\n"
    ".global orbifit_editor_page_end\n"
    "orbifit_editor_page_end:\n"
    ".byte 0\n"
    ".text\n");
extern "C" const char orbifit_editor_page[];
extern "C" const char orbifit_editor_page_end[];

namespace orbifit {

namespace {

constexpr std::string_view kPlace = "<!--DATA-->";

std::string base64(std::string_view bytes) {
  constexpr std::string_view kLetters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    unsigned bits = 0;
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    for (std::size_t k = 0; k < 3; ++k) {
      bits = bits << 8U | (k < count ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) text += k <= count ? kLetters[bits >> (18 - 6 * k) & 63U] : '=';
  }
  return text;
}

}  // namespace

std::string_view editor_page() {
  return {orbifit_editor_page, static_cast<std::size_t>(orbifit_editor_page_end - orbifit_editor_page)};
}

std::string page_with(std::string_view page, const std::vector<PageData>& data) {
  const std::size_t place = page.find(kPlace);
  if (place == std::string_view::npos) throw Error("the editor's page has no place for a mesh");
  std::string result(page.substr(0, place));
  for (const PageData& entry : data) {
    result += "<script type=\"application/octet-stream\" id=\"" + escaped(entry.id) + "\" data-name=\"" +
              escaped(entry.name) + "\" data-source=\"" + escaped(entry.source) + "\">";
    result += base64(entry.bytes);
    result += "</script>\n";
  }
  return result += page.substr(place + kPlace.size());
}

}  // namespace orbifit
