#include "region_names.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <string_view>

#include <Eigen/Eigenvalues>

#include "base/plural.h"
#include "geometry/surface_index.h"
#include "surface/thresholds.h"

namespace orbifit {

namespace {

using Eigen::Vector3d;
using Family = PointGroup::Family;

constexpr double kLong = 2.5;   // ratio of two lengths at which a shape is called by another noun
constexpr double kAside = 0.2;  // of the mesh's extent from its middle: on one side

struct Extents {
  double inner = std::numeric_limits<double>::infinity(), outer = 0;  // distances from the axis
  double low = std::numeric_limits<double>::infinity(), high = -std::numeric_limits<double>::infinity();
};

Extents extents_about(const PreparedMesh& prepared, const Region& region) {
  Extents result;
  for (const int face : region.faces) {
    std::array<Vector3d, 3> across;  // the corners as seen along the axis
    for (int k = 0; k < 3; ++k) {
      const Vector3d from_centre =
          prepared.input_of_normalised(prepared.mesh.vertices.row(prepared.mesh.faces(face, k)).transpose()) -
          region.centre;
      const double height = region.axis.dot(from_centre);
      Vector3d& corner = across[static_cast<std::size_t>(k)];
      corner = from_centre - height * region.axis;
      result.outer = std::max(result.outer, corner.norm());
      result.low = std::min(result.low, height);
      result.high = std::max(result.high, height);
    }
    const Vector3d weights = nearest_on_triangle(Vector3d::Zero(), across[0], across[1], across[2]);
    const Vector3d nearest = weights[0] * across[0] + weights[1] * across[1] + weights[2] * across[2];
    result.inner = std::min(result.inner, nearest.norm());
  }
  return result;
}

std::string_view round_noun(const PreparedMesh& prepared, const Region& region) {
  if (region.group.family == Family::K || region.group.family == Family::Kh) return "sphere";
  const Extents extents = extents_about(prepared, region);
  const double width = 2 * extents.outer;
  const double height = extents.high - extents.low;
  if (kLong * extents.inner > extents.outer && height < width) return "ring";
  if (kLong * height < width) return "disc";
  return height > kLong * width ? "rod" : "round part";
}

// By the lengths along the principal axes.
std::string_view angular_noun(const SurfaceMoments& moments) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(moments.covariance, Eigen::EigenvaluesOnly);
  const Vector3d lengths = solver.eigenvalues().cwiseMax(0).cwiseSqrt();
  if (lengths[2] > kLong * lengths[1]) return "bar";
  return kLong * lengths[0] < lengths[1] ? "plate" : "block";
}

std::size_t components_in(const PreparedMesh& prepared, const std::vector<int>& faces) {
  std::set<int> components;
  for (const int face : faces) {
    components.insert(prepared.components.component_of_face[static_cast<std::size_t>(face)]);
  }
  return components.size();
}

// "ring", or "group of 12 parts".
std::string shape_noun(const PreparedMesh& prepared, const std::vector<int>& faces, const Region* region) {
  if (region != nullptr && region->group.continuous()) return std::string(round_noun(prepared, *region));
  const std::size_t parts = components_in(prepared, faces);
  if (parts > 1) return "group of " + std::to_string(parts) + " parts";
  return std::string(angular_noun(surface_moments(prepared, faces)));
}

struct Noun {
  std::string text;
  bool given = false;  // the file's name
};

// By the file's names, or by the shape: "leg", "group of 4 x leg", "plate of door", "ring".
Noun noun_of(const PreparedMesh& prepared, const PartNames& names, const std::vector<int>& faces,
             const Region* region) {
  const auto named = names.of(faces);
  if (named && named->whole && named->parts == 1) return {named->text, true};
  if (named && named->whole) {
    return {"group of " + std::to_string(named->parts) + " x " + named->text, true};
  }
  const std::string shape = shape_noun(prepared, faces, region);
  return {shape + (named && named->parts == 1 ? " of " + named->text : ""), false};
}

// What each region of a family is called: all by one noun and their number, unless the file gives them names of their
// own.
std::vector<std::string> names_of_family(const PreparedMesh& prepared, const PartNames& names,
                                         const std::vector<const Region*>& family) {
  std::vector<Noun> nouns;
  for (const Region* region : family) nouns.push_back(noun_of(prepared, names, region->faces, region));
  const bool alike = std::ranges::all_of(nouns, [&](const Noun& noun) { return noun.text == nouns.front().text; });
  const bool own = family.size() == 1 || (!alike && std::ranges::all_of(nouns, &Noun::given));
  const std::string shared = alike ? nouns.front().text : shape_noun(prepared, family.front()->faces, family.front());
  std::vector<std::string> result;
  for (std::size_t i = 0; i < family.size(); ++i) {
    result.push_back(own ? nouns[i].text
                         : shared + " " + std::to_string(i + 1) + " of " + std::to_string(family.size()));
  }
  return result;
}

/// Words for the sides of the mesh.
class Sides {
 public:
  Sides(const PreparedMesh& prepared, const SideAxes& axes) : axes_(axes) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Eigen::VectorXd along = prepared.mesh.vertices * axis(k);
      low_[k] = along.minCoeff();
      high_[k] = along.maxCoeff();
    }
  }

  // "upper left ", or nothing where it lies in the middle.
  std::string of(const Vector3d& centroid) const {
    static constexpr std::string_view kWords[3][2] = {{"left", "right"}, {"front", "back"}, {"lower", "upper"}};
    std::string text;
    for (const std::size_t k : {2UL, 1UL, 0UL}) {
      const double extent = high_[k] - low_[k];
      if (extent < kAside) continue;  // of the diagonal: too flat to have sides
      const double aside = (centroid.dot(axis(k)) - 0.5 * (low_[k] + high_[k])) / extent;
      if (std::abs(aside) > kAside) text += std::string(kWords[k][aside > 0 ? 1 : 0]) + " ";
    }
    return text;
  }

 private:
  Vector3d axis(std::size_t k) const { return axes_.col(static_cast<Eigen::Index>(k)); }

  SideAxes axes_;
  double low_[3], high_[3];
};

