#include <cstdint>

#include "files/binary.h"
#include "files/mesh_formats.h"
#include "files/stl.h"
#include "files/text.h"
#include "rewrite/replacements.h"
#include "rewrite/rewriters.h"
#include "rewrite/turned_normals.h"

namespace orbifit {

namespace {

// The normal of a triangle as the file has it after the edit; one of zeros stays, as programs that leave it out write.
Eigen::Vector3d turned(const Eigen::Vector3d& normal, const Points& before, const Points& after, Eigen::Index face) {
  NormalTurn turn;
  turn.add(before.row(face), after.row(face));
  return turn.apply(normal);
}

std::string rewritten_binary(const MeshEdit& edit, const Points& before, const Points& after) {
  std::string bytes(edit.content.substr(0, stl::kHeader));
  bytes.reserve(edit.content.size());
  for (Eigen::Index f = 0; f < edit.rest.faces.rows(); ++f) {
    const char* triangle = edit.content.data() + stl::kHeader + stl::kTriangle * static_cast<std::size_t>(f);
    const Eigen::Vector3d normal(load<float>(triangle), load<float>(triangle + 4), load<float>(triangle + 8));
    for (const double entry : turned(normal, before, after, f)) store(bytes, to_float(edit.source, entry));
    for (const int vertex : edit.rest.faces.row(f)) {
      for (int k = 0; k < 3; ++k) store(bytes, to_float(edit.source, edit.edited.vertices(vertex, k)));
    }
    bytes.append(triangle + 48, 2);
  }
  const std::size_t end = bytes.size();
  return bytes.append(edit.content.substr(end));
}

std::string rewritten_text(const MeshEdit& edit, const Points& before, const Points& after) {
  Replacements result(edit.content);
  LineReader lines(edit.content);
  std::string_view line;
  Eigen::Index vertex = 0;
  while (lines.next_content(line)) {
    WordReader words(line);
    const std::string keyword = lower_case(words.word());
    if (keyword == "vertex") {
      result.replace_numbers(line, 1, edit.edited.vertices.row(vertex++));
    } else if (keyword == "facet" && lower_case(words.word()) == "normal") {
      Eigen::Vector3d normal;
      for (double& entry : normal) entry = words.number().value_or(0);
      result.replace_numbers(line, 2, turned(normal, before, after, vertex / 3));
    }
  }
  return result.finish();
}

}  // namespace

std::string rewritten_stl(const MeshEdit& edit) {
  const Points before = face_area_vectors(edit.rest);
  const Points after = face_area_vectors(edit.edited);
  return stl::is_text(edit.content) ? rewritten_text(edit, before, after) : rewritten_binary(edit, before, after);
}

}  // namespace orbifit
