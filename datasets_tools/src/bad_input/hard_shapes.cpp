#include <cmath>
#include <functional>
#include <numbers>
#include <string>

#include "bad_input/bad_input_lists.h"
#include "files/mesh_formats.h"

namespace orbifit {

namespace {

using Corner = Eigen::RowVector3d;

Mesh of(const std::vector<Corner>& vertices, const std::vector<Eigen::RowVector3i>& faces) {
  Mesh mesh;
  mesh.vertices.resize(static_cast<Eigen::Index>(vertices.size()), 3);
  mesh.faces.resize(static_cast<Eigen::Index>(faces.size()), 3);
  for (std::size_t v = 0; v < vertices.size(); ++v) mesh.vertices.row(static_cast<Eigen::Index>(v)) = vertices[v];
  for (std::size_t f = 0; f < faces.size(); ++f) mesh.faces.row(static_cast<Eigen::Index>(f)) = faces[f];
  return mesh;
}

// Both meshes as one; the second's vertices are its own.
Mesh joined(const Mesh& a, const Mesh& b) {
  Mesh mesh;
  mesh.vertices.resize(a.vertices.rows() + b.vertices.rows(), 3);
  mesh.vertices << a.vertices, b.vertices;
  mesh.faces.resize(a.faces.rows() + b.faces.rows(), 3);
  mesh.faces << a.faces, (b.faces.array() + static_cast<int>(a.vertices.rows())).matrix();
  return mesh;
}

Mesh placed(Mesh mesh, double scale, const Corner& offset) {
  mesh.vertices = (scale * mesh.vertices).rowwise() + offset;
  return mesh;
}

// A band of quads, its ends joined after `half_turns` of half a turn each.
Mesh band(int half_turns, int cells = 24) {
  std::vector<Corner> vertices;
  std::vector<Eigen::RowVector3i> faces;
  for (int i = 0; i < cells; ++i) {
    const double turn = 2 * std::numbers::pi * i / cells;
    const double tilt = half_turns * turn / 2;
    for (const double side : {-0.3, 0.3}) {
      const double radius = 1 + side * std::cos(tilt);
      vertices.emplace_back(radius * std::cos(turn), radius * std::sin(turn), side * std::sin(tilt));
    }
    const bool crossed = i + 1 == cells && half_turns % 2 == 1;
    const int next = 2 * ((i + 1) % cells);
    const int a = next + (crossed ? 1 : 0);
    const int b = next + (crossed ? 0 : 1);
    faces.emplace_back(2 * i, a, 2 * i + 1);
    faces.emplace_back(2 * i + 1, a, b);
  }
  return of(vertices, faces);
}

Mesh tetrahedra(int count) {
  std::vector<Corner> vertices;
  std::vector<Eigen::RowVector3i> faces;
  for (int t = 0; t < count; ++t) {
    const Corner at(t % 50, t / 50 % 50, t / 2500);
    const int v = 4 * t;
    for (const Corner& corner : {Corner(0, 0, 0), Corner(0.5, 0, 0), Corner(0, 0.5, 0), Corner(0, 0, 0.5)}) {
      vertices.push_back(at + corner);
    }
    for (const Eigen::RowVector3i& face : {Eigen::RowVector3i(0, 2, 1), Eigen::RowVector3i(0, 1, 3),
                                           Eigen::RowVector3i(1, 2, 3), Eigen::RowVector3i(0, 3, 2)}) {
      faces.emplace_back(face.array() + v);
    }
  }
  return of(vertices, faces);
}

using AddMesh = std::function<void(const std::string& what, const Mesh& mesh)>;

void add_flat_shapes(const AddMesh& add) {
  add("one_triangle", of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}));
  add("one_symmetric_triangle", of({{-1, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}));
  add("one_point_thrice", of({{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}, {{0, 1, 2}}));
  add("one_vertex_thrice", of({{1, 1, 1}}, {{0, 0, 0}}));
  add("on_a_line", of({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}, {{0, 1, 2}, {1, 2, 3}}));
  add("needle", of({{0, 0, 0}, {1, 0, 0}, {0.5, 1e-14, 0}}, {{0, 1, 2}}));
  add("needles",
      of({{0, 0, 0}, {1, 0, 0}, {0.5, 1e-9, 0}, {0.5, -1e-9, 0}, {0.5, 0, 1}}, {{0, 1, 2}, {0, 3, 1}, {0, 1, 4}}));
}

// The cube with other faces: repeated, turned round, of too few corners.
void add_changed_cubes(const AddMesh& add) {
  const Mesh cube = cube_of_bad_input();
  add("cube", cube);
  Mesh changed = cube;
  changed.faces.row(0).setConstant(3);
  changed.faces.row(5) << 1, 1, 2;
  add("faces_on_points_and_edges", changed);
  add("isolated_points", joined(cube, of({{3, 3, 3}, {-3, 2, 1}, {0, 0, 9}}, {{0, 0, 0}})));
  changed = joined(cube, cube);
  add("twice", changed);
  changed.faces.bottomRows(12).col(1).swap(changed.faces.bottomRows(12).col(2));
  add("two_sided", changed);
  changed = cube;
  changed.faces.conservativeResize(24, 3);
  changed.faces.bottomRows(12) = cube.faces;
  add("every_face_twice", changed);
  changed = cube;
  for (int f = 0; f < 12; f += 2) std::swap(changed.faces(f, 1), changed.faces(f, 2));
  add("half_flipped", changed);
  changed = cube;
  changed.faces.col(1).swap(changed.faces.col(2));
  add("inside_out", changed);
}

void add_non_manifold(const AddMesh& add) {
  add("edge_of_three",
      of({{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {-1, 0.5, 0}, {-1, -0.5, 0}}, {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}}));
  std::vector<Corner> vertices{{0, 0, 0}, {0, 0, 1}};
  std::vector<Eigen::RowVector3i> faces;
  for (int k = 0; k < 500; ++k) {
    vertices.emplace_back(std::cos(k * 0.0125664), std::sin(k * 0.0125664), 0);
    faces.emplace_back(0, 1, k + 2);
  }
  add("edge_of_500", of(vertices, faces));
  const Mesh cube = cube_of_bad_input();
  add("two_cubes_at_one_vertex", [&] {
    Mesh mesh = joined(cube, placed(cube, 1, {1, 1, 1}));
    for (int f = 12; f < 24; ++f) {
      for (int k = 0; k < 3; ++k) mesh.faces(f, k) = mesh.faces(f, k) == 8 ? 7 : mesh.faces(f, k);
    }
    return mesh;
  }());
  add("t_junctions", of({{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {1, 0, 0}, {0, -1, 0}, {2, -1, 0}},
                        {{0, 1, 2}, {4, 3, 0}, {4, 5, 3}, {5, 1, 3}}));
}

// What lies in the same place: surfaces, corners of triangles, all vertices.
void add_coincident(const AddMesh& add) {
  const Mesh cube = cube_of_bad_input();
  add("crossing", joined(cube, placed(cube, 1, {0.3, 0.2, 0.1})));
  Mesh soup;
  soup.vertices.resize(36, 3);
  soup.faces.resize(12, 3);
  for (int k = 0; k < 36; ++k) {
    soup.vertices.row(k) = cube.vertices.row(cube.faces(k / 3, k % 3));
    soup.faces(k / 3, k % 3) = k;
  }
  add("soup", soup);
  add("nearly_coincident", joined(cube, placed(cube, 1 + 1e-15, {0, 0, 0})));
  add("all_vertices_equal", placed(cube, 0, {1, 2, 3}));
  add("flat", [&] {
    Mesh mesh = cube;
    mesh.vertices.col(2).setZero();
    return mesh;
  }());
}

void add_sizes(const AddMesh& add) {
  const Mesh cube = cube_of_bad_input();
  add("band", band(0));
  add("moebius", band(1));
  add("full_turn", band(2));
  add("moebius_thrice", band(3));
  add("scale_1e-9", placed(cube, 1e-9, {0, 0, 0}));
  add("scale_1e9", placed(cube, 1e9, {0, 0, 0}));
  add("scale_1e49", placed(cube, 1e49, {0, 0, 0}));
  add("scale_1e99", placed(cube, 1e99, {0, 0, 0}));
  add("scale_1e-99", placed(cube, 1e-99, {0, 0, 0}));
  add("scale_1e-300", placed(cube, 1e-300, {0, 0, 0}));
  add("scale_denormal", placed(cube, 4.9e-322, {0, 0, 0}));
  add("far_1e6", placed(cube, 1, {1e6, 0, 0}));
  add("far_1e15", placed(cube, 1, {1e15, 0, 0}));
  add("far_1e17", placed(cube, 1, {1e17, 0, 0}));
  add("anisotropic", [&] {
    Mesh mesh = cube;
    mesh.vertices.col(0) *= 1e8;
    mesh.vertices.col(1) *= 1e-8;
    return mesh;
  }());
  add("tiny_beside_huge", joined(cube, placed(cube, 1e-12, {0.75, 0, 0})));
  add("outlier_1e12", joined(cube, placed(cube, 1, {1e12, 0, 0})));
  add("100_components", tetrahedra(100));
  add("3000_components", tetrahedra(3000));
}

}  // namespace

void add_hard_shapes(BadInputs& files) {
  const auto add = [&](const std::string& what, const Mesh& mesh) {
    files.push_back({"shape_" + what + ".obj", BadInputKind::mesh, obj_text(mesh)});
  };
  add_flat_shapes(add);
  add_changed_cubes(add);
  add_non_manifold(add);
  add_coincident(add);
  add_sizes(add);
  files.push_back({"large_1e5_components.ply", BadInputKind::mesh, ply_bytes(tetrahedra(100'000), std::nullopt)});
}

}  // namespace orbifit
