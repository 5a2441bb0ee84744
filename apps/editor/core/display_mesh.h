#pragma once

#include <cstdint>
#include <vector>

#include "orbifit/model/mesh.h"

namespace orbifit::editor {

/// A mesh as a graphics card draws it: in single precision, about the mesh's centre and divided by its diagonal, with
/// vertices split where faces meet at a crease, so that curved parts look smooth and edges crisp. Made once; moved in
/// one pass over the vertices and one over the faces.
class DisplayMesh {
 public:
  DisplayMesh() = default;
  explicit DisplayMesh(const Mesh& mesh);

  /// The same mesh with its vertices elsewhere, #V by 3, mesh units.
  void move(const Points& vertices);

  std::size_t vertices() const { return sources_.size(); }
  const std::vector<std::uint32_t>& triangles() const { return triangles_; }  ///< 3 #F, numbers of shown vertices
  const std::vector<std::uint32_t>& sources() const { return sources_; }      ///< of shown vertices: the mesh's
  const std::vector<float>& positions() const { return positions_; }          ///< 3 a shown vertex
  const std::vector<float>& normals() const { return normals_; }              ///< likewise, area-weighted, any length

  const Eigen::Vector3d& centre() const { return centre_; }
  double scale() const { return scale_; }  ///< the diagonal

 private:
  Eigen::Vector3d centre_ = Eigen::Vector3d::Zero();
  double scale_ = 1;
  std::vector<std::uint32_t> triangles_, sources_;
  std::vector<float> positions_, normals_;
};

}  // namespace orbifit::editor
