#pragma once

#include <string>
#include <utility>
#include <vector>

namespace orbifit {

/// Figures against figures, on logarithmic axes: what is not positive and finite is left out.
struct Chart {
  struct Series {
    std::string name;
    std::vector<std::pair<double, double>> points;  ///< in the order in which they are joined
    int colour = -1;  ///< the same number is the same colour; below 0: its place among the series
  };

  std::string title, horizontal, vertical;  ///< what the axes show, with units
  std::vector<Series> series;
};

/// The chart as an SVG element that needs nothing else, with a grid at powers of ten and the names of the series beside
/// it. The same chart gives the same bytes.
std::string to_svg(const Chart& chart);

}  // namespace orbifit
