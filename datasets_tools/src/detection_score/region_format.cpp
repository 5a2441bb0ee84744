#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "detection_score/format_check.h"
#include "detection_score/group_comparison.h"

namespace orbifit::scoring {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Family = PointGroup::Family;

constexpr double kOrthogonal = 1e-6;
constexpr double kEqual = 1e-5;         // entries of linear parts; of translations, as a fraction of the diagonal
constexpr double kRepeated = 1e-4;      // likewise
constexpr double kMainAxis = 0.05;      // degrees
constexpr double kGeneratorAxis = 0.1;  // degrees
constexpr std::size_t kMaxElements = 1000;

bool equal(const Motion& a, const Motion& b, double scale, double tolerance) {
  return (a.linear - b.linear).cwiseAbs().maxCoeff() <= tolerance &&
         (a.translation - b.translation).cwiseAbs().maxCoeff() <= tolerance * scale;
}

// Place of the motion in the list; its size where it is none of them.
std::size_t find(const std::vector<Motion>& elements, const Motion& motion, double scale) {
  const auto found =
      std::ranges::find_if(elements, [&](const Motion& element) { return equal(element, motion, scale, kEqual); });
  return static_cast<std::size_t>(found - elements.begin());
}

// Seen from the centre: far from the origin the translations alone have lost their digits.
std::vector<Motion> about_centre(const std::vector<Motion>& motions, const Vector3d& centre) {
  std::vector<Motion> result;
  for (const Motion& motion : motions) result.push_back({motion.linear, motion(centre) - centre});
  return result;
}

double farthest_step(const std::vector<Motion>& motions) {
  double farthest = 0;
  for (const Motion& motion : motions) farthest = std::max(farthest, motion.translation.norm());
  return farthest;
}

bool orthogonal(const std::vector<Motion>& motions) {
  return std::ranges::all_of(motions, [](const Motion& motion) {
    return motion.translation.allFinite() && orthogonality_error(motion.linear) <= kOrthogonal;
  });
}

bool has_repeated(const std::vector<Motion>& elements, double scale) {
  for (std::size_t i = 0; i < elements.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (equal(elements[i], elements[j], scale, kRepeated)) return true;
    }
  }
  return false;
}

// Number of elements that products of the generators reach. \pre the generators are elements, these are closed
std::size_t generated(const std::vector<Motion>& elements, const std::vector<Motion>& generators, double scale) {
  std::vector<char> reached(elements.size(), 0);
  std::vector<std::size_t> open{0};
  reached[0] = 1;
  while (!open.empty()) {
    const Motion motion = elements[open.back()];
    open.pop_back();
    for (const Motion& generator : generators) {
      const std::size_t place = find(elements, generator * motion, scale);
      if (place == elements.size() || reached[place] != 0) continue;
      reached[place] = 1;
      open.push_back(place);
    }
  }
  return static_cast<std::size_t>(std::ranges::count(reached, 1));
}

// Angle in degrees from the region's axis to the nearest one that its elements have as their main axis.
double main_axis_error(const Region& region, const ClassifiedGroup& formed) {
  double error = angle_between_axes(region.axis, formed.frame.col(2));
  const Family family = formed.group.family;
  if (formed.group.n == 2 && (family == Family::Dn || family == Family::Dnh)) {
    for (int k = 0; k < 2; ++k) error = std::min(error, angle_between_axes(region.axis, formed.frame.col(k)));
  }
  return error;
}

