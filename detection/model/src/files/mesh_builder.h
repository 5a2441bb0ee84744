#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "orbifit/model/mesh.h"

namespace orbifit {

/// The sixth power of a coordinate beyond this would overflow; squares of volumes are such.
inline constexpr double kLargestCoordinate = 1e50;

/// What formats that repeat meshes, or announce them compressed, may ask for: a file of 2 KB could name any number.
inline constexpr std::int64_t kMostVertices = 200'000'000;

/// \throw InputError when a coordinate is not finite or beyond kLargestCoordinate
void check_coordinates(const std::string& file, long long line, long long vertex, const double (&point)[3]);

/// Collects a mesh while its file is read; every check that the formats share is here. `line` is the line in the file,
/// or 0 for a binary one, whose messages then count vertices and faces.
class MeshBuilder {
 public:
  explicit MeshBuilder(std::string file) : file_(std::move(file)) {}

  void reserve(std::size_t vertices, std::size_t faces);
  void add_vertex(const double (&point)[3], long long line);

  /// Corners count from 0. They may name vertices that come later in the file; finish() looks.
  void add_polygon(std::span<const std::int64_t> corners, long long line);

  std::int64_t vertices() const { return static_cast<std::int64_t>(coordinates_.size() / 3); }
  const std::string& file() const { return file_; }

  /// \throw InputError without vertices, with corners out of range, or (if they are needed) without faces
  Mesh finish(bool faces_needed = true);

 private:
  struct ForwardReference {
    std::int64_t corner, polygon;
    long long line;
  };

  std::string file_;
  std::vector<double> coordinates_;
  std::vector<int> corners_;
  std::vector<int> polygon_of_face_;
  std::vector<ForwardReference> forward_;
  std::int64_t polygons_ = 0;
  bool any_polygon_ = false;
};

/// Triangles that a file writer joins to one polygon again.
struct PolygonRange {
  int first_face = 0;
  int faces = 1;
};

/// The polygons from which the triangles were cut, as far as these still are a fan and (where given) of one colour.
std::vector<PolygonRange> polygon_ranges(const Mesh& mesh, const Points* face_colours = nullptr);

/// Corners of such a polygon, in order.
void polygon_corners(const Mesh& mesh, const PolygonRange& range, std::vector<int>& corners);

}  // namespace orbifit
