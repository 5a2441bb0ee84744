#include "search/line_region_search.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>
#include <span>

#include <Eigen/Geometry>

#include "evidence/chance_symmetry.h"
#include "evidence/policy.h"
#include "group/axis_orders.h"
#include "group/verification.h"
#include "primitives/featureless.h"
#include "primitives/revolution.h"
#include "support/own_group.h"
#include "support/region_growth.h"
#include "surface/smooth_border.h"
#include "surface/thresholds.h"

namespace orbifit {

namespace {

constexpr int kPatchSamples = 1000;
constexpr double kNearly = 0.9;       // of the samples: less is not worth thinning out
constexpr double kOfTurned = 0.98;    // of the samples of a turned surface that all rotations must keep
constexpr int kRounds = 2;            // of thinning out what does not verify
constexpr double kNothingNew = 0.05;  // of the region's area outside of one that says the same

// Of the rotations about its axis; 1 for none.
int order_of_turns(const PointGroup& group) {
  if (group.continuous() || !group.has_axis()) return 1;
  return group.family == PointGroup::Family::Sn ? group.n / 2 : group.n;
}

// Whether what has the group would be turned about its axis if it had the other, about the same axis, as well: by
// fifths and by sixths. It is not, or was found as such; the other keeps it to the tolerance only.
bool turns_otherwise(const GroupPlacement& has, const GroupPlacement& other, double radius, double near) {
  constexpr int kFew = 2;
  const int order = order_of_turns(has.group);
  const int turns = order_of_turns(other.group);
  if (order <= kFew || turns <= 1 || turns % order == 0 || order % turns == 0) return false;
  const Eigen::Vector3d axis = has.frame.col(2);
  return radius * axis.cross(other.frame.col(2)).norm() < near && axis.cross(other.centre - has.centre).norm() < near;
}

// Whether some element takes points of the patch elsewhere than it did, by more than the grid tells.
bool has_moved(const SurfacePatch& patch, const GroupPlacement& from, const GroupPlacement& to) {
  constexpr double kTold = 0.1;  // tolerances: a fifth of a cell
  const std::vector<Motion> before = judged_motions(from.group, from.frame, from.centre);
  const std::vector<Motion> after = judged_motions(to.group, to.frame, to.centre);
  for (std::size_t i = 0; i < before.size(); ++i) {
    const double moved = motion_distance(before[i], after[i], patch.moments.centroid, patch.moments.radius);
    if (moved > kTold * patch.tolerance) return true;
  }
  return false;
}

// The very same, of one stage.
bool same(const LineRegionSearch::Candidate& a, const LineRegionSearch::Candidate& b) {
  return a.stage == b.stage && a.enlarge == b.enlarge && a.start.group == b.start.group &&
         a.start.frame == b.start.frame && a.start.centre == b.start.centre;
}

}  // namespace

LineRegionSearch::LineRegionSearch(const ScreenedSurface& surface, const SurfaceIndex& whole,
                                   const std::vector<FoundRegion>& known, const LineRegionOptions& options,
                                   const RunContext& context)
    : surface_(surface), whole_(whole), known_(known), options_(options), context_(context) {
  for (const FoundRegion& region : known) said_.push_back(said_of(region));
}

LineRegionSearch::Said LineRegionSearch::said_of(const FoundRegion& region) const {
  Said said{surface_moments(surface_.prepared, region.faces), {}};
  for (const int face : surface_.samples.faces) {
    said.holds.push_back(std::ranges::binary_search(region.faces, face) ? 1 : 0);
  }
  return said;
}

std::vector<char> LineRegionSearch::explained(const GroupPlacement& placement) const {
  std::vector<char> result(surface_.samples.faces.size(), 0);
  // Mirrors and half-turns, of which there are many, are to be farther from the known ones to be worth a look.
  const bool many = !placement.group.continuous() && placement.group.order() == 2;
  const double near = (many ? 5 : 2) * surface_.tolerance;
  for (std::size_t r = 0; r < said_.size(); ++r) {
    const FoundRegion& region = known_region(r);
    const SurfaceMoments& moments = said_[r].moments;
    if (!contains_group(region.placement, placement, moments.centroid, moments.radius, near) &&
        !turns_otherwise(region.placement, placement, moments.radius, near)) {
      continue;
    }
    for (std::size_t i = 0; i < result.size(); ++i) result[i] = result[i] != 0 || said_[r].holds[i] != 0 ? 1 : 0;
  }
  const Balls& balls = surface_.balls;
  for (std::size_t b = 0; b < balls.all.size(); ++b) {
    if (!fixes(placement, balls.all[b], surface_.tolerance)) continue;
    for (std::size_t i = 0; i < result.size(); ++i) {
      const int ball = balls.ball_of_face[static_cast<std::size_t>(surface_.samples.faces[i])];
      if (ball == static_cast<int>(b)) result[i] = 1;
    }
  }
  for (const TurningAxis& axis : turning_) {
    if (!leaves(placement, axis.line)) continue;
    for (std::size_t i = 0; i < result.size(); ++i) result[i] = result[i] != 0 || axis.slides[i] != 0 ? 1 : 0;
  }
  return result;
}

void LineRegionSearch::add_turning_axis(const Line& axis) {
  TurningAxis turning{axis, {}};
  for (Eigen::Index i = 0; i < surface_.samples.points.rows(); ++i) {
    turning.slides.push_back(meets(axis, surface_.samples.points.row(i), surface_.samples.normals.row(i)) ? 1 : 0);
  }
  turning_.push_back(std::move(turning));
}

// Whether a mirror or half-turn, or a rotation about another line, leaves the axis where it is. What turns about the
// axis itself is judged by whole pieces.
bool LineRegionSearch::leaves(const GroupPlacement& placement, const Line& axis) const {
  const Eigen::Vector3d line = placement.frame.col(2);
  const bool mirror = placement.group.family == PointGroup::Family::Cs;
  const bool along = line.cross(axis.direction).norm() < kSameDirection;
  if (!mirror && along) return false;
  const double far = 2 * surface_.tolerance;
  return std::ranges::all_of(judged_motions(placement.group, placement.frame, placement.centre), [&](const Motion& g) {
    return (g.linear * axis.direction).cross(axis.direction).norm() < kSameDirection &&
           (g(axis.point) - axis.point).cross(axis.direction).norm() < far;
  });
}

Explanation::Note LineRegionSearch::note_of(const Candidate& candidate, const FoundRegion& region, bool kept,
                                            std::string_view reason) const {
  return {std::string(candidate.stage),
          region.placement.group.symbol() + " on " + std::to_string(region.faces.size()) + " faces", kept,
          std::string(reason)};
}

// Whether what the regions, the number `first` and those after it, say of this one is enough to turn it away.
bool LineRegionSearch::answer(Question question, const FoundRegion& region, std::size_t first) const {
  switch (question) {
    case Question::kWhole:
      return of_whole(region.placement, first);
    case Question::kNothingNew:
      return says_nothing_new(region, first);
    case Question::kEndsAnywhere:
      return ends_anywhere(region, first);
  }
  return false;
}

std::string_view LineRegionSearch::reason_of(Question question) {
  switch (question) {
    case Question::kWhole:
      return "known of the whole";
    case Question::kNothingNew:
      return "known from a larger region";
    case Question::kEndsAnywhere:
      return "ends within planes and curves, in what has a larger group";
  }
  return {};
}

// Whether the region's faces, whose area it sets, are worth a region.
bool LineRegionSearch::measure(FoundRegion& region) const {
  region.area = 0;
  for (const int f : region.faces) region.area += surface_.prepared.areas[f];
  return region.area >= options_.least_share * surface_.prepared.area;
}

SurfacePatch LineRegionSearch::patch_of(const FoundRegion& region, const RunContext& context) const {
  return make_patch(surface_.prepared, region.faces, kPatchSamples, surface_.tolerance, context, "line");
}

// Verifies the region's group, and leaves out faces that it does not keep as long as that helps. What is against it;
// empty when it is verified.
std::string LineRegionSearch::verify_thinning(FoundRegion& region, SurfacePatch& patch,
                                              const RunContext& context) const {
  VerificationLimits limits;
  // Ragged borders of what any rotation keeps: whoever looks from other places sees more of them.
  if (region.placement.group.continuous()) limits.joint = kOfTurned;
  for (int round = 0;; ++round) {
    const Verification verification = verify_group(patch, region.placement, context);
    std::string reason = objection(verification, limits);
    if (reason.empty() || round == kRounds || verification.joint < kNearly) return reason;
    std::vector<int> fewer = thinned_region(surface_, patch, verification, region.placement, context);
    if (fewer == region.faces) return reason;
    region.faces = std::move(fewer);
    if (!measure(region)) return "too small once thinned out";
    patch = patch_of(region, context);
    region.placement = refine(patch, region.placement, context);
  }
}

LineRegionSearch::Judgement LineRegionSearch::judge(const Candidate& candidate, const RunContext& context) const {
  const GroupPlacement& start = candidate.start;
  FoundRegion region{start, {}, 0, "turns or mirrors into itself"};
  Judgement result;
  result.known = said_.size();
  const auto judged = [&](bool kept, std::string_view reason) {
    if (options_.explanation != nullptr) result.notes.push_back(note_of(candidate, region, kept, reason));
    if (kept) result.region = std::move(region);
    return std::move(result);
  };
  std::optional<Question> known;
  const auto is_known = [&](Question question) {
    if (answer(question, region, 0)) {
      known = question;
    } else if (context_.threads > 1) {  // what was found meanwhile will be asked
      result.asked.push_back({question, region});
    }
    return known.has_value();
  };
  const auto known_already = [&] { return judged(false, reason_of(*known)); };
  if (is_known(Question::kWhole)) return known_already();
  region.faces = grid_region(surface_, start, context);
  if (!measure(region)) return judged(false, "too small");
  if (mere_plates(region.faces)) return judged(false, "any two plates are mirror images");
  if (mere_balls(region)) return judged(false, "little but balls that it fixes");
  if (is_known(Question::kNothingNew) || is_known(Question::kEndsAnywhere)) return known_already();
  SurfacePatch patch = patch_of(region, context);
  if (hopeless(patch, start, context)) return judged(false, "not verified: a first look keeps too little");
  region.placement = refine(patch, start, context);
  if (is_known(Question::kNothingNew)) return known_already();
  std::vector<int> again = region.faces;
  if (has_moved(patch, start, region.placement)) again = grid_region(surface_, region.placement, context);
  if (again != region.faces) {
    region.faces = std::move(again);
    if (!measure(region)) return judged(false, "too small once refined");
    patch = patch_of(region, context);
    region.placement = refine(patch, region.placement, context);
  }
  if (mere_plates(region.faces)) return judged(false, "any two plates are mirror images");
  if (is_known(Question::kNothingNew)) return known_already();
  if (const std::string reason = verify_thinning(region, patch, context); !reason.empty()) {
    return judged(false, reason);
  }
  if (is_known(Question::kNothingNew)) return known_already();
  if (region.area < kNearlyWhole * surface_.prepared.area && fades(patch, region.placement, context)) {
    return judged(false, "fades as the tolerance shrinks");
  }
  if (is_known(Question::kEndsAnywhere)) return known_already();
  // What slides is turned or straight, and was looked for as such: no larger group is.
  const auto slides = [&] {
    return featureless(patch, region.placement, whole_, surface_.ends, surface_.tolerance, context);
  };
  if (slides()) return judged(false, "other motions keep it as well");
  std::optional<OwnGroup> own;
  if (candidate.enlarge) own = find_own_group(patch, nullptr, {{region.placement.frame.col(2)}}, context);
  if (own && contains_group(own->placement, region.placement, patch.moments.centroid, patch.moments.radius,
                            2 * patch.tolerance)) {
    region.placement = own->placement;
    if (is_known(Question::kNothingNew)) return known_already();
    if (slides()) return judged(false, "other motions keep it as well");
  }
  return judged(true, "verified");
}

// Leaves the judgements in ahead_, in the order of the candidates.
void LineRegionSearch::judge_all(const std::vector<Candidate>& candidates) {
  std::vector<Judged> before = std::exchange(ahead_, {});
  std::vector<std::size_t> open;
  for (const Candidate& candidate : candidates) {
    const auto known =
        std::ranges::find_if(before, [&](const Judged& each) { return same(each.candidate, candidate); });
    if (known == before.end()) {
      open.push_back(ahead_.size());
      ahead_.push_back({candidate, {}});
    } else {
      ahead_.push_back(std::move(*known));
      before.erase(known);
      ask_again(ahead_.back());
    }
  }
  if (open.size() == 1) {
    Judged& only = ahead_[open.front()];
    only.judgement = judge(only.candidate, context_);
    return;
  }
  RunContext quiet = context_;
  quiet.on_progress = {};
  parallel_for(context_, open.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Judged& each = ahead_[open[i]];
      each.judgement = judge(each.candidate, quiet);
    }
  });
}

