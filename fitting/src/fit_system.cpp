#include "fit_system.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "orbifit/fitting/alignment.h"
#include "orbifit/model/errors.h"

namespace orbifit {

namespace {

// Prefers the pose to a deformation that does the same, relative to one sample's share of the data.
constexpr double kPreferPose = 1e-6;

// Sum over neighbours of (R_i + R_j) / 2 (x_i - x_j) less the same unrotated: what stretching pulls towards.
Points stretch_pull(const Corotation& corotation, const std::vector<Eigen::Matrix3d>& rotations) {
  Points pull = Points::Zero(corotation.rest.rows(), 3);
  for (std::size_t i = 0; i < rotations.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    for (const int j : corotation.neighbours[i]) {
      const Eigen::Vector3d edge = (corotation.rest.row(row) - corotation.rest.row(j)).transpose();
      const Eigen::Matrix3d mean = 0.5 * (rotations[i] + rotations[static_cast<std::size_t>(j)]);
      pull.row(row) += (mean * edge - edge).transpose();
    }
  }
  return pull;
}

}  // namespace

FitSystem::FitSystem(const Subspace& subspace, const Mesh& mesh, double stretch)
    : subspace_(subspace),
      rows_(subspace),
      mesh_(mesh),
      diagonal_(diagonal(mesh.vertices)),
      pivot_(bounding_box_centre(mesh.vertices)),
      corotation_(corotation(subspace.sampling.points, 2 * subspace.sampling.radius)),
      rotations_(static_cast<std::size_t>(subspace.sampling.points.rows()), Eigen::Matrix3d::Identity()) {
  // Per sample and neighbour, so that the stiffness means the same on every sampling.
  const double degree = std::max(1.0, corotation_.laplacian.diagonal().mean());
  corotation_.laplacian /= degree;
  corotation_.delta /= degree;
  stretch_ = stretch / degree;
  const Eigen::SparseMatrix<double> bending = corotation_.laplacian.transpose() * corotation_.laplacian;
  const Eigen::SparseMatrix<double> stretching = corotation_.laplacian * (degree * stretch_);
  stiffness_matrix_ = restricted(subspace.basis.columns, bending + stretching);
}

void FitSystem::rotate(const Eigen::VectorXd& q) {
  rotations_ = local_rotations(corotation_, corotation_.rest + sample_displacements(subspace_, q), rotations_);
}

// Rows of a least-squares problem that have much the same columns: multiplied out together, on those columns alone.
class FitSystem::Batch {
 public:
  explicit Batch(Eigen::Index columns) : place_(static_cast<std::size_t>(columns), -1) {}

  // Which columns the rows will have. In ascending order the local lower half is one of the whole matrix's.
  void begin(Eigen::Index rows, const std::vector<const std::vector<VertexRows::Entry>*>& entries) {
    for (const int column : columns_) place_[static_cast<std::size_t>(column)] = -1;
    columns_.clear();
    for (const auto* row : entries) {
      for (const VertexRows::Entry& entry : *row) {
        int& place = place_[static_cast<std::size_t>(entry.column)];
        if (place < 0) columns_.push_back(entry.column);
        place = 0;
      }
    }
    std::ranges::sort(columns_);
    for (int k = 0; k < 6; ++k) columns_.push_back(static_cast<int>(place_.size()) - 6 + k);
    for (std::size_t j = 0; j < columns_.size(); ++j) {
      place_[static_cast<std::size_t>(columns_[j])] = static_cast<int>(j);
    }
    local_.setZero(rows, static_cast<Eigen::Index>(columns_.size()));
    right_.setZero(rows);
  }

  // direction . u(vertex) is part of a row.
  void add_vertex(Eigen::Index row, const std::vector<VertexRows::Entry>& entries, const Eigen::Vector3d& direction) {
    for (const VertexRows::Entry& entry : entries) {
      local_(row, place_[static_cast<std::size_t>(entry.column)]) += direction.dot(entry.factor);
    }
  }

  // The six unknowns of the pose, the right-hand side, and the weight of the row: its last step.
  void finish(Eigen::Index row, const Eigen::Matrix<double, 6, 1>& pose, double right, double weight) {
    local_.row(row).tail<6>() = pose;
    right_[row] = right;
    const double root = std::sqrt(weight);
    local_.row(row) *= root;
    right_[row] *= root;
  }

  void add_to(Normal& normal) {
    gram_.setZero(local_.cols(), local_.cols());
    gram_.selfadjointView<Eigen::Lower>().rankUpdate(local_.transpose());
    side_.noalias() = local_.transpose() * right_;
    for (Eigen::Index b = 0; b < gram_.cols(); ++b) {
      const int column = columns_[static_cast<std::size_t>(b)];
      normal.side[column] += side_[b];
      double* to = normal.matrix.col(column).data();
      const double* from = gram_.col(b).data();
      for (Eigen::Index a = b; a < gram_.rows(); ++a) to[columns_[static_cast<std::size_t>(a)]] += from[a];
    }
  }

