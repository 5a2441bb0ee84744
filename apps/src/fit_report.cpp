#include "fit_report.h"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "orbifit/apps/report.h"

#include "command.h"
#include "fit_pictures.h"

namespace orbifit {

namespace {

nlohmann::ordered_json matrix_rows(const Eigen::Matrix3d& matrix) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (int i = 0; i < 3; ++i) rows.push_back({matrix(i, 0), matrix(i, 1), matrix(i, 2)});
  return rows;
}

ReportTable figures(const FitResult& result, const SymmetryReport& symmetry) {
  return {{"figure", "value"},
          {{"converged", result.converged ? "yes" : "no"},
           {"stopped because", result.stopped_because},
           {"iterations", std::to_string(result.iterations.size())},
           {"degrees of freedom", std::to_string(result.degrees_of_freedom)},
           {"overlap: share of the scan used as the template's", percent(result.overlap)},
           {"share of the scan left out although connected to that", percent(result.torn_off)},
           {"largest connected part of the scan that the fit does not explain", percent(result.unexplained_part)},
           {"inlier ratio at 1 % of the diagonal", percent(result.inlier_ratio)},
           {"rms distance of the inliers, of the diagonal", percent(result.rms)},
           {"visible coverage: share of the surface in view that the scan has", percent(result.visible_coverage)},
           {"share of the surface in view taken as cut off from the scan", percent(result.cut_off)},
           {"largest stretch that the scan leaves open", percent(result.open_stretch())},
           {"confidence, from 0 to 1", short_number(result.confidence, 2)},
           {"share of the surface that the scan did not see", percent(result.hidden_fraction)},
           {"largest symmetry residual added by the fit, of the diagonal", percent(symmetry.worst_excess)}}};
}

nlohmann::ordered_json open_stretches_json(const FitResult& result) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const OpenStretch& open : result.open_stretches) {
    list.push_back({{"along", matrix_rows(open.along)}, {"shorter", open.shorter}, {"longer", open.longer}});
  }
  return list;
}

nlohmann::ordered_json pose_to_json(const Similarity& pose) {
  return {{"scale", pose.scale},
          {"rotation", matrix_rows(pose.linear)},
          {"translation", {pose.translation.x(), pose.translation.y(), pose.translation.z()}}};
}

nlohmann::ordered_json open_poses_json(const FitResult& result) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const OpenPose& open : result.open_poses) {
    const Similarity there = Similarity{1, open.move.linear, open.move.translation} * result.pose;
    list.push_back(
        {{"pose", pose_to_json(there)}, {"apart", open.apart}, {"apart_at", {open.at.x(), open.at.y(), open.at.z()}}});
  }
  return list;
}

// Which groups the scan supports; those that it cannot judge are left out.
ReportTable group_table(const FitResult& result, const SymmetryReport& symmetry) {
  ReportTable table{{"region", "group", "pairs", "disagreement", "rms with the group", "rms without", "the scan"}, {}};
  for (const GroupAgreement& group : result.groups) {
    if (group.pairs == 0) continue;
    const auto region = std::ranges::find(symmetry.regions, group.region, &RegionResidual::id);
    const bool known = region != symmetry.regions.end();
    const bool left_out = std::ranges::find(result.dropped, group.region) != result.dropped.end();
    std::string verdict = "supports it";
    if (group.disagrees) verdict = left_out ? "contradicts it: dropped" : "contradicts it";
    table.rows.push_back({known && !region->name.empty() ? region->name : std::to_string(group.region),
                          known ? region->group : "", std::to_string(group.pairs), percent(group.disagreement),
                          percent(group.held), percent(group.free), verdict});
  }
  return table;
}

ReportTable level_table(const FitResult& result) {
  ReportTable table{
      {"degrees of freedom", "samples", "rms distance of points held out, before", "with this subspace", "verdict"},
      {}};
  for (const ResolutionLevel& level : result.levels) {
    const bool coarsest = &level == &result.levels.front();
    table.rows.push_back({std::to_string(level.degrees_of_freedom), std::to_string(level.samples),
                          coarsest ? "-" : percent(level.held_out_before), coarsest ? "-" : percent(level.held_out),
                          level.kept ? "kept" : "not nearer by more than chance: dropped"});
  }
  return table;
}

