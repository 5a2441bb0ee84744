#include "bad_input/bad_input.h"

#include <stdexcept>

#include "bad_input/bad_input_lists.h"
#include "files/mesh_formats.h"

namespace orbifit {

std::string with(std::string text, std::string_view from, std::string_view to) {
  const std::size_t at = text.find(from);
  if (at == std::string::npos) throw std::logic_error("bad input: '" + std::string(from) + "' is not in the text");
  return text.replace(at, from.size(), to);
}

void add_truncated(BadInputs& files, const std::string& stem, const std::string& ending, BadInputKind kind,
                   const std::string& content) {
  for (std::size_t part = 1; part < 8; ++part) {
    files.push_back(
        {stem + "_cut_" + std::to_string(part) + ending, kind, content.substr(0, part * content.size() / 8)});
  }
  files.push_back({stem + "_cut_last" + ending, kind, content.substr(0, content.size() - 1)});
}

Mesh cube_of_bad_input() {
  Mesh mesh;
  mesh.vertices.resize(8, 3);
  for (int v = 0; v < 8; ++v) mesh.vertices.row(v) << (v & 1) - 0.5, (v >> 1 & 1) - 0.5, (v >> 2) - 0.5;
  mesh.faces.resize(12, 3);
  mesh.faces << 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7,
      5;
  return mesh;
}

std::string bad_input_cube() {
  return obj_text(cube_of_bad_input());
}

std::vector<BadInput> bad_input() {
  BadInputs files;
  add_bad_obj(files);
  add_bad_off(files);
  add_bad_ply(files);
  add_bad_stl(files);
  add_bad_gltf(files);
  add_bad_scans(files);
  add_bad_json(files);
  add_hard_shapes(files);
  return files;
}

std::vector<BadInput> damaged_bases(std::string_view whole) {
  BadInputs files;
  const auto add = [&](const std::string& what, std::string content) {
    files.push_back({"basis_" + what + ".basis", BadInputKind::basis, std::move(content)});
  };
  constexpr std::size_t kWord = 8;
  for (std::size_t at = 0; at < 12 * kWord && at < whole.size(); at += kWord) {
    add("cut_header_" + std::to_string(at), std::string(whole.substr(0, at)));
    std::string flipped(whole);
    flipped[at] = static_cast<char>(flipped[at] ^ 0x40);
    add("flipped_" + std::to_string(at), std::move(flipped));
  }
  for (std::size_t part = 1; part < 8; ++part) {
    const std::size_t at = part * whole.size() / 8;
    add("cut_" + std::to_string(part), std::string(whole.substr(0, at)));
    std::string flipped(whole);
    flipped[at] = static_cast<char>(flipped[at] ^ 1);
    add("flipped_part_" + std::to_string(part), std::move(flipped));
  }
  add("longer", std::string(whole) + "12345678");
  add("twice", std::string(whole) + std::string(whole));
  return files;
}

}  // namespace orbifit
