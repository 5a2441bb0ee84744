#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "orbifit/detection/axis_regions.h"

namespace orbifit {

/// Makes verified regions of groups about lines and planes that the screen suggests, each but once.
class LineRegionSearch {
 public:
  /// All arguments are kept by reference.
  LineRegionSearch(const ScreenedSurface& surface, const SurfaceIndex& whole, const std::vector<FoundRegion>& known,
                   const LineRegionOptions& options, const RunContext& context);

  /// Tells of an axis about which some of the surface turns by any angle. What is shaped like that says nothing of
  /// motions that leave the axis in place: they keep every such surface.
  void add_turning_axis(const Line& axis);

  /// By sample: whether a region found before says that the group keeps it, or a turning axis that this is no news.
  std::vector<char> explained(const GroupPlacement& placement) const;

  /// Refines the group on the surface it keeps, and adds the region if it holds and says something new.
  /// \param enlarge whether to look for a larger group there
  void settle(std::string_view stage, const GroupPlacement& start, bool enlarge);

  std::vector<FoundRegion> take() { return std::move(found_); }

 private:
  // What a region says of the samples.
  struct Said {
    SurfaceMoments moments;
    std::vector<char> holds;  // by sample
  };
  Said said_of(const FoundRegion& region) const;
  bool leaves(const GroupPlacement& placement, const Line& axis) const;
  bool hopeless(const SurfacePatch& patch, const GroupPlacement& start) const;
  bool mere_plates(const std::vector<int>& faces) const;
  bool says_nothing_new(const FoundRegion& region) const;
  void note(std::string_view stage, const FoundRegion& region, bool kept, std::string_view reason) const;

  const ScreenedSurface& surface_;
  const SurfaceIndex& whole_;
  const std::vector<FoundRegion>& known_;
  const LineRegionOptions& options_;
  const RunContext& context_;
  std::vector<FoundRegion> found_;
  struct TurningAxis {
    Line line;
    std::vector<char> slides;  // by sample: the normal meets the axis
  };
  std::vector<TurningAxis> turning_;
  std::vector<Said> said_;  // of the known regions, then of the found
};

}  // namespace orbifit