// Asks the regions that the judgement does not know what it asked those that it does.
void LineRegionSearch::ask_again(Judged& judged) const {
  Judgement& judgement = judged.judgement;
  const auto turned_away = std::ranges::find_if(
      judgement.asked, [&](const Asked& each) { return answer(each.question, each.region, judgement.known); });
  if (turned_away != judgement.asked.end()) {
    judgement.region.reset();
    judgement.notes.clear();
    if (options_.explanation != nullptr) {
      const std::string_view reason = reason_of(turned_away->question);
      judgement.notes.push_back(note_of(judged.candidate, turned_away->region, false, reason));
    }
    judgement.asked.erase(turned_away, judgement.asked.end());
  }
  judgement.known = said_.size();
}

bool LineRegionSearch::accept_next() {
  Judgement judgement = std::move(ahead_.front().judgement);
  ahead_.erase(ahead_.begin());
  return accept(std::move(judgement));
}

bool LineRegionSearch::accept(Judgement judgement) {
  if (options_.explanation != nullptr) {
    std::ranges::move(judgement.notes, std::back_inserter(options_.explanation->notes));
  }
  if (!judgement.region) return false;
  if (judgement.region->placement.group.continuous()) {
    if (!discs_) discs_.emplace(surface_.prepared, surface_.sides);
    if (discs_->little_else(*judgement.region)) {
      if (options_.explanation != nullptr) {
        Explanation::Note& note = options_.explanation->notes.back();
        note.kept = false;
        note.reason = "little but discs that end within planes";
      }
      return false;
    }
  }
  said_.push_back(said_of(*judgement.region));
  found_.push_back(std::move(*judgement.region));
  return true;
}

