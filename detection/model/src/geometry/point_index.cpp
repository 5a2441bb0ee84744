#include "geometry/point_index.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <flann/flann.hpp>

namespace orbifit {

namespace {

using Tree = flann::KDTreeSingleIndex<flann::L2_Simple<double>>;

// FLANN adds up distances to its cells step by step; the slack keeps points at the very border.
constexpr double kSlack = 1 + 1e-12;

struct Candidate {
  double squared_distance;
  int index;

  bool operator<(const Candidate& other) const {
    return squared_distance < other.squared_distance ||
           (squared_distance == other.squared_distance && index < other.index);
  }
};

// The `count` best by distance, then number; FLANN's own sets leave ties to the order of the tree.
class NearestSet : public flann::ResultSet<double> {
 public:
  explicit NearestSet(std::size_t count) : count_(count) { heap_.reserve(count + 1); }

  bool full() const override { return heap_.size() == count_; }

  void addPoint(double squared_distance, std::size_t index) override {
    const Candidate candidate{squared_distance, static_cast<int>(index)};
    if (full()) {
      if (!(candidate < heap_.front())) return;
      std::pop_heap(heap_.begin(), heap_.end());
      heap_.pop_back();
    }
    heap_.push_back(candidate);
    std::push_heap(heap_.begin(), heap_.end());
    // FLANN offers only points strictly below the bound: the smallest denormal keeps a tie at distance zero.
    if (full()) bound_ = heap_.front().squared_distance * kSlack + std::numeric_limits<double>::denorm_min();
  }

  double worstDist() const override { return bound_; }

  std::vector<Candidate>& candidates() { return heap_; }

 private:
  std::size_t count_;
  double bound_ = std::numeric_limits<double>::infinity();
  std::vector<Candidate> heap_;
};

class RadiusSet : public flann::ResultSet<double> {
 public:
  explicit RadiusSet(double radius)
      : radius_(radius), bound_(radius * radius * kSlack + std::numeric_limits<double>::denorm_min()) {}

  bool full() const override { return true; }

  void addPoint(double squared_distance, std::size_t index) override {
    if (std::sqrt(squared_distance) <= radius_) candidates_.push_back({squared_distance, static_cast<int>(index)});
  }

  double worstDist() const override { return bound_; }

  std::vector<Candidate>& candidates() { return candidates_; }

 private:
  double radius_;
  double bound_;
  std::vector<Candidate> candidates_;
};

std::vector<PointIndex::Neighbour> sorted(std::vector<Candidate>& candidates) {
  std::sort(candidates.begin(), candidates.end());
  std::vector<PointIndex::Neighbour> result;
  result.reserve(candidates.size());
  for (const Candidate& candidate : candidates) {
    result.push_back({candidate.index, std::sqrt(candidate.squared_distance)});
  }
  return result;
}

flann::SearchParams exact_search() {
  return flann::SearchParams(flann::FLANN_CHECKS_UNLIMITED, 0.0F, false);
}

}  // namespace

struct PointIndex::Implementation {
  Points points;
  std::unique_ptr<Tree> tree;  // none for no points
};

PointIndex::PointIndex(const Points& points) : implementation_(std::make_unique<Implementation>()) {
  implementation_->points = points;
  if (points.rows() == 0) return;
  const flann::Matrix<double> data(implementation_->points.data(), static_cast<std::size_t>(points.rows()), 3);
  implementation_->tree = std::make_unique<Tree>(data, flann::KDTreeSingleIndexParams(10, true));
  implementation_->tree->buildIndex();
}

PointIndex::~PointIndex() = default;
PointIndex::PointIndex(PointIndex&&) noexcept = default;
PointIndex& PointIndex::operator=(PointIndex&&) noexcept = default;

std::vector<PointIndex::Neighbour> PointIndex::nearest(const Eigen::Vector3d& point, int count) const {
  const auto available = static_cast<int>(implementation_->points.rows());
  if (available == 0 || count <= 0) return {};
  NearestSet set(static_cast<std::size_t>(std::min(count, available)));
  implementation_->tree->findNeighbors(set, point.data(), exact_search());
  return sorted(set.candidates());
}

std::vector<PointIndex::Neighbour> PointIndex::within(const Eigen::Vector3d& point, double radius) const {
  if (implementation_->points.rows() == 0 || !(radius >= 0)) return {};
  RadiusSet set(radius);
  implementation_->tree->findNeighbors(set, point.data(), exact_search());
  return sorted(set.candidates());
}

}  // namespace orbifit
