#include "files/mesh_builder.h"

#include <cmath>
#include <limits>

#include "orbifit/model/errors.h"

#include "files/text.h"

namespace orbifit {

namespace {

constexpr std::int64_t kLargestCount = std::numeric_limits<int>::max() - 1;

[[noreturn]] void refuse_corner(const std::string& file, const std::string& where, std::int64_t corner,
                                std::int64_t vertices) {
  throw InputError(file, where,
                   "vertex index " + std::to_string(corner) + " (counted from 0) is out of range: the file has " +
                       std::to_string(vertices) + (vertices == 1 ? " vertex" : " vertices"));
}

}  // namespace

void check_coordinates(const std::string& file, long long line, long long vertex, const double (&point)[3]) {
  for (int k = 0; k < 3; ++k) {
    if (std::abs(point[k]) <= kLargestCoordinate) continue;
    std::string value;
    append_number(value, point[k]);
    throw InputError(file, place(line, "vertex", vertex),
                     std::string("coordinate ") + "xyz"[k] + " is " + value +
                         (std::isfinite(point[k]) ? ": beyond 1e50" : ": not a finite number"));
  }
}

void MeshBuilder::reserve(std::size_t vertices, std::size_t faces) {
  coordinates_.reserve(3 * vertices);
  corners_.reserve(3 * faces);
  polygon_of_face_.reserve(faces);
}

void MeshBuilder::add_vertex(const double (&point)[3], long long line) {
  check_coordinates(file_, line, vertices(), point);
  if (vertices() >= kLargestCount) throw InputError(file_, place(line, "vertex", vertices()), "too many vertices");
  coordinates_.insert(coordinates_.end(), point, point + 3);
}

void MeshBuilder::add_polygon(std::span<const std::int64_t> corners, long long line) {
  if (corners.size() < 3) {
    throw InputError(file_, place(line, "face", polygons_),
                     "a face with " + std::to_string(corners.size()) + (corners.size() == 1 ? " corner" : " corners") +
                         ": at least 3 are needed");
  }
  for (const std::int64_t corner : corners) {
    if (corner < 0 || corner >= kLargestCount) {
      refuse_corner(file_, place(line, "face", polygons_), corner, vertices());
    }
    if (corner >= vertices()) forward_.push_back({corner, polygons_, line});
  }
  if (static_cast<std::int64_t>(polygon_of_face_.size() + corners.size()) >= kLargestCount) {
    throw InputError(file_, place(line, "face", polygons_), "too many faces");
  }
  for (std::size_t k = 1; k + 1 < corners.size(); ++k) {
    for (const std::size_t corner : {std::size_t{0}, k, k + 1}) corners_.push_back(static_cast<int>(corners[corner]));
    polygon_of_face_.push_back(static_cast<int>(polygons_));
  }
  any_polygon_ = any_polygon_ || corners.size() > 3;
  ++polygons_;
}

Mesh MeshBuilder::finish(bool faces_needed) {
  if (vertices() == 0) throw InputError(file_, "", "has no vertices");
  for (const ForwardReference& reference : forward_) {
    if (reference.corner >= vertices()) {
      refuse_corner(file_, place(reference.line, "face", reference.polygon), reference.corner, vertices());
    }
  }
  if (faces_needed && polygons_ == 0) throw InputError(file_, "", "has no faces: a mesh is needed, not points alone");
  Mesh mesh;
  mesh.vertices = Eigen::Map<const Points>(coordinates_.data(), vertices(), 3);
  mesh.faces = Eigen::Map<const Triangles>(corners_.data(), static_cast<Eigen::Index>(corners_.size() / 3), 3);
  if (any_polygon_) mesh.polygon_of_face = std::move(polygon_of_face_);
  return mesh;
}

std::vector<PolygonRange> polygon_ranges(const Mesh& mesh, const Points* face_colours) {
  const int faces = static_cast<int>(mesh.faces.rows());
  const bool polygons = static_cast<int>(mesh.polygon_of_face.size()) == faces;
  const auto continues = [&](int first, int face) {
    const auto polygon_of = [&](int f) { return mesh.polygon_of_face[static_cast<std::size_t>(f)]; };
    return polygons && polygon_of(first) == polygon_of(face) && mesh.faces(first, 0) == mesh.faces(face, 0) &&
           mesh.faces(face - 1, 2) == mesh.faces(face, 1) &&
           (face_colours == nullptr || face_colours->row(first) == face_colours->row(face));
  };
  std::vector<PolygonRange> ranges;
  for (int face = 0; face < faces; ++face) {
    if (!ranges.empty() && continues(ranges.back().first_face, face)) {
      ++ranges.back().faces;
    } else {
      ranges.push_back({face, 1});
    }
  }
  return ranges;
}

void polygon_corners(const Mesh& mesh, const PolygonRange& range, std::vector<int>& corners) {
  corners.assign({mesh.faces(range.first_face, 0), mesh.faces(range.first_face, 1)});
  for (int face = range.first_face; face < range.first_face + range.faces; ++face) {
    corners.push_back(mesh.faces(face, 2));
  }
}

}  // namespace orbifit
