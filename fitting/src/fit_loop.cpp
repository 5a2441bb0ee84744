#include "fit_loop.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "registration/alignment.h"
#include "stage_clock.h"

namespace orbifit {

namespace {

constexpr double kFirstReach = 0.15;  // of the diagonal: correspondences farther apart are none, at the start
// Offsets far above the robust scale hardly count. It shrinks last: parts that the soft template has yet to reach
// would be taken for outliers. Fractions of the diagonal: at the start, when softest, and at the end.
constexpr double kFirstRobust = 0.05;
constexpr double kSoftRobust = 0.02;
constexpr std::array<double, 3> kConverging{0.02, 0.012, kLastRobust};
// The energy weighs data of this noise, a fraction of the diagonal, as the least stiffness is meant for; noisier data
// count by the inverse of their variance, up to a share of the first stiffness. What is left unexplained where the
// stiffness has fallen so far tells of noise that neighbours share, which is not seen among them.
constexpr double kLittleNoise = 0.001;
constexpr double kStiffest = 0.05;
constexpr double kSilhouetteFrom = 0.3;  // of the levels: the pose is known by then
constexpr double kStill = 1e-4;          // of the diagonal: the fit has converged when no sample moves more,
constexpr double kGain = 0.02;           // or when a step lowers the energy by less than this share;
constexpr double kLastGain = 0.002;      // in the end
constexpr double kDamping = 1e-3;        // of one sample's share of the data
constexpr int kScheduledPoints = 1300;   // of the scan that are looked at, at least, while the stiffness falls
constexpr const char* kUsedUp = "the iterations allowed are used up";

}  // namespace

FitLoop::FitLoop(const FitInput& input, const PlacedScan& start, DeformationSystem& system, const FitOptions& options,
                 const RunContext& context)
    : input_(input),
      start_(start),
      scan_(start.scan),
      views_(*start.views),
      system_(system),
      options_(options),
      context_(context),
      size_(diagonal(input.mesh.vertices)),
      centre_(bounding_box_centre(input.mesh.vertices)),
      deformed_(input.mesh),
      surface_(moving_template(start, deformed_)) {}

FitLoop::Stage FitLoop::stage(int iteration) const {
  Stage now;
  const int level = iteration / options_.iterations;
  now.progress = std::min(1.0, static_cast<double>(level) / std::max(1, options_.levels - 1));
  now.every = std::max(1, static_cast<int>(scan_.points.rows()) / kScheduledPoints);
  const double falling = options_.first_stiffness * std::pow(last_stiffness_ / options_.first_stiffness, now.progress);
  now.stiffness = std::max(falling, least_stiffness_);
  now.robust = kFirstRobust * std::pow(kSoftRobust / kFirstRobust, now.progress) * size_;
  return now;
}

double FitLoop::stiffness_for(double noise) const {
  const double most = std::max(options_.last_stiffness, kStiffest * options_.first_stiffness);
  const double ratio = noise / kLittleNoise;
  const double warranted = std::clamp(options_.last_stiffness * ratio * ratio, options_.last_stiffness, most);
  return std::max(warranted, options_.least_stiffness);
}

FitLoop::Matches FitLoop::match(const FitState& state, const Stage& now) {
  CorrespondenceOptions options;
  options.max_distance = reach_of(now);
  options.signed_normals = views_.signed_normals;
  // Far points are left out while the template is far; in the end the robust weights judge each by itself.
  options.trim = options_.trim + (1 - options_.trim) * now.progress;
  options.never_trim = 0.005 * size_;
  options.direction_noise = kDirectionNoise * size_;
  const double robust = unit(state) * now.robust;
  options.robust_scale = robust;
  options.every = now.every;
  Matches result;
  add_pulls(state, now, result);
  const bool several = !state.others.empty();
  const PreparedScan put = several ? with_others_moved(start_, state.others) : PreparedScan{};
  result.points = to_template(state.pose, several ? put.points : scan_.points);
  const Points normals = normals_to_template(state.pose, several ? put.normals : scan_.normals);
  result.pairs = find_correspondences(surface_, result.points, normals, options, context_, &likely_);
  if (!start_.held_out.empty()) {
    std::erase_if(result.pairs, [&](const Correspondence& pair) {
      return start_.held_out[static_cast<std::size_t>(pair.scan_point)] != 0;
    });
  }
  result.of_scan = static_cast<int>(result.pairs.size());
  result.rms = weighted_rms(result.pairs) / size_;
  result.spread = typical_distance(result.pairs) / size_;
  // Each point looked at stands for those that are not.
  const auto looked_at = (scan_.points.rows() + now.every - 1) / now.every;
  result.energy = static_cast<double>(looked_at - result.of_scan) * robust * robust;
  for (Correspondence& pair : result.pairs) {
    result.energy += robust_error(pair.distance, robust);
    pair.weight *= now.every;
  }
  result.energy *= now.every;
  if (now.progress >= kSilhouetteFrom && views_.silhouette.knows_viewpoints()) {
    if (!cut_off_) cut_off_ = views_.silhouette.cut_off(deformed_, surface_, state.pose, context_);
    if (!*cut_off_) {
      result.energy +=
          views_.silhouette.add(deformed_, surface_, result.points, state.pose, robust, result.pairs, context_);
    }
  }
  if (several && now.others_open) {
    for (Correspondence& pair : result.pairs) pair.view = start_.view_of[static_cast<std::size_t>(pair.scan_point)];
  }
  return result;
}

// All pairs together weigh as many as there are samples.
double FitLoop::share_of(const Matches& matches, int every) const {
  const double silhouettes = static_cast<double>(matches.pairs.size()) - matches.of_scan;
  return static_cast<double>(system_.samples()) / std::max(1.0, every * matches.of_scan + silhouettes);
}

double FitLoop::reach_of(const Stage& now) const {
  return (kFirstReach + (kLastReach - kFirstReach) * now.progress) * size_;
}

void FitLoop::add_pulls(const FitState& state, const Stage& now, Matches& matches) const {
  matches.pulls = pulls_towards(input_, state.pose, options_.landmark_weight);
  for (std::size_t i = 0; i < matches.pulls.size(); ++i) {
    Pull& pull = matches.pulls[i];
    const double distance = (deformed_.vertices.row(pull.vertex).transpose() - pull.target).norm();
    const bool landmark = i < input_.landmarks.size();
    matches.pull_energy += pull.weight * (landmark ? robust_error(distance, reach_of(now)) : distance * distance);
    if (landmark) pull.weight *= robust_weight(distance, reach_of(now));
  }
}

double FitLoop::energy(const FitState& state, const Matches& matches, double share, const Stage& now) const {
  const double regularity = system_.regularity(state.q) + system_.growth_cost(std::log(unit(state)));
  const double result = share * matches.energy + matches.pull_energy + now.stiffness * regularity +
                        system_.symmetry_energy(state.q) +
                        contact_share(now.stiffness) * system_.contact_energy(state.q);
  return result / (unit(state) * unit(state));
}

void FitLoop::move_to(const FitState& state) {
  system_.rotate(state.q);
  deformed_.vertices = input_.mesh.vertices + system_.vertices_at(state.q, context_);
  surface_.move(deformed_, context_);
}

void FitLoop::step(FitState& state, const Matches& matches, const Stage& now, double share, double damping,
                   FitIteration& record) {
  const DeformationSystem::Hold hold{now.stiffness,
                                     damping,
                                     state.q,
                                     now.scale_open,
                                     -std::log(unit(state)),
                                     now.others_open ? static_cast<int>(state.others.size()) : 0};
  const DeformationSystem::Solution solution =
      system_.solve(matches.pairs, share, matches.points, matches.pulls, hold, context_);
  const Points before = system_.samples_at(state.q);
  state.q = solution.q;
  for (std::size_t k = 0; k < solution.other_steps.size(); ++k) {
    state.others[k] = conjugate(state.pose, solution.other_steps[k]) * state.others[k];
  }
  const Motion back = inverse(solution.scan_step);
  state.pose = state.pose * Similarity{1, back.linear, back.translation} *
               Similarity{solution.growth, Eigen::Matrix3d::Identity(), (1 - solution.growth) * centre_};
  move_to(state);
  record.damping = damping;
  record.change = (system_.samples_at(state.q) - before).rowwise().norm().maxCoeff() / size_;
  if (input_.watch) input_.watch(record, state.pose, deformed_.vertices);
}

FitIteration FitLoop::record_of(const Matches& matches, const Stage& now, double energy) const {
  FitIteration record;
  record.stiffness = now.stiffness;
  record.correspondences = matches.of_scan;
  record.rms = matches.rms;
  record.energy = energy / (static_cast<double>(system_.samples()) * size_ * size_);
  return record;
}

FitLoop::Minimum FitLoop::minimise(FitState& state, const Stage& now, double gain,
                                   std::vector<FitIteration>& iterations) {
  struct Best {
    FitState state;
    DeformationSystem::Rotations rotations;
    Matches matches;
    double energy;
  };
  std::optional<Best> best;
  double share = 0;
  Minimum result{kUsedUp};
  while (static_cast<int>(iterations.size()) < options_.max_iterations) {
    context_.progress("fit", double(iterations.size()) / options_.max_iterations);
    const Stopwatch clock;
    Matches matches = match(state, now);
    if (!best) share = share_of(matches, now.every);  // the same from then on: energies are compared
    const double energy_now = energy(state, matches, share, now);
    iterations.push_back(record_of(matches, now, energy_now));
    if (best) result.gained = 1 - energy_now / best->energy;
    const bool stalled = best && !(result.gained > gain);
    if (!best || energy_now < best->energy) best = Best{state, system_.rotations(), std::move(matches), energy_now};
    if (stalled) {
      iterations.back().seconds = clock.seconds();
      result.reason = "converged: the energy no longer falls";
      break;
    }
    step(state, best->matches, now, share, kDamping, iterations.back());
    iterations.back().seconds = clock.seconds();
    if (iterations.back().change < kStill) {
      result.reason = "converged: no sample moves by more than 0.01 % of the diagonal";
      break;
    }
  }
  if (!best) return result;
  result.spread = best->matches.spread;
  state = best->state;
  move_to(state);
  system_.set_rotations(best->rotations);
  return result;
}

std::string FitLoop::run(FitState& state, int first_level, bool scale_open, std::vector<FitIteration>& iterations) {
  first_scale_ = state.pose.scale;
  state.others.resize(start_.others.size());
  move_to(state);
  last_stiffness_ = stiffness_for(scan_.noise / (state.pose.scale * size_));
  Stage now = stage(first_level * options_.iterations);
  for (int i = first_level * options_.iterations; i < options_.levels * options_.iterations; ++i) {
    context_.progress("fit", double(i) / options_.max_iterations);
    const Stopwatch clock;
    now = stage(i);
    const Matches matches = match(state, now);
    if (matches.pairs.empty() && input_.landmarks.empty() && input_.handles.empty()) {
      return "no point of the scan lies near the template";
    }
    const double share = share_of(matches, now.every);
    iterations.push_back(record_of(matches, now, energy(state, matches, share, now)));
    least_stiffness_ = stiffness_for(matches.spread);
    step(state, matches, now, share, 0, iterations.back());
    iterations.back().seconds = clock.seconds();
  }
  std::string reason = kUsedUp;
  now.every = 1;
  now.scale_open = scale_open;
  now.others_open = true;
  if (first_level >= options_.levels) return go_on(state, now, iterations);
  Minimum reached;
  for (const double robust : kConverging) {
    now.robust = robust * size_;
    // Converged once, the fit has reached what it had left unexplained for being on its way.
    if (robust == kConverging[1]) now.stiffness = std::min(now.stiffness, stiffness_for(reached.spread));
    reached = minimise(state, now, robust == kConverging.back() ? kLastGain : kGain, iterations);
  }
  return reached.reason;
}

std::string FitLoop::go_on(FitState& state, Stage now, std::vector<FitIteration>& iterations) {
  now.robust = kLastRobust * size_;
  now.stiffness = std::max(last_stiffness_, stiffness_for(match(state, now).spread));
  Minimum reached = minimise(state, now, kGain, iterations);
  const double warranted = stiffness_for(reached.spread);
  const bool softer = warranted < now.stiffness;
  if (!softer && reached.gained <= kLastGain) return reached.reason;
  now.stiffness = std::min(now.stiffness, warranted);
  return minimise(state, now, kLastGain, iterations).reason;
}

}  // namespace orbifit
