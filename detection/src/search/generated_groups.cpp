#include "search/generated_groups.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <utility>

#include <Eigen/Geometry>
#include <Eigen/SVD>

#include "orbifit/model/point_group.h"

#include "search/line_region_search.h"
#include "support/kept_samples.h"
#include "support/region_growth.h"

namespace orbifit {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr std::size_t kMaxJoined = 120;      // elements: those of Ih
constexpr int kMaxTurns = 12;                // by which mirrors and half-turns alone generate rotations
constexpr double kOpenDirection = 0.1;       // of the largest singular value: the common points go on there
constexpr std::array kSame{0.05, 0.1, 0.2};  // largest entry, about radians, by which an element may differ from itself
constexpr double kClosed = 1e-9;             // once averaged

// The point nearest to `near` that all motions leave where it is, as nearly as can be.
Vector3d common_point(const std::vector<Motion>& motions, const Vector3d& near) {
  Eigen::MatrixXd moved(3 * static_cast<Eigen::Index>(motions.size()), 3);
  Eigen::VectorXd by(moved.rows());
  for (std::size_t k = 0; k < motions.size(); ++k) {
    const auto row = 3 * static_cast<Eigen::Index>(k);
    moved.middleRows<3>(row) = Matrix3d::Identity() - motions[k].linear;
    by.segment<3>(row) = motions[k](near) - near;
  }
  Eigen::JacobiSVD<Eigen::MatrixXd> solver(moved, Eigen::ComputeThinU | Eigen::ComputeThinV);
  solver.setThreshold(kOpenDirection);
  return near + solver.solve(by);
}

using Elements = std::vector<Matrix3d>;

// The number of the element nearest to a map, -1 where that is farther than `same`.
int nearest_of(const Elements& elements, const Matrix3d& map, double same) {
  int best = -1;
  for (std::size_t k = 0; k < elements.size(); ++k) {
    const double away = (map - elements[k]).cwiseAbs().maxCoeff();
    if (away >= same) continue;
    same = away;
    best = static_cast<int>(k);
  }
  return best;
}

// The elements with all their products, each once; nothing where they become too many.
std::optional<Elements> closure(const Elements& generators, double same) {
  Elements result{Matrix3d::Identity()};
  for (std::size_t k = 0; k < result.size(); ++k) {
    for (const Matrix3d& generator : generators) {
      const Matrix3d product = result[k] * generator;
      if (nearest_of(result, product, same) >= 0) continue;
      if (result.size() == kMaxJoined) return std::nullopt;
      result.push_back(product);
    }
  }
  return result;
}

// Maps that are nearly a group as one that is: each becomes the mean of the quotients that it should be, over and over,
// which squares what is left. Nothing where their products are none of them, or two of them the same.
std::optional<Elements> averaged(Elements elements, double same) {
  constexpr int kRounds = 6;
  const std::size_t count = elements.size();
  std::vector<std::size_t> product(count * count);
  for (std::size_t a = 0; a < count; ++a) {
    std::vector<char> taken(count, 0);
    for (std::size_t b = 0; b < count; ++b) {
      const int at = nearest_of(elements, elements[a] * elements[b], 2 * same);
      if (at < 0 || std::exchange(taken[static_cast<std::size_t>(at)], 1) != 0) return std::nullopt;
      product[a * count + b] = static_cast<std::size_t>(at);
    }
  }
  for (int round = 0; round < kRounds; ++round) {
    Elements sums(count, Matrix3d::Zero());  // of a^-1 (a k)
    for (std::size_t a = 0; a < count; ++a) {
      for (std::size_t k = 0; k < count; ++k) sums[k] += elements[a].transpose() * elements[product[a * count + k]];
    }
    for (std::size_t k = 0; k < count; ++k) elements[k] = nearest_orthogonal(sums[k]);
  }
  for (std::size_t a = 0; a < count; ++a) {
    for (std::size_t b = 0; b < count; ++b) {
      const Matrix3d& should = elements[product[a * count + b]];
      if ((elements[a] * elements[b] - should).cwiseAbs().maxCoeff() > kClosed) return std::nullopt;
    }
  }
  return elements;
}

std::optional<ClassifiedGroup> generated(const Elements& generators) {
  for (const double same : kSame) {
    const std::optional<Elements> nearly = closure(generators, same);
    const std::optional<Elements> group = nearly ? averaged(*nearly, same) : std::nullopt;
    if (group) return classify(*group);
  }
  return std::nullopt;
}

}  // namespace

std::optional<GroupPlacement> joined_group(const GroupPlacement& a, const GroupPlacement& b,
                                           const Eigen::Vector3d& near, double tolerance) {
  if (a.group.continuous() || b.group.continuous()) return std::nullopt;
  Elements linear;  // with all elements of both, words are short
  std::vector<Motion> motions;
  for (const GroupPlacement* each : {&a, &b}) {
    for (const Matrix3d& element : elements(each->group, each->frame)) {
      linear.push_back(element);
      motions.push_back(Motion::about(element, each->centre));
    }
  }
  const Vector3d centre = common_point(motions, near);
  for (const Motion& motion : motions) {
    if ((motion(centre) - centre).norm() > tolerance) return std::nullopt;
  }
  const std::optional<ClassifiedGroup> group = generated(linear);
  if (!group || group->group.order() <= std::max(a.group.order(), b.group.order())) return std::nullopt;
  // By fractions of a turn that are fine enough any two mirrors make a group, roughly.
  if (group->group.n > std::max(kMaxTurns, 2 * std::max(a.group.n, b.group.n))) return std::nullopt;
  return GroupPlacement{group->group, group->frame, centre};
}

std::vector<FoundRegion> find_joined_groups(const ScreenedSurface& surface, const SurfaceIndex& whole,
                                            const std::vector<Line>& turning, const std::vector<FoundRegion>& known,
                                            const LineRegionOptions& options, const RunContext& context) {
  constexpr double kNear = 3;  // tolerances
  LineRegionSearch search(surface, whole, known, options, context);
  for (const Line& axis : turning) search.add_turning_axis(axis);
  std::vector<GroupPlacement> asked;
  std::vector<GroupPlacement> joined;
  const auto late = [&] { return options.late && options.late(); };
  for (std::size_t a = 0; a < known.size() && !late(); ++a) {
    context.check();
    const Vector3d near = surface_moments(surface.prepared, known[a].faces).centroid;
    for (std::size_t b = 0; b < a; ++b) {
      const std::optional<GroupPlacement> group =
          joined_group(known[a].placement, known[b].placement, near, kNear * surface.tolerance);
      if (!group) continue;
      const bool again = std::ranges::any_of(asked, [&](const GroupPlacement& other) {
        return other.group == group->group && contains_group(other, *group, near, 1, 2 * surface.tolerance);
      });
      if (again) continue;
      asked.push_back(*group);
      const KeptSamples samples(surface, *group, context);
      if (samples.material(samples.kept_by(samples.all()), search.explained(*group), samples.all())) {
        joined.push_back(*group);
      }
    }
  }
  std::ranges::stable_sort(joined, std::greater<>(), [](const GroupPlacement& each) { return each.group.order(); });
  search.consider_all<std::size_t>(0, [&](std::size_t& k) -> std::optional<LineRegionSearch::Candidate> {
    if (k == joined.size()) return std::nullopt;
    return LineRegionSearch::Candidate{"joined", joined[k++], false};
  });
  return search.take();
}

}  // namespace orbifit
