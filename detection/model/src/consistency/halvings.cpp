#include "consistency/halvings.h"

#include <algorithm>
#include <cmath>

#include "consistency/consistency_search.h"

namespace orbifit {

namespace {

// Of a continuous group the places that count as different, in place of its elements.
double places_of(const PointGroup& group) {
  const double circle = ConsistencyPolicy{}.circle;
  switch (group.family) {
    case PointGroup::Family::Cinf:
      return circle;
    case PointGroup::Family::Cinfv:
    case PointGroup::Family::Cinfh:
    case PointGroup::Family::Dinf:
      return 2 * circle;
    case PointGroup::Family::Dinfh:
      return 4 * circle;
    case PointGroup::Family::K:
      return circle * circle;
    case PointGroup::Family::Kh:
      return 2 * circle * circle;
    default:
      return group.order();
  }
}

}  // namespace

double halvings(std::size_t places) {
  return std::log2(std::max<double>(1, static_cast<double>(places)));
}

double halvings(const PointGroup& group) {
  return std::log2(places_of(group));
}

}  // namespace orbifit
