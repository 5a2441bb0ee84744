#pragma once

#include "orbifit/model/motion.h"

#include "remeshing/finite_group.h"
#include "remeshing/symmetric_cell.h"

namespace orbifit {

/// The small rigid motion that takes a surface to where the group asks it to be: its centroid to where the group
/// leaves it, and its tensor of inertia as near as a rotation brings it to the mean over the group. A surface that is
/// off by as much as it is thick would lose its thickness, or double it, where it is cut.
Motion settled_place(const CellSurface& cell, const FiniteGroup& group);

}  // namespace orbifit
