#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include <Eigen/Core>

#include "orbifit/model/motion.h"

#include "symmetry/region_map.h"

namespace orbifit {

/// Where a point's image goes when the point at the start of a word goes to y: to frame y + shift + sum of carried t.
/// For displacements, where every group stays as it is or is carried by a translation: u = frame s + sum of carried t
/// (paper, section 5; docs/method.md 2.2).
struct Transport {
  Eigen::Matrix3d frame = Eigen::Matrix3d::Identity();
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();
  Carried carried;  ///< empty when groups are fixed
};

/// First `from`, then `step`.
Transport composed(const Transport& step, const Transport& from);
Transport inverse(const Transport& transport);

/// Largest entry of the difference of two transports' frames and carried parts.
double transport_difference(const Transport& a, const Transport& b);

/// Transport by one motion of a place. `rotation` is R of a region whose group moves (docs/method.md 2.2): the motion's
/// linear part becomes R O R^T about the region's carried centre.
Transport step_transport(const RegionMap& regions, int place, int element, const Motion& motion, bool floating,
                         const Eigen::Matrix3d& rotation = Eigen::Matrix3d::Identity());

/// Products of the groups' elements, as met on the way from a point to its images. Word 0 is the identity.
/// Many points go the same ways, so there are few words.
class GroupWords {
 public:
  /// The last motion of a word, and the word before it.
  struct Step {
    int parent, place, element;
    Motion motion;
  };

  GroupWords(const RegionMap& regions, bool floating);

  /// First `word`, then a motion of `place`: element number `element`, or for -1 a rotation of its continuum.
  int extended(int word, int place, int element, const Motion& motion);

  int count() const { return static_cast<int>(steps_.size()); }
  bool floating() const { return floating_; }
  const Step& step(int word) const { return steps_[static_cast<std::size_t>(word)]; }
  const Motion& motion(int word) const { return motions_[static_cast<std::size_t>(word)]; }
  const Transport& transport(int word) const { return transports_[static_cast<std::size_t>(word)]; }

  /// Whether two words carry displacements alike, to rounding.
  bool same(int a, int b) const;

  /// The transports of all words when region i's group is turned by rotations[i]; empty: as they are.
  std::vector<Transport> transports(const std::vector<Eigen::Matrix3d>& rotations) const;

  /// Adds to a list of transports() those of the words that came since.
  void append_transports(const std::vector<Eigen::Matrix3d>& rotations, std::vector<Transport>& known) const;

 private:
  const RegionMap& regions_;
  bool floating_;
  std::vector<Step> steps_;
  std::vector<Motion> motions_;
  std::vector<Transport> transports_;
  std::unordered_multimap<std::uint64_t, int> known_;
  mutable std::unordered_map<std::uint64_t, bool> same_;
};

}  // namespace orbifit
