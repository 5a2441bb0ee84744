#include "orbifit/fitting/placement.h"

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

#include "orbifit/model/errors.h"

#include "base/random.h"
#include "placement/placement_data.h"
#include "placement/pose_comparison.h"
#include "placement/pose_hypotheses.h"
#include "placement/pose_score.h"
#include "placement/scan_symmetry.h"
#include "placement/surface_placements.h"
#include "placement/symmetry_hypotheses.h"
#include "registration/alignment.h"
#include "scan/scan_preparation.h"

namespace orbifit {

namespace {

constexpr std::size_t kMaxKept = 600;  // proposals that wait for their refinement
constexpr std::size_t kMaxReturned = 10;

/// Proposes poses, keeps those that explain most of the scan, and refines them.
class Search {
 public:
  Search(const PlacementData& data, const SymmetryAnnotation& annotation, const PlacementOptions& options,
         const RunContext& context)
      : data_(data),
        annotation_(annotation),
        options_(options),
        context_(context),
        score_(data, options),
        comparison_(data) {}

  std::vector<Placement> run(const std::optional<Similarity>& given) {
    std::vector<Proposal> proposals = propose();
    std::ranges::stable_sort(proposals, std::greater<>(), &Proposal::share);
    std::vector<Similarity> starts;
    if (given) starts.push_back(*given);
    for (const Proposal& each : proposals) {
      if (starts.size() >= static_cast<std::size_t>(options_.refined)) break;
      if (std::ranges::none_of(starts, [&](const Similarity& s) { return comparison_.alike(s, each.pose); })) {
        starts.push_back(each.pose);
      }
    }
    std::vector<Placement> found = refined(starts, 250, 14, 0.08);
    std::ranges::stable_sort(found, std::greater<>(), &Placement::score);
    std::vector<Similarity> best;
    for (const Placement& each : found) {
      if (best.size() >= kMaxReturned || !(each.score() > 0)) break;
      if (std::ranges::none_of(best, [&](const Similarity& s) { return comparison_.one(s, each.pose); })) {
        best.push_back(each.pose);
      }
    }
    found = refined(best, 800, 30, 0.04);
    std::ranges::stable_sort(found, std::greater<>(), &Placement::score);
    std::vector<Placement> result;
    for (const Placement& each : found) {
      const bool known =
          std::ranges::any_of(result, [&](const Placement& other) { return comparison_.one(other.pose, each.pose); });
      if (!known) result.push_back(each);
    }
    return result;
  }

 private:
  struct Proposal {
    Similarity pose;
    double share;
  };

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
            const std::optional<Similarity> pose = score_.at_known_scale(proposed);
            const double all = pose ? score_.judged(*pose, pool.bar) : 0;
            if (all > 0) found[i].push_back({*pose, all});
          });
        }
      });
      for (const auto& each : found) pool.add(each);
    }
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
    const SymmetryHypotheses hypotheses(data_.samples, template_symmetries(data_.surface.mesh(), annotation_));
    if (hypotheses.empty()) return;
    const std::vector<SymmetryElement> elements =
        scan_symmetries(data_.scan, data_.order, data_.seen, data_.extent, context_);
    constexpr std::size_t kTasks = kPoints / kInTask;
    const auto run = [&](std::size_t task, Random& random, const Take& take) {
      const SymmetryElement& element = elements[task / kTasks];
      for (std::size_t k = 0; k < kInTask; ++k) {
        const auto p = static_cast<Eigen::Index>(random.below(data_.order.size()));
        hypotheses.propose(element, data_.scan.points.row(p), data_.scan.normals.row(p), kMax, random, take);
      }
    };
    gather("placement by symmetry ", kTasks * elements.size(), run, pool);
  }

  void propose_by_pairs(Pool& pool) const {
    constexpr int kInTask = 64;
    const PoseHypotheses hypotheses(data_.samples);
    const auto run = [&](std::size_t task, Random& random, const Take& take) {
      const int begin = static_cast<int>(task) * kInTask;
      context_.progress("placement", 0.7 * begin / options_.pairs);
      for (int k = begin; k < std::min(begin + kInTask, options_.pairs); ++k) {
        const auto p = static_cast<Eigen::Index>(random.below(data_.order.size()));
        const auto q = static_cast<Eigen::Index>(random.below(data_.order.size()));
        const double apart = (data_.scan.points.row(p) - data_.scan.points.row(q)).norm();
        if (apart < 0.1 * data_.extent || apart > data_.extent) continue;
        hypotheses.propose(data_.scan.points.row(p), data_.scan.normals.row(p), data_.scan.points.row(q),
                           data_.scan.normals.row(q), options_.proposals, random, take);
      }
    };
    gather("placement by pairs ", static_cast<std::size_t>((options_.pairs + kInTask - 1) / kInTask), run, pool);
  }

  std::vector<Placement> refined(const std::vector<Similarity>& starts, std::size_t points, int iterations,
                                 double robust) const {
    const std::vector<int> of(data_.order.begin(),
                              data_.order.begin() + static_cast<std::ptrdiff_t>(std::min(points, data_.order.size())));
    std::vector<Placement> result(starts.size());
    RunContext own = context_;
    own.threads = 1;
    parallel_for(context_, starts.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        result[i].pose = align_with_scale(data_.surface, data_.scan, of, starts[i],
                                          {iterations, robust, 0.015, options_.scale.has_value()}, own);
        const Similarity back = inverse(result[i].pose);
        const double reach = score_.reach_of(result[i].pose);
        result[i].inlier_ratio = score_.closeness(back, reach / result[i].pose.scale, 1500);
        result[i].visible_coverage =
            data_.seen.coverage(data_.samples, data_.surface.index, result[i].pose, reach + 2 * data_.scan.spacing)
                .share();
      }
    });
    return result;
  }

  const PlacementData& data_;
  const SymmetryAnnotation& annotation_;
  const PlacementOptions& options_;
  const RunContext& context_;
  PoseScore score_;
  PoseComparison comparison_;
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
  const PlacementData data(surface, scan, prepare_scan(scan, preparation, context), context);
  return Search(data, annotation, options, context).run(given);
}

}  // namespace orbifit
