#pragma once

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "orbifit/model/motion.h"

namespace orbifit {

/// The elements of a finite group as a file gives them, seen from the group's centre, with the questions a reader asks.
/// Two motions count as equal when no entry of the linear part differs by more than `tolerance`, and no entry of the
/// translation by more than `tolerance` times `scale`. Products are looked up in a sorted list: O(n^2 log n) in all.
class ElementList {
 public:
  ElementList(std::vector<Motion> elements, double scale, double tolerance);

  using Pair = std::pair<std::size_t, std::size_t>;

  bool identity_first() const;
  std::optional<Pair> find_repeated() const;         ///< an element and a later one equal to it
  std::optional<Pair> find_missing_product() const;  ///< two elements whose product is none

 private:
  bool equal(const Motion& a, const Motion& b) const;
  /// First element in the sorted list that equals the motion, besides number `except`.
  std::optional<std::size_t> find(const Motion& motion, std::optional<std::size_t> except = std::nullopt) const;

  std::vector<Motion> elements_;
  double scale_;
  double tolerance_;
  std::vector<std::pair<double, std::size_t>> keys_;  // ascending
};

}  // namespace orbifit