std::string pattern_name(const Pattern& pattern, const Noun& noun) {
  const std::string items = std::to_string(pattern.instances.size()) + " " + plural(noun.text);
  switch (pattern.kind) {
    case Pattern::Kind::translation_1d:
      return "row of " + items;
    case Pattern::Kind::translation_2d:
    case Pattern::Kind::translation_3d:
      return "grid of " + items;
    case Pattern::Kind::rotation:
      return "arc of " + items;
    case Pattern::Kind::screw:
      return "spiral of " + items;
    case Pattern::Kind::congruent:
      return items;
  }
  return items;
}

}  // namespace

SideAxes side_axes(const Vector3d& up) {
  SideAxes axes;
  axes.col(2) = up.normalized();
  const Vector3d right = std::abs(axes(0, 2)) < 0.9 ? Vector3d::UnitX() : Vector3d::UnitY();
  axes.col(0) = (right - right.dot(axes.col(2)) * axes.col(2)).normalized();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  return axes;
}

void name_by_shape_and_place(const PreparedMesh& prepared, const std::vector<std::vector<std::size_t>>& families,
                             const SideAxes& axes, const PartNames& names, SymmetryAnnotation& annotation,
                             Explanation* explanation) {
  const Sides sides(prepared, axes);
  std::vector<std::string> taken;  // names, to tell equal ones apart
  const auto told_apart = [&](std::string name) {
    const auto same = std::ranges::count(taken, name);
    taken.push_back(name);
    return same > 0 ? name + " (" + std::to_string(same + 1) + ")" : name;
  };
  const auto rename = [&](std::string& name, std::string now, const std::string& what) {
    if (explanation != nullptr) explanation->notes.push_back({"names", what + now, true, "found as " + name});
    name = std::move(now);
  };
  for (const std::vector<std::size_t>& family : families) {
    std::vector<const Region*> members;
    for (const std::size_t r : family) members.push_back(&annotation.regions[r]);
    const std::vector<std::string> own = names_of_family(prepared, names, members);
    for (std::size_t i = 0; i < family.size(); ++i) {
      Region& region = annotation.regions[family[i]];
      const std::string what = region.group.symbol() + " on ";
      const SurfaceMoments moments = surface_moments(prepared, region.faces);
      const std::string side = sides.of(moments.centroid);
      if (moments.area >= kOfWhole * prepared.area) {
        rename(region.name, told_apart("whole"), what);
      } else if (family.size() == 1) {
        rename(region.name, told_apart(side + own[i]), what);
      } else {
        const std::string where = side.empty() ? "" : ", " + side.substr(0, side.size() - 1);
        rename(region.name, told_apart(own[i] + where), what);
      }
    }
  }
  for (Pattern& pattern : annotation.patterns) {
    const std::vector<int>& first = pattern.instances.front().faces;
    rename(pattern.name, told_apart(pattern_name(pattern, noun_of(prepared, names, first, nullptr))),
           to_string(pattern.kind) + " of ");
  }
}

}  // namespace orbifit
