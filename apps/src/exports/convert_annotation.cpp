#include "convert_annotation.h"

#include <algorithm>
#include <optional>

#include <nlohmann/json.hpp>

#include "orbifit/model/annotation_io.h"
#include "orbifit/model/errors.h"
#include "orbifit/model/mesh_io.h"

#include "../console.h"
#include "annotated_files.h"
#include "batch/bop.h"
#include "correspondences.h"
#include "files/file.h"
#include "files/text.h"

namespace orbifit {

namespace {

using Json = nlohmann::ordered_json;

struct Written {
  Json json;
  std::string text;
};

// The number of a BOP model by its file's name, obj_000012.ply; 1 for other names.
std::string bop_number(const std::string& mesh) {
  const std::string stem = std::filesystem::path(mesh).stem().string();
  constexpr std::string_view kPrefix = "obj_";
  const auto number =
      stem.starts_with(kPrefix) ? parse_integer(std::string_view(stem).substr(kPrefix.size())) : std::nullopt;
  return std::to_string(number.value_or(1));
}

SymmetryAnnotation read_any(const AnnotationConversion& conversion, const Mesh& mesh) {
  const std::string text = read_file(conversion.input);
  const Json root = Json::parse(text, nullptr, false);
  if (!root.is_object() || root.contains("format")) return annotation_from_json(text, mesh, conversion.input);
  const std::string number = bop_number(conversion.mesh);
  if (!root.contains(number)) {
    throw InputError(conversion.input, "",
                     "is no annotation, and no models_info.json with an object " + number + ", which " +
                         conversion.mesh + " is by its name");
  }
  return batch::annotation_from_bop(root[number].dump(), mesh, conversion.input + ": " + number);
}

const Region& chosen_region(const AnnotationConversion& conversion, const SymmetryAnnotation& annotation) {
  const auto found = std::ranges::find_if(annotation.regions, [&](const Region& region) {
    return conversion.region < 0 ? !region.elements.empty() : region.id == conversion.region;
  });
  if (found == annotation.regions.end()) {
    if (conversion.region >= 0)
      throw UsageError("--region is " + std::to_string(conversion.region) + ": " + conversion.input +
                       " has no such region");
    throw InputError(conversion.input, "regions", "holds none of a finite group");
  }
  if (found->elements.empty()) {
    throw UsageError("--region is " + std::to_string(conversion.region) + ": its group " + found->group.symbol() +
                     " is continuous, and takes vertices to none");
  }
  for (const int element : conversion.elements) {
    if (element < 0 || element >= static_cast<int>(found->elements.size())) {
      throw UsageError("--element is " + std::to_string(element) + ": the region has " +
                       count_of(static_cast<long long>(found->elements.size()), "element") + ", counted from 0");
    }
  }
  return *found;
}

Written write_correspondences(const AnnotationConversion& conversion, const Mesh& mesh,
                              const SymmetryAnnotation& annotation, const RunContext& run) {
  const Region& region = chosen_region(conversion, annotation);
  const Correspondences found =
      correspondences(mesh, region, conversion.elements, annotation.tolerance * diagonal(mesh.vertices), run);
  run.check();
  const bool npz = lower_extension(conversion.output) == ".npz";
  write_file(conversion.output, npz ? to_npz(found, region) : conversion.orbits ? orbits_csv(found) : to_csv(found));
  const int orbits = found.orbits.empty() ? 0 : *std::ranges::max_element(found.orbits) + 1;
  return {{{"region", region.id},
           {"vertices", found.vertices.size()},
           {"elements", found.elements.size()},
           {"orbits", orbits},
           {"unmatched", found.unmatched}},
          "region " + std::to_string(region.id) + " (" + region.group.symbol() + "), " +
              count_of(static_cast<long long>(found.vertices.size()), "vertex", "vertices") + " under " +
              count_of(static_cast<long long>(found.elements.size()), "element") + ", " + count_of(orbits, "orbit") +
              "; " + count_of(found.unmatched, "image") + " farther than the tolerance from any vertex"};
}

Written write_json(const AnnotationConversion& conversion, const Mesh& mesh, const SymmetryAnnotation& annotation,
                   bool from_bop) {
  if (from_bop) {
    write_annotation(conversion.output, annotation);
    return {{{"regions", annotation.regions.size()}},
            count_of(static_cast<long long>(annotation.regions.size()), "region")};
  }
  Json root;
  root[bop_number(conversion.mesh)] = Json::parse(batch::annotation_to_bop(annotation, mesh));
  write_file(conversion.output, root.dump(2) + "\n");
  return {{{"object", bop_number(conversion.mesh)}}, "BOP's entry of object " + bop_number(conversion.mesh)};
}

Written write_glb(const AnnotationConversion& conversion, const Mesh& mesh, const SymmetryAnnotation& annotation,
                  const RunContext& run) {
  if (conversion.style != "instances") {
    write_file(conversion.output, glb_with_regions(conversion.output, mesh, annotation));
    return {{{"regions", annotation.regions.size()}},
            count_of(static_cast<long long>(annotation.regions.size()), "region") + " as attributes and empties"};
  }
  const InstancedGlb glb = glb_of_instances(conversion.output, mesh, annotation, run);
  run.check();
  write_file(conversion.output, glb.bytes);
  const double distance = glb.largest_distance / diagonal(mesh.vertices);
  return {{{"meshes", glb.meshes}, {"instances", glb.nodes}, {"largest_distance", distance}},
          count_of(glb.nodes, "part") + " as instances of " + count_of(glb.meshes, "mesh", "meshes") + ", by at most " +
              percent(distance) + " of the diagonal from where they were"};
}

}  // namespace

void check_conversion(const AnnotationConversion& conversion) {
  check_output(conversion.output, {".json", ".csv", ".npz", ".glb", ".ply"}, {conversion.input, conversion.mesh});
  const std::string ending = lower_extension(conversion.output);
  const bool pairs = ending == ".csv" || ending == ".npz";
  if (!pairs && (conversion.region >= 0 || !conversion.elements.empty())) {
    throw UsageError("--region and --element are for a .csv or .npz");
  }
  if (conversion.orbits && ending != ".csv") throw UsageError("--orbits is for a .csv; an .npz has them anyway");
  if (!conversion.style.empty() && ending != ".glb") throw UsageError("--as is for a .glb");
  if (!conversion.style.empty() && conversion.style != "regions" && conversion.style != "instances") {
    throw UsageError("--as is '" + conversion.style + "': must be regions or instances");
  }
}

int convert_annotation(const AnnotationConversion& conversion, CommandContext& context) {
  const Mesh mesh = read_mesh(conversion.mesh);
  const SymmetryAnnotation annotation = read_any(conversion, mesh);
  const Json input = Json::parse(read_file(conversion.input), nullptr, false);
  const bool from_bop = !input.contains("format");
  const std::string ending = lower_extension(conversion.output);
  Written written;
  if (ending == ".csv" || ending == ".npz") written = write_correspondences(conversion, mesh, annotation, context.run);
  if (ending == ".json") written = write_json(conversion, mesh, annotation, from_bop);
  if (ending == ".glb") written = write_glb(conversion, mesh, annotation, context.run);
  if (ending == ".ply") {
    write_file(conversion.output, ply_with_quality(mesh, annotation));
    written = {{{"faces", mesh.faces.rows()}}, "regions as the faces' quality and colour"};
  }
  Json json{{"output", conversion.output}};
  json.update(written.json);
  print(context, (context.json ? json.dump(2) : conversion.output + ": " + written.text) + "\n");
  return kDone;
}

}  // namespace orbifit
