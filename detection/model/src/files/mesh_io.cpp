#include "orbifit/model/mesh_io.h"

#include <cmath>
#include <limits>

#include "orbifit/model/errors.h"

#include "files/file.h"
#include "files/mesh_formats.h"
#include "files/text.h"

namespace orbifit {

namespace fs = std::filesystem;

namespace {

// The formats that need no other file beside them.
template <void (*Read)(std::string_view, MeshBuilder&)>
void read_content(const fs::path& /*file*/, std::string_view content, MeshBuilder& builder) {
  Read(content, builder);
}

}  // namespace

MeshReader mesh_reader(const fs::path& file) {
  const std::string ending = lower_extension(file);
  if (ending == ".obj") return read_content<read_obj>;
  if (ending == ".off") return read_content<read_off>;
  if (ending == ".ply") return read_content<read_ply_mesh>;
  if (ending == ".stl") return read_content<read_stl>;
  if (ending == ".gltf" || ending == ".glb") return read_gltf;
  return nullptr;
}

float to_float(const fs::path& file, double value) {
  if (!(std::abs(value) <= std::numeric_limits<float>::max())) {
    std::string text;
    append_number(text, value);
    throw InputError(file.string(), "", "cannot hold the coordinate " + text + ": it stores single precision");
  }
  return static_cast<float>(value);
}

Mesh read_mesh(const fs::path& file) {
  const std::string content = read_file(file);
  const MeshReader read = mesh_reader(file);
  if (read == nullptr) {
    throw InputError(file.string(), "",
                     "unknown ending " + in_quotes(file.extension().string()) +
                         ": meshes are read from .obj, .off, .ply, .stl, .gltf and .glb");
  }
  MeshBuilder builder(file.string());
  read(file, content, builder);
  return builder.finish();
}

void write_mesh(const fs::path& file, const Mesh& mesh, const std::optional<Points>& colours) {
  const std::string ending = lower_extension(file);
  if (ending == ".obj") return write_file(file, obj_text(mesh));
  if (ending == ".off") return write_file(file, off_text(mesh));
  if (ending == ".ply") return write_file(file, ply_bytes(mesh, colours));
  if (ending == ".stl") return write_file(file, stl_bytes(file, mesh));
  if (ending == ".glb") return write_file(file, glb_bytes(file, mesh));
  throw UsageError(file.string() + ": unknown ending " + in_quotes(file.extension().string()) +
                   ": meshes are written as .obj, .off, .ply, .stl or .glb");
}

}  // namespace orbifit
