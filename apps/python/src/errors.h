#pragma once

#include <pybind11/pybind11.h>

namespace orbifit::python {

/// Adds the exceptions to the module; the library's own become these, with the same messages.
void define_errors(pybind11::module_& module);

}  // namespace orbifit::python