void check_finite(const Region& region, double diagonal, std::vector<std::string>& breaches) {
  const std::string symbol = region.group.symbol();
  const std::vector<Motion> elements = about_centre(region.elements, region.centre);
  const std::vector<Motion> generators = about_centre(region.generators, region.centre);
  if (elements.empty()) {
    breaches.push_back("elements is empty, but " + symbol + " has " + std::to_string(region.group.order()));
    return;
  }
  if (!equal(elements.front(), {}, diagonal, kOrthogonal))
    breaches.emplace_back("the first element is not the identity");
  if (static_cast<int>(elements.size()) != region.group.order()) {
    breaches.push_back(symbol + " has " + std::to_string(region.group.order()) + " elements, the list has " +
                       std::to_string(elements.size()));
  }
  if (elements.size() > kMaxElements) {
    breaches.emplace_back("more than 1000 elements");
    return;
  }
  if (has_repeated(elements, diagonal)) breaches.emplace_back("an element is listed twice");
  if (!closed(elements, diagonal, kEqual)) {
    breaches.emplace_back("the list of elements is not closed");
    return;
  }
  std::vector<Matrix3d> linear;
  for (const Motion& element : elements) linear.push_back(element.linear);
  const auto formed = classify(linear);
  if (!formed || formed->group != region.group) {
    breaches.push_back("group is given as " + symbol + ", but the elements form " +
                       (formed ? formed->group.symbol() : std::string("none")));
  } else if (region.group.has_axis() && main_axis_error(region, *formed) > kMainAxis) {
    breaches.push_back("axis is " + std::to_string(main_axis_error(region, *formed)) +
                       " degrees off the main axis of the elements");
  }
  const auto is_element = [&](const Motion& motion) { return find(elements, motion, diagonal) < elements.size(); };
  if (generators.empty()) {
    breaches.emplace_back("generators is empty");
  } else if (!std::ranges::all_of(generators, is_element)) {
    breaches.emplace_back("a generator is not among the elements");
  } else if (const std::size_t count = generated(elements, generators, diagonal); count != elements.size()) {
    breaches.push_back("the generators generate " + std::to_string(count) + " elements, not " +
                       std::to_string(elements.size()));
  }
}

void check_continuous(const Region& region, std::vector<std::string>& breaches) {
  if (!region.elements.empty()) {
    breaches.push_back("elements must be [] for the continuous group " + region.group.symbol());
  }
  if (!region.group.has_axis()) return;
  for (const Motion& generator : region.generators) {
    if (!in_continuous_group(generator.linear, region.group.family, region.axis, kGeneratorAxis)) {
      breaches.push_back("a generator is no element of " + region.group.symbol() + " about the axis");
    }
  }
}

}  // namespace

std::vector<std::string> region_breaches(const MeasuredMesh& measured, const Region& region) {
  std::vector<std::string> breaches;
  if (region.group.family == Family::C1) breaches.emplace_back("unknown group symbol C1");
  if (!region.centre.allFinite()) breaches.emplace_back("centre must be three numbers");
  if (region.group.has_axis() && !(std::abs(region.axis.norm() - 1) <= kEqual)) {
    breaches.push_back("axis is not a unit vector (length " + std::to_string(region.axis.norm()) + ")");
  }
  if (region.faces.empty()) breaches.emplace_back("faces must be a non-empty list");
  if (!(region.residual.rms >= 0 && region.residual.rms <= region.residual.max * (1 + 1e-9) + 1e-15)) {
    breaches.emplace_back("residual must satisfy 0 <= rms <= max");
  }
  if (!orthogonal(region.generators) || !orthogonal(region.elements)) {
    breaches.emplace_back("a generator or element is not orthogonal to 1e-6");
  }
  if (!breaches.empty()) return breaches;
  const double moved = std::max(farthest_step(about_centre(region.generators, region.centre)),
                                farthest_step(about_centre(region.elements, region.centre)));
  if (moved > kEqual * measured.diagonal) {
    breaches.push_back("centre is moved by generators or elements, by " + std::to_string(moved / measured.diagonal) +
                       " of the diagonal");
  }
  if (region.group.continuous()) {
    check_continuous(region, breaches);
  } else {
    check_finite(region, measured.diagonal, breaches);
  }
  return breaches;
}

}  // namespace orbifit::scoring
