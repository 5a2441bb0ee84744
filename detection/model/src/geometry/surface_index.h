#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "orbifit/model/mesh.h"

namespace orbifit {

/// Nearest points and rays on a triangle mesh. Distances are exact in double precision (the tree, Embree's, only
/// culls); among faces at the same distance the lowest number wins. Const calls may run on several threads.
class SurfaceIndex {
 public:
  /// \param faces the faces to index; empty means all. The mesh is copied as far as needed.
  explicit SurfaceIndex(const Mesh& mesh, const std::vector<int>& faces = {});

  /// Of some of the faces. All that this index holds is shared, so that it costs next to nothing, O(#faces + F / 64);
  /// but where many others lie nearer than they, queries take longer, and so a few among very many get a tree of their
  /// own, O(#faces log #faces + F). Not for rays, which may meet all faces of this index.
  /// \param faces  numbers in the mesh; those that this index does not find are left out
  SurfaceIndex part(const std::vector<int>& faces) const;

  ~SurfaceIndex();
  SurfaceIndex(SurfaceIndex&&) noexcept;
  SurfaceIndex& operator=(SurfaceIndex&&) noexcept;

  struct Nearest {
    double distance = std::numeric_limits<double>::infinity();
    int face = -1;                                          ///< number in the mesh; -1: none within reach
    int place = -1;                                         ///< of the face in the index
    Eigen::Vector3d point = Eigen::Vector3d::Zero();        ///< on the face
    Eigen::Vector3d barycentric = Eigen::Vector3d::Zero();  ///< of that point, sums to 1
  };

  /// O(log F). Nearest point within `max_distance`.
  /// \param likely  the place of a face that may well be the nearest, of an answer of this index before: the answer is
  ///                the same but comes sooner; -1: none
  Nearest nearest(const Eigen::Vector3d& point, double max_distance = std::numeric_limits<double>::infinity(),
                  int likely = -1) const;

  /// Only faces whose unit normal n has n . normal >= min_cosine (|n . normal| if `unsigned_normal`).
  /// \param likely  as above
  Nearest nearest_facing(const Eigen::Vector3d& point, const Eigen::Vector3d& normal, double min_cosine,
                         double max_distance = std::numeric_limits<double>::infinity(), bool unsigned_normal = false,
                         int likely = -1) const;

  /// All faces within `distance`, ascending numbers. O(log F + what is found)
  std::vector<Nearest> all_within(const Eigen::Vector3d& point, double distance) const;

  /// Whether any face is within `max_distance`: nearest(...).face >= 0, for several times less.
  bool within(const Eigen::Vector3d& point, double max_distance) const;

  /// Likewise of the faces with |n . normal| >= min_cosine.
  bool within_facing(const Eigen::Vector3d& point, const Eigen::Vector3d& normal, double min_cosine,
                     double max_distance) const;

  struct Hit {
    double distance = 0;  ///< along the unit direction
    int face = -1;
    Eigen::Vector3d point = Eigen::Vector3d::Zero();
    Eigen::Vector3d barycentric = Eigen::Vector3d::Zero();
  };

  /// First face along a ray; single precision relative to the mesh's diagonal.
  std::optional<Hit> cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                          double min_distance = 0) const;

  /// Whether anything lies within `max_distance` along the ray; cheaper than cast().
  bool occluded(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double min_distance,
                double max_distance) const;

 private:
  struct Implementation;
  SurfaceIndex(std::shared_ptr<Implementation> implementation, std::shared_ptr<const std::vector<bool>> only);

  std::shared_ptr<Implementation> implementation_;  // of those that move: of one index alone
  std::shared_ptr<const std::vector<bool>> only_;   // by place: whether the face may be found; null: all may
};

/// Barycentric coordinates of the point of triangle (a, b, c) nearest to p (Ericson 2005, section 5.1.5); a degenerate
/// triangle is treated as its edges.
Eigen::Vector3d nearest_on_triangle(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                    const Eigen::Vector3d& c);

}  // namespace orbifit
