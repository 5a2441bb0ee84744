#pragma once

#include <functional>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "orbifit/model/annotation.h"
#include "orbifit/model/motion.h"
#include "orbifit/model/point_group.h"

#include "groups/motion_closure.h"

namespace orbifit {

/// Where a group stands: elements are frame * E * frame^T about the centre.
struct GroupPlace {
  PointGroup group;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  GroupFrame frame = GroupFrame::Identity();
};

/// Nothing where the elements form no group of the symbol given.
std::optional<GroupPlace> place_of(const Region& region);

/// Motions that determine where the group stands, and nothing that it leaves free: generators of a finite group; of a
/// continuous one a turn by one radian about its axis and, where its centre is determined, the mirror across it; an
/// inversion for all rotations about a point.
std::vector<Motion> marks(const GroupPlace& place);

/// Motions among which the images of marks are found: all elements; of a continuous group marks and their inverses.
std::vector<Motion> members(const GroupPlace& place);

/// Motions by which the group takes other regions to their images: as marks(); of a continuous group one of each
/// component but the identity's and mirrors through the axis, since its rotations leave regions where they are.
std::vector<Motion> movers(const GroupPlace& place);

/// All rotations about a continuous group's axis, or centre, alone.
GroupPlace turning_part(const GroupPlace& place);

/// The place as `motion` moves it.
GroupPlace image_of(const GroupPlace& place, const Motion& motion);

/// How far `way` is from taking the one group to the other: the largest displacement within `extent` (of `to`) between
/// the image of a mark of `from` and the member of `to` nearest to it.
double group_distance(const GroupPlace& from, const Motion& way, const GroupPlace& to, const Extent& extent);

/// How far the one group is from being within the other: the largest displacement within `extent` between an element
/// and the nearest one of `outer`; of continuous groups one element of each component, and a turn. Infinity where it
/// cannot be.
double distance_from_within(const GroupPlace& inner, const GroupPlace& outer, const Extent& extent);

/// How many elements of a finite group are, to `tolerance` within `extent`, elements of another one.
std::size_t common_members(const GroupPlace& finite, const GroupPlace& other, const Extent& extent, double tolerance);

/// What is asked of a place x: before * (own mark) * after takes `from` to `to`.
struct Tie {
  Motion before, after;
  int own = -1;                    ///< number of the mark of x in between; -1: none
  std::optional<GroupPlace> from;  ///< nothing: x
  std::optional<GroupPlace> to;    ///< nothing: x
  Extent extent;                   ///< around `to`
};

struct PlaceFit {
  GroupPlace place;
  double unmet = 0;  ///< of what the ties ask, mesh units: rounding, or they contradict one another
};

/// The place at which all ties hold that is nearest to `start` and, on average, to `wanted`; a tie between motions
/// farther apart than `near` is not met. Gauss-Newton, the ties exactly (null space), in six unknowns.
/// \param extent  of the region around x
/// \param directions  unit vectors that the marks of x take to one another, or to their opposites, where they nearly
/// do:
///                    steps of rows that are known more exactly
/// \return nothing where a mark has no counterpart within `near`
std::optional<PlaceFit> fitted_place(const GroupPlace& start, const std::vector<GroupPlace>& wanted,
                                     const std::vector<Tie>& ties, const Extent& extent, double near,
                                     const std::vector<Eigen::Vector3d>& directions = {});

/// Unknowns near zero at which hard(x) = 0 and soft(x) is least: Gauss-Newton with numerical derivatives, at most
/// twelve rounds. Lengths in mesh units; `scale` is the size of a unit step.
Eigen::VectorXd nearest_solution(Eigen::Index unknowns,
                                 const std::function<Eigen::VectorXd(const Eigen::VectorXd&)>& hard,
                                 const std::function<Eigen::VectorXd(const Eigen::VectorXd&)>& soft, double scale);

}  // namespace orbifit
