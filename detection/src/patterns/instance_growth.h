#pragma once

#include <vector>

#include <Eigen/Geometry>

#include "orbifit/model/run_context.h"

#include "group/patterns.h"
#include "patterns/part_table.h"

namespace orbifit {

/// The instances of a pattern on its way.
struct Instances {
  Arrangement arrangement;
  std::vector<std::vector<int>> parts;  ///< by instance
};

/// Adds to patterns what belongs to them: more instances along a row, and more parts to every instance. A part is used
/// in one pattern at most.
class InstanceGrowth {
 public:
  /// \param table, context  kept by reference
  InstanceGrowth(const PartTable& table, const RunContext& context);

  bool is_used(int part) const { return used_[static_cast<std::size_t>(part)] != 0; }
  void use(int part) { used_[static_cast<std::size_t>(part)] = 1; }

  /// Adds copies at the row's next places and in its gaps that the survey did not take for copies: surfaces may differ
  /// in their triangles, and a little in shape where they join.
  void continue_row(Instances& instances);

  /// Adds to the instances the parts that touch them and that the same motions carry along, as long as there are any.
  void grow(Instances& instances);

 private:
  int copy_at(const SurfacePatch& patch, const Motion& motion) const;
  bool touches(int part, const std::vector<int>& others) const;
  std::vector<int> orbit_of(std::size_t k, std::size_t m, const Instances& instances) const;

  const PartTable& table_;
  const RunContext& context_;
  std::vector<char> used_;                  // by part
  std::vector<Eigen::AlignedBox3d> boxes_;  // by part
};

}  // namespace orbifit
