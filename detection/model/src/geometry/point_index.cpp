#include "geometry/point_index.h"

#include <algorithm>
#include <cmath>
#include <limits>

#ifdef ORBIFIT_PORTABLE
#include <nanoflann.hpp>
#else
#include <flann/flann.hpp>
#endif

namespace orbifit {

namespace {

constexpr int kLeaf = 10;  // points of the tree's leaves

#ifdef ORBIFIT_PORTABLE

// Where FLANN is not; the searches below are written for FLANN's interface.
struct PointsView {
  const Points& points;

  std::size_t kdtree_get_point_count() const { return static_cast<std::size_t>(points.rows()); }
  double kdtree_get_pt(std::size_t row, std::size_t column) const {
    return points(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column));
  }
  template <class Box>
  bool kdtree_get_bbox(Box& /*box*/) const {
    return false;
  }
};

class Tree {
 public:
  explicit Tree(const Points& points)
      : view_{points}, tree_(3, view_, nanoflann::KDTreeSingleIndexAdaptorParams(kLeaf)) {
    tree_.buildIndex();
  }

  template <class Set>
  void search(Set& set, const double* point) const {
    Results<Set> results{set};
    tree_.findNeighbors(results, point, nanoflann::SearchParams());
  }

 private:
  template <class Set>
  struct Results {
    using DistanceType = double;
    Set& set;

    double worstDist() const { return set.worstDist(); }
    bool full() const { return set.full(); }
    bool addPoint(double squared_distance, std::size_t index) {
      set.addPoint(squared_distance, index);
      return true;
    }
  };
  using Metric = nanoflann::L2_Simple_Adaptor<double, PointsView>;

  PointsView view_;
  nanoflann::KDTreeSingleIndexAdaptor<Metric, PointsView, 3, std::size_t> tree_;
};

struct ResultSet {
  virtual ~ResultSet() = default;
  virtual bool full() const = 0;
  virtual void addPoint(double squared_distance, std::size_t index) = 0;
  virtual double worstDist() const = 0;
};

#else

using ResultSet = flann::ResultSet<double>;

class Tree {
 public:
  explicit Tree(Points& points)
      : tree_(flann::Matrix<double>(points.data(), static_cast<std::size_t>(points.rows()), 3),
              flann::KDTreeSingleIndexParams(kLeaf, true)) {
    tree_.buildIndex();
  }

  void search(ResultSet& set, const double* point) const {
    tree_.findNeighbors(set, point, flann::SearchParams(flann::FLANN_CHECKS_UNLIMITED, 0.0F, false));
  }

 private:
  flann::KDTreeSingleIndex<flann::L2_Simple<double> > tree_;
};

#endif

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
class NearestSet : public ResultSet {
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

// Likewise of one, which needs no list.
class NearestOne : public ResultSet {
 public:
  bool full() const override { return best_.index >= 0; }

  void addPoint(double squared_distance, std::size_t index) override {
    const Candidate candidate{squared_distance, static_cast<int>(index)};
    if (full() && !(candidate < best_)) return;
    best_ = candidate;
    bound_ = squared_distance * kSlack + std::numeric_limits<double>::denorm_min();
  }

  double worstDist() const override { return bound_; }

  const Candidate& best() const { return best_; }

 private:
  double bound_ = std::numeric_limits<double>::infinity();
  Candidate best_{0, -1};
};

class RadiusSet : public ResultSet {
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

// Whether there is any within the radius: nothing is near enough once there is.
class AnySet : public ResultSet {
 public:
  explicit AnySet(double radius)
      : radius_(radius), bound_(radius * radius * kSlack + std::numeric_limits<double>::denorm_min()) {}

  bool full() const override { return true; }

  void addPoint(double squared_distance, std::size_t) override {
    if (!(std::sqrt(squared_distance) <= radius_)) return;
    found_ = true;
    bound_ = -1;
  }

  double worstDist() const override { return bound_; }

  bool found() const { return found_; }

 private:
  double radius_;
  double bound_;
  bool found_ = false;
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

}  // namespace

struct PointIndex::Implementation {
  Points points;
  std::unique_ptr<Tree> tree;  // none for no points
};

PointIndex::PointIndex(const Points& points) : implementation_(std::make_unique<Implementation>()) {
  implementation_->points = points;
  if (points.rows() == 0) return;
  implementation_->tree = std::make_unique<Tree>(implementation_->points);
}

PointIndex::~PointIndex() = default;
PointIndex::PointIndex(PointIndex&&) noexcept = default;
PointIndex& PointIndex::operator=(PointIndex&&) noexcept = default;

std::vector<PointIndex::Neighbour> PointIndex::nearest(const Eigen::Vector3d& point, int count) const {
  const auto available = static_cast<int>(implementation_->points.rows());
  if (available == 0 || count <= 0) return {};
  NearestSet set(static_cast<std::size_t>(std::min(count, available)));
  implementation_->tree->search(set, point.data());
  return sorted(set.candidates());
}

PointIndex::Neighbour PointIndex::nearest(const Eigen::Vector3d& point) const {
  if (implementation_->points.rows() == 0) return {};
  NearestOne set;
  implementation_->tree->search(set, point.data());
  return {set.best().index, std::sqrt(set.best().squared_distance)};
}

bool PointIndex::any_within(const Eigen::Vector3d& point, double radius) const {
  if (implementation_->points.rows() == 0 || !(radius >= 0)) return false;
  AnySet set(radius);
  implementation_->tree->search(set, point.data());
  return set.found();
}

std::vector<PointIndex::Neighbour> PointIndex::within(const Eigen::Vector3d& point, double radius) const {
  if (implementation_->points.rows() == 0 || !(radius >= 0)) return {};
  RadiusSet set(radius);
  implementation_->tree->search(set, point.data());
  return sorted(set.candidates());
}

}  // namespace orbifit
