#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "orbifit/detection/explanation.h"

#include "evidence/cut_discs.h"
#include "search/axis_regions.h"

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

  /// A group that may keep some of the surface.
  struct Candidate {
    std::string_view stage;  ///< outlives the search
    GroupPlacement start;
    bool enlarge = false;  ///< whether to look for a larger group there
  };

  /// Refines the group on the surface it keeps, and adds the region if it holds and says something new.
  void consider(const Candidate& candidate) { accept(judge(candidate, context_)); }

  /// Considers one candidate after the other. Several are judged at once; once one of them is added, those after it are
  /// chosen anew, and those chosen again are only asked what that region says of them. So the outcome is that of one
  /// after the other, with any number of threads.
  /// \param at    where the candidates begin
  /// \param next  gives the candidate at `at` and moves on, as far as what was found tells which; nothing at the end
  template <typename State>
  void consider_all(State at, const std::function<std::optional<Candidate>(State& at)>& next) {
    const auto most = static_cast<std::size_t>(context_.threads);
    while (!(options_.late && options_.late())) {
      std::vector<Candidate> candidates;
      std::vector<State> after;
      State ahead = at;
      while (candidates.size() < most) {
        std::optional<Candidate> candidate = next(ahead);
        if (!candidate) break;
        candidates.push_back(std::move(*candidate));
        after.push_back(ahead);
      }
      if (candidates.empty()) return;
      judge_all(candidates);
      for (std::size_t i = 0; i < candidates.size(); ++i) {
        at = after[i];
        if (accept_next()) break;
      }
    }
  }

  std::vector<FoundRegion> take() { return std::move(found_); }

 private:
  // What a judgement asked the regions found so far, and would ask those found since.
  enum class Question { kWhole, kNothingNew, kEndsAnywhere };
  struct Asked {
    Question question;
    FoundRegion region;  // as it was then
  };
  struct Judgement {
    std::optional<FoundRegion> region;  // where it is to be added
    std::vector<Explanation::Note> notes;
    std::vector<Asked> asked;  // and answered by no
    std::size_t known = 0;     // how many of the regions it knows
  };
  struct Judged {
    Candidate candidate;
    Judgement judgement;
  };
  Judgement judge(const Candidate& candidate, const RunContext& context) const;
  bool measure(FoundRegion& region) const;
  SurfacePatch patch_of(const FoundRegion& region, const RunContext& context) const;
  std::string verify_thinning(FoundRegion& region, SurfacePatch& patch, const RunContext& context) const;
  Explanation::Note note_of(const Candidate& candidate, const FoundRegion& region, bool kept,
                            std::string_view reason) const;
  void judge_all(const std::vector<Candidate>& candidates);
  bool accept_next();
  void ask_again(Judged& judged) const;  // of the regions that the judgement does not know
  bool accept(Judgement judgement);      // whether a region was added
  bool answer(Question question, const FoundRegion& region, std::size_t first) const;
  static std::string_view reason_of(Question question);

  // Those known before, then those found.
  const FoundRegion& known_region(std::size_t r) const {
    return r < known_.size() ? known_[r] : found_[r - known_.size()];
  }

  // What a region says of the samples.
  struct Said {
    SurfaceMoments moments;
    std::vector<char> holds;  // by sample
  };
  Said said_of(const FoundRegion& region) const;
  bool leaves(const GroupPlacement& placement, const Line& axis) const;
  bool hopeless(const SurfacePatch& patch, const GroupPlacement& start, const RunContext& context) const;
  bool mere_plates(const std::vector<int>& faces) const;
  bool ends_anywhere(const FoundRegion& region, std::size_t first) const;
  bool of_whole(const GroupPlacement& placement, std::size_t first) const;
  bool mere_balls(const FoundRegion& region) const;
  bool says_nothing_new(const FoundRegion& region, std::size_t first) const;

  const ScreenedSurface& surface_;
  const SurfaceIndex& whole_;
  const std::vector<FoundRegion>& known_;
  const LineRegionOptions& options_;
  const RunContext& context_;
  std::vector<FoundRegion> found_;
  std::vector<Judged> ahead_;      // judged before what comes before them was
  std::optional<CutDiscs> discs_;  // made once there is a turned region
  struct TurningAxis {
    Line line;
    std::vector<char> slides;  // by sample: the normal meets the axis
  };
  std::vector<TurningAxis> turning_;
  std::vector<Said> said_;  // of the known regions, then of the found
};

}  // namespace orbifit
