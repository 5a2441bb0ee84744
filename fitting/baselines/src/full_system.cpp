#include "full_system.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "orbifit/baselines/symmetry_constraints.h"
#include "orbifit/model/errors.h"

#include "basis/subspace_parts.h"
#include "for_each_coordinate.h"
#include "plain_weights.h"
#include "registration/alignment.h"
#include "solver/rigid_modes.h"

namespace orbifit {

namespace {

using Eigen::Index;
using Eigen::Vector3d;
using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;

// Of each unknown: samples of one orbit share 1.
VectorXd metric_of(const SymmetricSampling& sampling, bool shared, Index unknowns) {
  VectorXd result = VectorXd::Ones(unknowns);
  if (!shared) return result;
  for (std::size_t k = 0; k < sampling.orbit_of_sample.size(); ++k) {
    const auto orbit = static_cast<std::size_t>(sampling.orbit_of_sample[k]);
    result.segment<3>(3 * static_cast<Index>(k))
        .setConstant(1.0 / (sampling.first_sample[orbit + 1] - sampling.first_sample[orbit]));
  }
  return result;
}

std::vector<int> nearest_samples(const LiftWeights& weights) {
  std::vector<int> result(static_cast<std::size_t>(weights.rows()), 0);
  for (Index v = 0; v < weights.rows(); ++v) {
    double largest = 0;
    for (LiftWeights::InnerIterator entry(weights, v); entry; ++entry) {
      if (entry.value() <= largest) continue;
      largest = entry.value();
      result[static_cast<std::size_t>(v)] = static_cast<int>(entry.col());
    }
  }
  return result;
}

Sparse constraints_of(const Subspace& subspace, FullSymmetry symmetry) {
  if (symmetry == FullSymmetry::none) return Sparse(0, 3 * subspace->sampling.points.rows());
  return symmetry_constraints(subspace);
}

}  // namespace

LiftWeights plain_weights(const Subspace& subspace) {
  const auto count = static_cast<Index>(subspace->orbits.followers.size());
  std::vector<Eigen::Triplet<double>> entries;
  for (Index v = 0; v < count; ++v) {
    const int representative = subspace->orbits.followers[static_cast<std::size_t>(v)].representative;
    subspace->lift.visit(representative, [&](int atom, double weight) { entries.emplace_back(v, atom, weight); });
  }
  LiftWeights weights(count, subspace->sampling.points.rows());
  weights.setFromTriplets(entries.begin(), entries.end());
  return weights;
}

FullSystem::FullSystem(const Subspace& subspace, const Mesh& mesh, double stretch, FullSymmetry symmetry, double weight)
    : DeformationSystem(CorotatedEnergy(subspace->sampling.points, subspace->sampling.radius, stretch)),
      mesh_(mesh),
      weights_(plain_weights(subspace)),
      nearest_(nearest_samples(weights_)),
      diagonal_(diagonal(mesh.vertices)),
      pivot_(bounding_box_centre(mesh.vertices)),
      constraints_(constraints_of(subspace, symmetry)),
      unknowns_(constraints_.cols()),
      metric_(metric_of(subspace->sampling, symmetry != FullSymmetry::none, unknowns_)),
      rigid_(rigid_modes(subspace->sampling.points)),
      stiffness_(lower_for_each_coordinate(energy_.matrix(), unknowns_)),
      coupled_(static_cast<std::size_t>(samples()), std::vector<bool>(static_cast<std::size_t>(samples()), false)),
      known_(static_cast<std::size_t>(mesh.faces.rows()), 0),
      data_(unknowns_, unknowns_),
      saddle_(symmetry == FullSymmetry::constrained ? constraints_ : Sparse(0, unknowns_)) {
  if (symmetry != FullSymmetry::soft || constraints_.rows() == 0) return;
  // The mean over the pairs, which weighs as all samples do.
  soft_weight_ = weight * 3 * static_cast<double>(samples()) / static_cast<double>(constraints_.rows());
  const Sparse gram = constraints_.transpose() * constraints_;
  penalty_ = soft_weight_ * Sparse(gram.triangularView<Eigen::Lower>());
}

Points FullSystem::samples_at(const VectorXd& q) const {
  return Eigen::Map<const Points>(q.data(), samples(), 3);
}

Points FullSystem::vertices_at(const VectorXd& q, const RunContext&) const {
  return weights_ * Eigen::Map<const Points>(q.data(), samples(), 3);
}

double FullSystem::symmetry_energy(const VectorXd& q) const {
  return soft_weight_ == 0 ? 0 : soft_weight_ * (constraints_ * q).squaredNorm();
}

// Rows of a least-squares problem that touch much the same samples: multiplied out together, on those alone.
class FullSystem::Batch {
 public:
  Batch(const LiftWeights& weights, Index samples) : weights_(weights), place_(static_cast<std::size_t>(samples), -1) {}

