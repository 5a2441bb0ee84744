#include "remeshing/finite_group.h"

#include <algorithm>
#include <limits>

#include "orbifit/model/point_group.h"

namespace orbifit {

namespace {

using Eigen::Vector3d;

constexpr std::size_t kMaxElements = 512;  // D128h has as many; generators that fit badly have no end
constexpr double kSameMotion = 1e-5;       // of the extent; neighbouring rotations of order 256 differ by 1e-2

int nearest_element(const std::vector<Motion>& elements, const Motion& motion, const Vector3d& about, double extent,
                    double& distance) {
  int best = -1;
  distance = std::numeric_limits<double>::infinity();
  for (std::size_t e = 0; e < elements.size(); ++e) {
    const double d = motion_distance(elements[e], motion, about, extent);
    if (d < distance) {
      distance = d;
      best = static_cast<int>(e);
    }
  }
  return best;
}

// All products of the generators, or nothing where they are too many.
std::optional<std::vector<Motion>> closure(const std::vector<Motion>& generators, const Vector3d& about,
                                           double extent) {
  std::vector<Motion> elements{Motion{}};
  for (std::size_t next = 0; next < elements.size(); ++next) {
    for (const Motion& generator : generators) {
      const Motion product = generator * elements[next];
      double distance = 0;
      nearest_element(elements, product, about, extent, distance);
      if (distance <= kSameMotion * extent) continue;
      elements.push_back(product);
      if (elements.size() > kMaxElements) return std::nullopt;
    }
  }
  return elements;
}

// The table, read off the elements' linear parts. \return false where some product is no element
bool fill_table(FiniteGroup& group, double extent) {
  const std::size_t order = group.elements.size();
  group.products.assign(order, std::vector<int>(order, 0));
  group.inverses.assign(order, 0);
  for (std::size_t a = 0; a < order; ++a) {
    for (std::size_t b = 0; b < order; ++b) {
      double distance = 0;
      const Motion product = group.elements[a] * group.elements[b];
      group.products[a][b] = nearest_element(group.elements, product, group.centre, extent, distance);
      if (distance > kSameMotion * extent) return false;
      if (group.products[a][b] == 0) group.inverses[a] = static_cast<int>(b);
    }
  }
  return true;
}

}  // namespace

std::optional<FiniteGroup> generated_group(const std::vector<Motion>& generators, const Vector3d& about,
                                           double extent) {
  const std::optional<std::vector<Motion>> closed = closure(generators, about, extent);
  if (!closed) return std::nullopt;
  FiniteGroup group;
  group.centre = Vector3d::Zero();
  for (const Motion& element : *closed) group.centre += element(about) / static_cast<double>(closed->size());
  if (closed->size() == 1) return group;

  std::vector<Eigen::Matrix3d> linear;
  for (const Motion& element : *closed) linear.push_back(element.linear);
  const std::optional<ClassifiedGroup> classified = classify(linear);
  if (!classified || classified->group.order() != static_cast<int>(closed->size())) return std::nullopt;
  group.elements.clear();
  for (const Eigen::Matrix3d& element : elements(classified->group, classified->frame)) {
    group.elements.push_back(Motion::about(element, group.centre));
  }
  if (!fill_table(group, extent)) return std::nullopt;
  return group;
}

}  // namespace orbifit
