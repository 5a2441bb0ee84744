#include "annotated_files.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include "../region_colours.h"
#include "files/binary.h"
#include "files/gltf.h"
#include "files/mesh_formats.h"
#include "geometry/surface_index.h"
#include "geometry/topology.h"
#include "remeshing/demands.h"

namespace orbifit {

namespace {

using Json = nlohmann::ordered_json;
using Eigen::Index;

// A GLB of meshes and nodes.
class GlbParts {
 public:
  explicit GlbParts(const std::filesystem::path& file) : file_(file) {}

  struct Scalar {
    std::string name;
    std::vector<float> values;  // by vertex
  };

  int add_mesh(const Mesh& mesh, const std::vector<Scalar>& scalars) {
    std::string points;
    std::vector<float> low(3, INFINITY);
    std::vector<float> high(3, -INFINITY);
    for (Index v = 0; v < mesh.vertices.rows(); ++v) {
      for (std::size_t k = 0; k < 3; ++k) {
        const float value = to_float(file_, mesh.vertices(v, static_cast<Index>(k)));
        store(points, value);
        low[k] = std::min(low[k], value);
        high[k] = std::max(high[k], value);
      }
    }
    Json attributes{{"POSITION", add_accessor(points, mesh.vertices.rows(), "VEC3", gltf::kFloat, 34962)}};
    accessors_.back()["min"] = low;
    accessors_.back()["max"] = high;
    for (const Scalar& scalar : scalars) {
      std::string bytes;
      for (const float value : scalar.values) store(bytes, value);
      attributes[scalar.name] = add_accessor(bytes, mesh.vertices.rows(), "SCALAR", gltf::kFloat, 34962);
    }
    std::string corners;
    for (const int corner : mesh.faces.reshaped<Eigen::RowMajor>()) store(corners, static_cast<std::uint32_t>(corner));
    const std::size_t indices = add_accessor(corners, 3 * mesh.faces.rows(), "SCALAR", gltf::kUnsignedInt, 34963);
    meshes_.push_back({{"primitives", {{{"attributes", attributes}, {"indices", indices}}}}});
    return static_cast<int>(meshes_.size()) - 1;
  }

  void add_node(Json node) { nodes_.push_back(std::move(node)); }
  int meshes() const { return static_cast<int>(meshes_.size()); }
  int nodes() const { return static_cast<int>(nodes_.size()); }

  std::string bytes() const {
    Json root{{"asset", {{"version", "2.0"}, {"generator", "Orbifit"}}}, {"scene", 0}};
    Json all = Json::array();
    for (std::size_t n = 0; n < nodes_.size(); ++n) all.push_back(n);
    root["scenes"] = {{{"nodes", all}}};
    root["nodes"] = nodes_;
    root["meshes"] = meshes_;
    root["accessors"] = accessors_;
    root["bufferViews"] = views_;
    root["buffers"] = {{{"byteLength", data_.size()}}};
    return gltf::glb_container(file_, root.dump(-1, ' ', false, Json::error_handler_t::replace), data_);
  }

 private:
  std::size_t add_accessor(const std::string& bytes, Index count, const char* type, int component, int target) {
    views_.push_back({{"buffer", 0}, {"byteOffset", data_.size()}, {"byteLength", bytes.size()}, {"target", target}});
    data_ += bytes;
    accessors_.push_back(
        {{"bufferView", views_.size() - 1}, {"componentType", component}, {"count", count}, {"type", type}});
    return accessors_.size() - 1;
  }

  const std::filesystem::path& file_;
  Json meshes_ = Json::array(), nodes_ = Json::array(), accessors_ = Json::array(), views_ = Json::array();
  std::string data_;
};

std::vector<double> numbers(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

// An empty at a region's centre whose z looks along a direction.
Json marker(const Region& region, const std::string& what, const Eigen::Vector3d& direction) {
  const Eigen::Quaterniond turn = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), direction);
  return {{"name", what + " of region " + std::to_string(region.id) + ": " + region.name},
          {"translation", numbers(region.centre)},
          {"rotation", {turn.x(), turn.y(), turn.z(), turn.w()}},
          {"extras", {{"region", region.id}, {"group", region.group.symbol()}}}};
}

void add_markers(GlbParts& glb, const Region& region) {
  std::vector<Eigen::Vector3d> axes;
  if (!region.axis.isZero() && region.group.family != PointGroup::Family::Cs) axes.push_back(region.axis);
  for (const Motion& element : region.elements) {
    const AxisAngle turn = axis_angle(element.linear);
    const bool mirror = turn.determinant < 0 && std::abs(turn.angle - std::numbers::pi) < 1e-6;
    if (mirror) glb.add_node(marker(region, "mirror plane", turn.axis));
    if (turn.determinant < 0 || turn.angle == 0) continue;
    const bool known = std::ranges::any_of(
        axes, [&](const Eigen::Vector3d& axis) { return std::abs(axis.dot(turn.axis)) > 1 - 1e-9; });
    if (!known) axes.push_back(turn.axis);
  }
  for (const Eigen::Vector3d& axis : axes) glb.add_node(marker(region, "axis", axis));
}

std::vector<int> faces_of(const Components& components, const std::vector<int>& numbers_of) {
  std::vector<int> faces;
  for (const int c : numbers_of) {
    const std::vector<int>& own = components.faces[static_cast<std::size_t>(c)];
    faces.insert(faces.end(), own.begin(), own.end());
  }
  std::ranges::sort(faces);
  return faces;
}

std::vector<double> column_major(const Motion& motion) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.topLeftCorner<3, 3>() = motion.linear;
  matrix.topRightCorner<3, 1>() = motion.translation;
  return {matrix.data(), matrix.data() + 16};
}

}  // namespace

