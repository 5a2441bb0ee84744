#include "orbifit/apps/report.h"

#include <filesystem>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "orbifit/apps/annotation_pictures.h"
#include "orbifit/apps/upright.h"
#include "orbifit/model/annotation_io.h"
#include "orbifit/model/errors.h"
#include "orbifit/model/mesh_io.h"

#include "../commands.h"
#include "files/file.h"

namespace orbifit::commands {

namespace {

// Reads the description of a report; every refusal names the file and the key.
class StepsReader {
 public:
  /// \param page  that will link to the files
  StepsReader(const std::filesystem::path& file, const std::filesystem::path& page, const RunContext& run)
      : file_(file), page_(page), run_(run) {}

  Report read() const {
    nlohmann::json json;
    try {
      json = nlohmann::json::parse(read_file(file_));
    } catch (const nlohmann::json::parse_error& error) {
      throw InputError(file_.string(), "byte " + std::to_string(error.byte), "not JSON");
    }
    if (!json.is_object()) throw InputError(file_.string(), "", "not a JSON object");
    Report report;
    report.title = text(json, "title", "");
    report.intro = text(json, "intro", "");
    for (const auto& [section, place] : list(json, "sections", ""))
      report.sections.push_back(read_section(*section, place));
    return report;
  }

 private:
  using Items = std::vector<std::pair<const nlohmann::json*, std::string>>;

  [[noreturn]] void refuse(const std::string& place, const std::string& reason) const {
    throw InputError(file_.string(), place, reason);
  }

  static std::string key_at(const std::string& place, const std::string& key) {
    return place.empty() ? key : place + "." + key;
  }

  // A missing key is an empty text.
  std::string text(const nlohmann::json& json, const std::string& key, const std::string& place) const {
    const auto found = json.find(key);
    if (found == json.end()) return "";
    if (!found->is_string()) refuse(key_at(place, key), "must be a text");
    return found->get<std::string>();
  }

  // A missing key is an empty list.
  Items list(const nlohmann::json& json, const std::string& key, const std::string& place,
             bool of_objects = true) const {
    Items items;
    const auto found = json.find(key);
    if (found == json.end()) return items;
    if (!found->is_array()) refuse(key_at(place, key), "must be a list");
    for (std::size_t i = 0; i < found->size(); ++i) {
      items.emplace_back(&(*found)[i], key_at(place, key) + "[" + std::to_string(i) + "]");
      if (of_objects && !items.back().first->is_object()) refuse(items.back().second, "must be an object");
    }
    return items;
  }

  // Numbers are taken as they are written.
  std::string cell(const nlohmann::json& json, const std::string& place) const {
    if (json.is_string()) return json.get<std::string>();
    if (json.is_number_float()) return short_number(json.get<double>());
    if (json.is_number() || json.is_boolean()) return json.dump();
    if (json.is_null()) return "";
    refuse(place, "must be a text or a number");
  }

  std::vector<std::string> cells(const nlohmann::json& row, const std::string& place) const {
    if (!row.is_array()) refuse(place, "must be a list");
    std::vector<std::string> result;
    for (std::size_t i = 0; i < row.size(); ++i) result.push_back(cell(row[i], place + "[" + std::to_string(i) + "]"));
    return result;
  }

  ReportPicture read_picture(const nlohmann::json& json, const std::string& place) const {
    const std::string name = text(json, "file", place);
    if (name.empty()) refuse(key_at(place, "file"), "missing");
    const std::filesystem::path file = file_.parent_path() / name;
    if (lower_extension(file) != ".png") refuse(key_at(place, "file"), "\"" + name + "\" is not a .png");
    ReportPicture picture{read_file(file), text(json, "caption", place)};
    if (picture.png.compare(0, 4, "\x89PNG") != 0) throw InputError(file.string(), "", "not a PNG");
    return picture;
  }

