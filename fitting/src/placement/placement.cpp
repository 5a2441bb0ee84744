#include "orbifit/fitting/placement.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <string>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "orbifit/model/errors.h"

#include "base/random.h"
#include "geometry/sampling.h"
#include "placement/pose_hypotheses.h"
#include "placement/scan_symmetry.h"
#include "placement/surface_placements.h"
#include "placement/symmetry_hypotheses.h"
#include "placement/template_field.h"
#include "registration/alignment.h"
#include "registration/correspondences.h"
#include "scan/scan_preparation.h"
#include "scan/seen_surface.h"

namespace orbifit {

namespace {

using Eigen::Vector3d;

constexpr int kTemplateSamples = 450;
constexpr int kCells = 56;
constexpr double kNormalCosine = 0.7;
constexpr std::size_t kMaxKept = 600;  // proposals that wait for their refinement
constexpr std::size_t kMaxReturned = 10;

/// A template and a scan, with what it takes to judge poses fast.
class Search {
 public:
  Search(const MatchSurface& surface, const SymmetryAnnotation& annotation, const PointCloud& cloud, PreparedScan scan,
         const PlacementOptions& options, const RunContext& context)
      : mesh_(surface.mesh()),
        annotation_(annotation),
        scan_(std::move(scan)),
        options_(options),
        context_(context),
        random_(context.seed, "placement"),
        size_(diagonal(mesh_.vertices)),
        samples_(sample_surface(mesh_, kTemplateSamples, random_)),
        surface_(surface),
        field_(mesh_, surface_.index, kCells, context),
        extent_(scan_extent()),
        seen_(cloud, scan_.points) {
    // The points in an order of which every beginning is spread over the scan.
    order_.resize(static_cast<std::size_t>(scan_.points.rows()));
    std::iota(order_.begin(), order_.end(), 0);
    for (std::size_t i = order_.size(); i > 1; --i) std::swap(order_[i - 1], order_[random_.below(i)]);
  }

  std::vector<Placement> run(const std::optional<Similarity>& given) {
    std::vector<Proposal> proposals = propose();
    std::ranges::stable_sort(proposals, std::greater<>(), &Proposal::share);
    std::vector<Similarity> starts;
    if (given) starts.push_back(*given);
    for (const Proposal& each : proposals) {
      if (starts.size() >= static_cast<std::size_t>(options_.refined)) break;
      if (std::ranges::none_of(starts, [&](const Similarity& s) { return alike(s, each.pose); })) {
        starts.push_back(each.pose);
      }
    }
    std::vector<Placement> found = refined(starts, 250, 14, 0.08);
    std::ranges::stable_sort(found, std::greater<>(), &Placement::score);
    std::vector<Similarity> best;
    for (const Placement& each : found) {
      if (best.size() >= kMaxReturned || !(each.score() > 0)) break;
      if (std::ranges::none_of(best, [&](const Similarity& s) { return one(s, each.pose); })) {
        best.push_back(each.pose);
      }
    }
    found = refined(best, 800, 30, 0.04);
    std::ranges::stable_sort(found, std::greater<>(), &Placement::score);
    std::vector<Placement> result;
    for (const Placement& each : found) {
      const bool known =
          std::ranges::any_of(result, [&](const Placement& other) { return one(other.pose, each.pose); });
      if (!known) result.push_back(each);
    }
    return result;
  }

 private:
  static constexpr double kAlike = 0.06;  // of the diagonal, mean distance: before they are refined
  static constexpr double kSame = 0.02;   // and after

  struct Proposal {
    Similarity pose;
    double share;
  };

  bool explains(const Similarity& back, int point, double reach) const {
    const TemplateField::Value* value = field_.at(back(scan_.points.row(point)));
    if (value == nullptr || value->distance > reach) return false;
    const Vector3d normal = back.linear * scan_.normals.row(point).transpose();
    return std::abs(value->normal.cast<double>().dot(normal)) >= kNormalCosine;
  }

