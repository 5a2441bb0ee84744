#include "annotations.h"
#include "errors.h"
#include "meshes.h"
#include "verbs.h"

// NOLINTNEXTLINE: what the macro makes
PYBIND11_MODULE(_core, module) {
  using namespace orbifit::python;
  module.doc() = "The library behind orbifit.";
  module.attr("__version__") = ORBIFIT_VERSION;
  define_errors(module);
  define_meshes(module);
  define_scans(module);
  define_depth_images(module);
  define_regions(module);
  define_patterns(module);
  define_annotations(module);
  define_detection(module);
  define_subspace(module);
  define_deformer(module);
  define_fit_result(module);
  define_fitting(module);
  define_checks(module);
  define_datasets(module);
  define_pictures(module);
}
