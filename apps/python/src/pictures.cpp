#include <algorithm>

#include <pybind11/stl.h>

#include "orbifit/apps/render.h"
#include "orbifit/model/errors.h"

#include "annotations.h"
#include "run.h"
#include "verbs.h"

namespace orbifit::python {

namespace {

using PixelArray = py::array_t<std::uint8_t>;

PixelArray pixels_of(Image image) {
  auto* kept = new Image(std::move(image));
  const py::capsule owner(kept, [](void* memory) { delete static_cast<Image*>(memory); });
  return PixelArray({kept->height, kept->width, 3}, kept->rgb.data(), owner);
}

Image image_from(const py::array_t<std::uint8_t, py::array::c_style | py::array::forcecast>& pixels) {
  if (pixels.ndim() != 3 || pixels.shape(2) != 3 || pixels.size() == 0) {
    throw InputError("", "pixels", "must have the shape (height, width, 3)");
  }
  Image image;
  image.height = static_cast<int>(pixels.shape(0));
  image.width = static_cast<int>(pixels.shape(1));
  image.rgb.assign(pixels.data(), pixels.data() + pixels.size());
  return image;
}

// Either one colour of all, or one of each vertex or face.
void set_colours(SurfaceLayer& layer, const Points& colours) {
  std::vector<Colour> list;
  for (const auto& row : colours.rowwise()) list.push_back(row.transpose().cast<float>());
  if (colours.rows() == 1 || colours.rows() == layer.mesh.faces.rows()) {
    layer.face_colours = list;
  } else if (colours.rows() == layer.mesh.vertices.rows()) {
    layer.vertex_colours = list;
  } else {
    throw InputError(
        "", "colours",
        "has " + std::to_string(colours.rows()) + " rows; it must have one for each face or vertex, or one of all");
  }
}

struct PictureArguments {
  MeshPointer mesh;
  AnnotationPointer annotation;
  std::optional<int> region, pattern;
  std::optional<Points> points, colours;
};

template <class Item>
const Item& item_of(const std::vector<Item>& items, int id, const std::string& what) {
  const auto found = std::ranges::find(items, id, &Item::id);
  if (found == items.end()) throw UsageError("the annotation has no " + what + " " + std::to_string(id));
  return *found;
}

Scene scene_of(const PictureArguments& arguments, const ViewOptions& view, const RunContext& context) {
  Scene scene;
  if (arguments.region) {
    scene = visible_region_scene(
        *arguments.mesh, item_of(arguments.annotation->value.regions, *arguments.region, "region"), view, context);
  } else if (arguments.pattern) {
    scene = visible_pattern_scene(
        *arguments.mesh, item_of(arguments.annotation->value.patterns, *arguments.pattern, "pattern"), view, context);
  } else {
    scene.surfaces.emplace_back().mesh = *arguments.mesh;
    if (arguments.colours) set_colours(scene.surfaces.back(), *arguments.colours);
  }
  if (arguments.points) scene.points.emplace_back().points = *arguments.points;
  return scene;
}

void define_render(py::module_& module) {
  const ViewOptions defaults;
  module.def(
      "render",
      [](const MeshLike& mesh, const AnnotationPointer& annotation, std::optional<int> region,
         std::optional<int> pattern, const std::optional<ScanLike>& points, const std::optional<ArrayLike>& colours,
         int width, int height, double azimuth, double elevation, const ArrayLike& up, int samples,
         const std::optional<MeshLike>& frame, std::uint64_t seed, std::optional<int> threads,
         std::optional<double> timeout, const Progress& progress) {
        PictureArguments arguments{mesh_from(mesh), annotation, region, pattern, {}, {}};
        if ((region || pattern) && !annotation) throw UsageError("region and pattern need an annotation");
        if (annotation) require_fit(annotation->value, *arguments.mesh);
        if (points) arguments.points = scan_from(*points)->points;
        if (colours) arguments.colours = points_from(*colours, "colours");
        ViewOptions view;
        view.width = width;
        view.height = height;
        view.azimuth = azimuth;
        view.elevation = elevation;
        view.samples = samples;
        const Eigen::Vector3d direction = vector_from(up, "up");
        if (!(direction.stableNorm() > 0)) throw UsageError("up must not be zero");
        view.up = direction.stableNormalized();
        if (frame) view.frame = mesh_from(*frame)->vertices;
        return pixels_of(run({seed, threads, timeout, progress}, [&](RunContext& context) {
          return render(scene_of(arguments, view, context), view, context);
        }));
      },
      py::arg("mesh"), py::arg("annotation") = py::none(), py::kw_only(), py::arg("region") = py::none(),
      py::arg("pattern") = py::none(), py::arg("points") = py::none(), py::arg("colours") = py::none(),
      py::arg("width") = defaults.width, py::arg("height") = defaults.height, py::arg("azimuth") = defaults.azimuth,
      py::arg("elevation") = defaults.elevation, py::arg("up") = py::make_tuple(0.0, 0.0, 1.0),
      py::arg("samples") = defaults.samples, py::arg("frame") = py::none(), seed_argument(), threads_argument(),
      timeout_argument(), progress_argument(),
      "(height, width, 3) uint8: a picture of a mesh.\n\n"
      "Args:\n"
      "    mesh: see :meth:`Mesh.of`.\n"
      "    annotation: with `region` or `pattern`, the id of one of its: drawn in colour, with axis or plane.\n"
      "    points: a scan, drawn over it.\n"
      "    colours: in [0, 1], (m, 3) for faces or (n, 3) for vertices, or (1, 3).\n"
      "    width, height: in pixels.\n"
      "    azimuth, elevation: of the eye, in degrees, about `up` and above the horizon.\n"
      "    samples: rays for each pixel, a square number.\n"
      "    frame: the mesh that the picture is to hold; keep it to have several at one scale.\n" ORBIFIT_RUN_DOC
      "\nRaises:\n"
      "    UsageError: a number out of range, or an id that the annotation has not.");
}

}  // namespace

void define_pictures(py::module_& module) {
  define_render(module);
  module.def(
      "encode_png", [](const PixelArray& pixels) { return py::bytes(encode_png(image_from(pixels))); },
      py::arg("pixels").noconvert(), "A picture as the bytes of a PNG file.");
  module.def(
      "write_png",
      [](const PathLike& file, const PixelArray& pixels) { write_png(path_from(file), image_from(pixels)); },
      py::arg("file"), py::arg("pixels").noconvert(), "Writes a picture as PNG, whole or not at all.");
  module.def(
      "contact_sheet",
      [](const std::vector<PixelArray>& pictures, const std::vector<std::string>& captions, int columns) {
        std::vector<Image> images;
        for (const PixelArray& picture : pictures) images.push_back(image_from(picture));
        return pixels_of(contact_sheet(images, captions, columns));
      },
      py::arg("pictures").noconvert(), py::arg("captions"), py::arg("columns") = 4,
      "(height, width, 3) uint8: small pictures side by side, with a caption each.");
  module.def(
      "region_colour",
      [](int number) {
        const Colour colour = region_colour(number);
        return std::tuple<double, double, double>(colour.x(), colour.y(), colour.z());
      },
      py::arg("number"), "The colour that pictures give the region of that id, in [0, 1].");
}

}  // namespace orbifit::python