// Whether a rough fit keeps so little of the patch that a better one will not do. Most candidates end here.
bool LineRegionSearch::hopeless(const SurfacePatch& patch, const GroupPlacement& start,
                                const RunContext& context) const {
  constexpr int kLooks = 300;
  constexpr double kLineSlack = 0.04;  // of the share: two standard deviations, and what the fit may gain
  RefinementOptions rough;
  rough.samples = 150;
  rough.iterations = 6;
  const GroupPlacement placement = refine(patch, start, context, rough);
  const std::vector<Motion> motions = judged_motions(placement.group, placement.frame, placement.centre);
  const double tolerance = placement.group.continuous() ? continuous_tolerance(patch) : patch.tolerance;
  return verify(patch, motions, tolerance, kLooks, kNearly - kLineSlack, context).joint < kNearly - kLineSlack;
}

// Whether the faces lie in a few planes only: any two plates are mirror images, and so are two walls with floor and
// ceiling.
bool LineRegionSearch::mere_plates(const std::vector<int>& faces) const {
  constexpr std::size_t kMany = 5;
  std::set<int> pieces;
  for (const int f : faces) {
    const int piece = surface_.prepared.components.component_of_face[static_cast<std::size_t>(f)];
    if (surface_.piece_flat[static_cast<std::size_t>(piece)] == 0) return false;
    pieces.insert(piece);
    if (pieces.size() >= kMany) return false;
  }
  return true;
}

