#include "basis/conjugated_regions.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "base/dense.h"
#include "basis/subspace_parts.h"

namespace orbifit {

namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;

constexpr double kFree = 1e-7;
constexpr double kNear = 1e-5;    // of the diagonal
constexpr double kAgree = 1e-12;  // of the diagonal

}  // namespace

Matrix3d blended_rotation(const Matrix3d& sum) {
  const Eigen::JacobiSVD<Matrix3d> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
  if (!(svd.singularValues()[0] > 0)) return Matrix3d::Identity();
  Matrix3d u = svd.matrixU();
  if ((u * svd.matrixV().transpose()).determinant() < 0) u.col(2) = -u.col(2);
  return u * svd.matrixV().transpose();
}

Matrix3d rotation_of(const Vector3d& vector) {
  const double angle = vector.norm();
  return angle > 0 ? axis_rotation(vector / angle, angle) : Matrix3d(Matrix3d::Identity());
}

MatrixXd applied(const LiftWeights& scalar, const MatrixXd& stacked) {
  MatrixXd result = MatrixXd::Zero(3 * scalar.rows(), stacked.cols());
  for (Eigen::Index row = 0; row < scalar.rows(); ++row) {
    for (LiftWeights::InnerIterator entry(scalar, row); entry; ++entry) {
      result.middleRows<3>(3 * row) += entry.value() * stacked.middleRows<3>(3 * entry.col());
    }
  }
  return result;
}

bool ConjugatedRegions::nested(int inner, int outer) const {
  const auto& small = samples_[static_cast<std::size_t>(inner)];
  const auto& large = samples_[static_cast<std::size_t>(outer)];
  const bool instance = outer >= subspace_->regions->count();  // may be no more than the region
  return small.size() < large.size() + (instance ? 1 : 0) && std::ranges::includes(large, small);
}

bool ConjugatedRegions::overlap(int a, int b) const {
  std::vector<int> common;
  std::ranges::set_intersection(samples_[static_cast<std::size_t>(a)], samples_[static_cast<std::size_t>(b)],
                                std::back_inserter(common));
  return !common.empty();
}

ConjugatedRegions::ConjugatedRegions(const Subspace& subspace, const RunContext& context) : subspace_(subspace) {
  const RegionMap& regions = *subspace->regions;
  const auto count = static_cast<std::size_t>(regions.count());
  samples_.resize(static_cast<std::size_t>(regions.places()));
  for (int k = 0; k < static_cast<int>(subspace->sampling.sets.size()); ++k) {
    for (const int place : regions.set_places(subspace->sampling.sets[static_cast<std::size_t>(k)])) {
      samples_[static_cast<std::size_t>(place)].push_back(k);
    }
  }
  Points centroids = Points::Zero(static_cast<Eigen::Index>(count), 3);
  for (std::size_t i = 0; i < count; ++i) {
    for (const int k : samples_[i]) centroids.row(static_cast<Eigen::Index>(i)) += subspace->sampling.points.row(k);
    centroids.row(static_cast<Eigen::Index>(i)) /= std::max(1.0, static_cast<double>(samples_[i].size()));
  }
  std::vector<int> order(count);
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, [&](int a, int b) {
    return samples_[static_cast<std::size_t>(a)].size() > samples_[static_cast<std::size_t>(b)].size();
  });
  around_.assign(count, -1);
  for (const int outer : order) {
    for (std::size_t i = 0; i < count; ++i) {
      if (nested(static_cast<int>(i), outer)) around_[i] = outer;  // the smallest comes last
    }
  }
  std::vector<char> taken(count, 0);
  for (std::size_t place = 0; place < order.size(); ++place) {
    if (taken[static_cast<std::size_t>(order[place])] == 0)
      gather(place, order, centroids, kNear * subspace->diagonal, taken);
  }
  if (subspace->mode == GroupMode::moving) keep_agreeing(context);
}

