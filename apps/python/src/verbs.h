#pragma once

#include <pybind11/pybind11.h>

namespace orbifit::python {

void define_checks(pybind11::module_& module);
void define_datasets(pybind11::module_& module);
void define_depth_images(pybind11::module_& module);
void define_deformer(pybind11::module_& module);
void define_detection(pybind11::module_& module);
void define_fitting(pybind11::module_& module);
void define_fit_result(pybind11::module_& module);
void define_pictures(pybind11::module_& module);
void define_subspace(pybind11::module_& module);

}  // namespace orbifit::python