std::string glb_with_regions(const std::filesystem::path& file, const Mesh& mesh,
                             const SymmetryAnnotation& annotation) {
  GlbParts glb(file);
  std::vector<GlbParts::Scalar> scalars;
  for (const Region& region : annotation.regions) {
    GlbParts::Scalar scalar{"_REGION_" + std::to_string(region.id), {}};
    scalar.values.assign(static_cast<std::size_t>(mesh.vertices.rows()), 0);
    for (const int vertex : vertices_of_faces(mesh, region.faces)) scalar.values[static_cast<std::size_t>(vertex)] = 1;
    scalars.push_back(std::move(scalar));
  }
  glb.add_node({{"name", file.stem().string()}, {"mesh", glb.add_mesh(mesh, scalars)}});
  for (const Region& region : annotation.regions) add_markers(glb, region);
  return glb.bytes();
}

InstancedGlb glb_of_instances(const std::filesystem::path& file, const Mesh& mesh, const SymmetryAnnotation& annotation,
                              const RunContext& context) {
  const double scale = diagonal(mesh.vertices);
  const Components components = touching_parts(mesh, weld_vertices(mesh.vertices, 1e-9 * scale), DoubledParts::apart);
  const AnnotationDemands asked = annotation_demands(mesh, components, annotation, 0, context);
  const Cells cells = find_cells(mesh, components, asked.demands, 2 * annotation.tolerance * scale, context);
  InstancedGlb result;
  GlbParts glb(file);
  std::vector<int> mesh_of(cells.cells.size(), -1);
  for (std::size_t c = 0; c < cells.cells.size(); ++c) {
    const MeshCell& cell = cells.cells[c];
    const auto source = static_cast<std::size_t>(cell.source);
    const Mesh part = submesh(mesh, faces_of(components, cells.cells[source].components));
    if (mesh_of[source] < 0) mesh_of[source] = glb.add_mesh(part, {});
    Json node{{"mesh", mesh_of[source]}};
    if (source != c) {
      node["matrix"] = column_major(cell.from_source);
      const SurfaceIndex index(mesh, faces_of(components, cell.components));
      for (Index v = 0; v < part.vertices.rows(); ++v) {
        const double distance = index.nearest(cell.from_source(part.vertices.row(v).transpose())).distance;
        result.largest_distance = std::max(result.largest_distance, distance);
      }
    }
    glb.add_node(std::move(node));
  }
  result.bytes = glb.bytes();
  result.meshes = glb.meshes();
  result.nodes = glb.nodes();
  return result;
}

std::string ply_with_quality(const Mesh& mesh, const SymmetryAnnotation& annotation) {
  std::vector<const Region*> smallest(static_cast<std::size_t>(mesh.faces.rows()), nullptr);
  for (const Region& region : annotation.regions) {
    for (const int face : region.faces) {
      const Region*& known = smallest[static_cast<std::size_t>(face)];
      if (known == nullptr || region.faces.size() < known->faces.size()) known = &region;
    }
  }
  const Points colours = region_face_colours(mesh, annotation.regions);
  std::string bytes = "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(mesh.vertices.rows()) +
                      "\nproperty double x\nproperty double y\nproperty double z\nelement face " +
                      std::to_string(mesh.faces.rows()) +
                      "\nproperty list uchar int vertex_indices\nproperty uchar red\nproperty uchar green\n"
                      "property uchar blue\nproperty float quality\nend_header\n";
  for (const double coordinate : mesh.vertices.reshaped<Eigen::RowMajor>()) store(bytes, coordinate);
  for (Index f = 0; f < mesh.faces.rows(); ++f) {
    store(bytes, std::uint8_t{3});
    for (int k = 0; k < 3; ++k) store(bytes, std::int32_t{mesh.faces(f, k)});
    for (int k = 0; k < 3; ++k) {
      store(bytes, static_cast<std::uint8_t>(std::lround(255 * std::clamp(colours(f, k), 0.0, 1.0))));
    }
    const Region* region = smallest[static_cast<std::size_t>(f)];
    store(bytes, region == nullptr ? -1.0F : static_cast<float>(region->id));
  }
  return bytes;
}

}  // namespace orbifit