// Turns all ways at once, each by another angle. Ways that lose freedom are given up: regions whose mirrors no longer
// agree would leave their common points no way to move but along both. Of ways that contradict those before them, the
// first is found by halving: what some ways break, more ways break too.
void ConjugatedRegions::keep_agreeing(const RunContext& context) {
  struct Way {
    std::size_t family;
    Vector3d vector;
  };
  std::vector<Way> open;
  for (std::size_t f = 0; f < families_.size(); ++f) {
    for (Eigen::Index d = 0; d < families_[f].free.cols(); ++d) open.push_back({f, families_[f].free.col(d)});
  }
  std::vector<Way> kept;
  const auto take = [&](std::size_t more) {  // those kept and the first few that are open
    context.check();
    for (Family& family : families_) family.free.resize(3, 0);
    freedom_ = static_cast<int>(kept.size() + more);
    for (std::size_t k = 0; k < kept.size() + more; ++k) {
      const Way& way = k < kept.size() ? kept[k] : open[k - kept.size()];
      MatrixXd& free = families_[way.family].free;
      free.conservativeResize(3, free.cols() + 1);
      free.rightCols<1>() = way.vector;
    }
  };
  const auto agree = [&](std::size_t more) {
    take(more);
    Eigen::VectorXd angles(freedom_);
    for (Eigen::Index k = 0; k < freedom_; ++k) angles[k] = 0.3 * std::sin(1.0 + 2.0 * static_cast<double>(k));
    return keeps_freedom(subspace_, rotations(turned(rest(), angles)), kAgree * subspace_->diagonal);
  };
  while (!open.empty()) {
    std::size_t good = 0;               // so many agree
    std::size_t bad = open.size() + 1;  // so many do not, or there are not so many
    if (agree(open.size())) {
      good = open.size();
    } else {
      bad = open.size();
    }
    while (good + 1 < bad) {
      const std::size_t middle = good + (bad - good) / 2;
      (agree(middle) ? good : bad) = middle;
    }
    const auto end = open.begin() + static_cast<std::ptrdiff_t>(good);
    kept.insert(kept.end(), open.begin(), end);
    open.erase(open.begin(), end == open.end() ? end : end + 1);
  }
  take(0);
}

// The family of a region: all that the elements of regions around it, and the motions of patterns, take it to.
void ConjugatedRegions::gather(std::size_t first, const std::vector<int>& order, const Points& centroids, double near,
                               std::vector<char>& taken) {
  const RegionMap& regions = *subspace_->regions;
  Family family;
  family.members.push_back({order[first], Matrix3d::Identity()});
  taken[static_cast<std::size_t>(order[first])] = 1;
  Matrix3d bound = Matrix3d::Zero();
  for (std::size_t m = 0; m < family.members.size(); ++m) {
    const Member member = family.members[m];
    for (int outer = 0; outer < regions.places(); ++outer) {
      if (!nested(member.region, outer)) continue;
      for (const Motion& element : outer < regions.count() ? regions.test_elements(outer) : regions.elements(outer)) {
        const Vector3d centroid = element(Vector3d(centroids.row(member.region).transpose()));
        const Vector3d centre = element(regions.centre(member.region));
        const Matrix3d linear = element.linear.determinant() * element.linear * member.from_first;
        for (const int other : order) {
          if (samples_[static_cast<std::size_t>(other)].size() !=
                  samples_[static_cast<std::size_t>(member.region)].size() ||
              regions.elements(other).size() != regions.elements(member.region).size() ||
              (centroids.row(other).transpose() - centroid).norm() > near) {
            continue;
          }
          // A region on the same surface about another centre is another region.
          const bool mirror = regions.elements(other).size() == 2;
          if (!mirror && (regions.centre(other) - centre).norm() > near) continue;
          const auto known = std::ranges::find(family.members, other, &Member::region);
          if (known == family.members.end()) {
            if (taken[static_cast<std::size_t>(other)] != 0) continue;
            taken[static_cast<std::size_t>(other)] = 1;
            family.members.push_back({other, linear});
          } else {
            const Matrix3d difference = linear - known->from_first;
            bound += difference.transpose() * difference;
          }
        }
      }
    }
  }
  for (const Member& member : family.members) {
    for (const int other : order) {
      if (other != member.region && overlap(member.region, other) && !nested(member.region, other) &&
          !nested(other, member.region)) {
        bound = Matrix3d::Identity();
      }
    }
    if (samples_[static_cast<std::size_t>(member.region)].size() < 3) bound = Matrix3d::Identity();
  }
  const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(bound);
  Eigen::Index free = 0;
  while (free < 3 && solver.eigenvalues()[free] < kFree) ++free;
  family.free = solver.eigenvectors().leftCols(free);
  freedom_ += static_cast<int>(free);
  families_.push_back(std::move(family));
}

