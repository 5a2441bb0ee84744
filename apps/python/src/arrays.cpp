#include "arrays.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Dense>

#include "orbifit/model/errors.h"

namespace orbifit::python {

namespace {

constexpr double kMaxCoordinate = 1e50;  // as readers of files demand
constexpr double kOrthogonal = 1e-6;     // largest entry of R R^T - 1, as in an annotation's file

std::string shape_text(const py::array& array) {
  return py::str(array.attr("shape")).cast<std::string>();
}

[[noreturn]] void refuse_shape(const std::string& name, const std::string& must, const py::array& array) {
  throw InputError("", name, "has the shape " + shape_text(array) + "; it must be " + must);
}

// A row's place within an array: "vertices[7]".
std::string entry(const std::string& name, py::ssize_t index) {
  return name + "[" + std::to_string(index) + "]";
}

std::string number_text(double value) {
  return py::str(py::float_(value)).cast<std::string>();
}

py::array array_from(const py::handle& values, const std::string& name) {
  py::array array = py::array::ensure(values);
  if (!array) {
    PyErr_Clear();
    throw py::type_error(name + " is no array of numbers");
  }
  return array;
}

// int64 in C order, of whatever integers were given; an empty list is one of integers too.
py::array_t<std::int64_t> integers_from(const py::handle& values, const std::string& name) {
  py::array array = array_from(values, name);
  const char kind = array.dtype().kind();
  if (kind != 'i' && kind != 'u' && array.size() > 0) {
    throw py::type_error(name + " holds " + py::str(array.dtype()).cast<std::string>() + "; it must hold integers");
  }
  if (kind == 'u' && array.itemsize() == 8) {  // those beyond int64 must not wrap to small ones
    const auto large = py::array_t<std::uint64_t, py::array::c_style | py::array::forcecast>(array);
    for (py::ssize_t i = 0; i < large.size(); ++i) {
      if (large.data()[i] > static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max())) {
        throw InputError("", entry(name, i), "is " + std::to_string(large.data()[i]) + ", which is too large");
      }
    }
  }
  return py::array_t<std::int64_t, py::array::c_style | py::array::forcecast>(array);
}

int checked_index(std::int64_t value, const std::string& name, py::ssize_t index, Eigen::Index count) {
  if (value < 0 || value >= count) {
    throw InputError("", entry(name, index),
                     "is " + std::to_string(value) + "; it must be from 0 to " + std::to_string(count - 1));
  }
  return static_cast<int>(value);
}

// Rows 0 to 2 of a 3 by 4 or 4 by 4 matrix; the last row of the latter must be 0 0 0 1.
Eigen::Matrix<double, 3, 4> affine_from(const double* values, py::ssize_t rows, const std::string& name) {
  const Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>> top(values);
  if (!top.allFinite()) throw InputError("", name, "holds a number that is not finite");
  if (rows == 4 && Eigen::RowVector4d(values + 12) != Eigen::RowVector4d(0, 0, 0, 1)) {
    throw InputError("", name, "has another last row than 0 0 0 1");
  }
  return top;
}

Motion checked_motion(const Eigen::Matrix<double, 3, 4>& matrix, const std::string& name) {
  const Motion motion{matrix.leftCols<3>(), matrix.col(3)};
  const double error = orthogonality_error(motion.linear);
  if (!(error <= kOrthogonal)) {
    throw InputError("", name, "is no Euclidean motion: its linear part is off orthogonal by " + number_text(error));
  }
  return motion;
}

bool is_affine(const py::array& array, int dimensions) {
  const auto rows = array.ndim() == dimensions ? array.shape(dimensions - 2) : 0;
  return (rows == 3 || rows == 4) && array.shape(dimensions - 1) == 4;
}

template <class Scalar>
py::array_t<Scalar> frozen(py::array_t<Scalar> array) {
  array.attr("setflags")(py::arg("write") = false);
  return array;
}

}  // namespace