ReportTable detail_table(const FitResult& result) {
  ReportTable table{{"heights alike over", "rms distance of points held out, before", "with this detail", "verdict"},
                    {}};
  for (const DetailLevel& level : result.detail_levels) {
    table.rows.push_back({percent(level.length), percent(level.held_out_before), percent(level.held_out),
                          level.kept ? "kept" : "not nearer by more than chance: dropped"});
  }
  return table;
}

ReportTable placement_table(const FitResult& result) {
  ReportTable table{{"placement", "scale", "inlier ratio", "visible coverage", "score, from 0 to 1"}, {}};
  for (std::size_t i = 0; i < result.placements.size(); ++i) {
    const Placement& each = result.placements[i];
    table.rows.push_back({std::to_string(i + 1), short_number(each.pose.scale), percent(each.inlier_ratio),
                          percent(each.visible_coverage), short_number(each.score(), 3)});
  }
  return table;
}

nlohmann::ordered_json iterations_json(const FitResult& result) {
  nlohmann::ordered_json iterations = nlohmann::ordered_json::array();
  for (const FitIteration& iteration : result.iterations) {
    iterations.push_back({{"stiffness", iteration.stiffness},
                          {"correspondences", iteration.correspondences},
                          {"rms", iteration.rms},
                          {"energy", iteration.energy},
                          {"damping", iteration.damping},
                          {"change", iteration.change}});
  }
  return iterations;
}

nlohmann::ordered_json times_json(const FitResult& result) {
  nlohmann::ordered_json times;
  for (const StageTime& time : result.times) times[time.stage] = time.seconds;
  return times;
}

nlohmann::ordered_json placements_json(const FitResult& result) {
  nlohmann::ordered_json placements = nlohmann::ordered_json::array();
  for (const Placement& placement : result.placements) {
    placements.push_back({{"pose", pose_to_json(placement.pose)},
                          {"explained", placement.inlier_ratio},
                          {"covered", placement.visible_coverage},
                          {"score", placement.score()}});
  }
  return placements;
}

nlohmann::ordered_json others_json(const FitResult& result) {
  nlohmann::ordered_json others = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < result.others.size(); ++i) {
    const Motion& motion = result.others[i];
    others.push_back(
        {{"used", result.other_used[i] != 0}, {"pose", pose_to_json({1, motion.linear, motion.translation})}});
  }
  return others;
}

nlohmann::ordered_json landmarks_json(const FitResult& result) {
  nlohmann::ordered_json landmarks = nlohmann::ordered_json::array();
  for (const LandmarkAgreement& each : result.landmarks) {
    landmarks.push_back({{"vertex", each.vertex}, {"residual", each.residual}, {"left_out", each.left_out}});
  }
  return landmarks;
}

nlohmann::ordered_json regions_json(const SymmetryReport& symmetry) {
  nlohmann::ordered_json regions = nlohmann::ordered_json::array();
  for (const RegionResidual& region : symmetry.regions) {
    regions.push_back({{"id", region.id},
                       {"name", region.name},
                       {"group", region.group},
                       {"rest", region.floor.max},
                       {"excess", region.excess.max}});
  }
  return regions;
}

nlohmann::ordered_json groups_json(const FitResult& result) {
  nlohmann::ordered_json groups = nlohmann::ordered_json::array();
  for (const GroupAgreement& group : result.groups) {
    groups.push_back({{"region", group.region},
                      {"pairs", group.pairs},
                      {"disagreement", group.disagreement},
                      {"held_rms", group.held},
                      {"free_rms", group.free},
                      {"disagrees", group.disagrees}});
  }
  return groups;
}

nlohmann::ordered_json levels_json(const FitResult& result) {
  nlohmann::ordered_json levels = nlohmann::ordered_json::array();
  for (const ResolutionLevel& level : result.levels) {
    levels.push_back({{"samples", level.samples},
                      {"degrees_of_freedom", level.degrees_of_freedom},
                      {"held_out_rms_before", level.held_out_before},
                      {"held_out_rms", level.held_out},
                      {"kept", level.kept}});
  }
  return levels;
}

