#include <algorithm>

#include "orbifit/model/errors.h"

#include "files/three_mf.h"
#include "look/look_formats.h"

namespace orbifit {

Appearance three_mf_look(const std::filesystem::path& file, std::string_view content, const Mesh& mesh) {
  MeshBuilder builder(file.string());
  ThreeMfContent told = read_three_mf_content(file, content, builder);
  Appearance look;
  look.warnings = std::move(told.warnings);
  for (const ThreeMfPart& part : told.parts) {
    if (part.first_face > mesh.faces.rows()) {
      throw InputError(file.string(), "", "has changed since it was read: its vertices or faces are others");
    }
    look.part_of_face.resize(static_cast<std::size_t>(part.first_face), static_cast<int>(look.parts.size()) - 1);
    look.parts.push_back({part.name, ""});
  }
  look.part_of_face.resize(static_cast<std::size_t>(mesh.faces.rows()), static_cast<int>(look.parts.size()) - 1);
  if (std::ranges::all_of(look.parts, [](const Part& part) { return part.object.empty(); })) {
    look.part_of_face.clear();
    look.parts.clear();
  }
  return look;
}

}  // namespace orbifit