  void begin(Index rows, const std::vector<int>& vertices) {
    for (const int sample : samples_) place_[static_cast<std::size_t>(sample)] = -1;
    samples_.clear();
    for (const int vertex : vertices) {
      for (LiftWeights::InnerIterator entry(weights_, vertex); entry; ++entry) {
        int& place = place_[static_cast<std::size_t>(entry.col())];
        if (place < 0) samples_.push_back(static_cast<int>(entry.col()));
        place = 0;
      }
    }
    std::ranges::sort(samples_);
    for (std::size_t j = 0; j < samples_.size(); ++j)
      place_[static_cast<std::size_t>(samples_[j])] = static_cast<int>(j);
    local_.setZero(rows, 3 * static_cast<Index>(samples_.size()));
    pose_.setZero(rows, 6);
    right_.setZero(rows);
  }

  // direction . u(vertex) is part of a row.
  void add_vertex(Index row, int vertex, const Vector3d& direction) {
    for (LiftWeights::InnerIterator entry(weights_, vertex); entry; ++entry) {
      local_.row(row).segment<3>(3 * place_[static_cast<std::size_t>(entry.col())]) +=
          entry.value() * direction.transpose();
    }
  }

  void finish(Index row, const Eigen::Matrix<double, 6, 1>& pose, double right, double weight) {
    const double root = std::sqrt(weight);
    local_.row(row) *= root;
    pose_.row(row) = root * pose;
    right_[row] = root * right;
  }

  void add_to(Normal& normal) {
    gram_.setZero(local_.cols(), local_.cols());
    gram_.selfadjointView<Eigen::Lower>().rankUpdate(local_.transpose());
    const VectorXd side = local_.transpose() * right_;
    const Eigen::MatrixXd border = local_.transpose() * pose_;
    for (std::size_t j = 0; j < samples_.size(); ++j) {
      const auto from = 3 * static_cast<Index>(j);
      const Index to = Index{3} * samples_[j];
      normal.side.segment<3>(to) += side.segment<3>(from);
      normal.border.middleRows<3>(to) += border.middleRows<3>(from);
      scatter(j, normal.sparse);
    }
    normal.side.tail<6>() += pose_.transpose() * right_;
    normal.corner += pose_.transpose() * pose_;
  }

 private:
  // The three columns of a sample, whose rows below the diagonal are three for each sample. Both ascend; what the
  // pattern leaves out is zero.
  void scatter(std::size_t sample, Sparse& matrix) const {
    const Index column = Index{3} * samples_[sample];
    const Index local = 3 * static_cast<Index>(sample);
    const auto* starts = matrix.outerIndexPtr() + column;
    const auto* rows = matrix.innerIndexPtr();
    Index at = starts[0];
    for (std::size_t i = sample; i < samples_.size(); ++i) {
      const int row = 3 * samples_[i];
      while (at < starts[1] && rows[at] < row) at += 3;
      if (at >= starts[1]) return;
      if (rows[at] != row) continue;
      for (Index c = 0; c < 3; ++c) {
        double* to = matrix.valuePtr() + starts[c] + (at - starts[0]) - c;
        const double* from = gram_.data() + (local + c) * gram_.rows() + 3 * static_cast<Index>(i);
        for (Index d = i == sample ? c : 0; d < 3; ++d) to[d] += from[d];
      }
    }
  }

