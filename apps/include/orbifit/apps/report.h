#pragma once

#include <string>
#include <vector>

#include "orbifit/apps/chart.h"
#include "orbifit/apps/render.h"

namespace orbifit {

/// Text below is plain: it is escaped, and a blank line begins a new paragraph.
struct ReportPicture {
  std::string png;      ///< the file's bytes (encode_png)
  std::string caption;  ///< where it has several lines, the first is a title
};

struct ReportLink {
  std::string target;  ///< relative to the page
  std::string text;
};

struct ReportTable {
  std::vector<std::string> headers;
  std::vector<std::vector<std::string>> rows;  ///< as many cells each as there are headers
};

struct ReportSection {
  std::string title, text;
  std::vector<ReportPicture> pictures;
  std::vector<ReportTable> tables;
  std::vector<std::string> notes = {};  ///< small print
  std::vector<Chart> charts = {};       ///< shown after the pictures
  std::string command = {};             ///< the command line that made this step
  std::string output = {};  ///< what the program printed: aligned columns become tables, all else keeps its fixed width
  std::vector<ReportLink> files = {};  ///< that the step wrote
};

struct Report {
  std::string title, intro;
  std::vector<ReportSection> sections;
};

/// One page that needs nothing else, but for the files that it links to: pictures and style within it, no script; for
/// desktop, phone and paper.
/// Columns whose cells are all numbers stand to the right. The same report gives the same bytes.
/// \throw UsageError for a row of another length than the headers, or a picture that is not a PNG
std::string to_html(const Report& report);

/// RFC 4648, with padding.
std::string base64(const std::string& bytes);

}  // namespace orbifit
