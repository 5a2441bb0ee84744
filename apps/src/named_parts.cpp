#include "named_parts.h"

#include <algorithm>
#include <cstddef>
#include <vector>

#include "orbifit/model/errors.h"

namespace orbifit {

Appearance look_if_readable(const std::string& file, const Mesh& mesh) {
  try {
    return read_appearance(file, mesh);
  } catch (const InputError&) {
    return {};
  }
}

NamedParts named_parts(const Appearance& look) {
  NamedParts result;
  if (look.parts.empty()) return result;
  const bool objects =
      std::ranges::any_of(look.parts, [&](const Part& part) { return part.object != look.parts.front().object; });
  std::vector<int> number_of;  // of each part of the look
  for (std::size_t p = 0; p < look.parts.size(); ++p) {
    const Part& part = look.parts[p];
    // Several groups of one object are one part; two nodes that have the same names are two.
    const bool goes_on =
        objects && p > 0 && part.object == look.parts[p - 1].object && part.group != look.parts[p - 1].group;
    if (!goes_on) result.names.push_back(objects ? part.object : part.group);
    number_of.push_back(static_cast<int>(result.names.size()) - 1);
  }
  for (const int part : look.part_of_face) {
    const int number = part < 0 ? -1 : number_of[static_cast<std::size_t>(part)];
    const bool named = number >= 0 && !result.names[static_cast<std::size_t>(number)].empty();
    result.part_of_face.push_back(named ? number : -1);
  }
  return result;
}

}  // namespace orbifit
