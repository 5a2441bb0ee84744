#pragma once

#include <array>
#include <limits>
#include <vector>

#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"

#include "geometry/surface_index.h"

namespace orbifit {

/// Nearest points and rays on a triangle mesh whose vertices move, or that is asked too little to be worth a
/// SurfaceIndex, which answers the same several times sooner but takes ten times as long to be made. A tree of boxes
/// that halves the faces by where they are as it is made, and then never changes: after a move only the boxes do, in a
/// hundredth of the time that a tree of its own would take. Distances are exact in double precision; among faces at the
/// same distance the lowest number wins. Const calls may run on several threads.
class MovingSurface {
 public:
  using Nearest = SurfaceIndex::Nearest;

  /// O(F log F). \param mesh  kept by reference \param faces  those that there are; empty means all
  explicit MovingSurface(const Mesh& mesh, const std::vector<int>& faces = {});

  /// The same faces of another mesh, which is kept by reference from then on, or of the same with its vertices
  /// elsewhere. O(F)
  void move(const Mesh& mesh, const RunContext& context);

  /// Nearest point within `max_distance`. O(log F) where the faces still lie as they did when the tree was made.
  /// \param likely  the place of a face that may well be the nearest, of an answer before; -1: none
  Nearest nearest(const Eigen::Vector3d& point, double max_distance = std::numeric_limits<double>::infinity(),
                  int likely = -1) const;

  /// Whether any face has a point within `distance`: ends with the first that is met. \param likely  as of nearest()
  bool within(const Eigen::Vector3d& point, double distance, int likely = -1) const;

  /// Only faces whose unit normal n has n . normal >= min_cosine (|n . normal| if `unsigned_normal`).
  Nearest nearest_facing(const Eigen::Vector3d& point, const Eigen::Vector3d& normal, double min_cosine,
                         double max_distance = std::numeric_limits<double>::infinity(), bool unsigned_normal = false,
                         int likely = -1) const;

  /// Whether anything lies between these distances along the ray. \param direction  any length
  bool occluded(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double min_distance,
                double max_distance) const;

  /// The first face along the ray from this distance on; -1: none.
  int first_hit(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double min_distance) const;

  Eigen::Vector3d normal(int face) const { return face_normal(*mesh_, face); }

 private:
  // Four boxes beside one another, in single precision: lengths from centre_, times scale_.
  struct Group {
    std::array<std::array<float, 4>, 3> low, high;  // by axis
  };
  struct Query;
  struct Ray;

  void frame();  // of the boxes
  // Groups of the lowest level. \param vertices  in the boxes' frame, four numbers each
  void fit_faces(const float* vertices, std::size_t begin, std::size_t end);
  void fit_nodes(std::size_t level, std::size_t begin, std::size_t end);
  void search(std::size_t level, std::size_t group, Query& query) const;
  void trace(std::size_t level, std::size_t group, Ray& ray) const;
  Ray ray_of(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double least, double most) const;
  void meet(std::size_t place, Ray& ray) const;
  void measure(std::size_t place, Query& query) const;
  Nearest answer(Query& query, int likely) const;
  Eigen::Vector3d corner(std::size_t place, std::size_t k) const { return mesh_->vertices.row(corners_[place][k]); }

  const Mesh* mesh_;
  std::vector<int> face_numbers_;            // by place: neighbours in space, at first, have neighbouring places
  std::vector<std::array<int, 3>> corners_;  // of those faces: vertices
  std::vector<int> vertices_;                // of all those faces, ascending
  std::vector<std::vector<Group>> levels_;   // group g of the next level has the boxes of groups 4 g ... 4 g + 3
  Eigen::Vector3d centre_ = Eigen::Vector3d::Zero();
  double scale_ = 1;
};

}  // namespace orbifit
