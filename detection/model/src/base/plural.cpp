#include "base/plural.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>

namespace orbifit {

namespace {

struct Ending {
  std::string_view of_one, of_many;
};

constexpr std::array kIrregular{Ending{"foot", "feet"},   Ending{"tooth", "teeth"},    Ending{"shelf", "shelves"},
                                Ending{"leaf", "leaves"}, Ending{"half", "halves"},    Ending{"knife", "knives"},
                                Ending{"axis", "axes"},   Ending{"vertex", "vertices"}};

// What a word ends in, and what takes its place.
Ending ending_of(std::string_view word) {
  for (const Ending& each : kIrregular) {
    if (word.ends_with(each.of_one)) return each;
  }
  if (word.empty() || !std::isalpha(static_cast<unsigned char>(word.back()))) return {};  // a number, or other writing
  for (const std::string_view hissing : {"s", "x", "z", "ch", "sh"}) {
    if (word.ends_with(hissing)) return {"", "es"};
  }
  const bool after_vowel = word.size() > 1 && std::string_view("aeiou").find(word[word.size() - 2]) != word.npos;
  if (word.ends_with("y") && word.size() > 1 && !after_vowel) return {"y", "ies"};
  return {"", "s"};
}

}  // namespace

std::string plural(const std::string& name) {
  const std::size_t end = std::min(name.find(" of "), name.size());
  const Ending ending = ending_of(std::string_view(name).substr(0, end));
  const std::size_t kept = end - ending.of_one.size();
  return name.substr(0, kept) + std::string(ending.of_many) + name.substr(end);
}

}  // namespace orbifit
