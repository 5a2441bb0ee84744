#include "orbifit/model/point_group.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <vector>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "groups/canonical_matrices.h"

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

PointGroup finite_counterpart(const PointGroup& group, int n) {
  switch (group.family) {
    case Family::Cinfv:
      return {Family::Cnv, n};
    case Family::Cinfh:
      return {Family::Cnh, n};
    case Family::Dinf:
      return {Family::Dn, n};
    case Family::Dinfh:
      return {Family::Dnh, n};
    default:
      return {Family::Cn, n};
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
