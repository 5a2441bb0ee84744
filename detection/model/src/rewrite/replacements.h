#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

namespace orbifit {

/// Collects what is to stand in place of some pieces of a text, from front to back.
class Replacements {
 public:
  /// \param content outlives this
  explicit Replacements(std::string_view content) : content_(content) {}

  /// \param piece of `content`, behind all pieces replaced so far; may be empty, where text is inserted
  void replace(std::string_view piece, std::string_view text);

  /// Replaces the three numbers that begin at word `first` (from 0) of a line of `content` where they differ from
  /// `values`. Words that are no numbers stay.
  void replace_numbers(std::string_view line, int first, const Eigen::Vector3d& values);

  /// The text with all replacements.
  std::string finish() const;

 private:
  std::string_view content_;
  std::string done_;
  std::size_t at_ = 0;  // what of `content` is in `done_`
};

}  // namespace orbifit
