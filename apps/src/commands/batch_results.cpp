#include "batch_results.h"

#include <filesystem>
#include <memory>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "orbifit/model/errors.h"

#include "batch/bop.h"
#include "batch/collection.h"
#include "batch/export.h"
#include "batch/item_names.h"
#include "batch/layouts.h"
#include "files/file.h"

namespace orbifit::commands {

namespace fs = std::filesystem;

namespace {

// Of the diagonal, between shapes that are told to be the same: what files in single precision differ by is far below.
constexpr double kSameWithin = 1e-3;

struct ResultsArguments {
  std::string folder, output, sqlite, csv, models_info, layout, annotations;
  double same_within = kSameWithin;
};

nlohmann::ordered_json to_json(const batch::CollectionStatus& status) {
  nlohmann::ordered_json by_status, begun = nlohmann::ordered_json::array();
  for (std::size_t s = 0; s < batch::kStatusNames.size(); ++s) by_status[batch::kStatusNames[s]] = status.by_status[s];
  for (const auto& part : status.begun) {
    begun.push_back({{"shard", part.shard.index}, {"items", part.items}, {"done", part.done}});
  }
  return {{"task", status.task},
          {"shards", status.shards},
          {"begun", begun},
          {"status", by_status},
          {"seconds", status.seconds},
          {"peak_memory", status.peak_memory},
          {"unreadable_lines", status.unreadable_lines}};
}

std::string to_text(const batch::CollectionStatus& status) {
  std::uint64_t items = 0, done = 0;
  TextTable parts({"shard", "items", "done"});
  for (const auto& part : status.begun) {
    items += part.items;
    done += part.done;
    parts.add({std::to_string(part.shard.index), std::to_string(part.items), std::to_string(part.done)});
  }
  TextTable statuses({"status", "items"});
  for (std::size_t s = 0; s < batch::kStatusNames.size(); ++s) {
    if (status.by_status[s] > 0) statuses.add({batch::kStatusNames[s], std::to_string(status.by_status[s])});
  }
  std::string text =
      status.task + ": " + std::to_string(done) + " of " + count_of(static_cast<long long>(items), "item") + " done";
  if (static_cast<int>(status.begun.size()) < status.shards) {
    text += " in the " + std::to_string(status.begun.size()) + " of " + std::to_string(status.shards) +
            " shards that have begun";
  }
  text += "\n" + statuses.text();
  if (status.shards > 1) text += parts.text();
  text += short_number(status.seconds) + " s in all items, at most " +
          short_number(static_cast<double>(status.peak_memory) / 1e6, 3) + " MB in one\n";
  if (status.unreadable_lines > 0) {
    text += count_of(static_cast<long long>(status.unreadable_lines), "line") +
            " unreadable; their items will be done again\n";
  }
  return text;
}

std::size_t repeated(const std::vector<std::size_t>& firsts) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < firsts.size(); ++i) count += firsts[i] != i ? 1 : 0;
  return count;
}

std::string same_text(const batch::SameShapes& same) {
  return count_of(static_cast<long long>(repeated(same.same_file)), "item") + " with the file of another, " +
         count_of(static_cast<long long>(repeated(same.same_shape)), "item") +
         " with the same shape up to a similarity";
}

int show_status(const ResultsArguments& arguments, const CommandContext& context) {
  const batch::CollectionStatus status = batch::status_of(batch::Collection(arguments.folder));
  print(context.json ? to_json(status).dump(2) + "\n" : to_text(status));
  return kDone;
}

int write_report(const ResultsArguments& arguments, const CommandContext& context) {
  const batch::Collection collection(arguments.folder);
  const fs::path folder =
      arguments.output.empty() ? fs::path(arguments.folder) / "gallery" : fs::path(arguments.output);
  const batch::SameShapes same = batch::find_same_shapes(collection, arguments.same_within, context.run);
  batch::write_gallery(collection, same, folder, context.run);
  const std::string page = (folder / "index.html").string();
  const nlohmann::ordered_json json{{"page", page},
                                    {"items", collection.size()},
                                    {"same_file", repeated(same.same_file)},
                                    {"same_shape", repeated(same.same_shape)}};
  print(context.json ? json.dump(2) + "\n"
                     : page + ": " + count_of(static_cast<long long>(collection.size()), "item") + "; " +
                           same_text(same) + "\n");
  return kDone;
}