nlohmann::ordered_json detail_json(const FitResult& result) {
  nlohmann::ordered_json levels = nlohmann::ordered_json::array();
  for (const DetailLevel& level : result.detail_levels) {
    levels.push_back({{"length", level.length},
                      {"held_out_rms_before", level.held_out_before},
                      {"held_out_rms", level.held_out},
                      {"kept", level.kept}});
  }
  return {{"rms", result.detail_rms}, {"levels", levels}};
}

}  // namespace

nlohmann::ordered_json fit_to_json(const std::vector<std::string>& verdict, const FitResult& result,
                                   const SymmetryReport& symmetry) {
  return {{"converged", result.converged},
          {"verdict", verdict},
          {"stopped_because", result.stopped_because},
          {"pose", pose_to_json(result.pose)},
          {"other_scans", others_json(result)},
          {"placements", placements_json(result)},
          {"samples", result.samples},
          {"degrees_of_freedom", result.degrees_of_freedom},
          {"resolutions", levels_json(result)},
          {"detail", detail_json(result)},
          {"used_fraction", result.overlap},
          {"torn_off", result.torn_off},
          {"unexplained_part", result.unexplained_part},
          {"unexplained_at", {result.unexplained_at.x(), result.unexplained_at.y(), result.unexplained_at.z()}},
          {"inlier_fraction", result.inlier_ratio},
          {"covered", result.visible_coverage},
          {"cut_off", result.cut_off},
          {"own_size", result.own_size},
          {"growth", result.growth},
          {"open_stretches", open_stretches_json(result)},
          {"open_poses", open_poses_json(result)},
          {"confidence", result.confidence},
          {"rms", result.rms},
          {"landmark_rms", result.landmark_rms},
          {"landmarks", landmarks_json(result)},
          {"hidden_fraction", result.hidden_fraction},
          {"symmetry",
           {{"field_residual", result.field_residual},
            {"worst_excess", symmetry.worst_excess},
            {"regions", regions_json(symmetry)}}},
          {"groups", groups_json(result)},
          {"relaxed", result.dropped},
          {"seconds", times_json(result)},
          {"iterations", iterations_json(result)}};
}

std::string fit_to_html(const Mesh& mesh, const PointCloud& scan, const FitResult& result,
                        const std::vector<std::string>& verdict, const SymmetryReport& symmetry,
                        const Eigen::Vector3d& up, const RunContext& run) {
  Report report;
  report.title = "Template fitted to a scan";
  std::string sentences;
  for (const std::string& sentence : verdict) sentences += sentence + "\n\n";
  report.sections.push_back(
      {"Fit", sentences, fit_pictures(mesh, scan, result, up, run), {figures(result, symmetry)}, {}});
  if (!result.groups.empty()) {
    report.sections.push_back({"Symmetry groups and the scan",
                               "Each group is compared with a fit that is not constrained by it. The disagreement is "
                               "how far that fit is from symmetric under the group. With --drop-unsupported, groups "
                               "that the scan contradicts are dropped. Distances are in percent of the diagonal.",
                               {},
                               {group_table(result, symmetry)},
                               {}});
  }
  if (result.levels.size() > 1) {
    report.sections.push_back(
        {"Resolution",
         "Finer subspaces are tried as long as points of the scan that were held out come nearer. Each is compared "
         "with the one before, by points of its own. Distances are in percent of the diagonal.",
         {},
         {level_table(result)},
         {}});
  }
  if (!result.detail_levels.empty()) {
    report.sections.push_back(
        {"Detail",
         "Heights along the normals, one for vertices that are images of one another, ever finer as long as points of "
         "the scan that were held out come nearer. They move the vertices by " +
             percent(result.detail_rms) + " (rms). Distances are in percent of the diagonal.",
         {},
         {detail_table(result)},
         {}});
  }
  if (!result.placements.empty()) {
    report.sections.push_back(
        {"Placements of the template in the scan", "The best is fitted.", {}, {placement_table(result)}, {}});
  }
  return to_html(report);
}

}  // namespace orbifit
