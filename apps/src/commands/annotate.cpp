#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "orbifit/detection/add_region.h"
#include "orbifit/detection/detect.h"
#include "orbifit/detection/guided_region.h"
#include "orbifit/model/annotation_io.h"
#include "orbifit/model/consistent_annotation.h"
#include "orbifit/model/errors.h"
#include "orbifit/model/mesh_io.h"

#include "../commands.h"
#include "annotation_edits.h"

namespace orbifit::commands {

namespace {

constexpr int kHighestOrder = 1000;

struct AnnotateArguments {
  std::string mesh, output, annotation, order, group, name;
  std::vector<double> plane, axis, centre, near;
  std::vector<int> seeds;
  AnnotationEdits edits;
  double tolerance = 0.005;
  bool tolerance_given = false;
  bool as_given = false;
  bool consistent = false;
  bool list = false;

  bool adds() const { return !plane.empty() || !axis.empty() || !centre.empty() || !seeds.empty() || !near.empty(); }
};

// "PX PY PZ" or "PX PY PZ DX DY DZ": a point, and where there are six a direction.
void read_place(const std::string& option, const std::vector<double>& values, RegionHint& hint) {
  for (const double value : values) {
    if (!std::isfinite(value)) throw UsageError(option + ": " + short_number(value) + " is not finite");
  }
  hint.point = Eigen::Vector3d(values.data());
  if (values.size() < 6) return;
  const Eigen::Vector3d direction(values.data() + 3);
  if (!(direction.stableNorm() > 0)) throw UsageError(option + ": the direction is 0 0 0; it must not be");
  hint.direction = direction.stableNormalized();
}

int to_order(const std::string& text) {
  if (text == "inf") return RegionHint::kContinuous;
  const std::string rule =
      "--order is '" + text + "': must be inf or a whole number from 2 to " + std::to_string(kHighestOrder);
  if (text.empty() || text.size() > 4 || text.find_first_not_of("0123456789") != std::string::npos) {
    throw UsageError(rule);
  }
  const int order = std::stoi(text);
  if (order < 2 || order > kHighestOrder) throw UsageError(rule);
  return order;
}

RegionHint to_hint(const AnnotateArguments& arguments) {
  RegionHint hint;
  const int places = static_cast<int>(!arguments.plane.empty()) + static_cast<int>(!arguments.axis.empty()) +
                     static_cast<int>(!arguments.centre.empty());
  if (places != 1) throw UsageError("one of --plane, --axis and --centre is needed, and no more than one");
  if (arguments.seeds.empty() && arguments.near.empty()) {
    throw UsageError("a face of the region is needed: --seed-face F, or a point near it: --near X Y Z");
  }
  if (!arguments.plane.empty()) {
    read_place("--plane", arguments.plane, hint);
  } else if (!arguments.axis.empty()) {
    hint.about = RegionHint::About::axis;
    read_place("--axis", arguments.axis, hint);
  } else {
    hint.about = RegionHint::About::centre;
    read_place("--centre", arguments.centre, hint);
  }
  if (!arguments.order.empty()) hint.order = to_order(arguments.order);
  if (!arguments.group.empty()) {
    hint.group = PointGroup::parse(arguments.group);
    if (!hint.group) throw UsageError("--group is '" + arguments.group + "': is no Schoenflies symbol such as C4v");
  }
  hint.seeds = arguments.seeds;
  hint.refine = !arguments.as_given;
  return hint;
}

double area_fraction(const Mesh& mesh, const std::vector<int>& faces) {
  const Eigen::VectorXd areas = face_areas(mesh);
  double area = 0;
  for (const int face : faces) area += areas[face];
  return area / areas.sum();
}

std::string reason_against(const GuidedRegion& found, const Mesh& mesh, const std::optional<double>& passing) {
  const std::string group = found.region.group.symbol();
  const std::string advice = passing ? "it would pass with --tolerance " + short_number(*passing, 2)
                                     : "no tolerance up to 0.1 of the diagonal would help";
  const std::string end = "; " + advice + "; nothing was written";
  if (found.region.faces.empty()) return group + " does not hold: " + found.shortfall + end;
  return group + " does not hold around the seed faces: " + found.shortfall + "; the residual is " +
         percent(found.region.residual.rms) + " rms and " + percent(found.region.residual.max) +
         " at most of the diagonal, " + short_number(diagonal(mesh.vertices), 6) + end;
}

nlohmann::ordered_json to_json(const Region& region, const RegionAddition& addition, const GuidedRegion& found,
                               const Mesh& mesh, std::size_t regions) {
  nlohmann::ordered_json result = {
      {"id", region.id},
      {"name", region.name},
      {"group", region.group.symbol()},
      {"centre", {region.centre.x(), region.centre.y(), region.centre.z()}},
  };
  if (region.group.has_axis()) result["axis"] = {region.axis.x(), region.axis.y(), region.axis.z()};
  result["faces"] = region.faces.size();
  result["area_fraction"] = area_fraction(mesh, region.faces);
  result["parent"] = region.parent ? nlohmann::ordered_json(*region.parent) : nullptr;
  result["share_kept"] = found.kept;
  result["residual"] = {{"rms", region.residual.rms}, {"max", region.residual.max}};
  result["replaced"] = addition.replaced;
  result["regions"] = regions;
  return result;
}

std::string triple(const Eigen::Vector3d& v) {
  return short_number(v.x(), 6) + " " + short_number(v.y(), 6) + " " + short_number(v.z(), 6);
}

std::string to_text(const Region& region, const RegionAddition& addition, const GuidedRegion& found, const Mesh& mesh,
                    std::size_t regions) {
  std::string text = "region " + std::to_string(region.id) + " of " + std::to_string(regions) + ": " +
                     region.group.symbol() + " on " + count_of(static_cast<long long>(region.faces.size()), "face") +
                     ", " + percent(area_fraction(mesh, region.faces)) + " of the area, parent " +
                     (region.parent ? std::to_string(*region.parent) : "none") + "\n";
  text += "  centre " + triple(region.centre) +
          (region.group.has_axis() ? ", axis " + triple(region.axis) : std::string()) + "\n";
  text += "  " + percent(found.kept) + " of it fits; residual " + percent(region.residual.rms) + " rms, " +
          percent(region.residual.max) + " at most of the diagonal\n";
  for (const std::string& old : addition.replaced) text += "  in place of " + old + ", which it subsumes\n";
  return text;
}

std::string lines(const std::vector<std::string>& changes) {
  std::string text;
  for (const std::string& change : changes) text += change + "\n";
  return text;
}

nlohmann::ordered_json edits_json(const std::vector<std::string>& changes, const SymmetryAnnotation& annotation,
                                  const Mesh& mesh) {
  nlohmann::ordered_json result = annotation_list(annotation, mesh);
  result["changes"] = changes;
  return result;
}

std::string edits_text(const std::vector<std::string>& changes, const SymmetryAnnotation& annotation, const Mesh& mesh,
                       bool list) {
  return lines(changes) +
         (list ? annotation_table(annotation, mesh)
               : count_of(static_cast<long long>(annotation.regions.size()), "region") + " and " +
                     count_of(static_cast<long long>(annotation.patterns.size()), "pattern") + " in the annotation\n");
}

void add_place(CLI::App& app, const std::string& option, std::vector<double>& values, int count,
               const std::string& help, const std::string& type) {
  app.add_option(option, values, help)->type_size(count)->expected(1)->type_name(type);
}

void add_edit_options(CLI::App& app, AnnotateArguments& arguments) {
  app.add_option("MESH", arguments.mesh, "Mesh to annotate")->required()->type_name("FILE");
  app.add_option("-o,--output", arguments.output, "Annotation to write (.json); without it the result is only shown")
      ->type_name("FILE");
  auto* given = app.add_option("--annotation", arguments.annotation, "Annotation to change or to add a region to")
                    ->type_name("FILE");
  app.add_flag("--list", arguments.list, "List the regions and patterns of the annotation with their ids")
      ->needs(given);
  app.add_option("--remove", arguments.edits.remove, "Ids of regions to remove; the others keep their ids")
      ->delimiter(',')
      ->needs(given)
      ->type_name("ID,...");
  app.add_option("--rename", arguments.edits.rename, "Rename a region; may be repeated")
      ->needs(given)
      ->type_name("ID NAME");
}

void add_region_options(CLI::App& app, AnnotateArguments& arguments) {
  add_place(app, "--plane", arguments.plane, 6, "Approximate mirror plane: a point and the normal",
            "PX PY PZ NX NY NZ");
  add_place(app, "--axis", arguments.axis, 6, "Approximate axis: a point and the direction", "PX PY PZ DX DY DZ");
  add_place(app, "--centre,--center", arguments.centre, 3, "Approximate centre", "X Y Z");
  app.add_option(
         "--order", arguments.order,
         "Order of rotation about the axis, or inf for a surface of revolution; the largest group of the region that "
         "contains these rotations is taken")
      ->type_name("N");
  app.add_option("--group", arguments.group,
                 "Schoenflies symbol of the group, such as C4v (default: Cs for a plane, Ci for a centre, the largest "
                 "found for "
                 "an axis)")
      ->type_name("SYMBOL");
  app.add_option("--seed-face", arguments.seeds, "A face of the region, numbered from 0; may be repeated")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->type_name("F");
  add_place(app, "--near", arguments.near, 3,
            "A point near the region: the face nearest to it is taken as a face of the region", "X Y Z");
  app.add_option("--name", arguments.name, "Name of the region")->type_name("TEXT");
  app.add_option(
      "--tolerance", arguments.tolerance,
      "Largest distance between the surface and its image that still counts as symmetric, as a fraction of the "
      "diagonal (default: that of --annotation, or 0.005)");
  app.add_flag(
      "--consistent", arguments.consistent,
      "Make all regions consistent with one another, exactly, as deform and fit do first: regions that cannot be are "
      "left out, missing images of regions are added");
  app.add_flag("--no-refine", arguments.as_given, "Take the plane, axis or centre exactly as given");
}

void write_result(const AnnotateArguments& arguments, const Mesh& mesh, SymmetryAnnotation& annotation,
                  const CommandContext& context) {
  if (arguments.consistent) annotation = made_consistent(mesh, annotation, context.run);
  if (!arguments.output.empty()) write_annotation(arguments.output, annotation);
}

// The region of the hint is found and added to the annotation.
int add(const AnnotateArguments& arguments, const RegionHint& hint, const GuidedRegionOptions& options,
        const std::vector<std::string>& changes, const Mesh& mesh, SymmetryAnnotation& annotation,
        CommandContext& context) {
  GuidedRegion found = guided_region(mesh, hint, options, context.run);
  if (!found.holds) {
    throw NoResultError(reason_against(found, mesh, passing_tolerance(mesh, hint, options, context.run)));
  }
  found.region.name = arguments.name.empty() ? "by hand" : arguments.name;
  const RegionAddition addition = add_region(mesh, found.region, options.tolerance, annotation);
  write_result(arguments, mesh, annotation, context);
  const auto added = std::ranges::find(annotation.regions, addition.id, &Region::id);
  if (added == annotation.regions.end()) {
    throw NoResultError("the region cannot be kept beside the others" +
                        std::string(arguments.output.empty() ? "" : "; it is not in what was written"));
  }
  const std::size_t count = annotation.regions.size();
  if (context.json) {
    nlohmann::ordered_json result = to_json(*added, addition, found, mesh, count);
    if (!changes.empty()) result["changes"] = changes;
    if (arguments.list) result["annotation"] = annotation_list(annotation, mesh);
    print(context, result.dump(2) + "\n");
  } else {
    print(context, lines(changes) + to_text(*added, addition, found, mesh, count) +
                       (arguments.list ? annotation_table(annotation, mesh) : ""));
  }
  return kDone;
}

int run(const AnnotateArguments& arguments, CommandContext& context) {
  const bool adds = arguments.adds() || (arguments.edits.empty() && !arguments.list && !arguments.consistent);
  RegionHint hint;
  if (adds) hint = to_hint(arguments);
  if (adds && !arguments.near.empty()) hint.near = to_point("--near", arguments.near);
  if (!arguments.output.empty()) check_output(arguments.output, {".json"}, {arguments.mesh});
  DetectOptions limits;
  limits.tolerance = arguments.tolerance;
  limits.validate();
  const Mesh mesh = read_mesh(arguments.mesh);
  GuidedRegionOptions options;
  options.tolerance = arguments.tolerance;
  SymmetryAnnotation annotation = empty_annotation(mesh, options.tolerance);
  if (!arguments.annotation.empty()) {
    annotation = read_annotation(arguments.annotation, mesh);
    if (!arguments.tolerance_given) options.tolerance = annotation.tolerance;
  }
  const std::vector<std::string> changes = apply_edits(arguments.edits, annotation);
  context.run.check();
  if (adds) return add(arguments, hint, options, changes, mesh, annotation, context);
  write_result(arguments, mesh, annotation, context);
  print(context, context.json ? edits_json(changes, annotation, mesh).dump(2) + "\n"
                              : edits_text(changes, annotation, mesh, arguments.list));
  return kDone;
}

}  // namespace

CommandBody annotate(CLI::App& app) {
  const auto arguments = std::make_shared<AnnotateArguments>();
  add_edit_options(app, *arguments);
  add_region_options(app, *arguments);
  return [arguments, &app](CommandContext& context) {
    arguments->tolerance_given = app.count("--tolerance") > 0;
    return run(*arguments, context);
  };
}

}  // namespace orbifit::commands
