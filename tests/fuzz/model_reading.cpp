#include "model_reading.h"

#include <stdexcept>

#include "orbifit/model/annotation_io.h"
#include "orbifit/model/errors.h"
#include "orbifit/model/mesh_io.h"
#include "orbifit/model/scan_io.h"

namespace orbifit {

namespace {

// A reader promises finite numbers and indices that exist.
void require_sound(const Mesh& mesh) {
  const bool inside =
      mesh.faces.size() > 0 && mesh.faces.minCoeff() >= 0 && mesh.faces.maxCoeff() < mesh.vertices.rows();
  if (!mesh.vertices.allFinite() || !inside) throw std::logic_error("an unsound mesh was read");
  if (!mesh.polygon_of_face.empty() && static_cast<Eigen::Index>(mesh.polygon_of_face.size()) != mesh.faces.rows()) {
    throw std::logic_error("a mesh with other polygons than triangles was read");
  }
}

void require_sound(const PointCloud& scan) {
  if (scan.points.rows() == 0 || !scan.points.allFinite() || !scan.normals.allFinite() ||
      !scan.viewpoints.allFinite()) {
    throw std::logic_error("an unsound scan was read");
  }
}

}  // namespace

std::string counted(long long count, const std::string& what) {
  return std::to_string(count) + " " + what;
}

std::string read_or_refused(const std::filesystem::path& file, const std::function<std::string()>& read) {
  try {
    return "read: " + read();
  } catch (const InputError& error) {
    std::string text = error.what();
    const std::string folder = file.parent_path().string() + "/";
    for (std::size_t at = text.find(folder); at != std::string::npos; at = text.find(folder))
      text.erase(at, folder.size());
    return text;
  }
}

std::string model_reading(BadInputKind kind, const std::filesystem::path& file, const Mesh& mesh_of_annotation) {
  switch (kind) {
    case BadInputKind::mesh: {
      const Mesh mesh = read_mesh(file);
      require_sound(mesh);
      return counted(mesh.vertices.rows(), "vertices, ") + counted(mesh.faces.rows(), "faces");
    }
    case BadInputKind::scan: {
      const PointCloud scan = read_scan(file);
      require_sound(scan);
      return counted(scan.points.rows(), "points, ") + counted(scan.normals.rows(), "normals, ") +
             counted(scan.viewpoints.rows(), "viewpoints, ") + counted(scan.dropped, "dropped");
    }
    case BadInputKind::annotation: {
      const SymmetryAnnotation annotation = read_annotation(file, mesh_of_annotation);
      return counted(static_cast<long long>(annotation.regions.size()), "regions, ") +
             counted(static_cast<long long>(annotation.patterns.size()), "patterns");
    }
    default:
      throw std::logic_error("no kind of the model's readers");
  }
}

}  // namespace orbifit
