#include "truth/transferred_faces.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "base/dense.h"
#include "detection_score/crease_index.h"
#include "detection_score/scored_surface.h"
#include "geometry/surface_index.h"

namespace orbifit {

namespace {

using Eigen::Index;
using Eigen::Vector3d;
using Family = PointGroup::Family;

// Square of the share of a sliding motion that may go across the surface.
constexpr double kSlides = 1.0 / (15 * 15);

Vector3d centroid_of(const Mesh& mesh, int face) {
  return (mesh.vertices.row(mesh.faces(face, 0)) + mesh.vertices.row(mesh.faces(face, 1)) +
          mesh.vertices.row(mesh.faces(face, 2))) /
         3;
}

double longest_side(const Mesh& mesh, int face) {
  double result = 0;
  for (Index k = 0; k < 3; ++k) {
    result = std::max(
        result, (mesh.vertices.row(mesh.faces(face, k)) - mesh.vertices.row(mesh.faces(face, (k + 1) % 3))).norm());
  }
  return result;
}

// The twists that map the region to itself by its group, as (turn, shift at the origin) in columns.
Eigen::Matrix<double, 6, Eigen::Dynamic> own_twists(const Region& region, const Vector3d& origin, double scale) {
  Eigen::Matrix<double, 6, Eigen::Dynamic> twists(6, 0);
  if (!region.group.continuous()) return twists;
  const Vector3d to_centre = (region.centre - origin) / scale;
  const auto turn_about = [&](const Vector3d& axis) {
    twists.conservativeResize(6, twists.cols() + 1);
    twists.rightCols(1) << axis, -axis.cross(to_centre);
  };
  if (region.group.has_axis()) {
    turn_about(region.axis);
  } else {
    for (Index k = 0; k < 3; ++k) turn_about(Vector3d::Unit(k));
  }
  return twists;
}

bool is_element(const Motion& motion, const Region& region, double size) {
  const double tolerance = 2e-3;
  if (!region.group.continuous()) {
    return std::ranges::any_of(region.elements, [&](const Motion& element) {
      return motion_distance(motion, element, region.centre, size) < tolerance * size;
    });
  }
  if ((motion(region.centre) - region.centre).norm() > tolerance * size) return false;
  const bool proper = motion.linear.determinant() > 0;
  if (!region.group.has_axis()) return proper || region.group.family == Family::Kh;
  const double along = region.axis.dot(motion.linear * region.axis);
  if (1 - std::abs(along) > tolerance * tolerance) return false;
  switch (region.group.family) {
    case Family::Cinf:
      return proper && along > 0;
    case Family::Cinfv:
      return along > 0;
    case Family::Cinfh:
      return proper == (along > 0);
    case Family::Dinf:
      return proper;
    default:
      return true;
  }
}

// Tests faces round by round, so that what one round finds spares the next ones work.
class OrbitTest {
 public:
  OrbitTest(const scoring::MeasuredMesh& measured, const std::vector<int>& from, const std::vector<int>& to,
            const std::vector<Motion>& motions, bool sampled, double tolerance)
      : measured_(measured),
        from_(from),
        motions_(motions),
        sampled_(sampled),
        tolerance_(tolerance),
        surface_(measured.mesh, to),
        creases_(measured.mesh, measured.normals, from),
        state_(static_cast<std::size_t>(measured.mesh.faces.rows()), State::open) {}

  KeptFaces operator()(const RunContext& context) {
    const std::size_t rounds = motions_.size() < kFewMotions ? 1 : kRounds;
    KeptFaces result;
    double squares = 0;
    double count = 0;
    for (std::size_t round = 0; round < rounds; ++round) {
      std::vector<int> open;
      for (std::size_t i = round; i < from_.size(); i += rounds) {
        if (state(from_[i]) == State::open && measured_.areas[from_[i]] > 0) open.push_back(from_[i]);
      }
      std::vector<Tested> tested(open.size());
      parallel_for(
          context, open.size(),
          [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) tested[i] = test(open[i]);
          },
          16);
      for (std::size_t i = 0; i < open.size(); ++i) {
        const State found = tested[i].kept ? State::kept : State::lost;
        state(open[i]) = found;
        // Of a group that is only sampled, one member of an orbit may miss the gap that another one falls into.
        for (const int face : tested[i].hit) {
          if (rounds > 1 && state(face) == State::open && (sampled_ || tested[i].kept)) state(face) = found;
        }
        if (!tested[i].kept) continue;
        squares += tested[i].squares;
        count += static_cast<double>(motions_.size());
        result.residual.max = std::max(result.residual.max, tested[i].largest / measured_.diagonal);
      }
    }
    for (const int face : from_) {
      if (state(face) == State::kept) result.faces.push_back(face);
    }
    if (count > 0) result.residual.rms = std::min(result.residual.max, std::sqrt(squares / count) / measured_.diagonal);
    return result;
  }

