#include "groups/canonical_matrices.h"

#include <array>
#include <cmath>
#include <initializer_list>
#include <numbers>

#include <Eigen/Geometry>

namespace orbifit {

namespace {

using Family = PointGroup::Family;
using Eigen::Matrix3d;
using Eigen::Vector3d;

Matrix3d diagonal_matrix(double x, double y, double z) {
  return Vector3d(x, y, z).asDiagonal();
}

const Matrix3d kMirrorX = diagonal_matrix(-1, 1, 1);
const Matrix3d kMirrorZ = diagonal_matrix(1, 1, -1);
const Matrix3d kHalfTurnX = diagonal_matrix(1, -1, -1);
const Matrix3d kHalfTurnZ = diagonal_matrix(-1, -1, 1);

// Rotation about z by 2 pi k / n; quarter turns come out exact, opposite angles exactly opposite.
Matrix3d turn(int k, int n) {
  const int eighths = 8 * (((k % n) + n) % n);
  const int octant = eighths / n;
  double angle = 2 * std::numbers::pi * (eighths - octant * n) / (8.0 * n);
  std::array<double, 2> base{std::cos(angle), std::sin(angle)};
  if (octant % 2 == 1) {  // measured back from the end of its quadrant
    angle = 2 * std::numbers::pi * ((octant + 1) * n - eighths) / (8.0 * n);
    base = {std::sin(angle), std::cos(angle)};
  }
  double c = base[0];
  double s = base[1];
  for (int quadrant = 0; quadrant < octant / 2; ++quadrant) {
    const double old = c;
    c = -s;
    s = old;
  }
  Matrix3d matrix;
  matrix << c, -s, 0, s, c, 0, 0, 0, 1;
  return matrix;
}

Matrix3d cyclic_permutation() {
  Matrix3d matrix;
  matrix << 0, 0, 1, 1, 0, 0, 0, 1, 0;
  return matrix;
}

// One fifth of a turn about (0, 1, phi), entries snapped to their closed form.
Matrix3d fifth_turn() {
  const double phi = std::numbers::phi;
  Matrix3d matrix = axis_rotation(Vector3d(0, 1, phi).normalized(), 2 * std::numbers::pi / 5);
  for (double& entry : matrix.reshaped()) {
    for (const double exact : {0.0, 0.5, phi / 2, (phi - 1) / 2}) {
      if (std::abs(std::abs(entry) - exact) < 1e-9) entry = std::copysign(exact, entry);
    }
  }
  return matrix;
}

std::vector<Matrix3d> tetrahedral_rotations() {
  std::vector<Matrix3d> result;
  const Matrix3d cycle = cyclic_permutation();
  const std::array<Matrix3d, 3> cycles{Matrix3d::Identity(), cycle, cycle * cycle};
  for (const Matrix3d& permutation : cycles) {
    for (const Matrix3d& half :
         {Matrix3d(Matrix3d::Identity()), kHalfTurnX, kHalfTurnZ, Matrix3d(kHalfTurnX * kHalfTurnZ)}) {
      result.push_back(half * permutation);
    }
  }
  return result;
}

void append_products(std::vector<Matrix3d>& matrices, const Matrix3d& right) {
  const std::size_t count = matrices.size();
  for (std::size_t i = 0; i < count; ++i) matrices.push_back(matrices[i] * right);
}

std::vector<Matrix3d> turns(int n) {
  std::vector<Matrix3d> result;
  for (int k = 0; k < n; ++k) result.push_back(turn(k, n));
  return result;
}

std::vector<Matrix3d> rotoreflections(int n) {
  std::vector<Matrix3d> result;
  for (int k = 0; k < n; ++k) result.push_back(k % 2 == 0 ? turn(k, n) : Matrix3d(turn(k, n) * kMirrorZ));
  return result;
}

std::vector<Matrix3d> icosahedral_rotations() {
  const std::vector<Matrix3d> tetrahedral = tetrahedral_rotations();
  std::vector<Matrix3d> result;
  Matrix3d power = Matrix3d::Identity();
  for (int k = 0; k < 5; ++k) {
    for (const Matrix3d& element : tetrahedral) result.push_back(power * element);
    power = fifth_turn() * power;
  }
  return result;
}

}  // namespace

std::vector<Matrix3d> canonical_elements(const PointGroup& group) {
  const int n = group.n;
  const Matrix3d inversion = -Matrix3d::Identity();
  // A subgroup, and its products with what generates the rest.
  const auto extended = [](std::vector<Matrix3d> subgroup, std::initializer_list<Matrix3d> generators) {
    for (const Matrix3d& generator : generators) append_products(subgroup, generator);
    return subgroup;
  };
  switch (group.family) {
    case Family::Cs:
      return {Matrix3d::Identity(), kMirrorZ};
    case Family::Ci:
      return {Matrix3d::Identity(), inversion};
    case Family::Cn:
      return turns(n);
    case Family::Cnv:
      return extended(turns(n), {kMirrorX});
    case Family::Cnh:
      return extended(turns(n), {kMirrorZ});
    case Family::Dn:
      return extended(turns(n), {kHalfTurnX});
    case Family::Dnh:
      return extended(turns(n), {kHalfTurnX, kMirrorZ});
    case Family::Dnd:
      return extended(turns(n), {kHalfTurnX, turn(1, 2 * n) * kMirrorZ});
    case Family::Sn:
      return rotoreflections(n);
    case Family::T:
      return tetrahedral_rotations();
    case Family::Td:
      return extended(tetrahedral_rotations(), {turn(1, 4) * kMirrorZ});
    case Family::Th:
      return extended(tetrahedral_rotations(), {inversion});
    case Family::O:
      return extended(tetrahedral_rotations(), {turn(1, 4)});
    case Family::Oh:
      return extended(tetrahedral_rotations(), {turn(1, 4), inversion});
    case Family::I:
      return icosahedral_rotations();
    case Family::Ih:
      return extended(icosahedral_rotations(), {inversion});
    default:
      return {Matrix3d::Identity()};
  }
}

std::vector<Matrix3d> canonical_generators(const PointGroup& group) {
  const int n = group.n;
  const Matrix3d inversion = -Matrix3d::Identity();
  const Matrix3d cycle = cyclic_permutation();
  const Matrix3d slide = axis_rotation(Vector3d::UnitZ(), 1);
  switch (group.family) {
    case Family::Cs:
      return {kMirrorZ};
    case Family::Ci:
      return {inversion};
    case Family::Cn:
      return {turn(1, n)};
    case Family::Cnv:
      return {turn(1, n), kMirrorX};
    case Family::Cnh:
      return {turn(1, n), kMirrorZ};
    case Family::Dn:
      return {turn(1, n), kHalfTurnX};
    case Family::Dnh:
      return {turn(1, n), kHalfTurnX, kMirrorZ};
    case Family::Dnd:
      return {turn(1, 2 * n) * kMirrorZ, kHalfTurnX};
    case Family::Sn:
      return {turn(1, n) * kMirrorZ};
    case Family::T:
      return {kHalfTurnZ, cycle};
    case Family::Td:
      return {turn(1, 4) * kMirrorZ, cycle};
    case Family::Th:
      return {kHalfTurnZ, cycle, inversion};
    case Family::O:
      return {turn(1, 4), cycle};
    case Family::Oh:
      return {turn(1, 4), cycle, inversion};
    case Family::I:
      return {kHalfTurnZ, cycle, fifth_turn()};
    case Family::Ih:
      return {kHalfTurnZ, cycle, fifth_turn(), inversion};
    case Family::Cinf:
      return {slide};
    case Family::Cinfv:
      return {slide, kMirrorX};
    case Family::Cinfh:
      return {slide, kMirrorZ};
    case Family::Dinf:
      return {slide, kHalfTurnX};
    case Family::Dinfh:
      return {slide, kHalfTurnX, kMirrorZ};
    case Family::K:
      return {slide, axis_rotation(Vector3d::UnitX(), 1)};
    case Family::Kh:
      return {slide, axis_rotation(Vector3d::UnitX(), 1), inversion};
    case Family::C1:
      break;
  }
  return {Matrix3d::Identity()};
}

}  // namespace orbifit
