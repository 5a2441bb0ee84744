#include "orbifit/datasets_tools/detection_score.h"

#include <algorithm>
#include <memory>
#include <numeric>

#include "orbifit/model/errors.h"

#include "detection_score/format_check.h"
#include "detection_score/pattern_match.h"
#include "detection_score/region_match.h"
#include "detection_score/region_validity.h"
#include "detection_score/scored_surface.h"
#include "detection_score/triviality.h"

namespace orbifit {

namespace {

using namespace scoring;

constexpr double kTiny = 0.002;  // of the mesh's area

class Scorer {
 public:
  Scorer(const Mesh& mesh, const SymmetryAnnotation& predicted, const DetectionScoreOptions& options,
         const RunContext& context)
      : measured_(mesh), predicted_(predicted), options_(options), context_(context) {}

  DetectionScore score(const DetectionTruth* truth) {
    const FormatReport format = check_format(measured_, predicted_);
    result_.breaches = format.breaches;
    score_regions(format);
    mark_duplicates();
    score_patterns(format);
    if (truth != nullptr) {
      match_regions_of(truth->expected.regions, *truth, false);
      match_regions_of(truth->optional_regions, *truth, true);
      match_patterns_of(truth->expected.patterns, false);
      match_patterns_of(truth->optional_patterns, true);
    }
    summarise(truth);
    return std::move(result_);
  }

 private:
  Random stream(const std::string& name) const { return Random(context_.seed, "detection score, " + name); }

  const ScoredSurface& whole() {
    if (!whole_) {
      std::vector<int> all(static_cast<std::size_t>(measured_.mesh.faces.rows()));
      std::iota(all.begin(), all.end(), 0);
      whole_ = std::make_unique<ScoredSurface>(measured_, all, 0.005 * measured_.diagonal);
    }
    return *whole_;
  }

  void score_regions(const FormatReport& format) {
    for (std::size_t i = 0; i < predicted_.regions.size(); ++i) {
      context_.progress("validity", static_cast<double>(i) / static_cast<double>(predicted_.regions.size()));
      const Region& region = predicted_.regions[i];
      RegionScore& score = result_.regions.emplace_back();
      score.id = region.id;
      score.name = region.name;
      score.group = region.group.symbol();
      score.well_formed = format.regions[i] != 0;
      if (!score.well_formed) continue;
      regions_.emplace_back(measured_, region);
      number_of_region_.push_back(i);
      measure(regions_.back(), "region " + std::to_string(i), score);
    }
  }

  void measure(const ScoredRegion& scored, const std::string& name, RegionScore& score) {
    const Region& region = scored.region;
    score.area = measured_.area > 0 ? scored.area / measured_.area : 0;
    const double extent = measured_.diagonal_of(region.faces);
    const ScoredSurface surface(measured_, region.faces, measured_.tolerance_of(region.faces));
    score.trivial = Triviality::tiny;
    if (surface.empty() || extent <= 0) return;
    Random random = stream(name);
    score.validity = region_validity(surface, region, options_.samples, random, context_);
    if (score.area < kTiny) return;
    const bool slides = featureless(surface, extent, region, whole(), random, context_);
    score.trivial = slides ? Triviality::featureless : Triviality::none;
  }

  void mark_duplicates() {
    for (std::size_t k = 0; k < regions_.size(); ++k) {
      for (std::size_t j = 0; j < regions_.size(); ++j) {
        if (j == k) continue;
        if (!repeats(measured_, regions_[k], regions_[j], j < k)) continue;
        result_.regions[number_of_region_[k]].duplicate_of = regions_[j].region.id;
        break;
      }
    }
  }

  void score_patterns(const FormatReport& format) {
    for (std::size_t i = 0; i < predicted_.patterns.size(); ++i) {
      context_.progress("patterns", static_cast<double>(i) / static_cast<double>(predicted_.patterns.size()));
      const Pattern& pattern = predicted_.patterns[i];
      PatternScore& score = result_.patterns.emplace_back();
      score.id = pattern.id;
      score.name = pattern.name;
      score.kind = pattern.kind;
      score.instances = static_cast<int>(pattern.instances.size());
      score.well_formed = format.patterns[i] != 0;
      if (!score.well_formed) continue;
      const PlacedPattern placed(measured_, pattern);
      score.area = measured_.area > 0 ? placed.area / measured_.area : 0;
      Random random = stream("pattern " + std::to_string(i));
      score.validity = pattern_validity(measured_, pattern, random, context_);
      score.trivial = triviality(pattern, score.area, random);
      const auto earlier = std::ranges::find_if(
          patterns_, [&](const PlacedPattern& other) { return repeats(measured_, placed, other); });
      if (earlier != patterns_.end()) score.duplicate_of = earlier->pattern.id;
      patterns_.push_back(placed);
      number_of_pattern_.push_back(i);
    }
  }

