#pragma once

#include <optional>
#include <vector>

#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"

#include "evidence/colour_samples.h"

namespace orbifit {

/// Judges motions of one part of a surface by what they make of its colours.
class ColourJudge {
 public:
  /// \param from  faces whose samples are moved \param to  faces where they must arrive
  ColourJudge(const ColourSamples& samples, Eigen::Index faces, const std::vector<int>& from,
              const std::vector<int>& to);

  /// Share of the part's surface that shows another colour where the motion takes it, in [0, 1].
  /// \param enough  where the share is certain to be more than this, some share above it
  double differing(const Motion& motion, double enough = 1) const;
  bool keeps(const Motion& motion) const;

  const ColourSamples& samples() const { return samples_; }
  const std::vector<int>& chosen() const { return chosen_; }

 private:
  const ColourSamples& samples_;
  std::vector<char> to_;
  std::vector<int> chosen_;  // in random order, so that the first ones tell of all
};

/// The largest subgroup of a region's group whose elements all keep the colours.
struct ColouredGroup {
  std::optional<Region> region;  ///< the region with that group; nothing where only the identity is left
  bool whole = true;             ///< it is the group itself
  double differing = 0;          ///< of the element that changes most
};

/// \param reach  mesh units: how far from the axis counts as much as an angle
ColouredGroup coloured_group(const Region& region, const ColourJudge& judge, double reach);

}  // namespace orbifit
