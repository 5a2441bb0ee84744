#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/motion.h"

#include "domains/piece_moments.h"
#include "domains/point_sets.h"
#include "geometry/point_index.h"

namespace orbifit {

/// The continuous part of a region's group: all rotations about an axis, or about a point (docs/method.md 2.4).
struct Continuum {
  bool spherical = false;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();       ///< unit; spherical: where a point's canonical place lies
  Eigen::Vector3d reference = Eigen::Vector3d::UnitX();  ///< unit, across the axis: the half-plane of canonical places
  int fold = 1;  ///< order of the finite rotations about the same axis: copies of a ring come in multiples of it

  /// The rotation that takes the canonical place of `point` to `point`; the identity on the axis.
  Motion turn_to(const Eigen::Vector3d& point) const;

  /// Distance from the axis, or from the centre.
  double distance(const Eigen::Vector3d& point) const;

  /// Nearest point of the axis, or the centre.
  Eigen::Vector3d foot(const Eigen::Vector3d& point) const;
};

/// The regions and pattern instances of an annotated mesh, called places: sets of faces on which motions act. Places
/// 0 ... count() - 1 are the regions, in the annotation's order, each mapped onto itself; the instances of the patterns
/// follow, mapped onto one another. Sets of places have numbers: set_places() lists their members. What motions do to
/// sets is decided once for all points, by algebra (docs/method.md 3).
class DomainMap {
 public:
  /// \param motions  of each pattern, from its first instance to each; as many as it has instances
  DomainMap(const Mesh& mesh, const SymmetryAnnotation& annotation, const std::vector<std::vector<Motion>>& motions);
  DomainMap(const DomainMap&) = delete;
  DomainMap& operator=(const DomainMap&) = delete;

  int count() const { return regions_; }                           ///< regions
  int places() const { return static_cast<int>(places_.size()); }  ///< regions, then pattern instances

  /// The motions that act at a place, the identity among them: all elements of a finite group; of a continuous group
  /// one of each component (the identity; a mirror, ...), the rotations being continuum(); from a pattern's instance to
  /// every instance.
  const std::vector<Motion>& elements(int place) const { return at(place).motions; }

  /// The place where element number `element` of `place` arrives.
  int arrival(int place, int element) const;

  /// The number, at the place of arrival, of the motion that takes back what that element takes there. Not for use by
  /// several threads.
  int inverse_element(int place, int element) const;

  /// The place of a pattern's first instance.
  int first_place_of_pattern(int pattern) const { return first_place_[static_cast<std::size_t>(pattern)]; }
  /// The first instance of the pattern that a place belongs to; -1 for a region.
  int first_of_same_pattern(int place) const { return at(place).pattern_first; }

  const Continuum* continuum(int place) const { return at(place).continuum ? &*at(place).continuum : nullptr; }
  const Eigen::Vector3d& centre(int place) const { return at(place).centre; }
  const std::string& name(int place) const { return at(place).name; }

  int set_of_face(int face) const { return set_of_face_[static_cast<std::size_t>(face)]; }
  const std::vector<int>& sets_of_faces() const { return set_of_face_; }
  const std::vector<int>& set_places(int set) const { return *sets_[static_cast<std::size_t>(set)]; }
  const std::vector<int>& regions_of_face(int face) const { return set_places(set_of_face(face)); }

  /// Of the mesh's vertices.
  const PointSets& points() const { return points_; }

  /// How many sets have numbers so far, and the number of a set, given anew where it has none. Not for use by several
  /// threads.
  int set_count() const { return static_cast<int>(sets_.size()); }
  int set_of(const std::vector<int>& places) const { return intern(places); }

  /// The set with a place, or all places of another set, added. Not for use by several threads.
  int with(int set, int place) const;
  int joined(int a, int b) const;
  bool holds(int set, int place) const;
  bool contains(int set, int subset) const;
  /// Whether one of both sets contains the other.
  bool comparable(int a, int b) const { return contains(a, b) || contains(b, a); }

  /// The places that hold the image, by element number `element` of `place`, of a point that `set` holds: those that
  /// the motion takes places of the set to, the arrival, and what holds all of that. By algebra alone: the surface at
  /// the image is not asked, since it is off by the tolerance and would answer now so, now so (docs/method.md 3). Not
  /// for use by several threads.
  int carried_set(int set, int place, int element) const;

  /// The places to which that motion takes `other`, which has surface in common with `place`; none where the annotation
  /// has no such place.
  std::vector<int> images_of(int other, int place, int element) const;

  /// By place, the one that is its image by element number `element` of `place`, to rounding: for places that lie in
  /// `place`, where their moments leave no doubt; -1 for others.
  std::vector<int> exact_images(int place, int element) const;

