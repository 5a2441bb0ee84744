#include "errors.h"

#include "orbifit/model/errors.h"

namespace orbifit::python {

namespace py = pybind11;

namespace {

// Never freed: exceptions may be translated as long as the interpreter runs.
struct Exceptions {
  PyObject *error, *usage, *input, *no_result, *timeout;
};
Exceptions exceptions;  // NOLINT(readability-identifier-naming): made with the module, read when exceptions pass

PyObject* define(py::module_& module, const char* name, const py::tuple& bases, const char* doc) {
  const std::string full = std::string("orbifit.") + name;
  PyObject* type = PyErr_NewExceptionWithDoc(full.c_str(), doc, bases.ptr(), nullptr);
  if (type == nullptr) throw py::error_already_set();
  module.attr(name) = py::handle(type);
  return type;
}

}  // namespace

void define_errors(py::module_& module) {
  const py::handle value_error(PyExc_ValueError);
  exceptions.error = define(module, "Error", py::make_tuple(py::handle(PyExc_Exception)),
                            "Every failure that Orbifit reports on purpose.");
  const py::handle error(exceptions.error);
  exceptions.usage = define(module, "UsageError", py::make_tuple(error, value_error),
                            "A call that makes no sense: names the argument, its value and the rule.");
  exceptions.input = define(module, "InputError", py::make_tuple(error, value_error),
                            "A file, an array, or a value in one, that cannot be used: says where and why.");
  exceptions.no_result =
      define(module, "NoResultError", py::make_tuple(error), "The computation ran and has no answer to give.");
  exceptions.timeout = define(module, "TimeoutError", py::make_tuple(error, py::handle(PyExc_TimeoutError)),
                              "The time given as `timeout` has passed.");
  py::register_exception_translator([](std::exception_ptr pointer) {
    try {
      if (pointer) std::rethrow_exception(pointer);
    } catch (const UsageError& failure) {
      PyErr_SetString(exceptions.usage, failure.what());
    } catch (const InputError& failure) {
      PyErr_SetString(exceptions.input, failure.what());
    } catch (const NoResultError& failure) {
      PyErr_SetString(exceptions.no_result, failure.what());
    } catch (const TimeoutError& failure) {
      PyErr_SetString(exceptions.timeout, failure.what());
    } catch (const InterruptedError& failure) {
      PyErr_SetString(PyExc_KeyboardInterrupt, failure.what());
    } catch (const Error& failure) {
      PyErr_SetString(exceptions.error, failure.what());
    }
  });
}

}  // namespace orbifit::python
