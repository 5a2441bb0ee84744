#include <algorithm>
#include <cstdio>
#include <map>
#include <utility>

#include <nlohmann/json.hpp>

#include "command.h"
#include "detection.h"

namespace orbifit::benchmarks {

namespace {

constexpr double kWhole = 0.9;  // of the area

std::string decimal(double value, int digits) {
  char text[64];
  std::snprintf(text, sizeof(text), "%.*f", digits, value);
  return text;
}

std::string decimal(const std::optional<double>& value, int digits) {
  return value ? decimal(*value, digits) : "-";
}

std::optional<double> percent(std::optional<double> fraction) {
  if (fraction) *fraction *= 100;
  return fraction;
}

std::string noise_text(const CaseForm& form) {
  return form.noise > 0 ? short_number(100 * form.noise) + " %" : "-";
}

using Rows = std::vector<const DetectionRow*>;

// Rows of one form and noise, forms in the order of their first row.
std::vector<Rows> by_form(const std::vector<DetectionRow>& rows) {
  std::vector<Rows> result;
  for (const DetectionRow& row : rows) {
    const auto same = std::ranges::find_if(result, [&](const Rows& group) { return group[0]->form == row.form; });
    (same == result.end() ? result.emplace_back() : *same).push_back(&row);
  }
  return result;
}

std::vector<Rows> by_kind(const std::vector<DetectionRow>& rows) {
  std::vector<Rows> result;
  for (const DetectionRow& row : rows) {
    const auto same = std::ranges::find_if(result, [&](const Rows& group) { return group[0]->kind == row.kind; });
    (same == result.end() ? result.emplace_back() : *same).push_back(&row);
  }
  return result;
}

// What is listed by what is expected or optional.
std::optional<double> listed_share(const Rows& rows) {
  int listed = 0;
  int right = 0;
  for (const DetectionRow* row : rows) {
    listed += row->score.summary.predicted;
    right += row->score.summary.expected.value_or(0) + row->optional;
  }
  return right > 0 ? std::optional(static_cast<double>(listed) / right) : std::nullopt;
}

void add_means(TextTable& table, std::vector<std::string> cells, const Rows& rows) {
  const DetectionMeans means = means_of(rows);
  cells.push_back(std::to_string(means.rows));
  for (const auto& value : {means.strict_recall, means.loose_recall, means.precision, means.f1, means.axis_error}) {
    cells.push_back(decimal(value, 3));
  }
  cells.push_back(decimal(percent(means.offset_error), 3));
  cells.push_back(decimal(means.listed, 2));
  cells.push_back(decimal(means.within_tolerance, 3));
  cells.push_back(decimal(means.again, 3));
  cells.push_back(decimal(means.seconds, 1));
  table.add(std::move(cells));
}

std::string cases(const std::vector<DetectionRow>& rows) {
  TextTable table({"model", "form", "noise", "true", "found", "strict", "loose", "prec.", "axis", "offset %", "listed",
                   "within", "again", "s"});
  for (const DetectionRow& row : rows) {
    const DetectionSummary& summary = row.score.summary;
    if (row.faces == 0) {
      table.add({row.model, row.form.name(), noise_text(row.form), "failed"});
      continue;
    }
    table.add({row.model, row.form.name(), noise_text(row.form), std::to_string(summary.expected.value_or(0)),
               std::to_string(summary.predicted), decimal(summary.strict_recall, 2), decimal(summary.loose_recall, 2),
               decimal(summary.precision, 2), decimal(summary.axis_error, 2), decimal(percent(summary.offset_error), 2),
               decimal(listed_share({&row}), 2),
               row.regions > 0 ? std::to_string(row.within_tolerance) + "/" + std::to_string(row.regions) : "-",
               decimal(row.again, 2), decimal(row.seconds, 2)});
  }
  return table.text();
}

// How often a finite group is claimed where there is none.
struct FalseGroups {
  int shapes = 0, anywhere = 0, whole = 0;
};

FalseGroups false_groups(const Rows& rows) {
  FalseGroups result;
  for (const DetectionRow* row : rows) {
    if (row->kind != "none" || row->faces == 0) continue;
    ++result.shapes;
    if (row->unfounded_groups() > 0) ++result.anywhere;
    const bool whole = std::ranges::any_of(row->score.regions, [](const RegionScore& region) {
      const auto group = PointGroup::parse(region.group);
      return !region.matches && group && !group->continuous() && region.area >= kWhole;
    });
    if (whole) ++result.whole;
  }
  return result;
}

std::string asymmetric(const std::vector<DetectionRow>& rows) {
  TextTable table({"form", "noise", "shapes", "a finite group claimed", "of the whole"});
  bool any = false;
  for (const Rows& group : by_form(rows)) {
    const FalseGroups found = false_groups(group);
    if (found.shapes == 0) continue;
    any = true;
    table.add({group[0]->form.name(), noise_text(group[0]->form), std::to_string(found.shapes),
               std::to_string(found.anywhere), std::to_string(found.whole)});
  }
  return any ? "\nShapes without any symmetry\n" + table.text() : "";
}

constexpr const char* kNotes =
    "  true, found: regions and patterns expected and detected; strict, loose: share of the expected ones that is\n"
    "  found; prec.: share of the detected ones that is right; axis in degrees, offset in percent of the diagonal, of\n"
    "  what is found strictly; listed: detected by expected and optional; within: regions whose residual.max is "
    "within\n"
    "  the tolerance; again: share of regions found in other orders and poses as well; s: seconds of detection.\n";

nlohmann::ordered_json number(const std::optional<double>& value) {
  return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json();
}

nlohmann::ordered_json means_json(const Rows& rows) {
  const DetectionMeans means = means_of(rows);
  const FalseGroups wrong = false_groups(rows);
  return {{"rows", means.rows},
          {"strict_recall", number(means.strict_recall)},
          {"loose_recall", number(means.loose_recall)},
          {"precision", number(means.precision)},
          {"f1", number(means.f1)},
          {"axis_error", number(means.axis_error)},
          {"offset_error", number(means.offset_error)},
          {"listed", number(means.listed)},
          {"within_tolerance", number(means.within_tolerance)},
          {"again", number(means.again)},
          {"seconds", means.seconds},
          {"asymmetric_shapes", wrong.shapes},
          {"asymmetric_shapes_with_a_finite_group", wrong.anywhere},
          {"asymmetric_shapes_with_a_finite_group_of_the_whole", wrong.whole}};
}

nlohmann::ordered_json row_json(const DetectionRow& row) {
  const DetectionSummary& summary = row.score.summary;
  nlohmann::ordered_json missed = nlohmann::ordered_json::array();
  for (const ExpectedRegionScore& region : row.score.expected_regions) {
    if (!region.strict) missed.push_back(region.group + (region.loose ? " (loose)" : "") + ": " + region.name);
  }
  for (const ExpectedPatternScore& pattern : row.score.expected_patterns) {
    if (!pattern.strict) {
      missed.push_back(to_string(pattern.kind) + (pattern.loose ? " (loose)" : "") + ": " + pattern.name);
    }
  }
  return {{"model", row.model},
          {"kind", row.kind},
          {"form", row.form.remeshed ? "remesh" : "assembly"},
          {"cut", row.form.cut},
          {"noise", row.form.noise},
          {"failure", row.failure},
          {"vertices", row.vertices},
          {"faces", row.faces},
          {"expected", summary.expected.value_or(0)},
          {"predicted", summary.predicted},
          {"valid", summary.valid},
          {"breaches", row.score.breaches.size()},
          {"strict_recall", number(summary.strict_recall)},
          {"loose_recall", number(summary.loose_recall)},
          {"precision", summary.precision},
          {"f1", number(summary.f1)},
          {"axis_error", number(summary.axis_error)},
          {"offset_error", number(summary.offset_error)},
          {"unfounded_groups", row.unfounded_groups()},
          {"not_strict", missed},
          {"optional", row.optional},
          {"regions", row.regions},
          {"within_tolerance", row.within_tolerance},
          {"again", number(row.again)},
          {"seconds", row.seconds},
          {"vertices_per_second",
           row.seconds > 0 ? nlohmann::ordered_json(row.vertices / row.seconds) : nlohmann::ordered_json()}};
}

}  // namespace

int DetectionRow::unfounded_groups() const {
  return static_cast<int>(std::ranges::count_if(score.regions, [](const RegionScore& region) {
    const auto group = PointGroup::parse(region.group);
    return !region.matches && group && !group->continuous();
  }));
}

DetectionMeans means_of(const std::vector<const DetectionRow*>& rows) {
  DetectionMeans means;
  const auto mean = [&](const auto& value_of) -> std::optional<double> {
    double sum = 0;
    int count = 0;
    for (const DetectionRow* row : rows) {
      if (row->faces == 0) continue;
      const std::optional<double> value = value_of(row->score.summary);
      if (!value) continue;
      sum += *value;
      ++count;
    }
    return count > 0 ? std::optional(sum / count) : std::nullopt;
  };
  for (const DetectionRow* row : rows) {
    if (row->faces > 0) ++means.rows;
    means.seconds += row->seconds;
  }
  means.strict_recall = mean([](const DetectionSummary& s) { return s.strict_recall; });
  means.loose_recall = mean([](const DetectionSummary& s) { return s.loose_recall; });
  means.precision = mean([](const DetectionSummary& s) { return std::optional(s.precision); });
  means.f1 = mean([](const DetectionSummary& s) { return s.f1; });
  means.axis_error = mean([](const DetectionSummary& s) { return s.axis_error; });
  means.offset_error = mean([](const DetectionSummary& s) { return s.offset_error; });
  means.listed = listed_share(rows);
  int regions = 0;
  int within = 0;
  double again = 0;
  int asked = 0;
  for (const DetectionRow* row : rows) {
    regions += row->regions;
    within += row->within_tolerance;
    again += row->again.value_or(0);
    if (row->again) ++asked;
  }
  if (regions > 0) means.within_tolerance = static_cast<double>(within) / regions;
  if (asked > 0) means.again = again / asked;
  return means;
}

std::string detection_text(const std::vector<DetectionRow>& rows) {
  const std::vector<std::string> figures{"rows",     "strict", "loose",  "precision", "F1",      "axis",
                                         "offset %", "listed", "within", "again",     "s in all"};
  std::vector<std::string> form_header{"form", "noise"};
  form_header.insert(form_header.end(), figures.begin(), figures.end());
  std::vector<std::string> kind_header{"kind"};
  kind_header.insert(kind_header.end(), figures.begin(), figures.end());
  TextTable forms(form_header);
  for (const Rows& group : by_form(rows)) add_means(forms, {group[0]->form.name(), noise_text(group[0]->form)}, group);
  TextTable kinds(kind_header);
  for (const Rows& group : by_kind(rows)) add_means(kinds, {group[0]->kind}, group);
  std::string text = "Detection against truth\n" + cases(rows) + kNotes;
  text += "\nMeans by form and noise\n" + forms.text();
  text += "\nMeans by kind\n" + kinds.text();
  return text + asymmetric(rows);
}

std::string detection_json(const std::vector<DetectionRow>& rows) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const DetectionRow& row : rows) list.push_back(row_json(row));
  nlohmann::ordered_json forms = nlohmann::ordered_json::array();
  for (const Rows& group : by_form(rows)) {
    nlohmann::ordered_json entry{{"form", group[0]->form.remeshed ? "remesh" : "assembly"},
                                 {"cut", group[0]->form.cut},
                                 {"noise", group[0]->form.noise}};
    entry.update(means_json(group));
    forms.push_back(std::move(entry));
  }
  nlohmann::ordered_json kinds = nlohmann::ordered_json::array();
  for (const Rows& group : by_kind(rows)) {
    nlohmann::ordered_json entry{{"kind", group[0]->kind}};
    entry.update(means_json(group));
    kinds.push_back(std::move(entry));
  }
  return nlohmann::ordered_json{{"rows", list}, {"means", {{"by_form", forms}, {"by_kind", kinds}}}}.dump(2) + "\n";
}

}  // namespace orbifit::benchmarks