  Triviality triviality(const Pattern& pattern, double area, Random& random) {
    const std::vector<int>& first = pattern.instances.front().faces;
    const ScoredSurface surface(measured_, first, measured_.tolerance_of(first));
    if (area < kTiny || surface.empty()) return Triviality::tiny;
    return featureless(surface, pattern, whole(), random, context_) ? Triviality::featureless : Triviality::none;
  }

  void match_regions_of(const std::vector<Region>& regions, const DetectionTruth& truth, bool optional) {
    for (const Region& region : regions) {
      const ScoredRegion expected(measured_, region);
      const AcceptedFaces accepted = accepted_faces(region, truth);
      RegionMatch best;
      std::size_t by = regions_.size();
      for (std::size_t k = 0; k < regions_.size(); ++k) {
        const RegionMatch candidate = match_regions(measured_, expected, accepted, regions_[k]);
        if (by < regions_.size() && !candidate.better_than(best)) continue;
        best = candidate;
        by = k;
      }
      // The best one takes the match; a further one has to stand on its own.
      if (best.strict || best.modest) take_match(result_.regions[number_of_region_[by]].matches, region.id, optional);
      if (optional) continue;
      ExpectedRegionScore& score = result_.expected_regions.emplace_back();
      score.id = region.id;
      score.name = region.name;
      score.group = region.group.symbol();
      score.area = measured_.area > 0 ? expected.area / measured_.area : 0;
      score.strict = best.strict;
      score.loose = best.strict || best.loose;
      if (by == regions_.size()) continue;
      score.by = regions_[by].region.id;
      score.by_group = regions_[by].region.group.symbol();
      score.iou = best.iou;
      score.axis_error = best.axis_error;
      score.offset_error = best.offset_error;
    }
  }

  static void take_match(std::optional<TruthMatch>& taken, int id, bool optional) {
    if (!taken) taken = TruthMatch{id, optional};
  }

  void match_patterns_of(const std::vector<Pattern>& patterns, bool optional) {
    for (std::size_t i = 0; i < patterns.size(); ++i) {
      const Pattern& pattern = patterns[i];
      const PlacedPattern expected(measured_, pattern);
      Random random = stream((optional ? "optional pattern " : "expected pattern ") + std::to_string(i));
      PatternMatch best;
      std::size_t by = patterns_.size();
      for (std::size_t k = 0; k < patterns_.size(); ++k) {
        const PatternMatch candidate = match_patterns(measured_, expected, patterns_[k], random, context_);
        if (by < patterns_.size() && !candidate.better_than(best)) continue;
        best = candidate;
        by = k;
      }
      if (best.loose) take_match(result_.patterns[number_of_pattern_[by]].matches, pattern.id, optional);
      if (optional) continue;
      ExpectedPatternScore& score = result_.expected_patterns.emplace_back();
      score.id = pattern.id;
      score.name = pattern.name;
      score.kind = pattern.kind;
      score.instances = static_cast<int>(pattern.instances.size());
      score.area = measured_.area > 0 ? expected.area / measured_.area : 0;
      score.strict = best.strict;
      score.loose = best.loose;
      score.iou = best.median_iou;
      if (by < patterns_.size()) score.by = patterns_[by].pattern.id;
      if (score.strict || pattern.kind != Pattern::Kind::congruent) continue;
      score.by_region = std::ranges::any_of(regions_, [&](const ScoredRegion& region) {
        return region_relates(measured_, expected, region.region, region.set, random, context_);
      });
      if (score.by_region) score.strict = score.loose = true;
    }
  }

  void summarise(const DetectionTruth* truth);

