// A pattern's motions, fitted to the groups around it.

#include <algorithm>
#include <cmath>
#include <limits>

#include "consistency/consistency_search.h"
#include "groups/motion_closure.h"

namespace orbifit {

namespace {

using Eigen::Index;
using Eigen::Vector3d;
using Eigen::VectorXd;

void add_rows(const Motion& a, const Motion& b, const Extent& extent, std::vector<double>& rows) {
  const Eigen::Matrix3d linear = extent.reach * (a.linear - b.linear);
  const Vector3d moved = a(extent.centre) - b(extent.centre);
  rows.insert(rows.end(), linear.data(), linear.data() + 9);
  rows.insert(rows.end(), moved.data(), moved.data() + 3);
}

VectorXd as_vector(const std::vector<double>& rows) {
  return Eigen::Map<const VectorXd>(rows.data(), static_cast<Index>(rows.size()));
}

// A turn by x / reach about the extent's centre, then a shift.
Motion small_motion(const VectorXd& x, const Extent& extent) {
  const Vector3d turn = x.head<3>() / extent.reach;
  const double angle = turn.norm();
  Motion result;
  if (angle > 0) result = Motion::rotation(turn / angle, angle, extent.centre);
  result.translation += x.tail<3>();
  return result;
}

// generator^count.
Motion power(const Motion& generator, int count) {
  const Motion step = count < 0 ? inverse(generator) : generator;
  Motion result;
  for (int k = 0; k < std::abs(count); ++k) result = step * result;
  return result;
}

// The steps taken so often each, one after the other.
Motion product(const std::vector<Motion>& steps, const std::vector<int>& counts) {
  Motion result;
  for (std::size_t g = 0; g < steps.size(); ++g) result = result * power(steps[g], counts[g]);
  return result;
}

// A pattern's steps, and how they may change: translations each by itself, others by one small motion of all of them.
class Steps {
 public:
  /// \param extent  of the first instance, kept by reference
  Steps(const std::vector<Motion>& steps, const Extent& extent) : steps_(steps), extent_(extent) {
    translations_ = std::ranges::all_of(
        steps, [](const Motion& g) { return (g.linear - Eigen::Matrix3d::Identity()).norm() < 1e-9; });
  }

  Index unknowns() const { return translations_ ? 3 * count() : 6; }

  std::vector<Motion> at(const VectorXd& x) const {
    std::vector<Motion> result = steps_;
    for (Index g = 0; g < count(); ++g) {
      Motion& step = result[static_cast<std::size_t>(g)];
      if (translations_) {
        step.linear.setIdentity();
        step.translation += x.segment<3>(3 * g);
      } else {
        step = conjugate(small_motion(x.segment<6>(0), extent_), step);
      }
    }
    return result;
  }

  // How often each is taken, `most` times at most, to come nearest to the motion.
  std::vector<int> counts_of(const Motion& motion, int most) const {
    std::vector<int> result(steps_.size(), 0);
    if (translations_) {
      Eigen::MatrixXd columns(3, count());
      for (Index g = 0; g < count(); ++g) columns.col(g) = steps_[static_cast<std::size_t>(g)].translation;
      const VectorXd counts = columns.colPivHouseholderQr().solve(motion.translation);
      for (Index g = 0; g < count(); ++g) {
        result[static_cast<std::size_t>(g)] = static_cast<int>(std::lround(counts[g]));
      }
      return result;
    }
    double nearest = std::numeric_limits<double>::infinity();
    for (int k = -most; k <= most; ++k) {
      const double d = distance(power(steps_[0], k), motion, extent_);
      if (d < nearest) {
        nearest = d;
        result[0] = k;
      }
    }
    return result;
  }

 private:
  Index count() const { return static_cast<Index>(steps_.size()); }

