#include "search/axis_regions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <map>
#include <memory>
#include <numbers>
#include <optional>
#include <utility>

#include "group/verification.h"
#include "primitives/line_orbits.h"
#include "search/line_region_search.h"
#include "support/axial_groups.h"
#include "surface/thresholds.h"

namespace orbifit {

namespace {

using Eigen::Vector3d;
using Family = PointGroup::Family;

constexpr std::array<int, 20> kPrimes{2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41, 43, 47, 53, 59, 61, 67, 71};
constexpr int kIrrational = 11;  // rotations that stand for all
constexpr double kMinStep = 5;   // tolerances: shorter steps are not told from none
constexpr double kOnAxis = 2;    // tolerances: what lies nearer turns with everything
constexpr double kWholePiece = 0.9;
constexpr double kFlatPiece = 0.7;  // of a flat piece that must turn for any of it to speak
constexpr double kTurnedPiece = 0.1;

/// What turns about one axis, by samples.
class Turns {
 public:
  Turns(const ScreenedSurface& surface, const Line& axis) : surface_(surface), axis_(axis) {
    const Eigen::Index count = surface.samples.points.rows();
    turned_of_piece_.resize(surface.piece_areas.size(), 0);
    samples_of_piece_.resize(surface.piece_areas.size(), 0);
    const std::vector<Motion> all = rotations_by(irrational_turns());
    for (Eigen::Index i = 0; i < count; ++i) {
      const auto piece = static_cast<std::size_t>(surface.piece_of_sample[static_cast<std::size_t>(i)]);
      ++samples_of_piece_[piece];
      const Vector3d point = surface.samples.points.row(i);
      const double radius = axis.direction.cross(point - axis.point).norm();
      if (radius < kOnAxis * surface.tolerance) continue;
      const bool slides = meets(axis, point, surface.samples.normals.row(i));
      if (slides && holds(i, all)) {
        ++turned_of_piece_[piece];
        (surface.piece_flat[piece] == 0 ? turned_ : discs_).push_back(static_cast<int>(i));
        continue;
      }
      open_.push_back({static_cast<int>(i), radius, slides});
    }
  }

  // Samples that the rotation by 1/n of a turn and its powers keep, among some that those by 1/m do, m a divisor.
  std::vector<std::size_t> kept(const std::vector<std::size_t>& among, int n, int m) const {
    std::vector<double> turns;
    for (int k = 1; k < n; ++k) {
      if (k % (n / m) != 0) turns.push_back(static_cast<double>(k) / n);
    }
    const std::vector<Motion> motions = rotations_by(turns);
    std::vector<std::size_t> result;
    for (const std::size_t i : among) {
      if (2 * std::numbers::pi * open_[i].radius / n < kMinStep * surface_.tolerance) continue;
      if (holds(open_[i].sample, motions)) result.push_back(i);
    }
    return result;
  }

  // How far the rotation by 1/n of a turn and the next carry a few of the samples off the surface, rms.
  double largest_residual(const std::vector<std::size_t>& of, int n, const SurfaceIndex& whole) const {
    constexpr std::size_t kMax = 100;
    const std::vector<Motion> motions = rotations_by(n > 2 ? std::vector{1.0 / n, 2.0 / n} : std::vector{0.5});
    const double most = 2 * surface_.tolerance;
    const std::size_t count = std::min(of.size(), kMax);
    double square = 0;
    for (std::size_t k = 0; k < count; ++k) {
      const Vector3d point = surface_.samples.points.row(open_[of[k * of.size() / count]].sample);
      for (const Motion& motion : motions) {
        const double off = std::min(most, whole.nearest(motion(point), most).distance);
        square += off * off;
      }
    }
    return std::sqrt(square / std::max(1.0, static_cast<double>(count * motions.size())));
  }

  const Line& axis() const { return axis_; }

  // Samples that all rotations keep, without those of planes: a disc of a plane is no part of anything.
  const std::vector<int>& turned() const { return turned_; }

  // Some samples with all that any rotation keeps.
  std::vector<int> with_turned(std::vector<int> samples) const {
    samples.insert(samples.end(), turned_.begin(), turned_.end());
    samples.insert(samples.end(), discs_.begin(), discs_.end());
    std::ranges::sort(samples);  // a few then stand for all
    return samples;
  }

