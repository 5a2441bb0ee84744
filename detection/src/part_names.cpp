#include "part_names.h"

#include <algorithm>
#include <cstddef>
#include <map>

namespace orbifit {

namespace {

constexpr std::size_t kLongest = 60;      // bytes of a name that is shown
constexpr double kHeld = 0.5;             // of a part's faces: a region of more is the part, one of fewer is in it
constexpr const char* kBetween = " ._-";  // what stands between a name and its number

std::string printable(const std::string& name) {
  std::string result;
  for (const char c : name) {
    if (static_cast<unsigned char>(c) >= 0x20 && c != 0x7f) result += c;
  }
  return result;
}

// "leg" of "leg_12"; nothing is left of a mere number.
std::string stem_of(const std::string& name) {
  std::string stem = printable(name);
  const std::size_t number = stem.find_last_not_of("0123456789");
  if (number == std::string::npos) return {};
  const std::size_t end = stem.find_last_not_of(kBetween, number);
  if (end == std::string::npos) return {};
  stem.resize(end + 1);
  return stem.size() <= kLongest ? stem : std::string{};
}

}  // namespace

PartNames::PartNames(const NamedParts& parts, std::size_t faces) : parts_(parts), size_(parts.names.size(), 0) {
  if (parts.part_of_face.size() != faces) return;
  for (const int part : parts.part_of_face) {
    if (part >= 0) ++size_[static_cast<std::size_t>(part)];
  }
  std::map<std::string, int> parts_of_stem;
  for (std::size_t part = 0; part < size_.size(); ++part) {
    stems_.push_back(size_[part] > 0 ? stem_of(parts.names[part]) : std::string{});
    if (!stems_.back().empty()) ++parts_of_stem[stems_.back()];
  }
  telling_ = parts_of_stem.size() > 1;
  // Numbers count parts of one kind; of one of its kind it is in the name for another reason.
  for (std::size_t part = 0; part < size_.size(); ++part) {
    const bool alone = !stems_[part].empty() && parts_of_stem[stems_[part]] == 1;
    if (alone && parts.names[part].size() <= kLongest) stems_[part] = printable(parts.names[part]);
  }
}

std::optional<PartNames::Noun> PartNames::of(const std::vector<int>& faces) const {
  if (!telling_) return std::nullopt;
  std::map<int, std::size_t> held;  // faces by part
  for (const int face : faces) {
    const int part = parts_.part_of_face[static_cast<std::size_t>(face)];
    if (part < 0) return std::nullopt;
    ++held[part];
  }
  Noun noun;
  noun.whole = true;
  for (const auto& [part, count] : held) {
    const auto p = static_cast<std::size_t>(part);
    if (noun.parts == 0) noun.text = stems_[p];
    if (stems_[p].empty() || stems_[p] != noun.text) return std::nullopt;
    noun.whole = noun.whole && static_cast<double>(count) > kHeld * static_cast<double>(size_[p]);
    ++noun.parts;
  }
  return noun;
}

}  // namespace orbifit