  MeasuredMesh measured_;
  const SymmetryAnnotation& predicted_;
  const DetectionScoreOptions& options_;
  const RunContext& context_;
  std::unique_ptr<ScoredSurface> whole_;
  std::vector<ScoredRegion> regions_;  // those that are well formed
  std::vector<std::size_t> number_of_region_;
  std::vector<PlacedPattern> patterns_;
  std::vector<std::size_t> number_of_pattern_;
  DetectionScore result_;
};

void Scorer::summarise(const DetectionTruth* truth) {
  DetectionSummary& summary = result_.summary;
  int counting = 0;
  const auto count = [&](auto& score) {
    score.counts =
        score.well_formed &&
        (score.matches || (score.validity >= kFits && !score.duplicate_of && score.trivial == Triviality::none));
    ++summary.predicted;
    if (score.validity >= kFits) ++summary.valid;
    if (score.counts) ++counting;
  };
  std::ranges::for_each(result_.regions, count);
  std::ranges::for_each(result_.patterns, count);
  const auto share = [](int part, int all) { return static_cast<double>(part) / static_cast<double>(all); };
  if (summary.predicted > 0) summary.precision = share(counting, summary.predicted);
  if (truth == nullptr) return;

  const int expected = static_cast<int>(result_.expected_regions.size() + result_.expected_patterns.size());
  summary.expected = expected;
  if (summary.predicted == 0) summary.precision = expected > 0 ? 0 : 1;
  int strict = 0;
  int loose = 0;
  double axis = 0;
  double offset = 0;
  int measured = 0;
  for (const ExpectedRegionScore& score : result_.expected_regions) {
    if (score.loose) ++loose;
    if (!score.strict) continue;
    ++strict;
    ++measured;
    axis += score.axis_error.value_or(0);
    offset += score.offset_error.value_or(0);
  }
  for (const ExpectedPatternScore& score : result_.expected_patterns) {
    if (score.strict) ++strict;
    if (score.loose) ++loose;
  }
  if (expected > 0) {
    summary.strict_recall = share(strict, expected);
    summary.loose_recall = share(loose, expected);
  }
  const double recall = summary.strict_recall.value_or(1);
  const double sum = recall + summary.precision;
  summary.f1 = sum > 0 ? 2 * recall * summary.precision / sum : 0;
  if (measured == 0) return;
  summary.axis_error = axis / measured;
  summary.offset_error = offset / measured;
}

void check_faces(const std::vector<int>& faces, Eigen::Index count, const std::string& where) {
  for (std::size_t i = 0; i < faces.size(); ++i) {
    if (faces[i] < 0 || faces[i] >= count) {
      throw InputError(
          "", where,
          "face " + std::to_string(faces[i]) + " is outside the mesh, which has " + std::to_string(count) + " faces");
    }
    if (i > 0 && faces[i] <= faces[i - 1]) throw InputError("", where, "the faces are not ascending");
  }
}

void check_faces(const std::vector<Region>& regions, const std::vector<Pattern>& patterns, Eigen::Index count,
                 const std::string& where) {
  for (const Region& region : regions) {
    check_faces(region.faces, count, where + " region " + std::to_string(region.id));
  }
  for (const Pattern& pattern : patterns) {
    for (const PatternInstance& instance : pattern.instances) {
      check_faces(instance.faces, count, where + " pattern " + std::to_string(pattern.id));
    }
  }
}

void check_mesh(const SymmetryAnnotation& annotation, const Mesh& mesh, const std::string& where) {
  if (annotation.mesh_vertices != mesh.vertices.rows() || annotation.mesh_faces != mesh.faces.rows()) {
    throw InputError("", where,
                     "is of a mesh with " + std::to_string(annotation.mesh_vertices) + " vertices and " +
                         std::to_string(annotation.mesh_faces) + " faces, this one has " +
                         std::to_string(mesh.vertices.rows()) + " and " + std::to_string(mesh.faces.rows()));
  }
  check_faces(annotation.regions, annotation.patterns, mesh.faces.rows(), where);
}

}  // namespace

void DetectionScoreOptions::validate() const {
  if (samples < 100) throw UsageError("samples = " + std::to_string(samples) + ": must be at least 100");
}

DetectionScore score_detection(const Mesh& mesh, const SymmetryAnnotation& predicted, const DetectionTruth* truth,
                               const DetectionScoreOptions& options, const RunContext& context) {
  options.validate();
  check_mesh(predicted, mesh, "prediction");
  if (truth != nullptr) {
    check_mesh(truth->expected, mesh, "truth");
    check_faces(truth->optional_regions, truth->optional_patterns, mesh.faces.rows(), "truth: optional");
    for (const auto& [id, sets] : truth->also_accepted) {
      for (const std::vector<int>& faces : sets) {
        check_faces(faces, mesh.faces.rows(), "truth: also accepted for region " + std::to_string(id));
      }
    }
  }
  return Scorer(mesh, predicted, options, context).score(truth);
}

}  // namespace orbifit