  std::vector<std::size_t> all() const {
    std::vector<std::size_t> result(open_.size());
    for (std::size_t i = 0; i < result.size(); ++i) result[i] = i;
    return result;
  }

  // The share of the surface that speaks for a rotation which keeps `kept`, without the samples marked.
  double evidence(const std::vector<std::size_t>& kept, const std::vector<char>& explained) const {
    const auto count = std::ranges::count_if(
        speaking(kept), [&](std::size_t i) { return explained[static_cast<std::size_t>(open_[i].sample)] == 0; });
    return static_cast<double>(count) / static_cast<double>(surface_.samples.points.rows());
  }

  std::vector<int> samples(const std::vector<std::size_t>& of) const {
    std::vector<int> result;
    result.reserve(of.size());
    for (const std::size_t i : of) result.push_back(open_[i].sample);
    return result;
  }

  // Those that speak for an order, see evidence().
  std::vector<std::size_t> speaking(const std::vector<std::size_t>& kept) const {
    std::map<std::size_t, int> of_piece;
    for (const std::size_t i : kept) ++of_piece[piece_of(i)];
    std::vector<std::size_t> result;
    std::ranges::copy_if(kept, std::back_inserter(result), [&](std::size_t i) {
      const std::size_t piece = piece_of(i);
      const auto samples = static_cast<double>(samples_of_piece_[piece]);
      const auto mine = static_cast<double>(of_piece[piece]);
      if (surface_.piece_flat[piece] != 0 && mine < kFlatPiece * samples) return false;
      return !open_[i].slides || (mine >= kWholePiece * samples && turned_of_piece_[piece] <= kTurnedPiece * samples);
    });
    return result;
  }

  // Those of them that a group keeps as well.
  std::vector<std::size_t> kept_by(const std::vector<std::size_t>& among, const GroupPlacement& placement) const {
    const std::vector<Motion> motions = judged_motions(placement.group, placement.frame, placement.centre);
    std::vector<std::size_t> result;
    std::ranges::copy_if(among, std::back_inserter(result),
                         [&](std::size_t i) { return holds(open_[i].sample, motions); });
    return result;
  }

 private:
  struct Open {
    int sample;
    double radius;
    bool slides;
  };

  static std::vector<double> irrational_turns() {
    std::vector<double> turns;
    for (int k = 1; k <= kIrrational; ++k) turns.push_back(k / std::numbers::phi - std::floor(k / std::numbers::phi));
    return turns;
  }

  std::vector<Motion> rotations_by(const std::vector<double>& turns) const {
    std::vector<Motion> result;
    result.reserve(turns.size());
    for (const double turn : turns) {
      result.push_back(Motion::rotation(axis_.direction, 2 * std::numbers::pi * turn, axis_.point));
    }
    return result;
  }

  bool holds(Eigen::Index i, const std::vector<Motion>& motions) const {
    const Vector3d point = surface_.samples.points.row(i);
    const Vector3d normal = surface_.samples.normals.row(i);
    return std::ranges::all_of(
        motions, [&](const Motion& motion) { return surface_.grid.holds(motion(point), motion.linear * normal); });
  }

  std::size_t piece_of(std::size_t i) const {
    return static_cast<std::size_t>(surface_.piece_of_sample[static_cast<std::size_t>(open_[i].sample)]);
  }

  const ScreenedSurface& surface_;
  Line axis_;
  std::vector<Open> open_;  // samples off the axis that some rotation may not keep
  std::vector<int> turned_;
  std::vector<int> discs_;  // likewise, of planes
  std::vector<int> turned_of_piece_, samples_of_piece_;
};

/// An order that something turns by about an axis.
struct Order {
  std::size_t axis;
  int n;
  std::vector<std::size_t> kept;  // of the axis's open samples
  double evidence = 0;
  double residual = 0;  // rms, of a few of them
};

class AxisSearch {
 public:
  AxisSearch(const ScreenedSurface& surface, const SurfaceIndex& whole, const std::vector<Line>& axes,
             const std::vector<FoundRegion>& known, const LineRegionOptions& options, const RunContext& context)
      : surface_(surface),
        whole_(whole),
        axes_(axes),
        options_(options),
        context_(context),
        search_(surface, whole, known, options, context),
        few_(few_of_each_orbit(axes, options.of_whole, surface.tolerance)) {}

