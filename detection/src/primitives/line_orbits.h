#pragma once

#include <cstddef>
#include <vector>

#include "orbifit/model/motion.h"

#include "primitives/revolution.h"

namespace orbifit {

/// Lines that motions of the whole carry onto one another, and how many of them to look at: what is found about the
/// first few has images about the others, see complete_regions(). Where the first few have nothing, the others have
/// not.
class LineOrbits {
 public:
  /// As few_of_each_orbit().
  LineOrbits(const std::vector<Line>& lines, const std::vector<Motion>& motions, double tolerance);

  /// Whether to look at a line, in the order in which they are: a few of each orbit, and all where something was found.
  bool worth_a_look(std::size_t line);

  /// Tells that something was found about a line.
  void found(std::size_t line) { found_[orbit_of_line_[line]] = 1; }

 private:
  std::vector<std::size_t> orbit_of_line_;
  std::vector<int> looks_;   // by orbit
  std::vector<char> found_;  // by orbit
};

/// Of lines that motions of the whole carry onto one another, the first few: what is found about them has images about
/// the others, see complete_regions(). A few, as one line may be less well placed than the next.
/// \param motions of a group that keeps the whole mesh; none: every line stands for itself
/// \param tolerance of the detector, a length as the lines' points
/// \return by line: whether to look there
std::vector<char> few_of_each_orbit(const std::vector<Line>& lines, const std::vector<Motion>& motions,
                                    double tolerance);

}  // namespace orbifit
