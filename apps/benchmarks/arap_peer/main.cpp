// Times CGAL's Surface_mesh_deformation on one mesh. CGAL's package Surface_mesh_deformation is under the GPL, and so
// is this program where it is built: it stands alone, is not installed, and nothing of Orbifit links CGAL.
//
//   orbifit-benchmark-arap MESH ORDER.json
//
// ORDER.json: {"iterations": N, "repetitions": N, "handles": [{"vertices": [...], "motion": [3 by 4, row by row]}]}.
// Prints {"prefactor_ms": ..., "solve5_ms": ..., "note": "..."}; the note alone where CGAL does not take the mesh.

#include <algorithm>
#include <array>
#include <exception>
#include <iostream>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include <CGAL/Polygon_mesh_processing/connected_components.h>
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_deformation.h>
#include <CGAL/boost/graph/helpers.h>
#include <nlohmann/json.hpp>

#include "orbifit/model/mesh_io.h"

#include "files/file.h"
#include "stopwatch.h"

namespace {

using Json = nlohmann::json;
using Kernel = CGAL::Simple_cartesian<double>;
using Point = Kernel::Point_3;
using Surface = CGAL::Surface_mesh<Point>;
using Vertex = Surface::Vertex_index;
using Face = Surface::Face_index;
using Deformation = CGAL::Surface_mesh_deformation<Surface>;

struct Problem {
  Surface surface;
  std::vector<std::vector<Vertex>> handles;
  std::vector<std::vector<Point>> targets;
  std::string note;
};

void append(std::string& note, const std::string& text) {
  note += (note.empty() ? "" : "; ") + text;
}

// Vertices keep their numbers; copies that make the surface manifold come after them.
Surface manifold_surface(const orbifit::Mesh& mesh, std::string& note) {
  std::vector<Point> points;
  for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) {
    points.emplace_back(mesh.vertices(v, 0), mesh.vertices(v, 1), mesh.vertices(v, 2));
  }
  std::vector<std::vector<std::size_t>> faces;
  std::set<std::array<std::size_t, 3>> known;
  std::size_t doubled = 0;
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    std::vector<std::size_t> face;
    for (int c = 0; c < 3; ++c) face.push_back(static_cast<std::size_t>(mesh.faces(f, c)));
    if (face[0] == face[1] || face[1] == face[2] || face[2] == face[0]) continue;
    std::array<std::size_t, 3> corners{face[0], face[1], face[2]};
    std::ranges::sort(corners);
    if (known.insert(corners).second) {
      faces.push_back(std::move(face));
    } else {
      ++doubled;
    }
  }
  if (doubled > 0) append(note, std::to_string(doubled) + " doubled faces taken once");
  CGAL::Polygon_mesh_processing::orient_polygon_soup(points, faces);
  const std::size_t copies = points.size() - static_cast<std::size_t>(mesh.vertices.rows());
  if (copies > 0) append(note, std::to_string(copies) + " vertices doubled to make it manifold");
  Surface surface;
  for (const Point& point : points) surface.add_vertex(point);
  std::size_t refused = 0;
  for (const auto& face : faces) {
    const auto corner = [&](std::size_t c) { return Vertex(static_cast<Vertex::size_type>(face[c])); };
    if (surface.add_face(corner(0), corner(1), corner(2)) == Surface::null_face()) ++refused;
  }
  if (refused > 0) append(note, std::to_string(refused) + " faces left out");
  return surface;
}

