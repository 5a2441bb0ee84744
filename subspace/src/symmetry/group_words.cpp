#include "symmetry/group_words.h"

#include <algorithm>
#include <cmath>

namespace orbifit {

namespace {

// Two ways to one point give the same transport up to rounding unless they restrict the displacement.
constexpr double kSameTransport = 1e-7;
constexpr double kSameTurn = 1e-9;

std::uint64_t key_of(int word, int place, int element) {
  std::uint64_t key = static_cast<std::uint32_t>(word);
  key = key * 0x9e3779b97f4a7c15ULL + static_cast<std::uint32_t>(place + 1);
  return key * 0x9e3779b97f4a7c15ULL + static_cast<std::uint32_t>(element + 2);
}

}  // namespace

Transport composed(const Transport& step, const Transport& from) {
  Transport result;
  result.frame = step.frame * from.frame;
  result.shift = step.frame * from.shift + step.shift;
  result.carried = carried_sum(step.carried, step.frame, from.carried);
  return result;
}

Transport inverse(const Transport& transport) {
  Transport result;
  result.frame = transport.frame.transpose();
  result.shift = -(result.frame * transport.shift);
  result.carried = carried_sum({}, -result.frame, transport.carried);
  return result;
}

double transport_difference(const Transport& a, const Transport& b) {
  double result = (a.frame - b.frame).cwiseAbs().maxCoeff();
  for (const auto& [carrier, matrix] : carried_sum(a.carried, -Eigen::Matrix3d::Identity(), b.carried)) {
    result = std::max(result, matrix.cwiseAbs().maxCoeff());
  }
  return result;
}

Transport step_transport(const RegionMap& regions, int place, int element, const Motion& motion, bool floating,
                         const Eigen::Matrix3d& rotation) {
  Transport step;
  step.frame = motion.linear;
  step.shift = motion.translation;
  if (place < regions.count() && rotation != Eigen::Matrix3d::Identity()) {
    // The motion conjugated by the region's turn, also where it leaves the centre off by rounding or a file's digits.
    const Eigen::Vector3d& centre = regions.centre(place);
    step.frame = rotation * motion.linear * rotation.transpose();
    step.shift = centre - step.frame * centre + rotation * (motion(centre) - centre);
  }
  if (floating) step.carried = regions.carried(place, element, step.frame);
  return step;
}

GroupWords::GroupWords(const RegionMap& regions, bool floating) : regions_(regions), floating_(floating) {
  steps_.push_back({-1, -1, -1, Motion{}});
  motions_.emplace_back();
  transports_.emplace_back();
}

int GroupWords::extended(int word, int place, int element, const Motion& motion) {
  if (motion.translation.isZero(0) && motion.linear == Eigen::Matrix3d::Identity()) return word;
  const std::uint64_t key = key_of(word, place, element);
  const auto [begin, end] = known_.equal_range(key);
  for (auto entry = begin; entry != end; ++entry) {
    const Step& step = steps_[static_cast<std::size_t>(entry->second)];
    if (step.parent != word || step.place != place || step.element != element) continue;
    if (element >= 0 || (step.motion.linear - motion.linear).cwiseAbs().maxCoeff() < kSameTurn) return entry->second;
  }
  const int number = count();
  known_.emplace(key, number);
  steps_.push_back({word, place, element, motion});
  motions_.push_back(motion * motions_[static_cast<std::size_t>(word)]);
  transports_.push_back(composed(step_transport(regions_, place, element, motion, floating_),
                                 transports_[static_cast<std::size_t>(word)]));
  return number;
}

bool GroupWords::same(int a, int b) const {
  if (a == b) return true;
  const std::uint64_t key = static_cast<std::uint64_t>(static_cast<std::uint32_t>(std::min(a, b))) << 32U |
                            static_cast<std::uint32_t>(std::max(a, b));
  const auto known = same_.find(key);
  if (known != same_.end()) return known->second;
  const bool result = transport_difference(transport(a), transport(b)) <= kSameTransport;
  same_.emplace(key, result);
  return result;
}

std::vector<Transport> GroupWords::transports(const std::vector<Eigen::Matrix3d>& rotations) const {
  std::vector<Transport> result;
  append_transports(rotations, result);
  return result;
}

void GroupWords::append_transports(const std::vector<Eigen::Matrix3d>& rotations, std::vector<Transport>& known) const {
  if (rotations.empty()) {
    known.insert(known.end(), transports_.begin() + static_cast<std::ptrdiff_t>(known.size()), transports_.end());
    return;
  }
  if (known.empty()) known.emplace_back();
  for (std::size_t word = known.size(); word < steps_.size(); ++word) {
    const Step& step = steps_[word];
    const bool region = step.place < regions_.count();
    const Eigen::Matrix3d rotation =
        region ? rotations[static_cast<std::size_t>(step.place)] : Eigen::Matrix3d(Eigen::Matrix3d::Identity());
    known.push_back(composed(step_transport(regions_, step.place, step.element, step.motion, floating_, rotation),
                             known[static_cast<std::size_t>(step.parent)]));
  }
}

}  // namespace orbifit
