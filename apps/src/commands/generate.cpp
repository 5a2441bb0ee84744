#include "orbifit/datasets_tools/generate.h"

#include <charconv>
#include <filesystem>
#include <memory>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "orbifit/model/annotation_io.h"
#include "orbifit/model/errors.h"
#include "orbifit/model/mesh_io.h"

#include "../commands.h"

namespace orbifit::commands {

namespace fs = std::filesystem;

namespace {

struct GenerateArguments {
  std::string name, folder;
  std::vector<std::string> parameters;
  bool list = false;
};

std::map<std::string, double> parse_parameters(const std::vector<std::string>& texts) {
  std::map<std::string, double> result;
  for (const std::string& text : texts) {
    const std::size_t equals = text.find('=');
    double value = 0;
    const char* end = text.data() + text.size();
    const char* begin = equals == std::string::npos ? end : text.data() + equals + 1;
    const auto [stop, error] = std::from_chars(begin, end, value);
    if (error != std::errc{} || stop != end || equals == 0) {
      throw UsageError("--param '" + text + "': must be NAME=NUMBER");
    }
    if (!result.emplace(text.substr(0, equals), value).second) {
      throw UsageError("--param '" + text + "': the parameter is given twice");
    }
  }
  return result;
}

int list_models(CommandContext& context) {
  if (context.json) {
    nlohmann::ordered_json models = nlohmann::ordered_json::array();
    for (const Generator& model : generators()) {
      nlohmann::ordered_json parameters = nlohmann::ordered_json::array();
      for (const GeneratorParameter& parameter : model.parameters) {
        parameters.push_back({{"name", parameter.name},
                              {"default", parameter.value},
                              {"minimum", parameter.minimum},
                              {"maximum", parameter.maximum},
                              {"integer", parameter.integer},
                              {"meaning", parameter.meaning}});
      }
      models.push_back({{"name", model.name}, {"meaning", model.meaning}, {"parameters", parameters}});
    }
    print(context, nlohmann::ordered_json{{"models", models}}.dump(2) + "\n");
    return kDone;
  }
  std::string text;
  for (const Generator& model : generators()) {
    text += (text.empty() ? "" : "\n") + model.name + ": " + model.meaning + "\n";
    TextTable table({"parameter", "default", "from", "to", "meaning"});
    for (const GeneratorParameter& parameter : model.parameters) {
      table.add({parameter.name, short_number(parameter.value), short_number(parameter.minimum),
                 short_number(parameter.maximum), parameter.meaning});
    }
    text += table.text();
  }
  print(context, text);
  return kDone;
}

}  // namespace

CommandBody generate(CLI::App& app) {
  const auto arguments = std::make_shared<GenerateArguments>();
  app.add_option("NAME", arguments->name, "Model to build; --list shows them")->type_name("");
  app.add_option("--param", arguments->parameters, "Parameter of the model; may be repeated")
      ->type_name("NAME=NUMBER")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  app.add_option("-o,--output", arguments->folder, "Folder for NAME.ply and NAME.annotation.json; created if missing")
      ->type_name("FOLDER");
  app.add_flag("--list", arguments->list, "List the models and their parameters");
  return [arguments](CommandContext& context) -> int {
    if (arguments->list) return list_models(context);
    if (arguments->name.empty()) throw UsageError("a model's NAME is needed ('orbifit generate --list' shows them)");
    if (arguments->folder.empty()) throw UsageError("-o FOLDER is needed");
    const GeneratedModel model = orbifit::generate(arguments->name, parse_parameters(arguments->parameters));
    context.run.check();
    const fs::path folder = arguments->folder;
    make_folder(folder);
    const fs::path mesh_file = folder / (arguments->name + ".ply");
    const fs::path annotation_file = folder / (arguments->name + ".annotation.json");
    check_output(mesh_file);
    check_output(annotation_file);
    write_mesh(mesh_file, model.mesh);
    write_annotation(annotation_file, model.truth);
    if (context.json) {
      print(context, nlohmann::ordered_json{{"mesh", mesh_file.string()},
                                            {"annotation", annotation_file.string()},
                                            {"vertices", model.mesh.vertices.rows()},
                                            {"faces", model.mesh.faces.rows()},
                                            {"regions", model.truth.regions.size()},
                                            {"patterns", model.truth.patterns.size()}}
                             .dump(2) +
                         "\n");
    } else {
      print(context, mesh_file.string() + ": " + count_of(model.mesh.vertices.rows(), "vertex", "vertices") + ", " +
                         count_of(model.mesh.faces.rows(), "triangle") + "\n" + annotation_file.string() + ": " +
                         count_of(static_cast<long long>(model.truth.regions.size()), "region") + ", " +
                         count_of(static_cast<long long>(model.truth.patterns.size()), "pattern") + "\n");
    }
    return kDone;
  };
}

}  // namespace orbifit::commands
