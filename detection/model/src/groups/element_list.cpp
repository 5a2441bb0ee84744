#include "groups/element_list.h"

#include <algorithm>
#include <limits>

namespace orbifit {

namespace {

// A projection of the nine entries to a line. The weights are of no meaning but to keep different elements apart;
// their absolute values sum up to kWeightSum, which bounds how far equal elements can lie apart on the line.
constexpr double kWeightSum = 9;

double key(const Eigen::Matrix3d& linear) {
  Eigen::Matrix3d weights;
  weights << 0.317, -1.411, 0.733, 1.871, 0.541, -1.129, -0.863, 1.597, 0.538;
  return linear.cwiseProduct(weights).sum();
}

}  // namespace

ElementList::ElementList(std::vector<Motion> elements, double scale, double tolerance)
    : elements_(std::move(elements)), scale_(scale), tolerance_(tolerance) {
  for (std::size_t i = 0; i < elements_.size(); ++i) keys_.emplace_back(key(elements_[i].linear), i);
  std::ranges::sort(keys_);
}

bool ElementList::identity_first() const {
  return !elements_.empty() && equal(elements_.front(), Motion{});
}

std::optional<ElementList::Pair> ElementList::find_repeated() const {
  for (std::size_t i = 0; i < elements_.size(); ++i) {
    if (const auto other = find(elements_[i], i)) return Pair{std::min(i, *other), std::max(i, *other)};
  }
  return std::nullopt;
}

std::optional<ElementList::Pair> ElementList::find_missing_product() const {
  for (std::size_t i = 0; i < elements_.size(); ++i) {
    for (std::size_t j = 0; j < elements_.size(); ++j) {
      if (!find(elements_[i] * elements_[j])) return Pair{i, j};
    }
  }
  return std::nullopt;
}

bool ElementList::equal(const Motion& a, const Motion& b) const {
  return (a.linear - b.linear).cwiseAbs().maxCoeff() <= tolerance_ &&
         (a.translation - b.translation).cwiseAbs().maxCoeff() <= tolerance_ * scale_;
}

std::optional<std::size_t> ElementList::find(const Motion& motion, std::optional<std::size_t> except) const {
  const double middle = key(motion.linear);
  const double reach = kWeightSum * tolerance_;
  auto candidate = std::ranges::lower_bound(keys_, std::pair{middle - reach, std::size_t{0}});
  for (; candidate != keys_.end() && candidate->first <= middle + reach; ++candidate) {
    if (candidate->second != except && equal(elements_[candidate->second], motion)) return candidate->second;
  }
  return std::nullopt;
}

}  // namespace orbifit
