#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include "orbifit/model/mesh.h"
#include "orbifit/model/motion.h"

/// What goes from Python to the library and back. Inputs are read straight from the array's memory where that is
/// float64 or int32 in C order, and converted otherwise; results are moved into arrays that own them, not copied.
namespace orbifit::python {

namespace py = pybind11;

using DoubleArray = py::array_t<double>;
using IntArray = py::array_t<int>;

/// An argument that is anything, under a name of its own in signatures and stubs (handle_type_name below).
#define ORBIFIT_ARGUMENT(Name)                      \
  class Name : public py::object {                  \
   public:                                          \
    using py::object::object;                       \
    Name(const py::object& o) : py::object(o) {}    \
    static bool check_(py::handle) { return true; } \
  }

ORBIFIT_ARGUMENT(ArrayLike);
ORBIFIT_ARGUMENT(MeshLike);
ORBIFIT_ARGUMENT(ScanLike);
ORBIFIT_ARGUMENT(PathLike);
ORBIFIT_ARGUMENT(StateLike);
ORBIFIT_ARGUMENT(Progress);

#undef ORBIFIT_ARGUMENT

/// A file's name: str, bytes or os.PathLike. \throw TypeError
std::filesystem::path path_from(const py::handle& file);

/// A float64 array of that many dimensions, in C order. \param name  of the argument, for messages
/// \throw InputError for another shape, TypeError for what holds no real numbers
DoubleArray doubles_from(const py::handle& values, const std::string& name, int dimensions);

/// #P by 3, finite and at most 1e50. \throw InputError naming the first row that is not
Points points_from(const py::handle& values, const std::string& name);

/// Three finite numbers.
Eigen::Vector3d vector_from(const py::handle& values, const std::string& name);

/// Finite numbers. \param count  how many; -1: any
Eigen::VectorXd numbers_from(const py::handle& values, const std::string& name, Eigen::Index count = -1);

/// Numbers from 0 to count - 1, in their order. \throw InputError naming the first that is not
std::vector<int> indices_from(const py::handle& values, const std::string& name, Eigen::Index count);

/// The same, ascending and without repetition; a mask of `count` booleans as well.
std::vector<int> index_set_from(const py::handle& values, const std::string& name, Eigen::Index count);

/// #F by 3, each from 0 to vertices - 1.
Triangles triangles_from(const py::handle& values, const std::string& name, Eigen::Index vertices);

/// Euclidean motions: (n, 3, 4) or (n, 4, 4). \throw InputError for a matrix that is not orthogonal to 1e-6
std::vector<Motion> motions_from(const py::handle& values, const std::string& name);

/// One motion, 3 by 4 or 4 by 4.
Motion motion_from(const py::handle& values, const std::string& name);

/// A similarity, 3 by 4 or 4 by 4: scale times orthogonal, and a translation.
Similarity similarity_from(const py::handle& values, const std::string& name);

/// The 4 by 4 matrix of a similarity.
DoubleArray matrix_of(const Similarity& similarity);

/// A read-only array of memory that `owner` keeps alive.
DoubleArray view_of(const Points& points, const py::handle& owner);
IntArray view_of(const Triangles& triangles, const py::handle& owner);
IntArray view_of(const std::vector<int>& numbers, const py::handle& owner);
DoubleArray view_of(const Eigen::VectorXd& numbers, const py::handle& owner);
DoubleArray view_of(const std::vector<Motion>& motions, const py::handle& owner);  ///< (n, 3, 4)

DoubleArray array_of(const Eigen::Vector3d& vector);

/// The matrix' or vector's memory as an array, which owns it from then on.
template <class Owned>
py::array_t<typename Owned::Scalar> owning(Owned value) {
  auto* kept = new Owned(std::move(value));
  const py::capsule owner(kept, [](void* memory) { delete static_cast<Owned*>(memory); });
  if constexpr (Owned::IsVectorAtCompileTime) {
    return py::array_t<typename Owned::Scalar>(kept->size(), kept->data(), owner);
  } else {
    static_assert(Owned::IsRowMajor);
    return py::array_t<typename Owned::Scalar>({kept->rows(), kept->cols()}, kept->data(), owner);
  }
}

}  // namespace orbifit::python

namespace pybind11::detail {

template <>
struct handle_type_name<orbifit::python::ArrayLike> {
  static constexpr auto name = const_name("ArrayLike");
};
template <>
struct handle_type_name<orbifit::python::MeshLike> {
  static constexpr auto name = const_name("MeshLike");
};
template <>
struct handle_type_name<orbifit::python::ScanLike> {
  static constexpr auto name = const_name("ScanLike");
};
template <>
struct handle_type_name<orbifit::python::PathLike> {
  static constexpr auto name = const_name("PathLike");
};
template <>
struct handle_type_name<orbifit::python::StateLike> {
  static constexpr auto name = const_name("StateLike");
};
template <>
struct handle_type_name<orbifit::python::Progress> {
  static constexpr auto name = const_name("Progress");
};

}  // namespace pybind11::detail
