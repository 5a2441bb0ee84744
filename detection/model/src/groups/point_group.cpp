#include "orbifit/model/point_group.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <initializer_list>
#include <numbers>
#include <vector>

#include <Eigen/Geometry>
#include <Eigen/LU>

namespace orbifit {

namespace {

using Family = PointGroup::Family;
using Eigen::Matrix3d;
using Eigen::Vector3d;

struct Named {
  Family family;
  std::string_view symbol;
  int order;
};

// The families whose symbol holds no number.
constexpr std::array<Named, 17> kNamed{{{Family::C1, "C1", 1},
                                        {Family::Cs, "Cs", 2},
                                        {Family::Ci, "Ci", 2},
                                        {Family::T, "T", 12},
                                        {Family::Td, "Td", 24},
                                        {Family::Th, "Th", 24},
                                        {Family::O, "O", 24},
                                        {Family::Oh, "Oh", 48},
                                        {Family::I, "I", 60},
                                        {Family::Ih, "Ih", 120},
                                        {Family::Cinf, "Cinf", 0},
                                        {Family::Cinfv, "Cinfv", 0},
                                        {Family::Cinfh, "Cinfh", 0},
                                        {Family::Dinf, "Dinf", 0},
                                        {Family::Dinfh, "Dinfh", 0},
                                        {Family::K, "K", 0},
                                        {Family::Kh, "Kh", 0}}};

struct Numbered {
  Family family;
  char letter;
  std::string_view suffix;
  int multiple;  // order / n
};

constexpr std::array<Numbered, 7> kNumbered{{{Family::Cn, 'C', "", 1},
                                             {Family::Cnv, 'C', "v", 2},
                                             {Family::Cnh, 'C', "h", 2},
                                             {Family::Dn, 'D', "", 2},
                                             {Family::Dnh, 'D', "h", 4},
                                             {Family::Dnd, 'D', "d", 4},
                                             {Family::Sn, 'S', "", 1}}};

const Named* find_named(Family family) {
  const auto* found = std::ranges::find(kNamed, family, &Named::family);
  return found == kNamed.end() ? nullptr : found;
}

const Numbered& find_numbered(Family family) {
  return *std::ranges::find(kNumbered, family, &Numbered::family);
}

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

// A subgroup of rotations, and its products with what generates the rest.
std::vector<Matrix3d> canonical_elements(const PointGroup& group) {
  const int n = group.n;
  const Matrix3d inversion = -Matrix3d::Identity();
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

std::vector<Matrix3d> in_frame(std::vector<Matrix3d> matrices, const GroupFrame& frame) {
  for (Matrix3d& matrix : matrices) matrix = frame * matrix * frame.transpose();
  return matrices;
}

}  // namespace

bool PointGroup::continuous() const {
  const Named* named = find_named(family);
  return named != nullptr && named->order == 0;
}

int PointGroup::order() const {
  const Named* named = find_named(family);
  return named != nullptr ? named->order : n * find_numbered(family).multiple;
}

bool PointGroup::has_axis() const {
  switch (family) {
    case Family::C1:
    case Family::Ci:
    case Family::T:
    case Family::Td:
    case Family::Th:
    case Family::O:
    case Family::Oh:
    case Family::I:
    case Family::Ih:
    case Family::K:
    case Family::Kh:
      return false;
    default:
      return true;
  }
}

bool belongs_to_continuous(const Eigen::Matrix3d& linear, const PointGroup& group, const Eigen::Vector3d& axis,
                           double angle) {
  using Family = PointGroup::Family;
  const bool proper = linear.determinant() > 0;
  if (group.family == Family::Kh) return true;
  if (group.family == Family::K) return proper;
  const Eigen::Vector3d image = linear * axis;
  if (image.cross(axis).norm() > angle) return false;
  const bool up = image.dot(axis) > 0;
  switch (group.family) {
    case Family::Cinf:
      return proper && up;
    case Family::Cinfv:
      return up;
    case Family::Cinfh:
      return proper == up;
    case Family::Dinf:
      return proper;
    default:
      return true;
  }
}

bool PointGroup::proper() const {
  switch (family) {
    case Family::C1:
    case Family::Cn:
    case Family::Dn:
    case Family::T:
    case Family::O:
    case Family::I:
    case Family::Cinf:
    case Family::Dinf:
    case Family::K:
      return true;
    default:
      return false;
  }
}

std::string PointGroup::symbol() const {
  if (const Named* named = find_named(family)) return std::string(named->symbol);
  const Numbered& numbered = find_numbered(family);
  return numbered.letter + std::to_string(n) + std::string(numbered.suffix);
}

std::optional<PointGroup> PointGroup::parse(std::string_view symbol) {
  for (const Named& named : kNamed) {
    if (named.symbol == symbol) return PointGroup{named.family, 1};
  }
  if (symbol.size() < 2 || symbol[1] == '0') return std::nullopt;
  int n = 0;
  const auto [end, error] = std::from_chars(symbol.data() + 1, symbol.data() + symbol.size(), n);
  if (error != std::errc() || n < 2 || n > 1'000'000) return std::nullopt;
  const std::string_view suffix(end, static_cast<std::size_t>(symbol.data() + symbol.size() - end));
  for (const Numbered& numbered : kNumbered) {
    if (numbered.letter != symbol[0] || numbered.suffix != suffix) continue;
    if (numbered.family == Family::Sn && (n % 2 != 0 || n < 4)) return std::nullopt;
    return PointGroup{numbered.family, n};
  }
  return std::nullopt;
}

std::vector<Matrix3d> elements(const PointGroup& group, const GroupFrame& frame) {
  return in_frame(canonical_elements(group), frame);
}

std::vector<Matrix3d> generators(const PointGroup& group, const GroupFrame& frame) {
  return in_frame(canonical_generators(group), frame);
}

bool closed(const std::vector<Motion>& elements, double scale, double tolerance) {
  for (const Motion& a : elements) {
    for (const Motion& b : elements) {
      const Motion product = a * b;
      const bool found = std::ranges::any_of(elements, [&](const Motion& c) {
        return (product.linear - c.linear).cwiseAbs().maxCoeff() <= tolerance &&
               (product.translation - c.translation).cwiseAbs().maxCoeff() <= tolerance * scale;
      });
      if (!found) return false;
    }
  }
  return true;
}

GroupFrame frame_about(const Vector3d& axis, const std::optional<Vector3d>& towards) {
  const Vector3d z = axis.normalized();
  Vector3d x = Vector3d::Zero();
  if (towards) x = *towards - z * z.dot(*towards);
  if (x.norm() < 1e-9) {
    int smallest = 0;
    z.cwiseAbs().minCoeff(&smallest);
    x = Vector3d::Unit(smallest) - z * z[smallest];
  }
  x.normalize();
  GroupFrame frame;
  frame << x, z.cross(x), z;
  return frame;
}

}  // namespace orbifit
