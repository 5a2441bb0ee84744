#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace orbifit {

/// The editor's page without a mesh (apps/editor/dist/editor.html), which is built into the program.
std::string_view editor_page();

/// What such a page carries: bytes under an id that the page knows.
struct PageData {
  std::string id;      ///< "mesh", "annotation" or "basis"
  std::string name;    ///< of the file that it is as good as
  std::string source;  ///< of the user's file
  std::string bytes;
};

/// The page with data in it. \throw Error where the page has no place for them
std::string page_with(std::string_view page, const std::vector<PageData>& data);

}  // namespace orbifit
