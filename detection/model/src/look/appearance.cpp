#include "orbifit/model/appearance.h"

#include <algorithm>
#include <limits>

#include <Eigen/Geometry>

#include "orbifit/model/errors.h"
#include "orbifit/model/mesh_io.h"

#include "files/file.h"
#include "files/mesh_formats.h"
#include "files/text.h"
#include "look/look_formats.h"

namespace orbifit {

namespace fs = std::filesystem;
using Eigen::Index;

namespace {

// Mean of a vertex' corners, white where it has none.
Points vertex_colours(const Mesh& mesh, const Appearance& look) {
  Points sums = Points::Zero(mesh.vertices.rows(), 3);
  Eigen::VectorXd counts = Eigen::VectorXd::Zero(mesh.vertices.rows());
  for (Index c = 0; c < look.colours.rows(); ++c) {
    if (!look.colours.row(c).allFinite()) continue;
    const int vertex = mesh.faces(c / 3, c % 3);
    sums.row(vertex) += look.colours.row(c).head<3>();
    counts[vertex] += 1;
  }
  for (Index v = 0; v < sums.rows(); ++v) {
    if (counts[v] > 0) sums.row(v) /= counts[v];
    if (counts[v] == 0) sums.row(v).setOnes();
  }
  return sums;
}

// A name for an image that came without a file's.
std::string image_name(const fs::path& file, const Material& material, std::size_t number) {
  if (!material.texture.empty() && within_folder(material.texture)) return material.texture;
  const std::string ending = image_type(material.image) == "image/jpeg" ? ".jpg" : ".png";
  return file.stem().string() + "-" + std::to_string(number) + ending;
}

std::vector<std::string> write_obj_with_look(const fs::path& file, const Mesh& mesh, Appearance look) {
  std::vector<std::string> problems;
  if (is_standard_stream(file)) {
    if (!look.materials.empty())
      problems.push_back("standard output takes no material library: materials are left out");
    look.materials.clear();
    look.material_of_face.clear();
    write_file(file, obj_with_look(mesh, look, "").mesh);
    return problems;
  }
  for (std::size_t m = 0; m < look.materials.size(); ++m) {
    Material& material = look.materials[m];
    if (material.image.empty()) continue;
    material.texture = image_name(file, material, m);
    const fs::path target = file.parent_path() / material.texture;
    std::error_code error;
    if (fs::exists(target, error)) continue;
    fs::create_directories(target.parent_path(), error);
    write_file(target, material.image);
  }
  const fs::path library = fs::path(file).replace_extension(".mtl");
  const ObjFiles files = obj_with_look(mesh, look, look.materials.empty() ? "" : library.filename().string());
  if (!files.library.empty()) write_file(library, files.library);
  write_file(file, files.mesh);
  return problems;
}

// Weights of a point of the triangle's plane; of a degenerate triangle the first corner's.
Eigen::Vector3d plane_weights(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                              const Eigen::Vector3d& c) {
  const Eigen::Vector3d normal = (b - a).cross(c - a);
  const double area = normal.squaredNorm();
  if (!(area > 0)) return {1, 0, 0};
  const double v = (p - a).cross(c - a).dot(normal) / area;
  const double w = (b - a).cross(p - a).dot(normal) / area;
  return {1 - v - w, v, w};
}

}  // namespace

bool Appearance::empty() const {
  return uvs.rows() == 0 && normals.rows() == 0 && colours.rows() == 0 && material_of_face.empty() &&
         part_of_face.empty();
}

bool within_folder(const fs::path& name) {
  return !name.empty() && !name.is_absolute() &&
         std::ranges::none_of(name, [](const fs::path& part) { return part == ".."; }) &&
         std::ranges::none_of(name.native(), [](char c) { return static_cast<unsigned char>(c) < ' '; });
}

void read_image(const fs::path& folder, Material& material, std::vector<std::string>& warnings) {
  if (!within_folder(material.texture)) {
    warnings.push_back("texture " + in_quotes(material.texture) + " is outside of the mesh's folder: not read");
    return;
  }
  std::error_code error;
  if (!fs::is_regular_file(folder / material.texture, error)) {
    warnings.push_back("texture " + in_quotes(material.texture) + " is missing");
    return;
  }
  material.image = read_file(folder / material.texture);
}

std::string image_type(std::string_view bytes) {
  if (bytes.starts_with("\x89PNG")) return "image/png";
  if (bytes.starts_with("\xFF\xD8\xFF")) return "image/jpeg";
  return "";
}

Appearance read_appearance(const fs::path& file, const Mesh& mesh) {
  if (is_standard_stream(file)) return {};
  const std::string ending = lower_extension(file);
  if (ending != ".obj" && ending != ".ply" && ending != ".gltf" && ending != ".glb" && ending != ".3mf") return {};
  const std::string content = read_file(file);
  if (ending == ".3mf") return three_mf_look(file, content, mesh);
  if (ending == ".obj") return obj_look(file, content, mesh);
  if (ending == ".ply") return ply_look(file, content, mesh);
  return gltf_look(file, content, mesh);
}

std::vector<std::string> write_mesh(const fs::path& file, const Mesh& mesh, const Appearance& look) {
  const std::string ending = lower_extension(file);
  if (!look.empty() && ending == ".obj") return write_obj_with_look(file, mesh, look);
  if (!look.empty() && ending == ".glb") {
    std::vector<std::string> problems;
    write_file(file, glb_with_look(file, mesh, look, problems));
    return problems;
  }
  const bool coloured = look.colours.rows() > 0 && ending == ".ply";
  write_mesh(file, mesh, coloured ? std::optional<Points>(vertex_colours(mesh, look)) : std::nullopt);
  std::string lost;
  const auto lose = [&](bool there, const char* what) {
    if (there) lost += (lost.empty() ? "" : ", ") + std::string(what);
  };
  lose(look.uvs.rows() > 0, "texture coordinates");
  lose(look.normals.rows() > 0, "normals");
  lose(look.colours.rows() > 0 && !coloured, "colours");
  lose(!look.material_of_face.empty(), "materials");
  lose(!look.part_of_face.empty(), "names of objects and groups");
  if (lost.empty()) return {};
  return {file.string() + " does not take the input's " + lost};
}

Appearance transferred(const Appearance& look, const Mesh& source, const Mesh& mesh,
                       const std::vector<int>& source_face, const std::vector<Motion>& motions,
                       const std::vector<int>& motion_of_face) {
  Appearance result;
  result.materials = look.materials;
  result.parts = look.parts;
  result.warnings = look.warnings;
  const Index corners = 3 * mesh.faces.rows();
  if (look.uvs.rows() > 0) result.uvs.resize(corners, 2);
  if (look.normals.rows() > 0) result.normals.resize(corners, 3);
  if (look.colours.rows() > 0) result.colours.resize(corners, 4);
  std::vector<Motion> back;
  back.reserve(motions.size());
  for (const Motion& motion : motions) back.push_back(inverse(motion));
  for (Index f = 0; f < mesh.faces.rows(); ++f) {
    const int from = source_face[static_cast<std::size_t>(f)];
    const auto motion = static_cast<std::size_t>(motion_of_face[static_cast<std::size_t>(f)]);
    if (!look.material_of_face.empty()) {
      result.material_of_face.push_back(look.material_of_face[static_cast<std::size_t>(from)]);
    }
    if (!look.part_of_face.empty()) {
      result.part_of_face.push_back(look.part_of_face[static_cast<std::size_t>(from)]);
    }
    const auto corner = [&](int k) -> Eigen::Vector3d {
      return source.vertices.row(source.faces(from, k)).transpose();
    };
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d point = back[motion](mesh.vertices.row(mesh.faces(f, k)).transpose());
      const Eigen::RowVector3d weights = plane_weights(point, corner(0), corner(1), corner(2)).transpose();
      const Index row = 3 * f + k;
      if (look.uvs.rows() > 0) result.uvs.row(row) = weights * look.uvs.middleRows<3>(3 * from);
      if (look.colours.rows() > 0) {
        result.colours.row(row) = (weights * look.colours.middleRows<3>(3 * from)).cwiseMax(0).cwiseMin(1);
      }
      if (look.normals.rows() > 0) {
        const Eigen::Vector3d normal = (weights * look.normals.middleRows<3>(3 * from)).transpose();
        result.normals.row(row) = (motions[motion].linear * normal).normalized().transpose();
      }
    }
  }
  return result;
}

}  // namespace orbifit
