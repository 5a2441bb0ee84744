#include "orbifit/model/appearance.h"
#include "orbifit/model/errors.h"
#include "orbifit/model/mesh_io.h"

#include "files/file.h"
#include "files/mesh_formats.h"
#include "rewrite/companions.h"
#include "rewrite/rewriters.h"
#include "rewrite/turned_normals.h"

namespace orbifit {

namespace fs = std::filesystem;

namespace {

using Rewriter = std::string (*)(const MeshEdit& edit);

Rewriter rewriter(const std::string& ending) {
  if (ending == ".obj") return rewritten_obj;
  if (ending == ".off") return rewritten_off;
  if (ending == ".ply") return rewritten_ply;
  if (ending == ".stl") return rewritten_stl;
  if (ending == ".gltf" || ending == ".glb") return rewritten_gltf;
  return nullptr;
}

void check_same(const fs::path& source, const Mesh& rest, const Mesh& edited) {
  if (rest.vertices.rows() != edited.vertices.rows() || rest.faces != edited.faces) {
    throw InputError(source.string(), "", "has changed since it was read: its vertices or faces are others");
  }
}

// In another format than the source's: the mesh with the source's look, whose normals turn with the faces.
std::vector<std::string> write_in_other_format(const fs::path& file, const fs::path& source, const Mesh& edited) {
  if (is_standard_stream(source)) {
    write_mesh(file, edited);
    return {};
  }
  const Mesh rest = read_mesh(source);
  check_same(source, rest, edited);
  Appearance look;
  try {
    look = read_appearance(source, rest);
  } catch (const InputError& error) {
    look.warnings.emplace_back(error.what());  // the edit is worth more than its look
  }
  if (look.normals.rows() > 0) {
    const std::vector<NormalTurn> turns = vertex_normal_turns(rest, edited);
    for (Eigen::Index c = 0; c < look.normals.rows(); ++c) {
      const auto vertex = static_cast<std::size_t>(rest.faces(c / 3, c % 3));
      look.normals.row(c) = turns[vertex].apply(look.normals.row(c).transpose()).transpose();
    }
  }
  std::vector<std::string> problems = look.warnings;
  const std::vector<std::string> lost = write_mesh(file, edited, look);
  problems.insert(problems.end(), lost.begin(), lost.end());
  return problems;
}

}  // namespace

std::vector<std::string> write_edited_mesh(const fs::path& file, const fs::path& source, const Mesh& edited) {
  const std::string ending = lower_extension(file);
  const Rewriter rewrite = rewriter(ending);
  if (rewrite == nullptr || ending != lower_extension(source)) return write_in_other_format(file, source, edited);
  const std::string content = read_file(source);
  MeshBuilder builder(source.string());
  mesh_reader(ending)(source, content, builder);
  const Mesh rest = builder.finish();
  check_same(source, rest, edited);
  write_file(file, rewrite({source, content, rest, edited}));
  return copy_companions(file, source, content);
}

}  // namespace orbifit
