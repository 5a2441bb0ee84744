#include "group/verification.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <numeric>

#include "surface/thresholds.h"

namespace orbifit {

namespace {

using Eigen::Vector3d;

constexpr int kContinuousAngles = 20;
constexpr double kFarOff = 2;  // tolerances

Vector3d row(const Points& points, std::size_t i) {
  return points.row(static_cast<Eigen::Index>(i));
}

bool on_surface(const SurfacePatch& patch, const Motion& motion, const SurfaceSamples& samples, bool at_crease,
                std::size_t sample, double tolerance) {
  const Vector3d image = motion(row(samples.points, sample));
  if (at_crease) return patch.index->within(image, tolerance);
  const Vector3d normal = motion.linear * row(samples.normals, sample);
  return patch.index->within_facing(image, normal, kAlikeNormals, tolerance);
}

bool keeps(const SurfacePatch& patch, const Motion& motion, std::size_t sample, double tolerance) {
  return on_surface(patch, motion, patch.samples, patch.at_crease[sample] != 0, sample, tolerance);
}

// Of the part that fares worst under one of the motions, the share that it keeps near the surface.
double worst_part(const SurfacePatch& patch, const std::vector<Motion>& motions, double tolerance) {
  constexpr std::size_t kSamples = SurfacePatch::kPartSamples;
  std::size_t least = kSamples;
  for (std::size_t first = 0; first + kSamples <= patch.part_at_crease.size(); first += kSamples) {
    for (const Motion& motion : motions) {
      std::size_t kept = 0;
      for (std::size_t s = first; s < first + kSamples; ++s) {
        if (on_surface(patch, motion, patch.part_samples, patch.part_at_crease[s] != 0, s, tolerance)) ++kept;
      }
      least = std::min(least, kept);
    }
  }
  return static_cast<double>(least) / static_cast<double>(kSamples);
}

// Numbers of `count` samples spread evenly; an odd stride through the strata keeps every prefix spread as well.
std::vector<std::size_t> spread(std::size_t total, int count) {
  const std::size_t wanted = count <= 0 ? total : std::min(total, static_cast<std::size_t>(count));
  std::vector<std::size_t> result(wanted);
  if (wanted == 0) return result;
  // Golden-section stepping visits all residues when the step is coprime to the total.
  std::size_t step = std::max<std::size_t>(1, static_cast<std::size_t>(static_cast<double>(total) / std::numbers::phi));
  while (std::gcd(step, total) != 1) ++step;
  for (std::size_t i = 0; i < wanted; ++i) result[i] = (i * step) % total;
  return result;
}

// Share of the largest set of far-off samples linked by steps of a few sample spacings.
double largest_blot(const SurfacePatch& patch, const std::vector<std::size_t>& far_off, std::size_t seen) {
  if (far_off.empty()) return 0;
  const double link = 2.5 * std::sqrt(patch.moments.area / static_cast<double>(seen));
  std::vector<std::size_t> open(far_off);
  std::size_t largest = 0;
  while (!open.empty()) {
    std::vector<std::size_t> blot{open.back()};
    open.pop_back();
    for (std::size_t i = 0; i < blot.size(); ++i) {
      const Vector3d here = row(patch.samples.points, blot[i]);
      const auto linked = [&](std::size_t s) { return (row(patch.samples.points, s) - here).norm() <= link; };
      const auto rest = std::stable_partition(open.begin(), open.end(), [&](std::size_t s) { return !linked(s); });
      blot.insert(blot.end(), rest, open.end());
      open.erase(rest, open.end());
    }
    largest = std::max(largest, blot.size());
  }
  return static_cast<double>(largest) / static_cast<double>(seen);
}

// What the samples tested so far say.
struct Tested {
  Tested(std::size_t samples, std::size_t motions) : kept(samples, 1), thrown(samples, 0), kept_by_motion(motions, 0) {}

  // Share of the samples that all motions keep.
  double joint() const {
    return static_cast<double>(std::count(kept.begin(), kept.begin() + static_cast<std::ptrdiff_t>(done), 1)) /
           static_cast<double>(done);
  }

