#include <memory>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "orbifit/model/mesh_io.h"

#include "../commands.h"
#include "../file_content.h"
#include "geometry/topology.h"

namespace orbifit::commands {

namespace {

nlohmann::ordered_json to_json(const std::string& file, const Mesh& mesh, const MeshReport& report) {
  const auto vector = [](const Eigen::Vector3d& v) { return std::vector<double>{v.x(), v.y(), v.z()}; };
  return {{"file", file},
          {"vertices", report.vertices},
          {"faces", report.faces},
          {"polygons", mesh.polygon_of_face.empty() ? report.faces : mesh.polygon_of_face.back() + 1},
          {"components", report.components},
          {"duplicate_vertices", report.duplicate_vertices},
          {"unused_vertices", report.unused_vertices},
          {"degenerate_faces", report.degenerate_faces},
          {"duplicate_faces", report.duplicate_faces},
          {"boundary_edges", report.boundary_edges},
          {"non_manifold_edges", report.non_manifold_edges},
          {"inconsistent_edges", report.inconsistent_edges},
          {"watertight", report.watertight},
          {"area", report.area},
          {"volume", report.watertight ? nlohmann::ordered_json(report.volume) : nullptr},
          {"diagonal", report.diagonal},
          {"minimum", vector(report.minimum)},
          {"maximum", vector(report.maximum)}};
}

std::string to_text(const std::string& file, const Mesh& mesh, const MeshReport& report) {
  std::string text = file + "\n";
  const auto line = [&](const std::string& label, const std::string& value) {
    text += "  " + label + std::string(12 - label.size(), ' ') + value + "\n";
  };
  const auto vector = [](const Eigen::Vector3d& v, const char* separator) {
    return short_number(v.x(), 6) + separator + short_number(v.y(), 6) + separator + short_number(v.z(), 6);
  };
  line("vertices", std::to_string(report.vertices));
  line("faces",
       count_of(report.faces, "triangle") +
           (mesh.polygon_of_face.empty() ? "" : ", cut from " + count_of(mesh.polygon_of_face.back() + 1, "polygon")));
  line("components", std::to_string(report.components));
  line("size", vector(report.maximum - report.minimum, " x ") + ", diagonal " + short_number(report.diagonal, 6));
  line("from", vector(report.minimum, "  "));
  line("to", vector(report.maximum, "  "));
  line("area", short_number(report.area, 6));
  line("volume", report.watertight ? short_number(report.volume, 6) : "unknown (the surface is not closed)");
  line("watertight", report.watertight ? "yes" : "no");
  std::string defects;
  const auto defect = [&](int count, const std::string& singular, const std::string& plural) {
    if (count > 0) defects += (defects.empty() ? "" : ", ") + count_of(count, singular, plural);
  };
  defect(report.boundary_edges, "boundary edge", "boundary edges");
  defect(report.non_manifold_edges, "edge of more than two faces", "edges of more than two faces");
  defect(report.inconsistent_edges, "edge where the orientation flips", "edges where the orientation flips");
  defect(report.degenerate_faces, "face of no area", "faces of no area");
  defect(report.duplicate_faces, "repeated face", "repeated faces");
  defect(report.duplicate_vertices, "repeated vertex", "repeated vertices");
  defect(report.unused_vertices, "unused vertex", "unused vertices");
  line("defects", defects.empty() ? "none" : defects);
  return text;
}

}  // namespace

CommandBody info(CLI::App& app) {
  const auto file = std::make_shared<std::string>();
  app.add_option("MESH", *file, "Mesh: .obj, .off, .ply, .stl, .gltf, .glb or .3mf")->required()->type_name("FILE");
  return [file](CommandContext& context) {
    const Mesh mesh = read_mesh(*file);
    context.run.check();
    const MeshReport report = inspect(mesh);
    if (context.json) {
      nlohmann::ordered_json json = to_json(*file, mesh, report);
      json["content"] = file_content(*file, mesh);
      print(context, json.dump(2) + "\n");
    } else {
      print(context, to_text(*file, mesh, report));
    }
    return kDone;
  };
}

}  // namespace orbifit::commands
