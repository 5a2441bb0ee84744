#include <cstdio>
#include <string>

#include "orbifit/datasets_tools/detection_score.h"

namespace orbifit {

namespace {

std::string decimal(double value, int digits) {
  char text[64];
  std::snprintf(text, sizeof(text), "%.*f", digits, value);
  return text;
}

std::string decimal(const std::optional<double>& value, int digits, double unit = 1) {
  return value ? decimal(*value / unit, digits) : "-";
}

std::string percent(double fraction) {
  return decimal(100 * fraction, 2) + " %";
}

template <typename Score>
std::string verdict(const Score& score) {
  std::string text = ", validity " + decimal(score.validity, 3) + ": ";
  text += score.counts ? "counts" : (score.well_formed ? "wrong" : "breaks the format");
  if (score.trivial != Triviality::none) text += score.trivial == Triviality::tiny ? ", tiny" : ", featureless";
  if (score.duplicate_of) text += ", repeats " + std::to_string(*score.duplicate_of);
  if (score.matches) {
    text +=
        std::string(", matches ") + (score.matches->optional ? "optional " : "") + std::to_string(score.matches->id);
  }
  return text + "\n";
}

template <typename Score>
std::string found(const Score& score) {
  return std::string(": ") + (score.strict ? "found" : (score.loose ? "found loosely" : "missed"));
}

std::string in_brackets(const std::string& name) {
  return " [" + name + "]\n";
}

}  // namespace

std::string to_text(const DetectionScore& score) {
  std::string text;
  for (const std::string& breach : score.breaches) text += "format: " + breach + "\n";
  for (const RegionScore& region : score.regions) {
    text +=
        "region " + std::to_string(region.id) + " " + region.group + ", area " + percent(region.area) + verdict(region);
  }
  for (const PatternScore& pattern : score.patterns) {
    text += "pattern " + std::to_string(pattern.id) + " " + to_string(pattern.kind) + " x" +
            std::to_string(pattern.instances) + ", area " + percent(pattern.area) + verdict(pattern);
  }
  for (const ExpectedRegionScore& region : score.expected_regions) {
    text += "expected region " + std::to_string(region.id) + " " + region.group + ", area " + percent(region.area) +
            found(region);
    if (region.by) {
      text += "; best " + std::to_string(*region.by) + " " + region.by_group + ", IoU " + decimal(region.iou, 3) +
              ", axis " + decimal(region.axis_error, 2) + " degrees, offset " + decimal(region.offset_error, 2, 0.01) +
              " %";
    }
    text += in_brackets(region.name);
  }
  for (const ExpectedPatternScore& pattern : score.expected_patterns) {
    text += "expected pattern " + std::to_string(pattern.id) + " " + to_string(pattern.kind) + " x" +
            std::to_string(pattern.instances) + ", area " + percent(pattern.area) + found(pattern);
    if (pattern.by_region) {
      text += "; by a region";
    } else if (pattern.by) {
      text += "; best " + std::to_string(*pattern.by) + ", median IoU " + decimal(pattern.iou, 3);
    }
    text += in_brackets(pattern.name);
  }
  const DetectionSummary& summary = score.summary;
  text += "predicted " + std::to_string(summary.predicted) + ", valid " + std::to_string(summary.valid) +
          ", precision " + decimal(summary.precision, 3);
  if (summary.expected) {
    text += ", expected " + std::to_string(*summary.expected) + ", strict " + decimal(summary.strict_recall, 3) +
            ", loose " + decimal(summary.loose_recall, 3) + ", F1 " + decimal(summary.f1, 3) + ", axis " +
            decimal(summary.axis_error, 3) + " degrees, offset " + decimal(summary.offset_error, 4, 0.01) + " %";
  }
  return text + "\n";
}

}  // namespace orbifit