std::filesystem::path path_from(const py::handle& file) {
  PyObject* bytes = nullptr;
  if (PyUnicode_FSConverter(file.ptr(), &bytes) == 0) throw py::error_already_set();
  return std::string(py::reinterpret_steal<py::bytes>(bytes));
}

DoubleArray doubles_from(const py::handle& values, const std::string& name, int dimensions) {
  py::array array = array_from(values, name);
  const char kind = array.dtype().kind();
  if (kind != 'f' && kind != 'i' && kind != 'u' && kind != 'b') {
    throw py::type_error(name + " holds " + py::str(array.dtype()).cast<std::string>() + "; it must hold real numbers");
  }
  if (array.ndim() != dimensions) {
    refuse_shape(name, "an array of " + std::to_string(dimensions) + (dimensions == 1 ? " dimension" : " dimensions"),
                 array);
  }
  return py::array_t<double, py::array::c_style | py::array::forcecast>(array);
}

Points points_from(const py::handle& values, const std::string& name) {
  const DoubleArray array = doubles_from(values, name, 2);
  if (array.shape(1) != 3) refuse_shape(name, "(n, 3)", array);
  const Eigen::Map<const Points> points(array.data(), array.shape(0), 3);
  if (points.size() > 0 && !(points.cwiseAbs().maxCoeff<Eigen::PropagateNaN>() <= kMaxCoordinate)) {
    for (Eigen::Index row = 0; row < points.rows(); ++row) {
      for (const double value : points.row(row)) {
        if (std::abs(value) <= kMaxCoordinate) continue;
        throw InputError("", entry(name, row), "holds " + number_text(value) + "; it must be finite, at most 1e50");
      }
    }
  }
  return points;
}

Eigen::Vector3d vector_from(const py::handle& values, const std::string& name) {
  return numbers_from(values, name, 3);
}

Eigen::VectorXd numbers_from(const py::handle& values, const std::string& name, Eigen::Index count) {
  const DoubleArray array = doubles_from(values, name, 1);
  if (count >= 0 && array.shape(0) != count) refuse_shape(name, "(" + std::to_string(count) + ",)", array);
  const Eigen::Map<const Eigen::VectorXd> numbers(array.data(), array.shape(0));
  for (Eigen::Index i = 0; i < numbers.size(); ++i) {
    if (!std::isfinite(numbers[i]))
      throw InputError("", entry(name, i), "is " + number_text(numbers[i]) + "; it must be finite");
  }
  return numbers;
}

std::vector<int> indices_from(const py::handle& values, const std::string& name, Eigen::Index count) {
  const auto array = integers_from(values, name);
  if (array.ndim() != 1) refuse_shape(name, "(n,)", array);
  std::vector<int> indices(static_cast<std::size_t>(array.shape(0)));
  for (std::size_t i = 0; i < indices.size(); ++i) {
    indices[i] = checked_index(array.data()[i], name, static_cast<py::ssize_t>(i), count);
  }
  return indices;
}

std::vector<int> index_set_from(const py::handle& values, const std::string& name, Eigen::Index count) {
  const py::array array = array_from(values, name);
  std::vector<int> indices;
  if (array.dtype().kind() == 'b') {
    if (array.ndim() != 1 || array.shape(0) != count) refuse_shape(name, "(" + std::to_string(count) + ",)", array);
    const auto mask = py::array_t<bool, py::array::c_style | py::array::forcecast>(array);
    for (int i = 0; i < count; ++i) {
      if (mask.data()[i]) indices.push_back(i);
    }
    return indices;
  }
  indices = indices_from(array, name, count);
  std::ranges::sort(indices);
  indices.erase(std::unique(indices.begin(), indices.end()), indices.end());
  return indices;
}

