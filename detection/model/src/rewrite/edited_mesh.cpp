#include "orbifit/model/errors.h"
#include "orbifit/model/mesh_io.h"

#include "files/file.h"
#include "files/mesh_formats.h"
#include "rewrite/companions.h"
#include "rewrite/rewriters.h"

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

}  // namespace

std::vector<std::string> write_edited_mesh(const fs::path& file, const fs::path& source, const Mesh& edited) {
  const std::string ending = lower_extension(file);
  const Rewriter rewrite = rewriter(ending);
  if (rewrite == nullptr || ending != lower_extension(source)) {
    write_mesh(file, edited);
    return {};
  }
  const std::string content = read_file(source);
  MeshBuilder builder(source.string());
  mesh_reader(ending)(source, content, builder);
  const Mesh rest = builder.finish();
  if (rest.vertices.rows() != edited.vertices.rows() || rest.faces != edited.faces) {
    throw InputError(source.string(), "", "has changed since it was read: its vertices or faces are others");
  }
  write_file(file, rewrite({source, content, rest, edited}));
  return copy_companions(file, source, content);
}

}  // namespace orbifit
