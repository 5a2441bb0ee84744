#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "orbifit/model/mesh.h"
#include "orbifit/model/motion.h"
#include "orbifit/model/point_group.h"

namespace orbifit {

/// Distances between g(S) and S over S and over all g, as fractions of the mesh's diagonal.
struct Residual {
  double rms = 0;
  double max = 0;
};

/// A part S of the surface and a group G with g(S) = S for all g in G.
struct Region {
  int id = 0;
  std::string name;
  PointGroup group;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< fixed by every element, mesh units
  Eigen::Vector3d axis = Eigen::Vector3d::Zero();    ///< unit; zero where the group has none
  std::vector<Motion> generators;
  std::vector<Motion> elements;  ///< all of a finite group, identity first; empty for a continuous one
  std::vector<int> faces;        ///< ascending, without repetition
  std::optional<int> parent;     ///< id of the smallest region that strictly contains this one
  Residual residual;
  /// Share of the quotient's area that it saves, given the regions and patterns listed before it, in [0, 1].
  std::optional<double> importance = {};
};

struct PatternInstance {
  Motion motion;           ///< from instance 0 to this one
  std::vector<int> faces;  ///< ascending
};

/// Congruent copies of one part that no finite group relates, or that repeat regularly.
struct Pattern {
  enum class Kind { translation_1d, translation_2d, translation_3d, rotation, screw, congruent };
  int id = 0;
  std::string name;
  Kind kind = Kind::congruent;
  std::vector<Motion> generators;  ///< one step of the lattice each: 0 to 3, by kind
  std::vector<PatternInstance> instances;
  Residual residual;
  std::optional<double> importance = {};  ///< as of a region
};

std::string to_string(Pattern::Kind kind);  ///< "translation-1d", ...
std::optional<Pattern::Kind> parse_pattern_kind(std::string_view text);
int generator_count(Pattern::Kind kind);

/// The symmetries of one mesh: annotation format, version 1.
struct SymmetryAnnotation {
  int mesh_vertices = 0;
  int mesh_faces = 0;
  double mesh_diagonal = 0;
  double tolerance = 0.005;                          ///< the detector's, as a fraction of the diagonal
  std::optional<Eigen::Vector3d> up = std::nullopt;  ///< unit: where up is as the shape stands, if somebody said so
  std::vector<Region> regions;
  std::vector<Pattern> patterns;
};

/// An annotation of `mesh` without regions.
SymmetryAnnotation empty_annotation(const Mesh& mesh, double tolerance);

/// A region of a finite or continuous group with generators and elements in closed form.
/// \param frame see GroupFrame
Region make_region(const PointGroup& group, const Eigen::Vector3d& centre, const GroupFrame& frame,
                   std::vector<int> faces, std::string name);

/// Sets each region's parent: the smallest (by face count) region that strictly contains it.
void set_parents(std::vector<Region>& regions);

/// The annotation without the regions of these ids; ids that it has not do not matter.
SymmetryAnnotation without_regions(SymmetryAnnotation annotation, const std::vector<int>& ids);

/// The annotation as it stands after the whole mesh was moved by `similarity`.
SymmetryAnnotation transformed(const SymmetryAnnotation& annotation, const Similarity& similarity);

}  // namespace orbifit
