#include "rewrite/replacements.h"

#include "files/text.h"

namespace orbifit {

void Replacements::replace(std::string_view piece, std::string_view text) {
  const auto begin = static_cast<std::size_t>(piece.data() - content_.data());
  done_.append(content_, at_, begin - at_).append(text);
  at_ = begin + piece.size();
}

void Replacements::replace_numbers(std::string_view line, int first, const Eigen::Vector3d& values) {
  WordReader words(line);
  for (int skipped = 0; skipped < first; ++skipped) words.word();
  std::string text;
  for (const double value : values) {
    const std::string_view word = words.word();
    const auto number = parse_number(word);
    if (!number || *number == value) continue;
    text.clear();
    append_number(text, value);
    replace(word, text);
  }
}

std::string Replacements::finish() const {
  return done_ + std::string(content_.substr(at_));
}

}  // namespace orbifit