 private:
  static constexpr std::size_t kFewMotions = 8;
  static constexpr std::size_t kRounds = 61;

  enum class State : char { open, kept, lost };

  State& state(int face) { return state_[static_cast<std::size_t>(face)]; }

  struct Tested {
    bool kept = false;
    std::vector<int> hit;  // a face of each image
    double squares = 0;
    double largest = 0;
  };

  Tested test(int face) const {
    const Vector3d centroid = centroid_of(measured_.mesh, face);
    const Vector3d normal = measured_.normals.row(face);
    const double reach = std::clamp(longest_side(measured_.mesh, face), tolerance_, 3 * tolerance_);
    const bool at_crease = creases_.turned_away(centroid, normal, scoring::kNormalCosine, reach);
    Tested result;
    for (const Motion& motion : motions_) {
      const Vector3d image = motion(centroid);
      SurfaceIndex::Nearest nearest =
          surface_.nearest_facing(image, motion.linear * normal, scoring::kNormalCosine, tolerance_, true);
      if (nearest.face < 0 && at_crease) nearest = surface_.nearest(image, tolerance_);
      if (nearest.face < 0) return result;
      result.hit.push_back(nearest.face);
      result.squares += nearest.distance * nearest.distance;
      result.largest = std::max(result.largest, nearest.distance);
    }
    result.kept = true;
    return result;
  }

  const scoring::MeasuredMesh& measured_;
  const std::vector<int>& from_;
  const std::vector<Motion>& motions_;
  bool sampled_;
  double tolerance_;
  SurfaceIndex surface_;
  scoring::CreaseIndex creases_;
  std::vector<State> state_;  // of all faces of the mesh
};

}  // namespace

KeptFaces kept_faces(const scoring::MeasuredMesh& measured, const std::vector<int>& from, const std::vector<int>& to,
                     const std::vector<Motion>& motions, bool sampled, double tolerance, const RunContext& context) {
  if (from.empty() || to.empty()) return {};
  OrbitTest test(measured, from, to, motions, sampled, tolerance);
  return test(context);
}

bool slides(const scoring::MeasuredMesh& measured, const Points& normals, const std::vector<int>& faces,
            const Region& region) {
  Vector3d origin = Vector3d::Zero();
  double area = 0;
  for (const int face : faces) {
    origin += measured.areas[face] * centroid_of(measured.mesh, face);
    area += measured.areas[face];
  }
  if (!(area > 0)) return false;
  origin /= area;
  double spread = 0;
  for (const int face : faces) spread = std::max(spread, (centroid_of(measured.mesh, face) - origin).norm());
  if (!(spread > 0)) return true;

  Matrix6d across = Matrix6d::Zero();  // squared velocity across the surface
  Matrix6d speed = Matrix6d::Zero();   // squared velocity
  for (const int face : faces) {
    const Vector3d p = (centroid_of(measured.mesh, face) - origin) / spread;
    const Vector3d n = normals.row(face);
    const double weight = measured.areas[face] / area;
    Eigen::Matrix<double, 6, 1> row;
    row << p.cross(n), n;
    across += weight * row * row.transpose();
    for (Index k = 0; k < 3; ++k) {
      const Vector3d unit = Vector3d::Unit(k);
      row << p.cross(unit), unit;
      speed += weight * row * row.transpose();
    }
  }
  speed.diagonal().array() += 1e-9;
  const Eigen::SelfAdjointEigenSolver<Matrix6d> root(speed);
  Matrix6d share = root.operatorInverseSqrt() * across * root.operatorInverseSqrt();
  const Eigen::Matrix<double, 6, Eigen::Dynamic> own = root.operatorSqrt() * own_twists(region, origin, spread);
  if (own.cols() > 0) {
    const Eigen::MatrixXd basis = orthonormal_basis(own);
    const Matrix6d rest = Matrix6d::Identity() - basis * basis.transpose();
    share = rest * share * rest + basis * basis.transpose();
  }
  return Eigen::SelfAdjointEigenSolver<Matrix6d>(share, Eigen::EigenvaluesOnly).eigenvalues()[0] < kSlides;
}

bool has_all_elements(const Region& larger, const Region& smaller, double size) {
  if (larger.group == smaller.group) return false;
  if (smaller.group.continuous() && !larger.group.continuous()) return false;
  // Of a continuous group the generators hold its axis and its cosets.
  const std::vector<Motion>& tested = smaller.group.continuous() ? smaller.generators : smaller.elements;
  return std::ranges::all_of(tested, [&](const Motion& motion) { return is_element(motion, larger, size); });
}

}  // namespace orbifit