  ReportLink read_link(const nlohmann::json& json, const std::string& place) const {
    const std::string name = cell(json, place);
    const std::filesystem::path file = file_.parent_path() / name;
    if (!std::filesystem::is_regular_file(file)) refuse(place, "\"" + name + "\" is no file beside it");
    const std::filesystem::path folder = std::filesystem::absolute(page_).parent_path();
    return {std::filesystem::absolute(file).lexically_normal().lexically_relative(folder.lexically_normal()).string(),
            name};
  }

  // Pictures of all that an annotation holds.
  void read_regions(const nlohmann::json& json, const std::string& place, std::vector<ReportPicture>& pictures) const {
    if (!json.is_object()) refuse(place, "must be an object with a mesh and its annotation");
    const std::filesystem::path mesh_file = file_.parent_path() / text(json, "mesh", place);
    const Mesh mesh = read_mesh(mesh_file);
    const SymmetryAnnotation annotation = read_annotation(file_.parent_path() / text(json, "annotation", place), mesh);
    ViewOptions view;
    view.width = 400;
    view.height = 320;
    view.up = up_of(mesh, mesh_file, &annotation);
    for (const AnnotationPicture& each : annotation_pictures(mesh, annotation, view, run_)) {
      pictures.push_back({encode_png(each.image), each.title + "\n" + each.detail});
    }
  }

  ReportTable read_table(const nlohmann::json& json, const std::string& place) const {
    ReportTable table;
    for (const auto& [header, at] : list(json, "headers", place, false)) table.headers.push_back(cell(*header, at));
    for (const auto& [row, at] : list(json, "rows", place, false)) {
      table.rows.push_back(cells(*row, at));
      if (table.rows.back().size() != table.headers.size()) {
        refuse(at, "has " + std::to_string(table.rows.back().size()) + " cells: must be " +
                       std::to_string(table.headers.size()) + ", as many as headers");
      }
    }
    return table;
  }

  ReportSection read_section(const nlohmann::json& json, const std::string& place) const {
    ReportSection section;
    section.title = text(json, "title", place);
    section.text = text(json, "text", place);
    section.command = text(json, "command", place);
    section.output = text(json, "output", place);
    for (const auto& [picture, at] : list(json, "pictures", place))
      section.pictures.push_back(read_picture(*picture, at));
    if (const auto regions = json.find("regions"); regions != json.end()) {
      read_regions(*regions, key_at(place, "regions"), section.pictures);
    }
    for (const auto& [file, at] : list(json, "files", place, false)) section.files.push_back(read_link(*file, at));
    for (const auto& [table, at] : list(json, "tables", place)) section.tables.push_back(read_table(*table, at));
    for (const auto& [note, at] : list(json, "notes", place, false)) section.notes.push_back(cell(*note, at));
    return section;
  }

  std::filesystem::path file_, page_;
  const RunContext& run_;
};

}  // namespace

CommandBody report(CLI::App& app) {
  struct Arguments {
    std::string steps, output;
  };
  const auto arguments = std::make_shared<Arguments>();
  app.add_option("STEPS", arguments->steps, "Description of the page (.json); its files are found beside it")
      ->required();
  app.add_option("-o,--output", arguments->output, "Page to write (.html)")->required()->type_name("FILE");
  return [arguments](CommandContext& context) {
    check_output(arguments->output, {".html", ".htm"}, {arguments->steps});
    const Report report = StepsReader(arguments->steps, arguments->output, context.run).read();
    const std::string page = to_html(report);
    context.run.check();
    write_file(arguments->output, page);
    std::size_t pictures = 0;
    for (const ReportSection& section : report.sections) pictures += section.pictures.size();
    if (context.json) {
      const nlohmann::ordered_json summary{{"page", arguments->output},
                                           {"sections", report.sections.size()},
                                           {"pictures", pictures},
                                           {"bytes", page.size()}};
      print(context, summary.dump(2) + "\n");
    } else {
      print(context, arguments->output + ": " + count_of(static_cast<long long>(report.sections.size()), "section") +
                         ", " + count_of(static_cast<long long>(pictures), "picture") + "\n");
    }
    return kDone;
  };
}

}  // namespace orbifit::commands