  AxisRegions run() {
    AxisRegions result;
    result.turning = find_turns();
    for (const Line& axis : result.turning) search_.add_turning_axis(axis);
    for (std::size_t a = 0; a < turns_.size() && !late(); ++a) {
      context_.progress("axes", 0.5 * static_cast<double>(a) / static_cast<double>(axes_.size()));
      if (turns_[a] && few_[a] != 0) look_for_middle(*turns_[a]);
    }
    climb();
    // High orders first: what they explain, such as the half-turns of a dihedral group, is not looked at again. What is
    // small turns by any angle to the tolerance: the order that it has fits best.
    const auto weight = [&](const Order& order) {
      return order.n * order.evidence / (kNoMisfit * surface_.tolerance + order.residual);
    };
    std::ranges::stable_sort(orders_, [&](const Order& x, const Order& y) {
      return (x.n > 2) != (y.n > 2) ? x.n > 2 : weight(x) > weight(y);
    });
    const auto halves = std::ranges::find(orders_, 2, &Order::n);
    // A row of n things has 2 n half-turns; the strongest will do.
    if (orders_.end() - halves > kMaxHalfTurns) orders_.erase(halves + kMaxHalfTurns, orders_.end());
    search_.consider_all<Place>({}, [&](Place& place) { return next(place); });
    result.regions = search_.take();
    return result;
  }

 private:
  bool late() const { return options_.late && options_.late(); }

  // Returns the axes about which more than a little turns.
  std::vector<Line> find_turns() {
    constexpr double kMin = 0.01;  // of the surface
    turns_.resize(axes_.size());
    parallel_for(context_, axes_.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t a = begin; a < end && !late(); ++a) turns_[a] = std::make_unique<Turns>(surface_, axes_[a]);
    });
    std::vector<Line> turning;
    for (std::size_t a = 0; a < axes_.size(); ++a) {
      if (!turns_[a]) continue;
      const auto turned = static_cast<double>(turns_[a]->turned().size());
      if (turned >= kMin * static_cast<double>(surface_.samples.faces.size())) turning.push_back(axes_[a]);
    }
    return turning;
  }

