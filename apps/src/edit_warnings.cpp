#include "edit_warnings.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/Geometry>
#include <Eigen/SVD>

#include "basis/subspace_parts.h"
#include "command.h"
#include "geometry/point_index.h"

namespace orbifit {

namespace {

using Eigen::Index;
using Eigen::Vector3d;

// What a handle asks of some of its vertices.
struct Demands {
  std::vector<int> vertices;  // spread over the handle's
  double asked = 0;           // root mean square length of what is asked, mesh units
  double missed = 0;          // the same of what was not reached
};

Demands demands_of(const Mesh& mesh, const Handle& handle, const Mesh& edited) {
  constexpr std::size_t kMax = 48;  // as many as the deformer takes
  Demands demands;
  const std::size_t count = std::min(kMax, handle.vertices.size());
  for (std::size_t i = 0; i < count; ++i) {
    const int v = handle.vertices[i * handle.vertices.size() / count];
    const Vector3d place = mesh.vertices.row(v);
    const Vector3d target = handle.motion(place);
    demands.vertices.push_back(v);
    demands.asked += (target - place).squaredNorm();
    demands.missed += (target - edited.vertices.row(v).transpose()).squaredNorm();
  }
  demands.asked = std::sqrt(demands.asked / static_cast<double>(count));
  demands.missed = std::sqrt(demands.missed / static_cast<double>(count));
  return demands;
}

// How much of what each handle asks one region's group forbids, on its own: where an element takes a point of a handle
// to one of a handle, the two displacements must be images of each other, u(g p) = O u(p), up to how the mode lets the
// group be carried along. What is left of the demands is their mean over such points.
class Forbidden {
 public:
  Forbidden(const Mesh& mesh, const std::vector<Handle>& handles, const std::vector<Demands>& demands)
      : mesh_(mesh), handles_(handles), demands_(demands) {
    for (std::size_t h = 0; h < handles.size(); ++h) {
      for (const int v : handles[h].vertices) {
        vertices_.push_back(v);
        handle_of_.push_back(h);
      }
    }
    index_.emplace(Points(mesh.vertices(vertices_, Eigen::all)));
  }

  /// Of each handle the root mean square of what is forbidden, mesh units.
  std::vector<double> by(const Subspace& subspace, const Region& region, int number) const {
    const std::vector<int> inside = vertices_of_faces(mesh_, region.faces);
    const std::vector<Pair> pairs = pairs_of(subspace->regions->test_elements(number), inside);
    const Vector3d scale = Vector3d::Constant(1 / std::max(diagonal(mesh_.vertices), 1e-300));
    // The group's translation, in mode moving also its rotation to first order, that agree with the demands best.
    const Index unknowns = subspace.mode() == GroupMode::fixed ? 0 : subspace.mode() == GroupMode::floating ? 3 : 6;
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(unknowns, unknowns);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(unknowns);
    const auto rows_of = [&](const Pair& pair) {
      Eigen::MatrixXd rows(3, unknowns);
      if (unknowns >= 3) rows.leftCols<3>() = Eigen::Matrix3d::Identity() - pair.motion.linear;
      if (unknowns >= 6) {
        const Vector3d from = pair.place - region.centre;
        const Vector3d to = pair.motion(pair.place) - region.centre;
        rows.rightCols<3>() = (pair.motion.linear * cross_matrix(from) - cross_matrix(to)) * scale.asDiagonal();
      }
      return rows;
    };
    for (const Pair& pair : pairs) {
      const Eigen::MatrixXd rows = rows_of(pair);
      normal += rows.transpose() * rows;
      right += rows.transpose() * pair.difference;
    }
    Eigen::VectorXd carried(unknowns);
    if (unknowns > 0) {
      Eigen::JacobiSVD<Eigen::MatrixXd> svd(normal, Eigen::ComputeThinU | Eigen::ComputeThinV);
      svd.setThreshold(1e-9);  // what no pair depends on
      carried = svd.solve(right);
    }
    std::vector<double> result(handles_.size(), 0);
    Vector3d sum = Vector3d::Zero();
    double count = 1;  // the point itself
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const Pair& pair = pairs[i];
      sum += pair.motion.linear.transpose() * (pair.difference - rows_of(pair) * carried);
      count += 1;
      if (i + 1 < pairs.size() && pairs[i + 1].point == pair.point) continue;
      result[pair.handle] += (sum / count).squaredNorm();
      sum.setZero();
      count = 1;
    }
    for (std::size_t h = 0; h < result.size(); ++h) {
      result[h] = std::sqrt(result[h] / static_cast<double>(demands_[h].vertices.size()));
    }
    return result;
  }

 private:
  struct Pair {
    std::size_t handle;   // of the point
    std::size_t point;    // counted over all handles
    Vector3d place;       // of the point at rest
    Motion motion;        // g
    Vector3d difference;  // demand at g p, less the image of that at p
  };

  static Eigen::Matrix3d cross_matrix(const Vector3d& v) {
    Eigen::Matrix3d matrix;
    matrix << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
    return matrix;
  }