  std::size_t done = 0;
  std::vector<char> kept, thrown;  // by all motions; far off by some
  std::vector<std::size_t> kept_by_motion;
};

// Tests the samples from those done up to `end`.
void test_block(const SurfacePatch& patch, const std::vector<Motion>& motions, double tolerance,
                const std::vector<std::size_t>& chosen, std::size_t end, const RunContext& context, Tested& tested) {
  constexpr std::size_t kWorthThreads = 300;  // queries
  const std::size_t count = end - tested.done;
  std::vector<char> hits(count * motions.size(), 0);
  const auto test = [&](std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < to; ++i) {
      const std::size_t at = tested.done + i;
      for (std::size_t m = 0; m < motions.size(); ++m) {
        const bool hit = keeps(patch, motions[m], chosen[at], tolerance);
        hits[i * motions.size() + m] = hit ? 1 : 0;
        if (hit) continue;
        tested.kept[at] = 0;
        if (tested.thrown[at] == 0 && !keeps(patch, motions[m], chosen[at], kFarOff * tolerance)) tested.thrown[at] = 1;
      }
    }
  };
  if (hits.size() < kWorthThreads) {
    test(0, count);
  } else {
    parallel_for(context, count, test);
  }
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t m = 0; m < motions.size(); ++m) {
      tested.kept_by_motion[m] += hits[i * motions.size() + m] != 0 ? 1U : 0U;
    }
  }
  tested.done = end;
}

}  // namespace

std::vector<Motion> judged_motions(const PointGroup& group, const GroupFrame& frame, const Vector3d& centre) {
  std::vector<Motion> result;
  if (!group.continuous()) {
    const std::vector<Eigen::Matrix3d> all = elements(group, frame);
    for (std::size_t i = 1; i < all.size(); ++i) result.push_back(Motion::about(all[i], centre));
    return result;
  }
  using Family = PointGroup::Family;
  const Vector3d x = frame.col(0);
  const Vector3d z = frame.col(2);
  std::vector<Eigen::Matrix3d> rotations;
  if (group.family == Family::K || group.family == Family::Kh) {
    for (int k = 1; k <= kContinuousAngles; ++k) {
      const double height = 1 - (2 * k - 1.0) / kContinuousAngles;
      const double turn = 2 * std::numbers::pi * k / std::numbers::phi;
      const double radius = std::sqrt(1 - height * height);
      const Vector3d axis = frame * Vector3d(radius * std::cos(turn), radius * std::sin(turn), height);
      rotations.push_back(axis_rotation(axis, 0.3 + 2.5 * k / kContinuousAngles));
    }
  } else {
    for (int k = 1; k <= kContinuousAngles; ++k) {
      const double turns = k / std::numbers::phi;
      rotations.push_back(axis_rotation(z, 2 * std::numbers::pi * (turns - std::floor(turns))));
    }
  }
  std::vector<Eigen::Matrix3d> cosets{Eigen::Matrix3d::Identity()};
  const Eigen::Matrix3d vertical = Eigen::Matrix3d::Identity() - 2 * x * x.transpose();
  const Eigen::Matrix3d horizontal = Eigen::Matrix3d::Identity() - 2 * z * z.transpose();
  if (group.family == Family::Cinfv || group.family == Family::Dinfh) cosets.push_back(vertical);
  if (group.family == Family::Cinfh || group.family == Family::Dinfh) cosets.push_back(horizontal);
  if (group.family == Family::Dinf || group.family == Family::Dinfh)
    cosets.push_back(axis_rotation(x, std::numbers::pi));
  if (group.family == Family::Kh) cosets.emplace_back(-Eigen::Matrix3d::Identity());
  for (const Eigen::Matrix3d& coset : cosets) {
    for (const Eigen::Matrix3d& rotation : rotations) result.push_back(Motion::about(rotation * coset, centre));
  }
  return result;
}