// Parts that no handle touches leave the system singular: the first three vertices of each are held.
void hold_free_parts(Problem& problem) {
  Surface& surface = problem.surface;
  auto part_of_face = surface.add_property_map<Face, std::size_t>("f:part").first;
  const std::size_t parts = CGAL::Polygon_mesh_processing::connected_components(surface, part_of_face);
  std::vector<char> held(parts, 0);
  for (const auto& handle : problem.handles) {
    for (const Vertex vertex : handle) {
      for (const Face face : CGAL::faces_around_target(surface.halfedge(vertex), surface)) {
        if (face != Surface::null_face()) held[part_of_face[face]] = 1;
      }
    }
  }
  std::vector<Vertex> holds;
  for (const Face face : surface.faces()) {
    char& done = held[part_of_face[face]];
    if (done != 0) continue;
    done = 1;
    for (const Vertex vertex : CGAL::vertices_around_face(surface.halfedge(face), surface)) holds.push_back(vertex);
  }
  if (holds.empty()) return;
  append(problem.note, std::to_string(holds.size() / 3) + " of " + std::to_string(parts) +
                           " parts that no handle touches are held by three vertices");
  std::vector<Point> places;
  for (const Vertex vertex : holds) places.push_back(surface.point(vertex));
  problem.handles.push_back(std::move(holds));
  problem.targets.push_back(std::move(places));
}

Problem read_problem(const std::string& mesh_file, const Json& order) {
  Problem problem;
  problem.surface = manifold_surface(orbifit::read_mesh(mesh_file), problem.note);
  std::vector<char> taken(problem.surface.number_of_vertices(), 0);
  for (const Json& handle : order.at("handles")) {
    const auto motion = handle.at("motion").get<std::vector<double>>();
    auto& vertices = problem.handles.emplace_back();
    auto& targets = problem.targets.emplace_back();
    for (const std::uint32_t number : handle.at("vertices")) {
      const Vertex vertex(number);
      if (problem.surface.is_isolated(vertex) || taken[number] != 0) continue;
      taken[number] = 1;
      const Point p = problem.surface.point(vertex);
      const auto row = [&](std::size_t i) {
        return motion[4 * i] * p.x() + motion[4 * i + 1] * p.y() + motion[4 * i + 2] * p.z() + motion[4 * i + 3];
      };
      vertices.push_back(vertex);
      targets.emplace_back(row(0), row(1), row(2));
    }
  }
  hold_free_parts(problem);
  return problem;
}

std::unique_ptr<Deformation> prepared(Problem& problem) {
  auto deformation = std::make_unique<Deformation>(problem.surface);
  for (const Vertex vertex : problem.surface.vertices()) {
    if (!problem.surface.is_isolated(vertex)) deformation->insert_roi_vertex(vertex);
  }
  for (const auto& handle : problem.handles) deformation->insert_control_vertices(handle.begin(), handle.end());
  return deformation;
}

Json measure(Problem& problem, unsigned iterations, int repetitions) {
  std::unique_ptr<Deformation> deformation;
  std::vector<double> times;
  double spent = 0;
  while (static_cast<int>(times.size()) < repetitions && (times.empty() || spent < 10)) {
    deformation = prepared(problem);
    const double start = orbifit::benchmarks::seconds_now();
    if (!deformation->preprocess()) return {{"note", "CGAL could not factorise the mesh's system"}};
    times.push_back(orbifit::benchmarks::seconds_now() - start);
    spent += times.back();
  }
  std::ranges::sort(times);
  for (std::size_t i = 0; i < problem.handles.size(); ++i) {
    for (std::size_t k = 0; k < problem.handles[i].size(); ++k) {
      deformation->set_target_position(problem.handles[i][k], problem.targets[i][k]);
    }
  }
  orbifit::benchmarks::TimingOptions timing;
  timing.repetitions = repetitions;
  const double solve = orbifit::benchmarks::median_ms([&] { deformation->deform(iterations, 0); }, timing);
  return {{"prefactor_ms", 1e3 * times[times.size() / 2]}, {"solve5_ms", solve}, {"note", problem.note}};
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "usage: orbifit-benchmark-arap MESH ORDER.json\n";
    return 2;
  }
  try {
    const Json order = Json::parse(orbifit::read_file(argv[2]));
    Problem problem = read_problem(argv[1], order);
    std::cout << measure(problem, order.at("iterations"), order.at("repetitions")).dump() << "\n";
  } catch (const std::exception& error) {
    std::cout << Json{{"note", error.what()}}.dump() << "\n";
  }
  return 0;
}
