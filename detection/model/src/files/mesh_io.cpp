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

// Triangles of 50 bytes follow a header of 80 and their count.
bool is_binary_stl(std::string_view content) {
  if (content.size() < 84) return false;
  std::size_t count = 0;
  for (std::size_t k = 4; k-- > 0;) count = count << 8U | static_cast<unsigned char>(content[80 + k]);
  return content.size() == 84 + 50 * count;
}

// The formats that need no other file beside them.
template <void (*Read)(std::string_view, MeshBuilder&)>
void read_content(const fs::path& /*file*/, std::string_view content, MeshBuilder& builder) {
  Read(content, builder);
}

}  // namespace

std::string format_ending(const fs::path& file, std::string_view content) {
  const std::string ending = lower_extension(file);
  if (!is_standard_stream(file) || !ending.empty()) return ending;
  const std::string_view line = content.substr(0, std::min<std::size_t>(content.find_first_of("\r\n"), 80));
  const std::size_t first = content.find_first_not_of(" \t\r\n");
  const char begin = first == std::string_view::npos ? ' ' : content[first];
  if (line == "ply") return ".ply";
  if (content.starts_with("glTF")) return ".glb";
  if (content.starts_with("PK\x03\x04")) return ".3mf";
  if (begin == '{') return ".gltf";
  if (line.ends_with("OFF") || line.starts_with("OFF")) return ".off";
  if (line.starts_with("# .PCD") || line.starts_with("VERSION")) return ".pcd";
  if (line.starts_with("solid") || is_binary_stl(content)) return ".stl";
  const bool number = begin == '-' || begin == '.' || (begin >= '0' && begin <= '9');
  if (!number) return ".obj";
  return line.find_first_of(" \t,;") == std::string_view::npos ? ".pts" : ".xyz";  // a PTS opens with its count
}

MeshReader mesh_reader(const std::string& ending) {
  if (ending == ".obj") return read_content<read_obj>;
  if (ending == ".off") return read_content<read_off>;
  if (ending == ".ply") return read_content<read_ply_mesh>;
  if (ending == ".stl") return read_content<read_stl>;
  if (ending == ".gltf" || ending == ".glb") return read_gltf;
  if (ending == ".3mf") return read_three_mf;
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
  const MeshReader read = mesh_reader(format_ending(file, content));
  if (read == nullptr) {
    throw InputError(file.string(), "",
                     "unknown ending " + in_quotes(file.extension().string()) +
                         ": meshes are read from .obj, .off, .ply, .stl, .gltf, .glb and .3mf");
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
  if (file == "-") throw UsageError("standard output needs a format: --output-format obj, off, ply, stl or glb");
  throw UsageError(file.string() + ": unknown ending " + in_quotes(file.extension().string()) +
                   ": meshes are written as .obj, .off, .ply, .stl or .glb");
}

}  // namespace orbifit