  // The share of the first `count` points that the pose explains; gives up where it cannot reach `least`.
  double share(const Similarity& back, std::size_t count, double reach, double least) const {
    count = std::min(count, order_.size());
    const double most = static_cast<double>(count);
    std::size_t hits = 0;
    for (std::size_t i = 0; i < count; ++i) {
      hits += explains(back, order_[i], reach) ? 1U : 0U;
      if (static_cast<double>(hits + count - 1 - i) < least * most) return 0;
    }
    return static_cast<double>(hits) / most;
  }

  // Scan units. A template far larger than the scan must not explain everything that is anywhere near.
  double reach_of(const Similarity& pose) const {
    constexpr double kOfScan = 0.6;
    return options_.reach * std::min(size_ * pose.scale, kOfScan * extent_);
  }

  // The mean over some points of 1 - (distance / reach)^2, 0 where nothing with a like normal is in reach.
  double closeness(const Similarity& back, double reach, std::size_t count) const {
    count = std::min(count, order_.size());
    double sum = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const Vector3d normal = back.linear * scan_.normals.row(order_[i]).transpose();
      const auto near =
          surface_.index.nearest_facing(back(scan_.points.row(order_[i])), normal, kNormalCosine, reach, true);
      if (near.face >= 0) sum += 1 - (near.distance / reach) * (near.distance / reach);
    }
    return sum / static_cast<double>(count);
  }

  /// The best proposals so far.
  struct Pool {
    std::vector<Proposal> kept;
    double bar = 0.2;  // what a proposal must explain to be kept; rises as better ones come

    void add(const std::vector<Proposal>& more) {
      kept.insert(kept.end(), more.begin(), more.end());
      if (kept.size() < 2 * kMaxKept) return;
      std::ranges::stable_sort(kept, std::greater<>(), &Proposal::share);
      kept.resize(kMaxKept);
      bar = std::max(bar, kept.back().share);
    }
  };

  using Take = std::function<void(const Similarity&)>;

  // Runs `tasks` tasks that propose poses, and keeps the best. A task's random numbers are its own, and the bar rises
  // after a number of tasks that does not depend on the number of threads.
  void gather(const std::string& source, std::size_t tasks,
              const std::function<void(std::size_t task, Random& random, const Take& take)>& run, Pool& pool) const {
    constexpr std::size_t kAtOnce = 8;
    for (std::size_t first = 0; first < tasks; first += kAtOnce) {
      std::vector<std::vector<Proposal>> found(std::min(kAtOnce, tasks - first));
      parallel_for(context_, found.size(), [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          Random random(context_.seed, source + std::to_string(first + i));
          run(first + i, random, [&](const Similarity& proposed) {
            const std::optional<Similarity> pose = at_known_scale(proposed);
            const double all = pose ? judged(*pose, pool.bar) : 0;
            if (all > 0) found[i].push_back({*pose, all});
          });
        }
      });
      for (const auto& each : found) pool.add(each);
    }
  }

  // Where the scale is known, the pose at that one, if it was proposed at much the same.
  std::optional<Similarity> at_known_scale(const Similarity& pose) const {
    constexpr double kMuchTheSame = 0.2;  // of its logarithm: how far lengths of shapes of one kind differ
    if (!options_.scale) return pose;
    if (std::abs(std::log(pose.scale / *options_.scale)) > kMuchTheSame) return std::nullopt;
    return rescaled(pose, *options_.scale, mesh_);
  }

  // The share of the points that a pose explains; 0 below the bar, and for scales that are not allowed.
  double judged(const Similarity& pose, double bar) const {
    const double relative = pose.scale * size_ / extent_;
    if (relative < options_.min_scale || relative > options_.max_scale) return 0;
    const Similarity back = inverse(pose);
    const double reach = reach_of(pose) / pose.scale;
    if (share(back, 24, reach, 0.7 * bar) <= 0 || share(back, 80, reach, 0.9 * bar) <= 0) return 0;
    return share(back, 300, reach, bar);
  }

