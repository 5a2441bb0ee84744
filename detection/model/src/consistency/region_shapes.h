#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <unordered_map>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/motion.h"
#include "orbifit/model/run_context.h"

#include "base/digest.h"
#include "consistency/group_place.h"
#include "domains/known_domains.h"
#include "domains/piece_moments.h"
#include "domains/vertex_images.h"
#include "geometry/surface_index.h"

namespace orbifit {

/// What is known of a mesh whatever its shapes are (RegionShapes), and what was answered about shapes of the same
/// faces, with the work that it took then.
struct ShapeSurface {
  /// \param of  kept by reference
  /// \param reach  how far an image may lie from the surface, mesh units
  /// \param running  its threads are used; kept by reference
  ShapeSurface(const Mesh& of, double reach, const RunContext& running);

  template <class Answer>
  using Answers = std::unordered_map<Digest, std::pair<Answer, std::size_t>, Digest::Hash>;

  const Mesh& mesh;
  const RunContext& context;
  double near;
  double diagonal;
  Eigen::Vector3d origin;            ///< of moments
  std::vector<int> point_of_vertex;  ///< of soups, one for the vertices at one position whose faces share an edge
  Eigen::VectorXd areas;
  Points centroids;                           ///< of faces
  std::shared_ptr<const SurfaceIndex> index;  ///< for who goes on with the mesh as well
  mutable VertexImages vertex_images;
  mutable KnownDomains domains;
  mutable Answers<double> arrived, distances;
  mutable Answers<PieceMoments> common_moments;
  mutable Answers<std::vector<int>> image_faces;
  mutable std::size_t faces_remembered = 0;  ///< in these

  /// By face and corner: whether the edge opposite to it has no other face. Empty of a closed surface. Found when it is
  /// first asked for, O(F log F).
  const std::vector<std::array<bool, 3>>& open_edges() const;

 private:
  mutable std::optional<std::vector<std::array<bool, 3>>> open_edges_;
};

/// Sets of faces of one mesh, called shapes, and whether motions take one to another. What two shapes have in common by
/// less than a fiftieth of the smaller one's area is a sliver: borders drawn face by face overlap by that much by
/// chance. What was asked once of shapes of the same faces is remembered; it counts as work as it did then.
class RegionShapes {
 public:
  /// \param surface  kept by reference
  explicit RegionShapes(const ShapeSurface& surface) : surface_(surface) {}

  /// \return the number of the new shape
  int add(const std::vector<int>& faces);
  /// Takes away the shapes from number `count` on.
  void keep(int count) {
    shapes_.resize(static_cast<std::size_t>(count));
    std::erase_if(ends_at_,
                  [&](const auto& known) { return std::max(known.first.first, known.first.second) >= count; });
  }
  int count() const { return static_cast<int>(shapes_.size()); }

  static constexpr double kSliver = 0.02;
  /// What is at most this share of another distance is far nearer: errors of detection differ by less.
  static constexpr double kFarNearer = 0.1;

  /// Faces and samples looked at so far: what time is measured by where the result must not depend on the machine.
  std::size_t work() const { return work_; }

  const std::vector<int>& faces(int shape) const { return at(shape).faces; }
  double area(int shape) const { return at(shape).area; }
  double area_of(const std::vector<int>& faces) const {
    double sum = 0;
    for (const int face : faces) sum += surface_.areas[face];
    return sum;
  }
  double area_of(int face) const { return surface_.areas[face]; }
  bool holds(int shape, int face) const { return at(shape).holds[static_cast<std::size_t>(face)] != 0; }
  const Extent& extent(int shape) const { return at(shape).extent; }
  double near() const { return surface_.near; }

  double area_of_all() const { return surface_.areas.sum(); }

  /// Area of the faces that both hold; kept, since it is asked for often.
  double common_area(int a, int b) const;

  /// The faces that both hold, ascending.
  std::vector<int> common_faces(int a, int b) const;

