#include "files/text.h"
#include "rewrite/replacements.h"
#include "rewrite/rewriters.h"
#include "rewrite/turned_normals.h"

namespace orbifit {

std::string rewritten_off(const MeshEdit& edit) {
  Replacements result(edit.content);
  LineReader lines(edit.content);
  std::string_view line;
  lines.next_content(line, '#');
  WordReader header(line);
  const std::string_view keyword = header.word();
  const bool normals = keyword.substr(0, keyword.find("OFF")).find('N') != std::string_view::npos;
  // The counts stand behind the keyword or on the next line.
  const bool counted = !header.at_end() || keyword.size() > keyword.find("OFF") + 3;
  if (!counted) lines.next_content(line, '#');
  const std::vector<NormalTurn> turns =
      normals ? vertex_normal_turns(edit.rest, edit.edited) : std::vector<NormalTurn>{};
  for (Eigen::Index v = 0; v < edit.rest.vertices.rows() && lines.next_content(line, '#'); ++v) {
    result.replace_numbers(line, 0, edit.edited.vertices.row(v));
    if (!normals) continue;
    WordReader words(line);
    for (int skipped = 0; skipped < 3; ++skipped) words.word();
    Eigen::Vector3d normal;
    bool complete = true;
    for (double& entry : normal) {
      const auto number = words.number();
      complete = complete && number.has_value();
      entry = number.value_or(0);
    }
    if (complete) result.replace_numbers(line, 3, turns[static_cast<std::size_t>(v)].apply(normal));
  }
  return result.finish();
}

}  // namespace orbifit
