#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <type_traits>

#include <pybind11/pybind11.h>

#include "orbifit/model/run_context.h"

#include "arrays.h"

namespace orbifit::python {

/// What every long call takes besides its own arguments.
struct RunArguments {
  std::uint64_t seed = 1;
  std::optional<int> threads;     ///< none: as many as there are cores
  std::optional<double> timeout;  ///< seconds
  Progress progress;              ///< called with stage and fraction; None: nobody
};

/// Runs a body without the interpreter's lock. Called in Python's main thread, the body runs in another one while this
/// one looks for signals: an exception of their handlers (KeyboardInterrupt) stops the body and is raised. So is one of
/// the progress callback. \throw what the body throws
void run_released(const RunArguments& arguments, const std::function<void(RunContext&)>& body);

/// The same for a body that returns something.
template <class Body>
auto run(const RunArguments& arguments, const Body& body) {
  std::optional<std::invoke_result_t<Body, RunContext&>> result;
  run_released(arguments, [&](RunContext& context) { result.emplace(body(context)); });
  return std::move(*result);
}

/// The arguments of Python's functions that become RunArguments.
inline py::arg_v seed_argument() {
  return py::arg("seed") = 1;
}
inline py::arg_v threads_argument() {
  return py::arg("threads") = py::none();
}
inline py::arg_v timeout_argument() {
  return py::arg("timeout") = py::none();
}
inline py::arg_v progress_argument() {
  return py::arg("progress") = py::none();
}

/// What the docstring of each says of them.
#define ORBIFIT_RUN_DOC                                                                          \
  "    seed: the same input and seed give the same result, with any number of threads.\n"        \
  "    threads: to use; all cores if not given.\n"                                               \
  "    timeout: in seconds, after which :class:`TimeoutError` is raised.\n"                      \
  "    progress: called with the stage's name and a fraction in [0, 1]; ``True`` for a bar of\n" \
  "        ``tqdm``, where that is installed.\n"

}  // namespace orbifit::python
