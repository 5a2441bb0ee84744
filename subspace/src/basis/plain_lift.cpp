#include "basis/plain_lift.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "basis/bessel.h"

namespace orbifit {

namespace {

constexpr double kPlainCutOff = 0.001;  // of a Gaussian (paper, section 5)
constexpr double kOutside = 1e-6;       // what a place leaves of samples outside, where nothing else is at hand
constexpr double kNegligible = 1e-5;    // of the largest weight
constexpr double kBand = 1;             // width of the fading band, in radii
constexpr int kMaxCells = 1 << 22;

const double kPlainReach = std::sqrt(-2 * std::log(kPlainCutOff));  // in standard deviations

double smooth_step(double x) {
  return x >= 1 ? 1 : x * x * (3 - 2 * x);
}

}  // namespace

PlainLift::PlainLift(const SymmetricSampling& sampling, const RegionMap& regions, bool faded)
    : sampling_(sampling), regions_(regions), faded_(faded) {
  for (int place = 0; place < regions.places(); ++place) {
    if (!regions.whole(place)) partial_places_.push_back(place);
  }
  rings_.resize(static_cast<std::size_t>(regions.places()));
  for (int k = 0; k < static_cast<int>(sampling.copies.size()); ++k) {
    const auto& copy = sampling.copies[static_cast<std::size_t>(k)];
    if (copy.place < 0 || copy.first != k) continue;
    for (const int place : regions.set_places(sampling.sets[static_cast<std::size_t>(k)])) {
      if (regions.continuum(place) != nullptr) rings_[static_cast<std::size_t>(place)].push_back(k);
    }
  }
  // Cells half as wide as a Gaussian reaches: samples by counting sort.
  const Points& points = sampling.points;
  reach_ = kPlainReach * (sampling.radii.size() > 0 ? sampling.radii.maxCoeff() : 1);
  origin_ = points.colwise().minCoeff();
  const Eigen::Vector3d extent = points.colwise().maxCoeff().transpose() - origin_;
  width_ = 0.5 * reach_;
  const auto count_of = [&]() -> Eigen::Vector3d { return (extent / width_).array().floor() + 1; };
  while (count_of().prod() > kMaxCells) width_ *= 2;
  const Eigen::Vector3d counts = count_of();
  for (int k = 0; k < 3; ++k) cells_[static_cast<std::size_t>(k)] = static_cast<int>(counts[k]);
  const double count = counts.prod();
  const auto cell_of = [&](Eigen::Index k) {
    const Eigen::Vector3d at = (points.row(k).transpose() - origin_) / width_;
    return (static_cast<int>(at[0]) * cells_[1] + static_cast<int>(at[1])) * cells_[2] + static_cast<int>(at[2]);
  };
  first_in_cell_.assign(static_cast<std::size_t>(count) + 1, 0);
  for (Eigen::Index k = 0; k < points.rows(); ++k) ++first_in_cell_[static_cast<std::size_t>(cell_of(k)) + 1];
  for (std::size_t c = 1; c < first_in_cell_.size(); ++c) first_in_cell_[c] += first_in_cell_[c - 1];
  samples_by_cell_.resize(static_cast<std::size_t>(points.rows()));
  std::vector<int> next(first_in_cell_.begin(), first_in_cell_.end() - 1);
  for (Eigen::Index k = 0; k < points.rows(); ++k) {
    samples_by_cell_[static_cast<std::size_t>(next[static_cast<std::size_t>(cell_of(k))]++)] = static_cast<int>(k);
  }
}

int PlainLift::continuous_place(int set) const {
  int chosen = -1;
  for (const int place : regions_.set_places(set)) {
    const Continuum* continuum = regions_.continuum(place);
    if (continuum != nullptr && (chosen < 0 || continuum->spherical)) chosen = place;
  }
  return chosen;
}

void PlainLift::find_near(const Eigen::Vector3d& point, int set, Scratch& scratch, std::size_t slot,
                          const Origin* origin) const {
  scratch.near.clear();
  scratch.blended = false;
  if (!faded_) return;
  for (const int place : regions_.set_places(set)) {
    if (!regions_.whole(place)) scratch.near.emplace_back(place, kOutside);
  }
  const double band = kBand * sampling_.radius;
  constexpr std::size_t kSlots = 64;
  const auto places = static_cast<std::size_t>(regions_.places());
  if (scratch.likely.empty()) scratch.likely.assign(kSlots * places, -1);
  int* const likely = scratch.likely.data() + slot % kSlots * places;
  if (scratch.asked.empty()) {
    scratch.asked.assign(places, 0);
    scratch.distances.resize(places);
  }
  const auto distance_of_first = [&](int place) {
    const auto p = static_cast<std::size_t>(place);
    if (scratch.asked[p] != scratch.orbit) {
      scratch.asked[p] = scratch.orbit;
      scratch.distances[p] = regions_.distance(origin->point, place, band, scratch.likely.data() + place);
    }
    return scratch.distances[p];
  };
  for (const int place : partial_places_) {
    if (regions_.holds(set, place)) continue;
    const int first = origin != nullptr ? origin->places[place] : -1;
    const double distance =
        first >= 0 ? distance_of_first(first) : regions_.distance(point, place, band, likely + place);
    if (!(distance < band)) continue;
    scratch.near.emplace_back(place, std::max(kOutside, smooth_step(distance / band)));
    scratch.blended = true;
  }
}

double PlainLift::factor(int sample, Scratch& scratch) const {
  if (scratch.near.empty()) return 1;
  const auto set = static_cast<std::size_t>(sampling_.sets[static_cast<std::size_t>(sample)]);
  if (set >= scratch.stamps.size()) {
    scratch.stamps.resize(set + 64, 0);
    scratch.factors.resize(set + 64, 1);
  }
  if (scratch.stamps[set] != scratch.stamp) {
    scratch.stamps[set] = scratch.stamp;
    double product = 1;
    for (const auto& [place, left] : scratch.near) {
      if (!regions_.holds(static_cast<int>(set), place)) product *= left;
    }
    scratch.factors[set] = product;
  }
  return scratch.factors[set];
}

void PlainLift::terms(const Eigen::Vector3d& point, int set, Scratch& scratch, std::size_t slot,
                      const Origin* origin) const {
  ++scratch.stamp;
  scratch.terms.clear();
  find_near(point, set, scratch, slot, origin);
  const int place = faded_ ? continuous_place(set) : -1;
  if (place >= 0) {
    ring_terms(point, place, scratch);
  } else {
    gaussian_terms(point, scratch);
  }
}

void PlainLift::gaussian_terms(const Eigen::Vector3d& point, Scratch& scratch) const {
  std::array<int, 3> low{};
  std::array<int, 3> high{};
  for (int k = 0; k < 3; ++k) {
    const auto i = static_cast<std::size_t>(k);
    low[i] = std::max(0, static_cast<int>(std::floor((point[k] - reach_ - origin_[k]) / width_)));
    high[i] = std::min(cells_[i] - 1, static_cast<int>(std::floor((point[k] + reach_ - origin_[k]) / width_)));
  }
  double largest = 0;
  for (int x = low[0]; x <= high[0]; ++x) {
    for (int y = low[1]; y <= high[1]; ++y) {
      const auto row = static_cast<std::size_t>((x * cells_[1] + y) * cells_[2]);
      if (low[2] > high[2]) continue;
      const int begin = first_in_cell_[row + static_cast<std::size_t>(low[2])];
      const int end = first_in_cell_[row + static_cast<std::size_t>(high[2]) + 1];
      for (int i = begin; i < end; ++i) {
        const int sample = samples_by_cell_[static_cast<std::size_t>(i)];
        const double sigma = sampling_.radii[sample];
        const double squared = (sampling_.points.row(sample).transpose() - point).squaredNorm() / (sigma * sigma);
        if (squared >= kPlainReach * kPlainReach) continue;
        const double weight = (std::exp(-0.5 * squared) - kPlainCutOff) * factor(sample, scratch) *
                              sampling_.shares[static_cast<std::size_t>(sample)];
        if (!(weight > 0)) continue;
        largest = std::max(largest, weight);
        scratch.terms.push_back({sample, LiftTerm::Kind::full, -1, weight});
      }
    }
  }
  double total = 0;
  std::erase_if(scratch.terms, [&](const LiftTerm& term) { return term.weight < kNegligible * largest; });
  for (const LiftTerm& term : scratch.terms) total += term.weight;
  if (scratch.terms.empty()) {  // out of reach: the nearest sample, of the right places where there is one
    double best = std::numeric_limits<double>::infinity();
    int nearest = 0;
    for (Eigen::Index k = 0; k < sampling_.points.rows(); ++k) {
      const int sample = static_cast<int>(k);
      const double foreign = std::log(factor(sample, scratch)) / std::log(kOutside);
      const double distance = (sampling_.points.row(k).transpose() - point).norm() + foreign * 1e6 * width_;
      if (distance >= best) continue;
      best = distance;
      nearest = sample;
    }
    scratch.terms.push_back({nearest, LiftTerm::Kind::full, -1, 1});
    total = 1;
  }
  for (LiftTerm& term : scratch.terms) term.weight /= total;
}

void PlainLift::ring_terms(const Eigen::Vector3d& point, int place, Scratch& scratch) const {
  const Continuum& continuum = *regions_.continuum(place);
  const double distance = continuum.distance(point);
  double total = 0;
  struct Ring {
    int sample;
    double weight, ratio, squared;
  };
  std::vector<Ring> rings;
  double nearest = std::numeric_limits<double>::infinity();
  for (const int sample : rings_[static_cast<std::size_t>(place)]) {
    const Eigen::Vector3d other = sampling_.points.row(sample).transpose();
    const double sigma = sampling_.radii[sample];
    const double other_distance = continuum.distance(other);
    double squared = (distance - other_distance) * (distance - other_distance);
    if (!continuum.spherical) squared += std::pow(continuum.axis.dot(point - other), 2);
    squared /= sigma * sigma;
    const double kappa = distance * other_distance / (sigma * sigma);
    const GaussianAverage average = continuum.spherical ? sphere_average(kappa) : circle_average(kappa);
    const double copies =
        sampling_.copy_counts[static_cast<std::size_t>(sample)] * sampling_.shares[static_cast<std::size_t>(sample)];
    const double weight = (std::exp(-0.5 * squared) - kPlainCutOff) * average.weight * copies * factor(sample, scratch);
    nearest = std::min(nearest, squared);
    rings.push_back({sample, weight, average.ratio, squared});
  }
  const bool reached = std::ranges::any_of(rings, [](const Ring& ring) { return ring.weight > 0; });
  for (Ring& ring : rings) {
    if (!reached) ring.weight = ring.squared <= nearest ? 1 : 0;
    total += std::max(0.0, ring.weight);
  }
  scratch.terms.push_back({-1, LiftTerm::Kind::centre, place, 1});
  for (const Ring& ring : rings) {
    if (ring.weight <= kNegligible * total) continue;
    if (continuum.spherical) {  // the axis is the radius of the canonical place
      scratch.terms.push_back({ring.sample, LiftTerm::Kind::axial, place, ring.ratio * ring.weight / total});
      continue;
    }
    scratch.terms.push_back({ring.sample, LiftTerm::Kind::axial, place, ring.weight / total});
    scratch.terms.push_back({ring.sample, LiftTerm::Kind::across, place, ring.ratio * ring.weight / total});
  }
}

}  // namespace orbifit
