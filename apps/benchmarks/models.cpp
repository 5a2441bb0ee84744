#include "models.h"

#include <cmath>
#include <utility>

#include "cases/table1.h"

namespace orbifit::benchmarks {

namespace {

int thousands(double count) {
  return static_cast<int>(std::lround(1000 * count));
}

Handle on_mesh(const Table1Handle& part, const Mesh& mesh) {
  Handle handle;
  handle.name = part.name;
  handle.motion = part.motion;
  for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) {
    if ((mesh.vertices.row(v).transpose() - part.centre).norm() > part.radius) continue;
    handle.vertices.push_back(static_cast<int>(v));
  }
  return handle;
}

}  // namespace

const std::vector<std::string>& benchmark_model_names() {
  return table1_names();
}

BenchmarkModel benchmark_model(const std::string& name) {
  Table1Model row = table1_model(name);
  BenchmarkModel model;
  model.name = name;
  for (const Table1Handle& part : row.handles) model.handles.push_back(on_mesh(part, row.model.mesh));
  model.mesh = std::move(row.model.mesh);
  model.annotation = std::move(row.model.truth);
  model.paper = {thousands(row.vertices_k),
                 thousands(row.triangles_k),
                 row.groups,
                 row.samples,
                 row.dof,
                 row.prefactor_ms,
                 row.solve5_ms,
                 row.lift_ms};
  return model;
}

}  // namespace orbifit::benchmarks