Triangles triangles_from(const py::handle& values, const std::string& name, Eigen::Index vertices) {
  const auto array = integers_from(values, name);
  if (array.ndim() != 2 || array.shape(1) != 3) refuse_shape(name, "(n, 3)", array);
  Triangles triangles(array.shape(0), 3);
  for (Eigen::Index i = 0; i < triangles.size(); ++i) {
    triangles.data()[i] = checked_index(array.data()[i], name, i / 3, vertices);
  }
  return triangles;
}

std::vector<Motion> motions_from(const py::handle& values, const std::string& name) {
  const DoubleArray array = doubles_from(values, name, 3);
  if (!is_affine(array, 3)) refuse_shape(name, "(n, 3, 4) or (n, 4, 4)", array);
  std::vector<Motion> motions;
  for (py::ssize_t i = 0; i < array.shape(0); ++i) {
    const std::string place = entry(name, i);
    motions.push_back(checked_motion(affine_from(array.data(i, 0, 0), array.shape(1), place), place));
  }
  return motions;
}

Motion motion_from(const py::handle& values, const std::string& name) {
  const DoubleArray array = doubles_from(values, name, 2);
  if (!is_affine(array, 2)) refuse_shape(name, "(3, 4) or (4, 4)", array);
  return checked_motion(affine_from(array.data(), array.shape(0), name), name);
}

Similarity similarity_from(const py::handle& values, const std::string& name) {
  const DoubleArray array = doubles_from(values, name, 2);
  if (!is_affine(array, 2)) refuse_shape(name, "(3, 4) or (4, 4)", array);
  Eigen::Matrix<double, 3, 4> matrix = affine_from(array.data(), array.shape(0), name);
  const double scale = std::cbrt(std::abs(matrix.leftCols<3>().determinant()));
  if (!(scale > 0)) throw InputError("", name, "is no similarity: its linear part is singular");
  matrix.leftCols<3>() /= scale;
  const Motion motion = checked_motion(matrix, name);
  return {scale, motion.linear, motion.translation};
}

DoubleArray matrix_of(const Similarity& similarity) {
  Eigen::Matrix<double, 4, 4, Eigen::RowMajor> matrix = Eigen::Matrix4d::Identity();
  matrix.topLeftCorner<3, 3>() = similarity.scale * similarity.linear;
  matrix.topRightCorner<3, 1>() = similarity.translation;
  return DoubleArray({4, 4}, matrix.data());
}

DoubleArray view_of(const Points& points, const py::handle& owner) {
  return frozen(py::array_t<double>({points.rows(), points.cols()}, points.data(), owner));
}

IntArray view_of(const Triangles& triangles, const py::handle& owner) {
  return frozen(py::array_t<int>({triangles.rows(), triangles.cols()}, triangles.data(), owner));
}

IntArray view_of(const std::vector<int>& numbers, const py::handle& owner) {
  return frozen(py::array_t<int>(static_cast<py::ssize_t>(numbers.size()), numbers.data(), owner));
}

DoubleArray view_of(const Eigen::VectorXd& numbers, const py::handle& owner) {
  return frozen(py::array_t<double>(numbers.size(), numbers.data(), owner));
}

DoubleArray view_of(const std::vector<Motion>& motions, const py::handle& owner) {
  // A motion lies in memory as a 3 by 4 matrix, column by column.
  static_assert(sizeof(Motion) == 12 * sizeof(double) && offsetof(Motion, translation) == 9 * sizeof(double));
  const double* first = motions.empty() ? nullptr : motions.front().linear.data();
  constexpr py::ssize_t kNumber = sizeof(double);
  return frozen(py::array_t<double>({static_cast<py::ssize_t>(motions.size()), py::ssize_t{3}, py::ssize_t{4}},
                                    {12 * kNumber, kNumber, 3 * kNumber}, first, owner));
}

DoubleArray array_of(const Eigen::Vector3d& vector) {
  return DoubleArray(3, vector.data());
}

}  // namespace orbifit::python