  std::vector<Motion> steps_;
  const Extent& extent_;
  bool translations_;
};

// A step's image under a normaliser: a product of the steps, after a motion that keeps the first instance. Of a chain
// whose links turn by a quarter a mirror across it makes steps of the other hand, which differ by a link's half-turn.
struct StepImage {
  std::size_t normaliser, step;
  std::vector<int> counts;  // of each step
  Motion own;
};

// Each step not at all, forwards or back, in all combinations; of up to three steps.
std::vector<std::vector<int>> single_steps(std::size_t count) {
  std::vector<std::vector<int>> result;
  for (int a = -1; a <= 1; ++a) {
    for (int b = count > 1 ? -1 : 0; b <= (count > 1 ? 1 : 0); ++b) {
      for (int c = count > 2 ? -1 : 0; c <= (count > 2 ? 1 : 0); ++c) {
        std::vector<int> counts{a, b, c};
        counts.resize(count);
        result.push_back(counts);
      }
    }
  }
  return result;
}

// Without what it shifts along its axis, which is the detector's error.
Motion turned_only(Motion motion) {
  const Vector3d axis = Eigen::AngleAxisd(motion.linear).axis();
  motion.translation -= axis.dot(motion.translation) * axis;
  return motion;
}

// Nothing where an image is farther than `near` from all products of single steps. \param own  the group that keeps the
// first instance
std::optional<std::vector<StepImage>> images_of_steps(const std::vector<Motion>& steps,
                                                      const std::vector<Motion>& normalisers,
                                                      const std::vector<Motion>& own, const Extent& extent,
                                                      double near) {
  const std::vector<std::vector<int>> candidates = single_steps(steps.size());
  std::vector<StepImage> result;
  for (std::size_t n = 0; n < normalisers.size(); ++n) {
    for (std::size_t g = 0; g < steps.size(); ++g) {
      const Motion image = conjugate(normalisers[n], steps[g]);
      StepImage best;
      double nearest = std::numeric_limits<double>::infinity();
      for (const Motion& element : own) {
        for (const std::vector<int>& counts : candidates) {
          const double d = distance(product(steps, counts) * element, image, extent);
          if (d >= nearest) continue;
          nearest = d;
          best = {n, g, counts, element};
        }
      }
      if (nearest > near) return std::nullopt;
      result.push_back(std::move(best));
    }
  }
  return result;
}

}  // namespace

// Whether it is, to rounding, an element of a region on the first instance, or one of those by which the groups around
// keep it.
bool ConsistencySearch::symmetry_of_instance(const KnownPattern& known, const std::vector<Motion>& kept_by,
                                             const Motion& motion) const {
  const Extent& extent = shapes_.extent(known.shapes[0]);
  if (distance(motion, Motion{}, extent) <= rounding_) return true;
  if (std::ranges::any_of(kept_by,
                          [&](const Motion& element) { return distance(motion, element, extent) <= rounding_; })) {
    return true;
  }
  return std::ranges::any_of(regions_, [&](const KnownRegion& region) {
    return region.state != State::out && shapes_.same(known.shapes[0], region.shape) &&
           std::ranges::any_of(region.region.elements,
                               [&](const Motion& element) { return distance(motion, element, extent) <= rounding_; });
  });
}

// Copies whose directions differ by less than what positions are told to are as the groups around have it, or alike:
// where copies touch, going round them would turn a point by that little.
Motion ConsistencySearch::with_told_directions(const KnownPattern& known, const Motion& motion) const {
  const Extent& extent = shapes_.extent(known.shapes[0]);
  const auto alike = [&](const Eigen::Matrix3d& linear) {
    return extent.reach * (motion.linear - linear).norm() <= policy_.told * diagonal_;
  };
  const auto turned = [&](const Eigen::Matrix3d& linear) {
    return Motion{linear, motion(extent.centre) - linear * extent.centre};
  };
  if (alike(Eigen::Matrix3d::Identity())) return turned(Eigen::Matrix3d::Identity());
  for (const KnownRegion& region : regions_) {
    if (region.state != State::placed || !shapes_.within(known.shapes[0], region.shape)) continue;
    for (const Motion& element : region.region.elements) {
      if (alike(element.linear)) return turned(element.linear);
    }
  }
  return motion;
}

// Copies that the groups around take to one another stand where those take them; between others the motion takes what
// keeps the one to what keeps the other.
std::optional<std::string> ConsistencySearch::fit_copies(KnownPattern& known, const InstanceOrbits& orbits) const {
  const Extent& extent = shapes_.extent(known.shapes[0]);
  const double near = length(policy_.same_group);
  const std::vector<Motion> own = closure(orbits.stabilisers[0], extent, near);
  for (std::size_t t = 1; t < known.shapes.size(); ++t) {
    Motion& motion = known.pattern.instances[t].motion;
    const auto root = static_cast<std::size_t>(orbits.roots[t]);
    if (root != t) {
      const Motion due = orbits.ways[t] * known.pattern.instances[root].motion;
      if (!symmetry_of_instance(known, own, inverse(due) * motion)) motion = due;
      continue;
    }
    motion = with_told_directions(known, motion);
    struct Pair {
      Motion there, here;
    };
    std::vector<Pair> pairs;
    const std::vector<Motion> others = closure(orbits.stabilisers[t], shapes_.extent(known.shapes[t]), near);
    const auto pair_up = [&](const std::vector<Motion>& from, const std::vector<Motion>& to, bool forth) {
      if (to.empty()) return from.empty();
      return std::ranges::all_of(from, [&](const Motion& stabiliser) {
        const Motion seen = conjugate(forth ? motion : inverse(motion), stabiliser);
        const Extent& on = forth ? shapes_.extent(known.shapes[t]) : extent;
        const auto nearest = std::ranges::min_element(to, {}, [&](const Motion& m) { return distance(m, seen, on); });
        if (distance(*nearest, seen, on) > near) return false;
        pairs.push_back(forth ? Pair{*nearest, stabiliser} : Pair{stabiliser, *nearest});
        return true;
      });
    };
    if (!pair_up(own, others, true) || !pair_up(others, own, false) ||
        !pair_up(orbits.turns[0], orbits.turns[t], true) || !pair_up(orbits.turns[t], orbits.turns[0], false)) {
      return "the groups around it keep one of its instances and not the others";
    }
    const Motion before = motion;
    const auto hard = [&](const VectorXd& x) {
      std::vector<double> rows;
      const Motion now = small_motion(x, shapes_.extent(known.shapes[t])) * before;
      for (const Pair& pair : pairs) add_rows(pair.there * now, now * pair.here, extent, rows);
      return as_vector(rows);
    };
    const VectorXd missed = hard(VectorXd::Zero(6));
    if (missed.size() == 0 || missed.cwiseAbs().maxCoeff() <= rounding_) continue;
    const auto soft = [&](const VectorXd& x) { return x; };
    const VectorXd x = nearest_solution(6, hard, soft, extent.reach);
    motion = small_motion(x, shapes_.extent(known.shapes[t])) * before;
    if (hard(x).cwiseAbs().maxCoeff() > rounding_) return "its motions cannot agree with the groups around it";
    if (distance(motion, before, extent) > length(policy_.movement)) {
      return "to agree with the groups around it its motions would have to change by more than the tolerance";
    }
  }
  return std::nullopt;
}

// What takes the instances to one another takes steps to steps, forward or back.
std::optional<std::string> ConsistencySearch::fit_lattice(KnownPattern& known, const InstanceOrbits& orbits) const {
  const std::vector<Motion>& normalisers = orbits.normalisers;
  Pattern& pattern = known.pattern;
  const Extent& extent = shapes_.extent(known.shapes[0]);
  std::vector<Motion> generators = pattern.generators;
  if (pattern.kind == Pattern::Kind::rotation) {
    for (Motion& generator : generators) generator = turned_only(generator);
  }
  const Steps given(generators, extent);
  const double near = length(policy_.same_group);
  const std::vector<Motion> own = closure(orbits.stabilisers[0], extent, near);
  const auto images = images_of_steps(generators, normalisers, own, extent, near);
  if (!images) return "the groups around it do not keep its steps";
  const auto hard = [&](const VectorXd& x) {
    std::vector<double> rows;
    const std::vector<Motion> steps = given.at(x);
    for (const StepImage& each : *images) {
      add_rows(conjugate(normalisers[each.normaliser], steps[each.step]), product(steps, each.counts) * each.own,
               extent, rows);
    }
    return as_vector(rows);
  };
  VectorXd x = VectorXd::Zero(given.unknowns());
  const VectorXd missed = hard(x);
  if (missed.size() > 0 && missed.cwiseAbs().maxCoeff() > rounding_) {
    x = nearest_solution(
        given.unknowns(), hard, [](const VectorXd& y) { return y; }, extent.reach);
    if (hard(x).cwiseAbs().maxCoeff() > rounding_) return "its steps cannot agree with the groups around it";
  } else if (std::equal(generators.begin(), generators.end(), pattern.generators.begin(),
                        [&](const Motion& a, const Motion& b) { return distance(a, b, extent) <= rounding_; })) {
    return std::nullopt;
  }
  const std::vector<Motion> steps = given.at(x);
  // Instances are products of steps: counted with the steps as they were, put together of the new ones.
  for (PatternInstance& instance : pattern.instances) {
    const int most = static_cast<int>(pattern.instances.size());
    const Motion moved = product(steps, given.counts_of(instance.motion, most));
    if (distance(moved, instance.motion, extent) > length(policy_.movement)) {
      return "to agree with the groups around it its steps would have to change by more than the tolerance";
    }
    instance.motion = moved;
  }
  pattern.generators = steps;
  return std::nullopt;
}

}  // namespace orbifit
