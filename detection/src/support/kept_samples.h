#pragma once

#include <bitset>
#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "orbifit/model/run_context.h"

#include "support/grid_region.h"

namespace orbifit {

/// Which elements of a finite group keep which samples of a surface.
class KeptSamples {
 public:
  static constexpr std::size_t kMaxElements = 160;
  using Elements = std::bitset<kMaxElements>;  ///< in the order of elements()

  /// Costs O(S N) grid look-ups for S samples and N elements. \param surface, placement kept by reference
  /// \pre a finite group of at most kMaxElements
  KeptSamples(const ScreenedSurface& surface, const GroupPlacement& placement, const RunContext& context);

  const std::vector<Eigen::Matrix3d>& linear() const { return linear_; }
  const std::vector<Elements>& elements_of_sample() const { return elements_of_sample_; }
  Elements all() const;

  /// By sample: whether all these elements keep it.
  std::vector<char> kept_by(const Elements& some) const;

  /// Whether what the subgroup keeps says materially more than what is known: of flat pieces, and of what every element
  /// moves along itself, only what belongs with all of its piece counts. \param kept, known by sample
  bool material(const std::vector<char>& kept, const std::vector<char>& known, const Elements& subgroup) const;

 private:
  Elements elements_keeping(Eigen::Index sample) const;
  bool slides(std::size_t sample, const Elements& subgroup) const;

  const ScreenedSurface& surface_;
  const GroupPlacement& placement_;
  std::vector<Eigen::Matrix3d> linear_;
  std::vector<Elements> elements_of_sample_;
};

}  // namespace orbifit