  // Ordered by point.
  std::vector<Pair> pairs_of(const std::vector<Motion>& elements, const std::vector<int>& inside) const {
    constexpr double kNear = 0.01;  // of the diagonal: an image so near a handle is meant to be of it
    const double reach = kNear * diagonal(mesh_.vertices);
    std::vector<Pair> pairs;
    std::size_t point = 0;
    for (std::size_t h = 0; h < handles_.size(); ++h) {
      for (const int v : demands_[h].vertices) {
        ++point;
        if (!std::ranges::binary_search(inside, v)) continue;
        const Vector3d place = mesh_.vertices.row(v);
        const Vector3d demand = handles_[h].motion(place) - place;
        for (const Motion& element : elements) {
          const Vector3d image = element(place);
          const PointIndex::Neighbour near = index_->nearest(image, 1).front();
          const auto at = static_cast<std::size_t>(near.index);
          if (near.distance > reach || !std::ranges::binary_search(inside, vertices_[at])) continue;
          const Vector3d there = handles_[handle_of_[at]].motion(image) - image;
          pairs.push_back({h, point, place, element, there - element.linear * demand});
        }
      }
    }
    return pairs;
  }

  const Mesh& mesh_;
  const std::vector<Handle>& handles_;
  const std::vector<Demands>& demands_;
  std::vector<int> vertices_;           // of all handles
  std::vector<std::size_t> handle_of_;  // each of them
  std::optional<PointIndex> index_;
};

std::string blame(const std::vector<const Region*>& regions) {
  constexpr std::size_t kMaxNamed = 4;
  std::string names;
  std::string ids;
  for (std::size_t i = 0; i < regions.size(); ++i) {
    const std::string id = std::to_string(regions[i]->id);
    ids += (i == 0 ? "" : ",") + id;
    if (i >= kMaxNamed) continue;
    names += (i == 0                    ? ""
              : i + 1 == regions.size() ? " and "
                                        : ", ") +
             id + " (" + regions[i]->group.symbol() + ", \"" + regions[i]->name + "\")";
  }
  if (regions.size() > kMaxNamed) names += " and " + std::to_string(regions.size() - kMaxNamed) + " more";
  return regions.size() == 1 ? "region " + names + " forbids this; leave it out with --without " + ids
                             : "regions " + names + " forbid this; leave them out with --without " + ids;
}

void add_missed_handles(const Mesh& mesh, const SymmetryAnnotation& annotation, const Subspace& subspace,
                        const std::vector<Handle>& handles, const Mesh& edited, std::vector<std::string>& warnings) {
  constexpr double kLargeShare = 0.25;  // of what is asked
  constexpr double kCause = 0.5;        // of what is missed
  std::vector<Demands> demands;
  double largest = 0;
  for (const Handle& handle : handles) {
    demands.push_back(demands_of(mesh, handle, edited));
    largest = std::max(largest, demands.back().asked);
  }
  if (!(largest > kExactResidual * diagonal(mesh.vertices))) return;  // nothing is asked
  std::optional<Forbidden> forbidden;
  std::vector<std::vector<double>> by_region;
  for (std::size_t h = 0; h < handles.size(); ++h) {
    const bool held = !(demands[h].asked > kExactResidual * diagonal(mesh.vertices));
    const double asked = held ? largest : demands[h].asked;
    if (demands[h].missed <= kLargeShare * asked) continue;
    if (!forbidden) {
      forbidden.emplace(mesh, handles, demands);
      for (std::size_t r = 0; r < annotation.regions.size(); ++r) {
        by_region.push_back(forbidden->by(subspace, annotation.regions[r], static_cast<int>(r)));
      }
    }
    std::vector<const Region*> causes;
    for (std::size_t r = 0; r < by_region.size(); ++r) {
      if (by_region[r][h] >= kCause * demands[h].missed) causes.push_back(&annotation.regions[r]);
    }
    const std::string name = "handle \"" + handles[h].name + "\" ";
    const std::string share =
        held ? "should be held but moves by " + percent(demands[h].missed / largest) + " of the largest move asked: "
             : "misses its target by " + percent(demands[h].missed / asked) + " of its move: ";
    warnings.push_back(
        name + share +
        (causes.empty() ? "the regions together, or samples too far apart (--radius), allow no more" : blame(causes)));
  }
}

// Whether the displacements are those of one rigid motion, but for a hundredth.
bool only_moved(const Mesh& mesh, const Mesh& edited) {
  constexpr double kRest = 0.01;  // of the displacements
  if (mesh.vertices.rows() < 3) return false;
  const double moved = (edited.vertices - mesh.vertices).norm();
  const double count = std::sqrt(static_cast<double>(mesh.vertices.rows()));
  if (!(moved > kExactResidual * count * diagonal(mesh.vertices))) return false;
  const Eigen::Matrix4d best = Eigen::umeyama(mesh.vertices.transpose(), edited.vertices.transpose(), false);
  const Eigen::Matrix3d rotation = best.topLeftCorner<3, 3>();
  const Points placed = (mesh.vertices * rotation.transpose()).rowwise() + best.topRightCorner<3, 1>().transpose();
  return (edited.vertices - placed).norm() <= kRest * moved;
}

}  // namespace

std::string exactness(double field_residual) {
  return "symmetric to " + short_number(100 * field_residual, 1) + " % of the diagonal";
}

std::vector<std::string> edit_warnings(const Mesh& mesh, const SymmetryAnnotation& annotation, const Subspace& subspace,
                                       const std::vector<Handle>& handles, const Mesh& edited, double field_residual) {
  std::vector<std::string> warnings;
  add_missed_handles(mesh, annotation, subspace, handles, edited, warnings);
  if (only_moved(mesh, edited)) {
    warnings.emplace_back("the whole shape moved as if rigid: hold something, by a handle without a motion");
  }
  if (field_residual > kExactResidual) warnings.push_back("the edit is only " + exactness(field_residual));
  return warnings;
}

}  // namespace orbifit