  std::vector<Proposal> propose() const {
    Pool pool;
    propose_by_symmetry(pool);
    propose_by_pairs(pool);
    return pool.kept;
  }

  // The template's planes and axes onto those that the scan shows.
  void propose_by_symmetry(Pool& pool) const {
    constexpr std::size_t kPoints = 400;  // of the scan, for each of its planes and axes
    constexpr std::size_t kInTask = 50;
    constexpr int kMax = 12;  // poses for each of them and of the template's planes or axes
    const SymmetryHypotheses hypotheses(samples_, template_symmetries(mesh_, annotation_));
    if (hypotheses.empty()) return;
    const std::vector<SymmetryElement> elements = scan_symmetries(scan_, order_, seen_, extent_, context_);
    constexpr std::size_t kTasks = kPoints / kInTask;
    const auto run = [&](std::size_t task, Random& random, const Take& take) {
      const SymmetryElement& element = elements[task / kTasks];
      for (std::size_t k = 0; k < kInTask; ++k) {
        const auto p = static_cast<Eigen::Index>(random.below(order_.size()));
        hypotheses.propose(element, scan_.points.row(p), scan_.normals.row(p), kMax, random, take);
      }
    };
    gather("placement by symmetry ", kTasks * elements.size(), run, pool);
  }

  void propose_by_pairs(Pool& pool) const {
    constexpr int kInTask = 64;
    const PoseHypotheses hypotheses(samples_);
    const auto run = [&](std::size_t task, Random& random, const Take& take) {
      const int begin = static_cast<int>(task) * kInTask;
      context_.progress("placement", 0.7 * begin / options_.pairs);
      for (int k = begin; k < std::min(begin + kInTask, options_.pairs); ++k) {
        const auto p = static_cast<Eigen::Index>(random.below(order_.size()));
        const auto q = static_cast<Eigen::Index>(random.below(order_.size()));
        const double apart = (scan_.points.row(p) - scan_.points.row(q)).norm();
        if (apart < 0.1 * extent_ || apart > extent_) continue;
        hypotheses.propose(scan_.points.row(p), scan_.normals.row(p), scan_.points.row(q), scan_.normals.row(q),
                           options_.proposals, random, take);
      }
    };
    gather("placement by pairs ", static_cast<std::size_t>((options_.pairs + kInTask - 1) / kInTask), run, pool);
  }

  // The diagonal of the box that holds nearly all points along each axis.
  double scan_extent() const {
    constexpr double kOutside = 0.03;
    Vector3d extent;
    for (int k = 0; k < 3; ++k) {
      std::vector<double> at(scan_.points.col(k).begin(), scan_.points.col(k).end());
      std::ranges::sort(at);
      const auto off = static_cast<std::size_t>(kOutside * static_cast<double>(at.size()));
      extent[k] = at[at.size() - 1 - off] - at[off];
    }
    return extent.norm();
  }

  // Whether ICP will bring two proposals to one pose, or to two that a symmetry of the template makes one.
  bool alike(const Similarity& a, const Similarity& b) const {
    constexpr double kTurn = 0.4;  // radians
    constexpr double kItself = 0.015;
    if (!same(a, b, kAlike)) return false;
    return axis_angle(a.linear * b.linear.transpose()).angle < kTurn || same(a, b, kItself);
  }

  // Whether two refined poses are one: nearly the same motion, or another by one of the template's symmetries, under
  // which it comes to lie on itself more closely than the ICP is exact.
  bool one(const Similarity& a, const Similarity& b) const {
    constexpr double kTurn = 0.17;  // radians
    constexpr double kItself = 0.004;
    if (!same(a, b, kSame)) return false;
    return axis_angle(a.linear * b.linear.transpose()).angle < kTurn || same(a, b, kItself);
  }