  /// Places that share faces or vertices with a place, itself among them, ascending.
  const std::vector<int>& meeting(int place) const { return meeting_[static_cast<std::size_t>(place)]; }

  /// Whether `outer` holds all faces of `inner`.
  bool around(int outer, int inner) const;

  /// Whether all that two regions have in common lies in regions whose groups hold the groups of both. What the one's
  /// motions ask of the other follows from those, so the other stays where it is under them: a rotor's fivefold axis
  /// and the mirror of the rest of a fan, which meet on the round hub.
  bool follows(int a, int b) const { return following_.contains(std::minmax(a, b)); }

  /// Pairs of regions of a set, the lesser first, whose groups do not close: going by motions of the one and of the
  /// other in turn takes a point that lies in both to ever more places, rotations of continuous groups not counted.
  /// Groups close where the motions of one region take the other to regions with its group, where all motions of both
  /// make a finite group, and where a third region of the set has a group that holds both. Two mirrors whose angle is
  /// no fraction of a turn do not, except on a round part that both go through. Not for use by several threads.
  std::vector<std::pair<int, int>> unclosed(int set) const;

  std::size_t face_count(int place) const { return at(place).faces.size(); }

  /// Whether the place holds every face.
  bool whole(int place) const { return at(place).whole; }

 protected:
  struct Place {
    std::string name;
    std::vector<Motion> motions;
    std::optional<Continuum> continuum;
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    std::vector<int> faces;
    Eigen::AlignedBox3d box;
    bool whole = false;
    int pattern_first = -1;  // place of the pattern's first instance; -1: a region
  };
  const Place& at(int place) const { return places_[static_cast<std::size_t>(place)]; }
  double size() const { return size_; }  ///< the mesh's diagonal

 private:
  /// What one motion of a place does to all places that have surface in common with it.
  struct Images {
    std::vector<std::pair<int, int>> pairs;  // a place and where it goes, ascending
    std::unordered_map<int, int> sets;       // carried sets known so far
    std::pair<int, int> last{-1, -1};        // the last one of those: neighbours ask for the same
  };
  bool group_goes_to(int from, const Motion& motion, int to) const;
  bool group_within(int inner, int outer) const;
  bool carries_group(int place, int other) const;
  bool make_a_group(int a, int b) const;
  bool groups_close(int a, int b) const;
  void find_followers(const std::vector<int>& sets);
  int intern(const std::vector<int>& places) const;
  const PieceMoments& common_moments(int a, int b) const;
  PieceMoments common_piece(int a, int b) const;
  const PieceMoments& common_faces(int a, int b) const;
  Motion told_from_origin(const Motion& motion) const;
  Images find_images(int place, int element) const;
  Images& images(int place, int element) const;
  void add_region(const Region& region);
  void add_pattern(const Pattern& pattern, const std::vector<Motion>& motions);
  void share_references();
  void find_sets(const Mesh& mesh);
  void find_meeting(const Mesh& mesh);
  void find_twins(const Mesh& mesh);
  double piece_distance(int from, const Motion& motion, int to) const;

  std::vector<Place> places_;
  std::vector<int> first_place_;
  double size_ = 0;  // the mesh's diagonal
  int regions_ = 0;
  std::vector<int> set_of_face_;
  PointSets points_;
  mutable std::map<std::vector<int>, int> number_of_set_;
  mutable std::vector<const std::vector<int>*> sets_;
  mutable std::unordered_map<std::uint64_t, int> with_;
  std::vector<std::vector<int>> meeting_;                    // of each place, the places that share faces with it
  std::vector<std::vector<int>> around_;                     // of each place, the places that hold all faces of it
  std::set<std::pair<int, int>> following_;                  // see follows()
  mutable std::map<std::pair<int, int>, bool> closing_;      // whether the groups of both do, see unclosed()
  std::vector<PieceMoments> moments_;                        // of the faces of each set
  std::vector<std::pair<int, PieceMoments>> point_moments_;  // of the vertices of each set that a vertex has
  struct Marks {
    Points points;
    mutable std::optional<PointIndex> index;  // once it is asked
  };
  std::map<int, Marks> twins_;                                  // places that moments do not tell apart: corners
  mutable std::map<std::pair<int, int>, PieceMoments> common_;  // of the faces that two places hold, as known so far
  Eigen::Vector3d origin_ = Eigen::Vector3d::Zero();            // of the moments
  mutable std::vector<std::vector<std::unique_ptr<Images>>> images_;
  mutable std::vector<std::vector<int>> inverses_;  // by place and element, once asked for
};

/// The region with fewest faces among a set's places; -1: none.
int innermost_region(const DomainMap& domains, int set);

}  // namespace orbifit
