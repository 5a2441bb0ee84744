#include <string>

#include "orbifit/model/annotation.h"
#include "orbifit/model/annotation_io.h"

#include "bad_input/bad_input_lists.h"

namespace orbifit {

namespace {

std::string cube_annotation() {
  const Mesh mesh = cube_of_bad_input();
  SymmetryAnnotation annotation = empty_annotation(mesh, 0.005);
  const std::vector<int> faces{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};
  annotation.regions.push_back(
      make_region(*PointGroup::parse("C2v"), Eigen::Vector3d::Zero(), Eigen::Matrix3d::Identity(), faces, "cube"));
  return to_json(annotation);
}

// What may be wrong with any JSON file.
void add_json_texts(BadInputs& files, const std::string& stem, BadInputKind kind, const std::string& whole) {
  const auto add = [&](const std::string& what, const std::string& content) {
    files.push_back({stem + "_" + what + ".json", kind, content});
  };
  add_truncated(files, stem, ".json", kind, whole);
  add("empty", "");
  add("null", "null");
  add("list", "[]");
  add("number", "1e999");
  add("object", "{}");
  add("nested", std::string(100'000, '['));
  add("comment", "// by hand\n" + whole);
  add("byte_order_mark", "\xef\xbb\xbf" + whole);
  add("wrong_utf8", with(whole, "\"", "\"\xff\xfe"));
  add("twice", whole + whole);
}

void add_annotations(BadInputs& files) {
  const std::string whole = cube_annotation();
  add_json_texts(files, "annotation", BadInputKind::annotation, whole);
  const auto change = [&](const std::string& what, const std::string& from, const std::string& to) {
    files.push_back({"annotation_" + what + ".json", BadInputKind::annotation, with(whole, from, to)});
  };
  change("other_format", "symmetry-annotation", "symmetry");
  change("version_2", R"("version": 1)", R"("version": 2)");
  change("version_word", R"("version": 1)", R"("version": "1")");
  change("vertices_other", R"("vertices": 8)", R"("vertices": 9)");
  change("vertices_negative", R"("vertices": 8)", R"("vertices": -8)");
  change("faces_2_64", R"("faces": 12)", R"("faces": 18446744073709551616)");
  change("diagonal_infinite", R"("diagonal": )", R"("diagonal": 1e999, "was": )");
  change("tolerance_word", R"("tolerance": )", R"("tolerance": "small", "was": )");
  change("regions_missing", R"("regions")", R"("areas")");
  change("id_negative", R"("id": 0)", R"("id": -1)");
  change("id_huge", R"("id": 0)", R"("id": 4294967296)");
  change("id_fraction", R"("id": 0)", R"("id": 0.5)");
  change("group_unknown", R"("C2v")", R"("C2w")");
  change("group_trivial", R"("C2v")", R"("C1")");
  change("group_of_order_2_32", R"("C2v")", R"("C4294967296")");
  change("group_long", R"("C2v")", R"("C)" + std::string(10'000, '9') + R"(v")");
  change("group_other_of_same_order", R"("C2v")", R"("C4")");
  change("group_continuous", R"("C2v")", R"("Cinfv")");
  change("centre_short", R"("centre": [0, 0, 0])", R"("centre": [0, 0])");
  change("centre_far", R"("centre": [0, 0, 0])", R"("centre": [9, 0, 0])");
  change("centre_1e300", R"("centre": [0, 0, 0])", R"("centre": [1e300, 0, 0])");
  change("axis_0", R"("axis": [0, 0, 1])", R"("axis": [0, 0, 0])");
  change("axis_long", R"("axis": [0, 0, 1])", R"("axis": [0, 0, 2])");
  change("axis_other", R"("axis": [0, 0, 1])", R"("axis": [1, 0, 0])");
  change("run_beyond", "[0, 12]", "[0, 13]");
  change("run_negative", "[0, 12]", "[-1, 12]");
  change("run_empty", "[0, 12]", "[0, 0]");
  change("run_2_63", "[0, 12]", "[1, 9223372036854775807]");
  change("run_touching", "[0, 12]", "[4, 8], [0, 6]");
  change("runs_none", "[[0, 12]]", "[]");
  change("matrix_skewed", "[[1, 0, 0, 0]", "[[1.1, 0, 0, 0]");
  change("matrix_zero", "[[1, 0, 0, 0]", "[[0, 0, 0, 0]");
  change("matrix_short", "[[1, 0, 0, 0]", "[[1, 0, 0]");
  change("matrix_word", "[[1, 0, 0, 0]", R"([["1", 0, 0, 0])");
  change("matrix_moves_centre", "[[1, 0, 0, 0]", "[[1, 0, 0, 5]");
  change("parent_itself", R"("parent": null)", R"("parent": 0)");
  change("parent_missing", R"("parent": null)", R"("parent": 77)");
  change("residual_negative", R"("rms": )", R"("rms": -1, "was": )");
  change("importance_half", R"("parent": null)", R"("parent": null, "importance": 0.5)");
  change("importance_negative", R"("parent": null)", R"("parent": null, "importance": -0.5)");
  change("importance_2", R"("parent": null)", R"("parent": null, "importance": 2)");
  change("importance_word", R"("parent": null)", R"("parent": null, "importance": "large")");
  change("name_missing", R"("name")", R"("title")");
  change("pattern_word", R"("patterns": [)", R"("patterns": ["row")");
  change("pattern_kind", R"("patterns": [)", R"("patterns": [{"id": 0, "name": "", "kind": "helix"})");
}

void add_edits(BadInputs& files) {
  const auto add = [&](BadInputKind kind, const std::string& name, const std::string& content) {
    files.push_back({name + ".json", kind, content});
  };
  const std::string handles =
      R"({"alpha": 100, "iterations": 10, "handles": [)"
      R"({"name": "a", "centre": [0.5, 0.5, 0.5], "radius": 0.1, "translation": [0.1, 0, 0],)"
      R"( "rotation": {"axis": [0, 0, 1], "degrees": 30}}, {"name": "b", "vertices": [0, 1]}]})";
  add_json_texts(files, "handles", BadInputKind::handles, handles);
  const auto change = [&](const std::string& what, const std::string& from, const std::string& to) {
    add(BadInputKind::handles, "handles_" + what, with(handles, from, to));
  };
  change("alpha_0", R"("alpha": 100)", R"("alpha": 0)");
  change("alpha_negative", R"("alpha": 100)", R"("alpha": -1)");
  change("alpha_infinite", R"("alpha": 100)", R"("alpha": 1e999)");
  change("iterations_0", R"("iterations": 10)", R"("iterations": 0)");
  change("iterations_huge", R"("iterations": 10)", R"("iterations": 4000000000)");
  change("iterations_fraction", R"("iterations": 10)", R"("iterations": 1.5)");
  change("handles_missing", R"("handles")", R"("grips")");
  change("handles_none", handles.substr(handles.find("[{")), "[]}");
  change("radius_0", R"("radius": 0.1)", R"("radius": 0)");
  change("radius_negative", R"("radius": 0.1)", R"("radius": -0.1)");
  change("radius_1e300", R"("radius": 0.1)", R"("radius": 1e300)");
  change("radius_missing", R"("radius": 0.1, )", "");
  change("centre_far", "[0.5, 0.5, 0.5]", "[50, 50, 50]");
  change("centre_1e300", "[0.5, 0.5, 0.5]", "[1e300, 0, 0]");
  change("vertex_beyond", "[0, 1]", "[0, 8]");
  change("vertex_negative", "[0, 1]", "[0, -1]");
  change("vertex_2_32", "[0, 1]", "[0, 4294967296]");
  change("vertex_fraction", "[0, 1]", "[0, 0.5]");
  change("vertex_twice", "[0, 1]", "[0, 0, 1, 1]");
  change("vertices_none", "[0, 1]", "[]");
  change("axis_0", "[0, 0, 1]", "[0, 0, 0]");
  change("degrees_1e300", R"("degrees": 30)", R"("degrees": 1e300)");
  change("translation_1e300", "[0.1, 0, 0]", "[1e300, 0, 0]");
  change("translation_short", "[0.1, 0, 0]", "[0.1]");

  const std::string landmarks = R"({"landmarks": [{"vertex": 2, "target": [0, 0, 1]}]})";
  add_json_texts(files, "landmarks", BadInputKind::landmarks, landmarks);
  add(BadInputKind::landmarks, "landmarks_none", R"({"landmarks": []})");
  add(BadInputKind::landmarks, "landmarks_whole", landmarks);
  add(BadInputKind::landmarks, "landmarks_list_number", R"({"landmarks": 3})");
  add(BadInputKind::landmarks, "landmarks_entry_word", R"({"landmarks": ["vertex"]})");
  add(BadInputKind::landmarks, "landmarks_target_missing", R"({"landmarks": [{"vertex": 2}]})");
  add(BadInputKind::landmarks, "landmarks_target_words", with(landmarks, "[0, 0, 1]", R"(["0", "0", "1"])"));
  add(BadInputKind::landmarks, "landmarks_vertex_twice",
      with(landmarks, "]}]", R"(]}, {"vertex": 2, "target": [1, 0, 1]}])"));
  add(BadInputKind::landmarks, "landmarks_target_twice",
      with(landmarks, "]}]", R"(]}, {"vertex": 3, "target": [0, 0, 1]}])"));
  add(BadInputKind::landmarks, "landmarks_vertex_beyond", with(landmarks, ": 2", ": 8"));
  add(BadInputKind::landmarks, "landmarks_vertex_negative", with(landmarks, ": 2", ": -1"));
  add(BadInputKind::landmarks, "landmarks_vertex_word", with(landmarks, ": 2", ": \"2\""));
  add(BadInputKind::landmarks, "landmarks_target_short", with(landmarks, "[0, 0, 1]", "[0, 0]"));
  add(BadInputKind::landmarks, "landmarks_target_infinite", with(landmarks, "[0, 0, 1]", "[0, 0, 1e999]"));

  const std::string radii = R"({"areas": [{"centre": [0, 0, 0], "radius": 1, "factor": 0.5}], "smallest": 0.5})";
  add_json_texts(files, "radii", BadInputKind::radius_field, radii);
  add(BadInputKind::radius_field, "radii_whole", radii);
  add(BadInputKind::radius_field, "radii_areas_word", R"({"areas": "all"})");
  add(BadInputKind::radius_field, "radii_area_word", R"({"areas": ["all"]})");
  add(BadInputKind::radius_field, "radii_factor_missing", with(radii, R"(, "factor": 0.5)", ""));
  add(BadInputKind::radius_field, "radii_centre_short", with(radii, "[0, 0, 0]", "[0, 0]"));
  add(BadInputKind::radius_field, "radii_centre_words", with(radii, "[0, 0, 0]", R"(["0", 0, 0])"));
  add(BadInputKind::radius_field, "radii_radius_word", with(radii, R"("radius": 1)", R"("radius": "1")"));
  add(BadInputKind::radius_field, "radii_feature_size", R"({"feature_size": true, "gradation": 0.3})");
  add(BadInputKind::radius_field, "radii_feature_size_word", R"({"feature_size": "yes"})");
  add(BadInputKind::radius_field, "radii_radius_0", with(radii, R"("radius": 1)", R"("radius": 0)"));
  add(BadInputKind::radius_field, "radii_factor_negative", with(radii, R"("factor": 0.5)", R"("factor": -1)"));
  add(BadInputKind::radius_field, "radii_centre_word", with(radii, "[0, 0, 0]", R"("origin")"));
  add(BadInputKind::radius_field, "radii_smallest_0", with(radii, R"("smallest": 0.5)", R"("smallest": 0)"));
  add(BadInputKind::radius_field, "radii_smallest_above_largest",
      with(radii, R"("smallest": 0.5)", R"("smallest": 5)"));
  add(BadInputKind::radius_field, "radii_gradation_infinite",
      with(radii, R"("smallest": 0.5)", R"("gradation": 1e999)"));
}

void add_manifests(BadInputs& files) {
  const auto add = [&](const std::string& what, const std::string& content) {
    files.push_back({"manifest_" + what + ".jsonl", BadInputKind::manifest, content});
  };
  const std::string line = R"({"id": "a", "mesh": "a.obj"})"
                           "\n";
  add("empty", "");
  add("blank", "\n\n");
  add("whole", line);
  add("cut", line + line.substr(0, 12));
  add("id_twice", line + line);
  add("id_empty", with(line, "\"a\"", "\"\""));
  add("id_number", with(line, "\"a\"", "7"));
  add("id_wrong_utf8", with(line, "\"a\"", "\"\xff\""));
  add("id_leaves_folder", with(line, "\"a\"", "\"../../a\""));
  add("mesh_missing", R"({"id": "a"})"
                      "\n");
  add("mesh_list", with(line, "\"a.obj\"", "[]"));
  add("scans_number", with(line, "}", R"(, "scans": 3})"));
  add("options_list", with(line, "}", R"(, "options": []})"));
  add("list", "[]\n");
  add("all_keys",
      with(line, "}", R"(, "scan": "a.ply", "scans": ["b.ply"], "annotation": "a.json", "options": {"seed": 3}})"));
  add("scan_list", with(line, "}", R"(, "scan": ["a.ply"]})"));
  add("scans_of_numbers", with(line, "}", R"(, "scans": [3]})"));
  add("annotation_number", with(line, "}", R"(, "annotation": 3})"));
  add("blank_lines", "\n" + line + "  \r\n" + with(line, "\"a\"", "\"b\"") + "\n");
  add("nested", std::string(100'000, '['));
}

}  // namespace

void add_bad_json(BadInputs& files) {
  add_annotations(files);
  add_edits(files);
  add_manifests(files);
}

}  // namespace orbifit
