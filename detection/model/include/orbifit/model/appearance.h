#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "orbifit/model/mesh.h"
#include "orbifit/model/motion.h"

namespace orbifit {

/// A surface's look, as OBJ's material libraries and glTF both know it.
struct Material {
  std::string name;
  std::array<double, 4> base_colour{1, 1, 1, 1};  ///< red, green, blue, opacity, as the file has them
  std::string texture;  ///< of the base colour: a file's name, from the mesh's folder; "" for none
  std::string image;    ///< that file's bytes, PNG or JPEG; empty where it is missing
};

/// What a file calls a part of the mesh.
struct Part {
  std::string object;  ///< OBJ's `o`, the name of a glTF node, that of a 3MF object; "" for none
  std::string group;   ///< OBJ's `g`, the name of a glTF mesh; "" for none
};

/// What a mesh file tells about its triangles besides where they are. Corner k of face f is row 3 f + k; what a corner
/// does not have is NaN, and what no corner has has 0 rows.
struct Appearance {
  using Uvs = Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::RowMajor>;
  using Colours = Eigen::Matrix<double, Eigen::Dynamic, 4, Eigen::RowMajor>;

  Uvs uvs;                            ///< 3 #F by 2; (0, 0) is the texture's lower left corner
  Points normals;                     ///< 3 #F by 3, unit
  Colours colours;                    ///< 3 #F by 4, in [0, 1]
  std::vector<int> material_of_face;  ///< #F, -1 for none; empty where no face has one
  std::vector<Material> materials;
  std::vector<int> part_of_face;      ///< #F, -1 for none; empty where no face is in a part that has a name
  std::vector<Part> parts;            ///< names may be repeated
  std::vector<std::string> warnings;  ///< what the file names that is missing, a line each

  bool empty() const;
};

/// Reads what OBJ with its material libraries, PLY (colours, normals, texture coordinates of vertices), glTF (first
/// set of UVs, normals, colours, base colours and their textures, names) and 3MF (names) tell about `mesh`, which
/// read_mesh() read from `file`. Of other formats nothing.
/// A material library or a texture that is missing, or is outside of the file's folder, is warned of; a texture keeps
/// its name.
/// \throw InputError as read_mesh() does; where a corner names a UV or normal that there is not, or the counts of
///        attributes and vertices disagree
Appearance read_appearance(const std::filesystem::path& file, const Mesh& mesh);

/// As write_mesh(), with the look as far as the format has it: OBJ (beside it NAME.mtl, and textures that are not there
/// yet), GLB (textures within it; a node for each part, a primitive for each material, in the order of the faces), PLY
/// (colours and UVs of vertices, where all corners at a vertex agree, as they do in a mesh that read_mesh() read from a
/// PLY or GLB; else the colours' means alone).
/// \return what could not be written, a line each
std::vector<std::string> write_mesh(const std::filesystem::path& file, const Mesh& mesh, const Appearance& look);

/// The look of a mesh whose faces were cut from those of another one and moved.
/// \param source_face     #F of `mesh`: the face of `source` in whose plane it was
/// \param motion_of_face  #F: which of the motions took it from there
Appearance transferred(const Appearance& look, const Mesh& source, const Mesh& mesh,
                       const std::vector<int>& source_face, const std::vector<Motion>& motions,
                       const std::vector<int>& motion_of_face);

}  // namespace orbifit
