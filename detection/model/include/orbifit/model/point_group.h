#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "orbifit/model/motion.h"

namespace orbifit {

/// A point group by its Schoenflies symbol (annotation-format: "regions").
struct PointGroup {
  enum class Family {
    C1,
    Cs,
    Ci,
    Cn,
    Cnv,
    Cnh,
    Dn,
    Dnh,
    Dnd,
    Sn,
    T,
    Td,
    Th,
    O,
    Oh,
    I,
    Ih,
    Cinf,
    Cinfv,
    Cinfh,
    Dinf,
    Dinfh,
    K,
    Kh
  };
  Family family = Family::C1;
  int n = 1;  ///< the number in the symbol: >= 2 for Cn ... Dnd, even and >= 4 for Sn, else 1

  bool operator==(const PointGroup&) const = default;

  bool continuous() const;
  int order() const;      ///< number of elements; 0 for a continuous group
  bool has_axis() const;  ///< false for C1, Ci, K, Kh and the polyhedral groups
  bool proper() const;    ///< rotations only

  /// Schoenflies symbol in ASCII: "C4v", "D2h", "S6", "Cinfv", "C1".
  std::string symbol() const;
  static std::optional<PointGroup> parse(std::string_view symbol);
};

/// Orthonormal frame in which a group is written: column 2 is the main axis (for Cs the plane's normal); column 0 is
/// the normal of one vertical mirror for Cnv, lies on one twofold axis for Dn, Dnh and Dnd, and is free otherwise.
/// Polyhedral groups: T, Td, Th, O, Oh have twofold or fourfold axes along the columns; I, Ih twofold axes along them.
using GroupFrame = Eigen::Matrix3d;

/// All elements in closed form, the identity first; accurate to rounding, closed under products to 1e-15.
/// The order of the elements is a function of the group alone.
/// \pre !group.continuous()
std::vector<Eigen::Matrix3d> elements(const PointGroup& group, const GroupFrame& frame = GroupFrame::Identity());

/// Whether the orthogonal map belongs to the group about the unit axis (of no effect for K and Kh): it keeps the axis,
/// as a line, to `angle` in radians, and its orientation and the axis' sense agree with the family.
/// \pre group.continuous()
bool belongs_to_continuous(const Eigen::Matrix3d& linear, const PointGroup& group, const Eigen::Vector3d& axis,
                           double angle);

/// The finite group of the same kind: Cnv of Cinfv, with n rotations about the axis in place of all. \pre
/// group.continuous(), group.has_axis()
PointGroup finite_counterpart(const PointGroup& group, int n);

/// A small set that generates elements(group, frame); for a continuous group the discrete cosets' representatives
/// and one rotation by 1 radian about each generating axis.
std::vector<Eigen::Matrix3d> generators(const PointGroup& group, const GroupFrame& frame = GroupFrame::Identity());

/// The point group formed by a closed set of orthogonal matrices (tolerance in radians), with a frame in which
/// elements() reproduces them; nothing when they are not closed or form none.
struct ClassifiedGroup {
  PointGroup group;
  GroupFrame frame;
};
std::optional<ClassifiedGroup> classify(const std::vector<Eigen::Matrix3d>& linear, double tolerance = 1e-3);

/// Whether every product of two elements is one of them, to `tolerance` in the largest entry, for parts of
/// translation relative to `scale`.
bool closed(const std::vector<Motion>& elements, double scale, double tolerance);

/// Right-handed frame whose column 2 is the unit axis; column 0 is nearest to `towards` where given.
GroupFrame frame_about(const Eigen::Vector3d& axis, const std::optional<Eigen::Vector3d>& towards = std::nullopt);

}  // namespace orbifit