int write_exports(const ResultsArguments& arguments, const CommandContext& context) {
  if (arguments.sqlite.empty() && arguments.csv.empty() && arguments.models_info.empty()) {
    throw UsageError("nothing to export: name --sqlite, --csv or --models-info");
  }
  const batch::Collection collection(arguments.folder);
  std::string text;
  nlohmann::ordered_json json{{"items", collection.size()}};
  if (!arguments.models_info.empty()) {
    check_output(arguments.models_info, {".json"});
    batch::write_models_info(collection, arguments.models_info);
    text += arguments.models_info + "\n";
  }
  if (!arguments.sqlite.empty()) check_output(arguments.sqlite);
  if (!arguments.sqlite.empty() || !arguments.csv.empty()) {
    const batch::SameShapes same = batch::find_same_shapes(collection, arguments.same_within, context.run);
    if (!arguments.sqlite.empty()) batch::write_database(collection, same, arguments.sqlite, context.run);
    if (!arguments.csv.empty()) batch::write_csv(collection, same, arguments.csv, context.run);
    text += (arguments.sqlite.empty() ? arguments.csv : arguments.sqlite) + ": " +
            count_of(static_cast<long long>(collection.size()), "item") + "; " + same_text(same) + "\n";
    json["same_file"] = repeated(same.same_file);
    json["same_shape"] = repeated(same.same_shape);
  }
  print(context.json ? json.dump(2) + "\n" : text);
  return kDone;
}

int write_manifest(const ResultsArguments& arguments, const CommandContext& context) {
  check_output(arguments.output, {".jsonl", ".json"});
  if (!arguments.annotations.empty() && arguments.layout != "bop") {
    throw UsageError("--annotations is for the layout bop, whose models_info.json has symmetries");
  }
  std::string text;
  std::size_t items = 0;
  batch::for_each_item(arguments.layout, arguments.folder, [&](batch::Item item) {
    item.mesh = fs::absolute(item.mesh);
    if (!batch::is_utf8(item.mesh.native())) {
      return context.run.message("left out, since its name is no UTF-8: " + item.id);
    }
    if (!arguments.annotations.empty()) batch::add_bop_annotation(item, fs::absolute(arguments.annotations));
    text += batch::manifest_line(item) + "\n";
    ++items;
  });
  write_file(arguments.output, text);
  print(context.json ? nlohmann::ordered_json{{"manifest", arguments.output}, {"items", items}}.dump(2) + "\n"
                     : arguments.output + ": " + count_of(static_cast<long long>(items), "item") + "\n");
  return kDone;
}

std::string layouts_text() {
  std::string text = "Known layouts:\n";
  for (const batch::Layout& layout : batch::known_layouts()) {
    text += std::string("  ") + layout.name + ": " + layout.dataset + " (" + layout.files + ")\n";
  }
  return text;
}

}  // namespace

std::function<std::optional<int>(CommandContext&)> define_batch_results(CLI::App& app) {
  const auto arguments = std::make_shared<ResultsArguments>();
  const auto add = [&](const char* name, const char* summary) {
    CLI::App* sub = app.add_subcommand(name, summary)->fallthrough();
    return sub;
  };
  const auto add_folder = [&](CLI::App* sub) {
    sub->add_option("DIR", arguments->folder, "Folder of results")->required()->type_name("DIR");
  };
  const auto add_same = [&](CLI::App* sub) {
    sub->add_option("--same-within", arguments->same_within,
                    "Largest distance between shapes that are told to be the same, as a fraction of the diagonal")
        ->capture_default_str();
  };
  CLI::App* status = add("status", "How far it is, and how its items ended");
  add_folder(status);
  CLI::App* report = add("report", "Write a page that shows all items");
  add_folder(report);
  add_same(report);
  report->add_option("-o,--output", arguments->output, "Folder of the page; DIR/gallery unless named")
      ->type_name("FOLDER");
  CLI::App* exports = add("export", "Write tables");
  add_folder(exports);
  add_same(exports);
  exports->add_option("--sqlite", arguments->sqlite, "Database of SQLite")->type_name("FILE");
  exports->add_option("--csv", arguments->csv, "Folder for CSV tables")->type_name("FOLDER");
  exports->add_option("--models-info", arguments->models_info, "Symmetries as BOP has them (.json)")->type_name("FILE");
  CLI::App* manifest = add("manifest", "List a data set as it is published");
  manifest->footer(layouts_text());
  manifest->add_option("LAYOUT", arguments->layout, "Its name, as listed below")->required();
  manifest->add_option("FOLDER", arguments->folder, "Where it lies")->required();
  manifest->add_option("-o,--output", arguments->output, "Manifest to write (.jsonl)")->required()->type_name("FILE");
  manifest->add_option("--annotations", arguments->annotations, "Folder for the symmetries of bop's models_info.json")
      ->type_name("FOLDER");
  return [=](CommandContext& context) -> std::optional<int> {
    if (status->parsed()) return show_status(*arguments, context);
    if (report->parsed()) return write_report(*arguments, context);
    if (exports->parsed()) return write_exports(*arguments, context);
    if (manifest->parsed()) return write_manifest(*arguments, context);
    return std::nullopt;
  };
}

}  // namespace orbifit::commands