  /// Whether they share more than a sliver.
  bool meet(int a, int b) const;
  /// Whether they meet, or share a vertex: of soups, vertices at one position whose faces have an edge in common there.
  bool touch(int a, int b) const;
  /// The faces of `a` that `b` holds or has a vertex of.
  std::vector<int> faces_at(int a, int b) const;
  /// Whether `outer` holds all of `inner`, but perhaps a sliver that touches it or lies near it: a small part is none.
  bool within(int inner, int outer) const;
  bool same(int a, int b) const { return within(a, b) && within(b, a); }

  /// How well `motion` takes the part of `from` within `domain` to the part of `to` within `arrival`: the share of the
  /// samples that arrive, there or back, whichever are fewer. Where less than a half does, it is not counted on; and
  /// none where most that arrive lie far nearer to what else there is: that is the image then.
  double arrived(int from, int domain, const Motion& motion, int to, int arrival) const;

  /// separation() of these two parts: of several to which a motion leads, the least is the image.
  double distance(int from, int domain, const Motion& motion, int to, int arrival) const;

  /// The faces of `arrival` that `motion` brings from faces of `from`: each whose centroid, taken back, has a face of
  /// `from` as its nearest of `domain`. Where others lie there alike to rounding, as plates that cross in one plane,
  /// each whose corners have it besides.
  std::vector<int> image_faces(int from, int domain, const Motion& motion, int arrival) const;

  /// The faces of a shape that the group takes to none of `taken` (ascending): what is left keeps the group where the
  /// shape does.
  std::vector<int> without_orbit(int shape, const std::vector<int>& taken, const GroupPlace& place);

  /// Share of the shape's samples that all the motions keep within `near` of it.
  double kept(int shape, const std::vector<Motion>& motions, double near) const;

  /// Whether `motion` takes more than a sliver of the shape past an end of the surface: of all the surface, an edge
  /// without a face beyond it is nearest then.
  bool past_the_end(int shape, const Motion& motion) const;

  /// Distances of the samples' images from the shape, root mean square and largest, fractions of the diagonal.
  Residual residual(int shape, const std::vector<Motion>& motions) const;

 private:
  struct Shape {
    std::vector<int> faces;  // ascending
    Digest digest;           // of the faces
    std::vector<char> holds;
    std::vector<int> points;  // numbers of the vertices' positions, ascending
    double area = 0;
    Extent extent;
    Eigen::AlignedBox3d box;
    PieceMoments moments;
    Points samples;
    mutable std::unique_ptr<SurfaceIndex> index;
    mutable std::vector<double> common;         // with the shapes before it, -1: not known
    mutable std::vector<signed char> touching;  // whether those before it share a point with it, likewise
  };
  bool belongs_elsewhere(const Eigen::Vector3d& image, int target, int arrival) const;
  const Shape& at(int shape) const { return shapes_[static_cast<std::size_t>(shape)]; }
  const SurfaceIndex& index(int shape) const;
  PieceMoments common_moments(int a, int b) const;
  bool share_a_point(int a, int b) const;
  bool ends_at(int inner, int outer) const;
  Digest question(int from, int domain, const Motion& motion, int to, int arrival) const;
  double share_arrived(int from, int domain, const Motion& motion, int to, int arrival) const;
  std::vector<int> faces_brought(int from, int domain, const Motion& motion, int arrival) const;

  template <class Answer, class Ask>
  const Answer& remembered(ShapeSurface::Answers<Answer>& answers, const Digest& question, const Ask& ask) const {
    if (const auto known = answers.find(question); known != answers.end()) {
      work_ += known->second.second;
      return known->second.first;
    }
    const std::size_t before = work_;
    Answer answer = ask();
    return answers.emplace(question, std::pair(std::move(answer), work_ - before)).first->second.first;
  }
  Points sampled(const std::vector<int>& faces, double area) const;
  Points common_samples(int a, int b) const;

  const ShapeSurface& surface_;
  std::vector<Shape> shapes_;
  mutable std::map<std::pair<int, int>, bool> ends_at_;
  mutable std::size_t work_ = 0;
};

}  // namespace orbifit