Verification verify(const SurfacePatch& patch, const std::vector<Motion>& motions, double tolerance, int samples,
                    double give_up_below, const RunContext& context) {
  const std::vector<std::size_t> chosen = spread(patch.at_crease.size(), samples);
  Tested tested(chosen.size(), motions.size());
  // Blocks of growing size, so that a hopeless case ends after few queries, whatever the number of threads.
  std::size_t block = give_up_below > 0 ? 64 : chosen.size();
  while (tested.done < chosen.size()) {
    test_block(patch, motions, tolerance, chosen, std::min(chosen.size(), tested.done + block), context, tested);
    block *= 2;
    // Two standard deviations of slack: a sample of 64 must not turn a good motion away.
    const double slack = 2 * std::sqrt(give_up_below * (1 - give_up_below) / static_cast<double>(tested.done));
    if (tested.done < chosen.size() && tested.joint() < give_up_below - slack) break;
  }
  context.check();
  Verification result;
  const std::size_t done = tested.done;
  result.complete = done == chosen.size();
  if (done == 0) return result;
  std::vector<std::size_t> far_off;
  for (std::size_t i = 0; i < done; ++i) {
    if (tested.thrown[i] != 0) far_off.push_back(chosen[i]);
  }
  result.joint = tested.joint();
  for (const std::size_t count : tested.kept_by_motion) {
    result.worst = std::min(result.worst, static_cast<double>(count) / static_cast<double>(done));
  }
  result.cluster = far_off.size() * 4 > done ? 1 : largest_blot(patch, far_off, done);
  const VerificationLimits limits;
  if (result.complete && result.joint >= limits.joint) {
    result.part = worst_part(patch, motions, kFarOff * tolerance);
  }
  result.kept.assign(patch.at_crease.size(), 0);
  for (std::size_t i = 0; i < done; ++i) result.kept[chosen[i]] = tested.kept[i];
  return result;
}

VerificationLimits limits_of(const SurfacePatch& patch) {
  VerificationLimits limits;
  limits.cluster = patch.largest_blot;
  return limits;
}

bool passes(const Verification& verification, const VerificationLimits& limits) {
  return objection(verification, limits).empty();
}

bool only_a_blot_fails(const Verification& verification, const VerificationLimits& limits) {
  VerificationLimits others = limits;
  others.cluster = 1;
  return verification.cluster > limits.cluster && passes(verification, others);
}

std::string objection(const Verification& verification, const VerificationLimits& limits) {
  const auto percent = [](double share) {
    std::array<char, 16> text{};
    std::snprintf(text.data(), text.size(), "%.1f %%", 100 * share);
    return std::string(text.data());
  };
  if (!verification.complete || verification.joint < limits.joint) {
    return "not verified: all its motions together keep " + percent(verification.joint);
  }
  if (verification.worst < limits.worst) return "not verified: one motion keeps " + percent(verification.worst);
  if (verification.cluster > limits.cluster) {
    return "not verified: a blot of " + percent(verification.cluster) + " has no image";
  }
  if (verification.part < limits.part) return "not verified: of one part " + percent(verification.part) + " is kept";
  return {};
}

double kept_share(const SurfacePatch& patch, const Motion& motion, double tolerance, int samples,
                  double give_up_below) {
  const std::vector<std::size_t> chosen = spread(patch.at_crease.size(), samples);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    if (keeps(patch, motion, chosen[i], tolerance)) ++kept;
    // Even if all that follow were kept the share would stay below.
    const double best = static_cast<double>(kept + chosen.size() - 1 - i) / static_cast<double>(chosen.size());
    if (best < give_up_below) return static_cast<double>(kept) / static_cast<double>(chosen.size());
  }
  return chosen.empty() ? 0 : static_cast<double>(kept) / static_cast<double>(chosen.size());
}

bool fits_as_well(double residual_there, double residual_here) {
  constexpr double kAsWell = 1.5;
  constexpr double kNegligible = 1e-9;
  return residual_there <= kAsWell * residual_here + kNegligible;
}

Residual measure_residual(const SurfacePatch& patch, const std::vector<Motion>& motions, const RunContext& context,
                          std::size_t queries) {
  const std::size_t least = std::min<std::size_t>(100, queries / 60);
  const std::size_t count = std::clamp<std::size_t>(queries / std::max<std::size_t>(1, motions.size()), least, 2000);
  const std::vector<std::size_t> chosen = spread(patch.at_crease.size(), static_cast<int>(count));
  std::vector<double> square(chosen.size(), 0);
  std::vector<double> largest(chosen.size(), 0);
  parallel_for(context, chosen.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      for (const Motion& motion : motions) {
        const double distance = patch.index->nearest(motion(row(patch.samples.points, chosen[i]))).distance;
        square[i] += distance * distance;
        largest[i] = std::max(largest[i], distance);
      }
    }
  });
  Residual result;
  if (chosen.empty() || motions.empty()) return result;
  const double sum = std::accumulate(square.begin(), square.end(), 0.0);
  result.rms = std::sqrt(sum / static_cast<double>(chosen.size() * motions.size()));
  result.max = *std::ranges::max_element(largest);
  return result;
}

}  // namespace orbifit
