// Finds the symmetries of a mesh, then lifts what is highest by a tenth of the mesh's size and lets the rest follow.
#include <cstdio>
#include <exception>
#include <vector>

#include "orbifit/detection/detect.h"
#include "orbifit/model/mesh_io.h"
#include "orbifit/subspace/deformer.h"
#include "orbifit/subspace/displacement_field.h"

int main(int argc, char** argv) try {
  if (argc != 3) {
    std::fprintf(stderr, "usage: edit MESH OUTPUT\n");
    return 2;
  }
  orbifit::RunContext context;  // seed, threads, time limit, whom to tell how far it is
  orbifit::Mesh mesh = orbifit::read_mesh(argv[1]);
  const orbifit::SymmetryAnnotation found = orbifit::detect(mesh, {}, context);
  const orbifit::Subspace subspace = orbifit::build_subspace(mesh, found, {}, context);

  // The vertices at the top are moved, those at the bottom held.
  const double size = orbifit::diagonal(mesh.vertices);
  const double top = mesh.vertices.col(2).maxCoeff();
  const double bottom = mesh.vertices.col(2).minCoeff();
  std::vector<orbifit::Handle> handles(2);
  for (int v = 0; v < mesh.vertices.rows(); ++v) {
    if (mesh.vertices(v, 2) > top - 0.02 * size) handles[0].vertices.push_back(v);
    if (mesh.vertices(v, 2) < bottom + 0.02 * size) handles[1].vertices.push_back(v);
  }
  orbifit::Deformer deformer(subspace, mesh);
  deformer.set_handles(handles, 100);  // factorises once; then solve as often as the handles move
  orbifit::Motion up;
  up.translation.z() = 0.1 * size;
  const orbifit::Deformation edit = deformer.solve({up, orbifit::Motion{}}, 10);

  const double residual = orbifit::worst_field_residual(subspace, mesh, found, edit.state, context);
  mesh.vertices += orbifit::vertex_displacements(subspace, edit.state);
  orbifit::write_mesh(argv[2], mesh);
  std::printf("%zu regions, symmetric to %.0e of the diagonal\n", found.regions.size(), residual);
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