std::vector<Matrix3d> ConjugatedRegions::rotations(const Turns& turns) const {
  std::vector<Matrix3d> result(around_.size(), Matrix3d::Identity());
  for (std::size_t f = 0; f < families_.size(); ++f) {
    for (const Member& member : families_[f].members) {
      const Matrix3d& to = member.from_first;  // det(O) O: conjugation does not mind the sign
      const int outer = around_[static_cast<std::size_t>(member.region)];
      const Matrix3d relative = to * turns[f] * to.transpose();
      result[static_cast<std::size_t>(member.region)] =
          outer < 0 ? relative : Matrix3d(result[static_cast<std::size_t>(outer)] * relative);
    }
  }
  return result;
}

ConjugatedRegions::Turns ConjugatedRegions::turns_of(const std::vector<Matrix3d>& rotations) const {
  Turns result = rest();
  for (std::size_t f = 0; f < families_.size(); ++f) {
    const auto first = static_cast<std::size_t>(families_[f].members.front().region);
    result[f] = rotations[first];
    if (around_[first] >= 0) result[f] = rotations[static_cast<std::size_t>(around_[first])].transpose() * result[f];
  }
  return result;
}

ConjugatedRegions::Turns ConjugatedRegions::as_one(const Matrix3d& rotation) const {
  Turns result = rest();
  for (std::size_t f = 0; f < families_.size(); ++f) {
    const auto first = static_cast<std::size_t>(families_[f].members.front().region);
    if (around_[first] < 0 && families_[f].free.cols() == 3) result[f] = rotation;
  }
  return result;
}

ConjugatedRegions::Turns ConjugatedRegions::turned(const Turns& turns, const Eigen::VectorXd& angles) const {
  Turns result = turns;
  Eigen::Index at = 0;
  for (std::size_t f = 0; f < families_.size(); ++f) {
    const Eigen::Index size = families_[f].free.cols();
    if (size > 0) result[f] = rotation_of(families_[f].free * angles.segment(at, size)) * turns[f];
    at += size;
  }
  return result;
}

MatrixXd ConjugatedRegions::columns(const Turns& turns, const Points& samples, const Points& centres) const {
  return columns_of(turns, samples_, samples, centres);
}

MatrixXd ConjugatedRegions::vertex_columns(const Turns& turns, const std::vector<int>& vertices, const Points& points,
                                           const Points& centres) const {
  Held held(around_.size());
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    for (const int place : subspace_->regions->set_places(set_of_vertex(subspace_->orbits, vertices[i]))) {
      if (place < subspace_->regions->count()) held[static_cast<std::size_t>(place)].push_back(static_cast<int>(i));
    }
  }
  return columns_of(turns, held, points, centres);
}

MatrixXd ConjugatedRegions::columns_of(const Turns& turns, const Held& held, const Points& points,
                                       const Points& centres) const {
  const std::vector<Matrix3d> now = rotations(turns);
  MatrixXd result = MatrixXd::Zero(3 * points.rows(), freedom_);
  Eigen::Index at = 0;
  for (const Family& family : families_) {
    for (Eigen::Index d = 0; d < family.free.cols(); ++d, ++at) {
      for (const Member& member : family.members) {
        const int outer = around_[static_cast<std::size_t>(member.region)];
        Vector3d rotation = member.from_first * family.free.col(d);
        if (outer >= 0) rotation = now[static_cast<std::size_t>(outer)] * rotation;
        for (const int k : held[static_cast<std::size_t>(member.region)]) {
          const Vector3d arm = (points.row(k) - centres.row(member.region)).transpose();
          result.block<3, 1>(3 * Eigen::Index{k}, at) += rotation.cross(arm);
        }
      }
    }
  }
  return result;
}

MatrixXd ConjugatedRegions::arms(const Turns& turns, const LiftWeights& spread, const Points& missing) const {
  const Points none = Points::Zero(static_cast<Eigen::Index>(around_.size()), 3);
  MatrixXd result = MatrixXd::Zero(3 * missing.rows(), freedom_);
  for (int c = 0; c < 3; ++c) {
    Points arm = Points::Zero(spread.cols(), 3);
    arm.col(c).setOnes();
    const MatrixXd across = applied(spread, columns(turns, arm, none));  // omega x e_c
    for (Eigen::Index p = 0; p < missing.rows(); ++p) {
      result.middleRows<3>(3 * p) += missing(p, c) * across.middleRows<3>(3 * p);
    }
  }
  return result;
}

}  // namespace orbifit