  const LiftWeights& weights_;
  std::vector<int> samples_, place_;
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> local_;
  Eigen::Matrix<double, Eigen::Dynamic, 6> pose_;
  Eigen::MatrixXd gram_;
  VectorXd right_;
};

// Extends the data's pattern by samples that a row of these touches together: what no scan point lies near stays
// sparse.
void FullSystem::couple(const std::vector<Correspondence>& pairs, const std::vector<Pull>& pulls) {
  std::vector<int> touched;
  bool more = data_.nonZeros() == 0;
  const auto touch = [&](int vertex) {
    for (LiftWeights::InnerIterator entry(weights_, vertex); entry; ++entry) {
      touched.push_back(static_cast<int>(entry.col()));
    }
  };
  const auto add = [&] {
    std::ranges::sort(touched);
    touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
    for (std::size_t i = 0; i < touched.size(); ++i) {
      std::vector<bool>& row = coupled_[static_cast<std::size_t>(touched[i])];
      for (std::size_t j = i; j < touched.size(); ++j) {
        const auto other = static_cast<std::size_t>(touched[j]);
        if (row[other]) continue;
        row[other] = true;
        more = true;
      }
    }
    touched.clear();
  };
  for (const Correspondence& pair : pairs) {
    if (std::exchange(known_[static_cast<std::size_t>(pair.face)], char{1}) != 0) continue;
    for (int k = 0; k < 3; ++k) touch(mesh_.faces(pair.face, k));
    add();
  }
  for (const Pull& pull : pulls) {
    touch(pull.vertex);
    add();
  }
  if (!more) return;
  data_ = Sparse(unknowns_, unknowns_);
  for (Index column = 0; column < unknowns_; ++column) {
    data_.startVec(column);
    if (column >= 3 * samples()) {
      data_.insertBack(column, column) = 0;
      continue;
    }
    const std::vector<bool>& row = coupled_[static_cast<std::size_t>(column / 3)];
    for (Index i = column; i < 3 * samples(); ++i) {
      if (i == column || row[static_cast<std::size_t>(i / 3)]) data_.insertBack(i, column) = 0;
    }
  }
  data_.finalize();
}

void FullSystem::normal_of(const std::vector<Correspondence>& pairs, double share, const Points& scan_points,
                           const std::vector<Pull>& pulls, Normal& normal) {
  constexpr std::size_t kRows = 48;  // of a batch
  const auto of_pose = [&](const Vector3d& goal, const Vector3d& direction) {
    Eigen::Matrix<double, 6, 1> result;
    result << -(goal - pivot_).cross(direction) / diagonal_, -direction;
    return result;
  };
  std::vector<std::size_t> order(pairs.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  // Those near one sample touch much the same ones.
  const auto sample_of = [&](std::size_t i) {
    return nearest_[static_cast<std::size_t>(mesh_.faces(pairs[i].face, 0))];
  };
  std::ranges::stable_sort(order, {}, sample_of);
  Batch batch(weights_, samples());
  std::vector<int> vertices;
  std::size_t count = 0;
  for (std::size_t first = 0; first < pairs.size(); first += count) {
    count = 1;
    while (count < kRows && first + count < pairs.size() &&
           sample_of(order[first + count]) == sample_of(order[first])) {
      ++count;
    }
    vertices.clear();
    for (std::size_t i = 0; i < count; ++i) {
      for (int k = 0; k < 3; ++k) vertices.push_back(mesh_.faces(pairs[order[first + i]].face, k));
    }
    batch.begin(static_cast<Index>(count), vertices);
    for (std::size_t i = 0; i < count; ++i) {
      const Correspondence& pair = pairs[order[first + i]];
      const auto row = static_cast<Index>(i);
      const Vector3d rest = mesh_.vertices(mesh_.faces.row(pair.face), Eigen::all).transpose() * pair.barycentric;
      const Vector3d goal = scan_points.row(pair.scan_point);
      for (int k = 0; k < 3; ++k) {
        if (pair.barycentric[k] == 0) continue;
        batch.add_vertex(row, mesh_.faces(pair.face, k), pair.barycentric[k] * pair.normal);
      }
      batch.finish(row, of_pose(goal, pair.normal), pair.normal.dot(goal - rest), share * pair.weight);
    }
    batch.add_to(normal);
  }
  for (const Pull& pull : pulls) {
    batch.begin(3, {pull.vertex});
    const Vector3d rest = mesh_.vertices.row(pull.vertex);
    for (int c = 0; c < 3; ++c) {
      const Vector3d direction = Vector3d::Unit(c);
      batch.add_vertex(c, pull.vertex, direction);
      batch.finish(c, of_pose(pull.target, direction), pull.target[c] - rest[c], pull.weight);
    }
    batch.add_to(normal);
  }
}

FullSystem::Solution FullSystem::solve(const std::vector<Correspondence>& pairs, double share,
                                       const Points& scan_points, const std::vector<Pull>& pulls, const Hold& hold,
                                       const RunContext&) {
  const auto all_samples = static_cast<double>(samples());
  couple(pairs, pulls);
  Normal normal{data_, Eigen::MatrixXd::Zero(unknowns_, 6), Eigen::MatrixXd::Zero(6, 6), VectorXd::Zero(unknowns_ + 6)};
  normal_of(pairs, share, scan_points, pulls, normal);
  normal.sparse += hold.stiffness * stiffness_;
  if (soft_weight_ > 0) normal.sparse += penalty_;
  normal.sparse.diagonal() += (kHoldStill * all_samples + hold.damping) * metric_;
  normal.corner.diagonal().array() += kHoldPose * all_samples + hold.damping;
  normal.side.head(3 * samples()) += hold.stiffness * stacked(energy_.pull());
  if (hold.damping > 0) normal.side.head(unknowns_) += hold.damping * metric_.cwiseProduct(hold.around);

  // What prefers the pose is not sparse: k |B^T u|^2 is the largest of 2 z^T sqrt(k) B^T u - |z|^2, z unknowns too.
  const Index all = unknowns_ + 6;
  Eigen::MatrixXd border = Eigen::MatrixXd::Zero(unknowns_, 6 + rigid_.cols());
  border.leftCols<6>() = normal.border;
  border.topRightCorner(rigid_.rows(), rigid_.cols()) = std::sqrt(kPreferPose) * rigid_;
  Eigen::MatrixXd corner = -Eigen::MatrixXd::Identity(border.cols(), border.cols());
  corner.topLeftCorner<6, 6>() = normal.corner;
  VectorXd side = VectorXd::Zero(unknowns_ + border.cols());
  side.head(all) = normal.side;

  saddle_.factorise(normal.sparse, border, corner);
  const VectorXd solved = saddle_.solve(side);
  if (!solved.allFinite()) throw NoResultError("the fit's linear system has no finite solution");
  Solution solution;
  solution.q = solved.head(unknowns_);
  solution.scan_step = small_motion(solved.segment<3>(unknowns_) / diagonal_, solved.segment<3>(unknowns_ + 3), pivot_);
  return solution;
}

}  // namespace orbifit
