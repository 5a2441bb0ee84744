#include "group_of_bytes.h"

#include <algorithm>
#include <numbers>
#include <stdexcept>
#include <vector>

#include <Eigen/Geometry>

#include "orbifit/model/point_group.h"

#include "byte_source.h"
#include "groups/element_list.h"

namespace orbifit {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kSame = 1e-6;             // entries of equal elements differ by less: rounding is 1e-14
constexpr std::size_t kMaxElements = 130;  // above the 120 of Ih and the 4 * 30 of the largest axial group made here

Vector3d axis(ByteSource& bytes) {
  const Vector3d any(bytes.coordinate(), bytes.coordinate(), bytes.coordinate());
  return any.norm() > 1e-3 ? any.normalized() : Vector3d::UnitZ();
}

// The fivefold axes of an icosahedron among them, so that I comes up as well.
Matrix3d generator(ByteSource& bytes) {
  const Vector3d icosahedral = Vector3d(0, 1, std::numbers::phi).normalized();
  const Vector3d about = bytes.below(4) == 0 ? icosahedral : axis(bytes);
  const int order = 1 + bytes.below(30);
  const double sign = bytes.flag() ? -1 : 1;
  return sign * axis_rotation(about, 2 * std::numbers::pi * bytes.below(order) / order);
}

bool holds(const std::vector<Matrix3d>& list, const Matrix3d& matrix, double tolerance) {
  return std::ranges::any_of(list, [&](const Matrix3d& m) { return (m - matrix).cwiseAbs().maxCoeff() < tolerance; });
}

// Empty where the group is larger, as an infinite one is.
std::vector<Matrix3d> closure(const std::vector<Matrix3d>& generators) {
  std::vector<Matrix3d> result{Matrix3d::Identity()};
  for (std::size_t i = 0; i < result.size(); ++i) {
    for (const Matrix3d& step : generators) {
      const Matrix3d product = nearest_orthogonal(step * result[i]);
      if (!holds(result, product, kSame)) result.push_back(product);
      if (result.size() > kMaxElements) return {};
    }
  }
  return result;
}

void require_truth(bool holds, const char* what) {
  if (!holds) throw std::logic_error(what);
}

void require_group(const std::vector<Matrix3d>& elements_of_set, const ClassifiedGroup& found) {
  constexpr double kReproduced = 0.01;  // classify's own tolerance is 1e-3 radians
  const std::vector<Matrix3d> expected = elements(found.group, found.frame);
  require_truth(expected.size() == elements_of_set.size(), "a group of another order was found");
  for (const Matrix3d& matrix : elements_of_set)
    require_truth(holds(expected, matrix, kReproduced), "an element is not in the group that was found");
  const auto again = PointGroup::parse(found.group.symbol());
  require_truth(found.group.family == PointGroup::Family::C1 || (again && *again == found.group),
                "the group's symbol is not its own");
}

}  // namespace

void classify_group_of_bytes(std::span<const std::uint8_t> data) {
  ByteSource bytes(data);
  std::vector<Matrix3d> generators;
  for (int count = 1 + bytes.below(3); count > 0; --count) generators.push_back(generator(bytes));
  std::vector<Matrix3d> set = closure(generators);
  if (set.empty()) return;
  // Two elements that are nearly the same make a set that is closed to the one tolerance and not to the other.
  for (std::size_t i = 1; i < set.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if ((set[i] - set[j]).cwiseAbs().maxCoeff() < 0.02) return;
    }
  }
  const bool whole = set.size() == 1 || bytes.below(4) != 0;
  if (!whole) set.erase(set.begin() + 1 + bytes.below(static_cast<int>(set.size()) - 1));
  std::vector<Motion> motions;
  for (const Matrix3d& matrix : set) motions.push_back({matrix, Vector3d::Zero()});
  const ElementList list(motions, 1, kSame);
  require_truth(list.identity_first() && !list.find_repeated(), "an element counts as another");
  require_truth(closed(motions, 1, kSame) == !list.find_missing_product(), "closed for the one and not for the other");
  const auto found = classify(set);
  if (whole) require_truth(found.has_value(), "a closed set is no group");
  if (whole) require_truth(closed(motions, 1, kSame), "a closed set is not closed");
  if (found) require_group(set, *found);
}

}  // namespace orbifit
