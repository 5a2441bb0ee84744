#include <filesystem>
#include <memory>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "orbifit/detection/detect.h"
#include "orbifit/model/annotation_io.h"
#include "orbifit/model/errors.h"
#include "orbifit/model/mesh_io.h"
#include "orbifit/subspace/subspace_io.h"

#include "../commands.h"
#include "../editor_page.h"
#include "../of_file.h"
#include "../subspace_arguments.h"
#include "files/file.h"

namespace orbifit::commands {

namespace {

struct EditArguments {
  std::string mesh, annotation, output;
  bool open = false;
  std::vector<int> without;
  SubspaceArguments subspace;
};

// A folder that goes away with this.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "orbifit-XXXXXX").string();
    if (::mkdtemp(pattern.data()) == nullptr) throw InputError(pattern, "", "the folder cannot be made");
    folder_ = pattern;
  }
  ~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  std::filesystem::path operator/(const char* name) const { return folder_ / name; }

 private:
  std::filesystem::path folder_;
};

// How the page samples when it builds a basis anew.
std::string sampling_json(const SubspaceArguments& arguments) {
  const SubspaceOptions& options = arguments.options;
  nlohmann::ordered_json result{{"lift", options.lift == LiftKind::orbit ? 0 : 1},
                                {"radius", options.radius},
                                {"samples", options.samples},
                                {"sharp", options.sharp_features_first}};
  if (const std::filesystem::path field(arguments.radius_field); !field.empty()) {
    result["radius_field"] = {{"name", field.filename().string()}, {"text", read_file(field)}};
  }
  return result.dump();
}

// Shows a page in the user's browser.
void open_page(const std::string& file, const RunContext& run) {
  const pid_t child = ::fork();
  if (child == 0) {
    ::execlp("xdg-open", "xdg-open", file.c_str(), static_cast<char*>(nullptr));
    ::_exit(127);
  }
  if (child < 0) run.message("the page could not be opened; open " + file + " in a browser");
}

}  // namespace

CommandBody edit(CLI::App& app) {
  const auto arguments = std::make_shared<EditArguments>();
  app.add_option("MESH", arguments->mesh, "Mesh to edit")->required();
  app.add_option("ANNOTATION", arguments->annotation, "Its annotation (.json); without one it is detected first");
  app.add_option("-o,--output", arguments->output, "Page to write (.html)")->required()->type_name("FILE");
  app.add_flag("--open", arguments->open, "Open it in the browser");
  add_without_option(app, arguments->without);
  add_subspace_options(app, arguments->subspace);
  return [arguments](CommandContext& context) {
    arguments->subspace.options.validate();
    check_output(arguments->output, {".html"}, {arguments->annotation, arguments->subspace.radius_field});
    const Mesh mesh = read_mesh(arguments->mesh);
    const SubspaceOptions options = subspace_options(arguments->subspace, mesh, context.run);
    SymmetryAnnotation annotation =
        arguments->annotation.empty()
            ? of_file(arguments->mesh, [&] { return orbifit::detect(mesh, DetectOptions{}, context.run); })
            : read_annotation(arguments->annotation, mesh);
    annotation = without(arguments->without, std::move(annotation));
    const Subspace subspace = build_consistent(mesh, annotation, options, context.run);
    context.run.progress("page", 0);

    const ScratchFolder scratch;
    write_mesh(scratch / "mesh.ply", mesh);
    write_subspace(scratch / "basis", subspace, mesh, annotation);
    const std::filesystem::path source(arguments->mesh);
    const std::string page = page_with(
        editor_page(),
        {{"mesh", source.stem().string() + ".ply", source.filename().string(), read_file(scratch / "mesh.ply")},
         {"annotation", "annotation.json", arguments->annotation, to_json(annotation)},
         {"sampling", "sampling.json", "", sampling_json(arguments->subspace)},
         {"basis", to_string(subspace.mode()), "", read_file(scratch / "basis")}});
    write_file(arguments->output, page);
    if (arguments->open) open_page(arguments->output, context.run);

    if (context.json) {
      const nlohmann::ordered_json summary{{"page", arguments->output},
                                           {"bytes", page.size()},
                                           {"bytes_without_mesh", editor_page().size()},
                                           {"regions", annotation.regions.size()},
                                           {"patterns", annotation.patterns.size()},
                                           {"samples", subspace.samples().rows()},
                                           {"degrees_of_freedom", subspace.degrees_of_freedom()}};
      print(summary.dump(2) + "\n");
      return kDone;
    }
    print(arguments->output + ": " + count_of(static_cast<long long>(annotation.regions.size()), "region") + ", " +
          count_of(subspace.degrees_of_freedom(), "degree of freedom", "degrees of freedom") + ", " +
          short_number(static_cast<double>(page.size()) / 1e6, 3) + " MB; open it in a browser\n");
    return kDone;
  };
}

}  // namespace orbifit::commands
