#include "start/thinned_input.h"

#include "scan/thinned_scan.h"

namespace orbifit {

ThinnedInput::ThinnedInput(const FitInput& input, int most, std::uint64_t seed)
    : scan_(thinned(input.scan, most, seed)), input_{input.mesh,      input.annotation,   scan_,          input.pose,
                                                     input.landmarks, input.handles,      input.subspace, input.watch,
                                                     input.others,    input.surface_index} {
  others_.reserve(input.others.size());
  for (const PointCloud*& other : input_.others) {
    others_.push_back(thinned(*other, most, seed));
    other = &others_.back();
  }
}

}  // namespace orbifit