// Whether the region, of few motions, ends where no part does, within a larger one of as many: chance keeps something
// under any of them. Of many motions it keeps little.
bool LineRegionSearch::ends_anywhere(const FoundRegion& region, std::size_t first) const {
  constexpr double kWithin = 0.9;  // of the region's area
  constexpr int kFew = 8;          // motions
  constexpr int kSeveral = 16;
  constexpr double kMuchOfSeveral = 0.75;  // of the mesh's area
  const PointGroup& group = region.placement.group;
  if (group.continuous() || group.order() >= kSeveral) return false;
  const PreparedMesh& prepared = surface_.prepared;
  if (region.area >= (group.order() < kFew ? kNearlyWhole : kMuchOfSeveral) * prepared.area) return false;
  const auto holds = [&](std::size_t r) {
    const FoundRegion& other = known_region(r);
    const PointGroup& larger = other.placement.group;
    return (larger.continuous() || larger.order() >= group.order()) && other.area > region.area &&
           area_outside(prepared, region.faces, other.faces) < (1 - kWithin) * region.area;
  };
  bool held = false;
  for (std::size_t r = first; r < said_.size() && !held; ++r) held = holds(r);
  if (!held) return false;
  const std::vector<Motion> motions =
      judged_motions(region.placement.group, region.placement.frame, region.placement.centre);
  const auto ended = [&](const Eigen::Vector3d& middle) { return surface_.ends.taken_near(middle, motions); };
  return smooth_border_share(prepared, surface_.sides, region.faces, surface_.tolerance, ended) >
         kEvidencePolicy.smooth_border;
}

// Whether what is known to keep all of the surface holds the group.
bool LineRegionSearch::of_whole(const GroupPlacement& placement, std::size_t first) const {
  for (std::size_t r = first; r < said_.size(); ++r) {
    const FoundRegion& region = known_region(r);
    const SurfaceMoments& moments = said_[r].moments;
    if (region.area >= kOfWhole * surface_.prepared.area &&
        contains_group(region.placement, placement, moments.centroid, moments.radius, 2 * surface_.tolerance)) {
      return true;
    }
  }
  return false;
}

bool LineRegionSearch::mere_balls(const FoundRegion& region) const {
  return little_but_cut_balls(surface_.prepared, surface_.balls, region.faces, region.placement, surface_.tolerance);
}

bool LineRegionSearch::says_nothing_new(const FoundRegion& region, std::size_t first) const {
  const auto beside = [&](const std::vector<FoundRegion>& all, std::size_t from) {
    const auto some = std::span(all).subspan(std::min(from, all.size()));
    return says_nothing_new_beside(surface_.prepared, some, region, surface_.tolerance, kNothingNew);
  };
  return beside(known_, first) || beside(found_, first - std::min(first, known_.size()));
}

}  // namespace orbifit