  // The orders about all axes.
  void climb() {
    std::vector<std::vector<Order>> found(turns_.size());
    parallel_for(context_, turns_.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t a = begin; a < end && !late(); ++a) {
        if (turns_[a] && few_[a] != 0) found[a] = orders_about(a);
      }
    });
    for (std::vector<Order>& orders : found) {
      orders_.insert(orders_.end(), std::make_move_iterator(orders.begin()), std::make_move_iterator(orders.end()));
    }
  }

  std::vector<Order> orders_about(std::size_t axis) const {
    const Turns& turns = *turns_[axis];
    std::vector<Order> result;
    std::map<int, std::vector<std::size_t>> kept;  // by order
    kept[1] = turns.all();
    const std::vector<char> none(surface_.samples.faces.size(), 0);
    for (auto at = kept.begin(); at != kept.end(); ++at) {  // grows ahead of itself
      const auto& [m, samples] = *at;
      for (const int p : kPrimes) {
        const int n = m * p;
        if (n > kHighestOrder) break;
        if (kept.contains(n)) continue;
        std::vector<std::size_t> stay = turns.kept(samples, n, m);
        const double evidence = turns.evidence(stay, none);
        if (evidence < options_.least_share) continue;
        result.push_back({axis, n, stay, evidence, turns.largest_residual(turns.speaking(stay), n, whole_)});
        kept.emplace(n, std::move(stay));
      }
    }
    return result;
  }

  // Of what turns by any angle, what is mirrored across the axis as well.
  void look_for_middle(const Turns& turns) {
    constexpr double kMin = 0.1;          // of the surface
    constexpr double kMinOfTurned = 0.6;  // any cylinder by itself has a middle
    const auto count = static_cast<double>(surface_.samples.faces.size());
    const double share = std::max(kMin, kMinOfTurned * static_cast<double>(turns.turned().size()) / count);
    if (static_cast<double>(turns.turned().size()) < kMin * count) return;
    for (const GroupPlacement& placement : groups_with_middle(surface_, turns.axis(), turns.turned(), share)) {
      search_.consider({"axes", placement, false});
    }
  }

  // Where the search for candidates is: which order, and which of the groups that turn by it, itself last.
  struct Place {
    std::size_t order = 0;
    std::size_t group = 0;
    std::vector<GroupPlacement> larger;  // of the order, once its first group is asked for
  };

  // The next candidate, `place` after it.
  std::optional<LineRegionSearch::Candidate> next(Place& place) {
    for (; place.order < orders_.size(); place = {place.order + 1, 0, {}}) {
      const Order& order = orders_[place.order];
      const Turns& turns = *turns_[order.axis];
      const GroupPlacement turn{
          {Family::Cn, order.n}, frame_about(axes_[order.axis].direction), axes_[order.axis].point};
      if (place.group == 0) {
        context_.progress("axes", 0.5 + 0.5 * static_cast<double>(place.order) / static_cast<double>(orders_.size()));
        tried_.resize(place.order);
        tried_.emplace_back();
        if (order.evidence < least(order)) continue;
        // What is known to turn may have parts with more mirrors.
        place.larger = larger(order);
      }
      while (place.group < place.larger.size()) {
        const GroupPlacement& group = place.larger[place.group++];
        if (fresh(place.order, group, turns.kept_by(order.kept, group))) {
          return LineRegionSearch::Candidate{"axes", group, false};
        }
      }
      if (place.group++ == place.larger.size() && fresh(place.order, turn, order.kept)) {
        return LineRegionSearch::Candidate{"axes", turn, true};
      }
      tried_[place.order] = turns.samples(order.kept);
    }
    return std::nullopt;
  }

  double least(const Order& order) const { return order.n > 2 ? options_.least_share : kMinOfHalfTurns; }

  // Half-turns are many; what more there is to theirs, mirrors will say.
  std::vector<GroupPlacement> larger(const Order& order) const {
    std::vector<GroupPlacement> result;
    if (order.n <= 2) return result;
    const Turns& turns = *turns_[order.axis];
    const std::vector<int> spoken = turns.samples(turns.speaking(order.kept));
    for (const AxialGroup& group : larger_groups(surface_, axes_[order.axis], order.n, spoken,
                                                 turns.with_turned(turns.samples(order.kept)), least(order))) {
      result.push_back(group.placement);
    }
    return result;
  }

  // Whether enough speaks for a group that turns by the order, and keeps the samples, that is not explained yet.
  bool fresh(std::size_t number, const GroupPlacement& placement, const std::vector<std::size_t>& kept) const {
    const Order& order = orders_[number];
    std::vector<char> explained = search_.explained(placement);
    // What was tried for a multiple of the order and failed is not tried again.
    for (std::size_t other = 0; other < number; ++other) {
      if (orders_[other].axis != order.axis || orders_[other].n % order.n != 0) continue;
      for (const int sample : tried_[other]) explained[static_cast<std::size_t>(sample)] = 1;
    }
    return turns_[order.axis]->evidence(kept, explained) >= least(order);
  }

  static constexpr double kNoMisfit = 0.1;  // tolerances
  static constexpr std::ptrdiff_t kMaxHalfTurns = 12;
  static constexpr double kMinOfHalfTurns = 0.03;  // of the surface: any few things have one

  const ScreenedSurface& surface_;
  const SurfaceIndex& whole_;
  const std::vector<Line>& axes_;
  const LineRegionOptions& options_;
  const RunContext& context_;
  LineRegionSearch search_;
  std::vector<char> few_;                      // by axis: whether to look for regions about it
  std::vector<std::unique_ptr<Turns>> turns_;  // of the axes, none where time was up
  std::vector<Order> orders_;
  std::vector<std::vector<int>> tried_;  // by order: the samples that it keeps, where it was looked at
};

}  // namespace

AxisRegions find_axis_regions(const ScreenedSurface& surface, const SurfaceIndex& whole, const std::vector<Line>& axes,
                              const std::vector<FoundRegion>& known, const LineRegionOptions& options,
                              const RunContext& context) {
  return AxisSearch(surface, whole, axes, known, options, context).run();
}

}  // namespace orbifit