  // Whether two poses bring the template to the same place, in the mean over its surface: the field tells it to a cell.
  bool same(const Similarity& a, const Similarity& b, double tolerance) const {
    constexpr double kOfField = 0.02;
    if (std::abs(std::log(a.scale / b.scale)) > 4 * tolerance) return false;
    constexpr Eigen::Index kLooks = 128;
    const Similarity back = inverse(b);
    double sum = 0;
    for (Eigen::Index i = 0; i < kLooks; ++i) {
      const Vector3d point = back(a(samples_.points.row(i * samples_.points.rows() / kLooks)));
      const TemplateField::Value* value = field_.at(point);
      if (tolerance < kOfField) {
        sum += surface_.index.nearest(point).distance / size_;
      } else {
        sum += value == nullptr ? 0.2 : value->distance / size_;
      }
      if (sum > tolerance * kLooks) return false;
    }
    return true;
  }

  std::vector<Placement> refined(const std::vector<Similarity>& starts, std::size_t points, int iterations,
                                 double robust) const {
    const std::vector<int> of(order_.begin(),
                              order_.begin() + static_cast<std::ptrdiff_t>(std::min(points, order_.size())));
    std::vector<Placement> result(starts.size());
    parallel_for(context_, starts.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        result[i].pose =
            align_with_scale(surface_, scan_, of, starts[i], {iterations, robust, 0.015, options_.scale.has_value()});
        const Similarity back = inverse(result[i].pose);
        const double reach = reach_of(result[i].pose);
        result[i].inlier_ratio = closeness(back, reach / result[i].pose.scale, 1500);
        result[i].visible_coverage =
            seen_.coverage(samples_, surface_.index, result[i].pose, reach + 2 * scan_.spacing).share();
      }
    });
    return result;
  }

  const Mesh& mesh_;
  const SymmetryAnnotation& annotation_;
  PreparedScan scan_;
  const PlacementOptions& options_;
  const RunContext& context_;
  Random random_;
  double size_;
  SurfaceSamples samples_;
  const MatchSurface& surface_;
  TemplateField field_;
  double extent_;  // of the scan, scan units
  SeenSurface seen_;
  std::vector<int> order_;
};

}  // namespace

void PlacementOptions::validate() const {
  require(!scale || *scale > 0, "PlacementOptions.scale", scale.value_or(1), "positive");
  require(pairs >= 1, "PlacementOptions.pairs", pairs, "at least 1");
  require(proposals >= 1, "PlacementOptions.proposals", proposals, "at least 1");
  require(scan_points >= 10, "PlacementOptions.scan_points", scan_points, "at least 10");
  require(refined >= 1, "PlacementOptions.refined", refined, "at least 1");
  require(reach > 0 && reach < 0.2, "PlacementOptions.reach", reach, "in (0, 0.2)");
  require(min_scale > 0, "PlacementOptions.min_scale", min_scale, "positive");
  require(max_scale > min_scale, "PlacementOptions.max_scale", max_scale, "more than min_scale");
}

std::vector<Placement> find_placements(const Mesh& mesh, const SymmetryAnnotation& annotation, const PointCloud& scan,
                                       const PlacementOptions& options, const RunContext& context,
                                       const std::optional<Similarity>& given) {
  return find_placements(MatchSurface(mesh), annotation, scan, options, context, given);
}

std::vector<Placement> find_placements(const MatchSurface& surface, const SymmetryAnnotation& annotation,
                                       const PointCloud& scan, const PlacementOptions& options,
                                       const RunContext& context, const std::optional<Similarity>& given) {
  options.validate();
  ScanPreparationOptions preparation;
  preparation.most_points = options.scan_points;
  preparation.evenly = false;  // a floor of few points is not to outweigh the shape that stands on it
  return Search(surface, annotation, scan, prepare_scan(scan, preparation, context), options, context).run(given);
}

}  // namespace orbifit