 private:
  std::vector<int> columns_, place_;
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> local_;
  Eigen::MatrixXd gram_;
  Eigen::VectorXd right_, side_;
};

FitSystem::Normal FitSystem::normal_of(const std::vector<Correspondence>& pairs, double share,
                                       const Points& scan_points, const std::vector<Pull>& pulls,
                                       const RunContext& context) {
  constexpr std::size_t kBlocks = 8;  // summed in turn: rounding does not depend on the number of threads
  constexpr std::size_t kRows = 48;   // of a batch
  const Eigen::Index dof = subspace_.degrees_of_freedom();
  const Normal zero{Eigen::MatrixXd::Zero(dof + 6, dof + 6), Eigen::VectorXd::Zero(dof + 6)};
  std::vector<Normal> blocks(std::min(kBlocks, 1 + pairs.size() / kRows), zero);
  // The rest is a point of the template, which is to go to the goal, along the direction.
  const auto of_pose = [&](const Eigen::Vector3d& goal, const Eigen::Vector3d& direction) {
    Eigen::Matrix<double, 6, 1> result;
    result << -(goal - pivot_).cross(direction) / diagonal_, -direction;
    return result;
  };
  std::vector<int> vertices;
  for (const Correspondence& pair : pairs) {
    for (int k = 0; k < 3; ++k) vertices.push_back(mesh_.faces(pair.face, k));
  }
  for (const Pull& pull : pulls) vertices.push_back(pull.vertex);
  rows_.prepare(vertices, context);
  // Neighbouring faces, mostly of neighbouring numbers, move with the same samples.
  std::vector<std::size_t> order(pairs.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return pairs[i].face; });
  parallel_for(context, blocks.size(), [&](std::size_t begin, std::size_t end) {
    Batch batch(dof + 6);
    std::vector<const std::vector<VertexRows::Entry>*> entries;
    for (std::size_t b = begin; b < end; ++b) {
      const std::size_t last = (b + 1) * pairs.size() / blocks.size();
      for (std::size_t first = b * pairs.size() / blocks.size(); first < last; first += kRows) {
        const std::size_t count = std::min(kRows, last - first);
        entries.clear();
        for (std::size_t i = first; i < first + count; ++i) {
          for (int k = 0; k < 3; ++k) entries.push_back(&rows_.of(mesh_.faces(pairs[order[i]].face, k)));
        }
        batch.begin(static_cast<Eigen::Index>(count), entries);
        for (std::size_t i = 0; i < count; ++i) {
          const Correspondence& pair = pairs[order[first + i]];
          const auto row = static_cast<Eigen::Index>(i);
          const Eigen::Vector3d rest =
              mesh_.vertices(mesh_.faces.row(pair.face), Eigen::all).transpose() * pair.barycentric;
          const Eigen::Vector3d goal = scan_points.row(pair.scan_point);
          for (int k = 0; k < 3; ++k) {
            if (pair.barycentric[k] == 0) continue;
            batch.add_vertex(row, *entries[3 * i + static_cast<std::size_t>(k)], pair.barycentric[k] * pair.normal);
          }
          batch.finish(row, of_pose(goal, pair.normal), pair.normal.dot(goal - rest), share * pair.weight);
        }
        batch.add_to(blocks[b]);
      }
    }
  });
  Normal total = zero;
  for (const Normal& block : blocks) {
    total.matrix += block.matrix;
    total.side += block.side;
  }
  Batch batch(dof + 6);
  for (const Pull& pull : pulls) {
    const std::vector<VertexRows::Entry>& entries = rows_.of(pull.vertex);
    const Eigen::Vector3d rest = mesh_.vertices.row(pull.vertex);
    batch.begin(3, {&entries});
    for (int c = 0; c < 3; ++c) {
      const Eigen::Vector3d direction = Eigen::Vector3d::Unit(c);
      batch.add_vertex(c, entries, direction);
      batch.finish(c, of_pose(pull.target, direction), pull.target[c] - rest[c], pull.weight);
    }
    batch.add_to(total);
  }
  return total;
}

FitSystem::Solution FitSystem::solve(const std::vector<Correspondence>& pairs, double share, const Points& scan_points,
                                     const std::vector<Pull>& pulls, const Hold& hold, const RunContext& context) {
  const Eigen::Index dof = subspace_.degrees_of_freedom();
  Normal normal = normal_of(pairs, share, scan_points, pulls, context);
  normal.matrix.topLeftCorner(dof, dof).triangularView<Eigen::Lower>() += hold.stiffness * stiffness_matrix_;
  normal.matrix.diagonal().head(dof).array() += kPreferPose * static_cast<double>(rotations_.size()) + hold.damping;
  normal.matrix.diagonal().tail<6>().array() += 1e-9 * static_cast<double>(rotations_.size()) + hold.damping;
  const Points pull = corotated_pull(corotation_, rotations_) + stretch_ * stretch_pull(corotation_, rotations_);
  normal.side.head(dof) += hold.stiffness * (subspace_.basis.columns.transpose() * stacked(pull));
  if (hold.damping > 0) normal.side.head(dof) += hold.damping * hold.around;

  const Eigen::LDLT<Eigen::MatrixXd, Eigen::Lower> factor(normal.matrix);
  const Eigen::VectorXd unknowns = factor.solve(normal.side);
  if (factor.info() != Eigen::Success || !unknowns.allFinite()) {
    throw NoResultError("the fit's linear system has no finite solution");
  }
  Solution solution;
  solution.q = unknowns.head(dof);
  solution.scan_step = small_motion(unknowns.segment<3>(dof) / diagonal_, unknowns.tail<3>(), pivot_);
  return solution;
}

double FitSystem::regularity(const Eigen::VectorXd& q) const {
  const Points moved = sample_displacements(subspace_, q);
  double stretching = 0;
  for (std::size_t i = 0; i < rotations_.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    for (const int j : corotation_.neighbours[i]) {
      if (j <= static_cast<int>(i)) continue;
      const Eigen::Vector3d edge = (corotation_.rest.row(row) - corotation_.rest.row(j)).transpose();
      const Eigen::Vector3d now = edge + (moved.row(row) - moved.row(j)).transpose();
      stretching += (now - 0.5 * (rotations_[i] + rotations_[static_cast<std::size_t>(j)]) * edge).squaredNorm();
    }
  }
  return laplace_energy(corotation_, rotations_, moved) + stretch_ * stretching;
}

}  // namespace orbifit
