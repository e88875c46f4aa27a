#include "fem/reduced.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <string>

#include "base/error.h"
#include "fem/factor/factorization.h"
#include "fem/given_modes.h"

namespace chladni::fem {
namespace {

Eigen::MatrixXd product(const SparseMatrix& lower, const Eigen::MatrixXd& x) {
  return lower.selfadjointView<Eigen::Lower>() * x;
}

void require_fit(const System& system, const modal::Modes& modes, const SparseMatrix& forces,
                 const char* name) {
  const auto n = system.stiffness.rows();
  require(modes.dof_count() == n && forces.rows() == n,
          "reduced: the system has " + fmt::to_string(n) + " degrees of freedom, the modes " +
              fmt::to_string(modes.dof_count()) + ", the " + name + " " +
              fmt::to_string(forces.rows()) + "; expected one number");
}

// M Φ, with which a field's part in the modes can be removed.
Eigen::MatrixXd weighted(const System& system, const modal::Modes& modes) {
  Eigen::MatrixXd result = product(system.mass, modes.shapes);
  const Eigen::MatrixXd gram = modes.shapes.transpose() * result;
  require(gram.isIdentity(1e-6), "reduced: the modes are not mass-orthonormal in this system");
  return result;
}

// A shift that is not above the omitted modes and well above the rounding of K.
double shift(const System& system, const modal::Modes& modes) {
  double hz = system.frequency_scale_hz;
  if (modes.mode_count() > modes.rigid_count) hz = modes.frequency_hz(modes.rigid_count);
  if (hz > 0.0) return std::pow(2.0 * std::numbers::pi * hz, 2);
  // The Rayleigh quotient of one degree of freedom is above the lowest eigenvalue.
  double least = std::numeric_limits<double>::infinity();
  for (Eigen::Index i = 0; i < system.stiffness.rows(); ++i) {
    const double k = system.stiffness.coeff(i, i);
    if (k > 0.0) least = std::min(least, k / system.mass.coeff(i, i));
  }
  return 1e-3 * least;
}

// The factor that `modes` has left, where its shift is well below the omitted modes, or a new one.
// Where the shift of `modes` serves, a new one has it too: the result has the same bits whether the
// factor is still there, was too large to keep, or the modes are those of an earlier run.
std::shared_ptr<const Factorization> factor_for(const System& system, const modal::Modes& modes) {
  constexpr double kWellBelow = 0.1;  // each step then leaves less than a tenth of the error
  const double s = shift(system, modes);
  const double last = modes.mode_count() > modes.rigid_count
                          ? std::pow(2.0 * std::numbers::pi * modes.frequency_hz.tail<1>()(0), 2)
                          : 0.0;
  const double least = 0.1 * s;
  const double most = kWellBelow * last;
  const auto kept = system.kept_factor->kept(system.stiffness, system.mass, least, most);
  if (kept.factor) return kept.factor;
  const double before = inverted_shift(system);
  const bool serves = before >= least && before <= most;
  return std::make_shared<const Factorization>(
      system.kept_factor->symbolic(system.stiffness, system.mass), system.stiffness,
      serves ? before : s, system.mass);
}

// One step of the pivoted Cholesky factorisation: the column of the largest diagonal entry left.
Eigen::VectorXd pivot_column(const SparseMatrix& damping,
                             const std::vector<Eigen::VectorXd>& columns, Eigen::Index pivot,
                             double left) {
  Eigen::VectorXd column =
      damping.selfadjointView<Eigen::Lower>() * Eigen::VectorXd::Unit(damping.rows(), pivot);
  for (const auto& earlier : columns) column -= earlier(pivot) * earlier;
  return column / std::sqrt(left);
}

SparseMatrix sparse_columns(Eigen::Index rows, const std::vector<Eigen::VectorXd>& columns) {
  SparseMatrix result(rows, static_cast<Eigen::Index>(columns.size()));
  for (std::size_t j = 0; j < columns.size(); ++j) {
    result.startVec(static_cast<Eigen::Index>(j));
    for (Eigen::Index i = 0; i < rows; ++i) {
      if (columns[j](i) != 0.0) {
        result.insertBack(i, static_cast<Eigen::Index>(j)) = columns[j](i);
      }
    }
  }
  result.finalize();
  return result;
}

SparseMatrix side_by_side(const SparseMatrix& a, const SparseMatrix& b) {
  SparseMatrix result(a.rows(), a.cols() + b.cols());
  result.leftCols(a.cols()) = a;
  result.rightCols(b.cols()) = b;
  return result;
}

}  // namespace

SparseMatrix columns_on_free(const DofMap& dofs,
                             const std::vector<Eigen::SparseVector<double>>& rows) {
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t j = 0; j < rows.size(); ++j) {
    require(rows[j].size() <= dofs.free_dof.size(),
            "reduced: the row of a channel has " + fmt::to_string(rows[j].size()) +
                " degrees of freedom, the body " + fmt::to_string(dofs.free_dof.size()));
    for (Eigen::SparseVector<double>::InnerIterator entry(rows[j]); entry; ++entry) {
      const int free = dofs.free_dof(entry.index());
      if (free >= 0) entries.emplace_back(free, static_cast<int>(j), entry.value());
    }
  }
  SparseMatrix result(dofs.free_count, static_cast<Eigen::Index>(rows.size()));
  result.setFromTriplets(entries.begin(), entries.end());
  return result;
}

SparseMatrix dashpots(const SparseMatrix& damping) {
  const Eigen::VectorXd diagonal = damping.diagonal();
  Eigen::VectorXd left = diagonal;
  std::vector<Eigen::VectorXd> columns;
  Eigen::Index pivot = 0;
  // A degree of freedom is done when its remaining diagonal entry is only rounding.
  const auto next = [&] {
    const Eigen::VectorXd open =
        (left.array() > 1e-13 * diagonal.array()).select(left, Eigen::VectorXd::Zero(left.size()));
    return left.size() > 0 ? open.maxCoeff(&pivot) : 0.0;
  };
  for (double largest = next(); largest > 0.0; largest = next()) {
    columns.push_back(pivot_column(damping, columns, pivot, largest));
    left -= columns.back().cwiseAbs2();
    left(pivot) = 0.0;
    const bool sound = (left.array() >= -1e-9 * diagonal.cwiseAbs().array()).all();
    require(sound, "reduced: the damping matrix is not positive semidefinite");
  }
  require((diagonal.array() >= 0.0).all(),
          "reduced: the damping matrix has a negative diagonal entry");
  return sparse_columns(damping.rows(), columns);
}

Eigen::MatrixXd residual_flexibility(const System& system, const modal::Modes& modes,
                                     const SparseMatrix& forces) {
  require_fit(system, modes, forces, "forces");
  const auto mass_shapes = weighted(system, modes);
  const auto in_the_modes_left_out = [&](Eigen::MatrixXd x) {
    for (int pass = 0; pass < 2; ++pass) x -= modes.shapes * (mass_shapes.transpose() * x);
    return x;
  };
  const Eigen::MatrixXd load =
      Eigen::MatrixXd(forces) - mass_shapes * (modes.shapes.transpose() * forces);
  const auto kept = factor_for(system, modes);
  const Factorization& factor = *kept;
  Eigen::MatrixXd x = in_the_modes_left_out(factor.solve(load));
  double change = std::numeric_limits<double>::infinity();
  for (int step = 0; step < 200; ++step) {
    const Eigen::MatrixXd correction =
        in_the_modes_left_out(factor.solve(load - product(system.stiffness, x)));
    x += correction;
    const double before = change;
    change = correction.norm();
    // The norm of the correction falls by s / (s + λ) each time, until the correction is rounding.
    if (change <= 1e-13 * x.norm()) return x;
    if (change <= 1e-9 * x.norm() && change >= 0.5 * before) return x;
  }
  throw NumericalFailure(
      "reduced: the static correction has not converged in 200 steps; ask for more modes, or check "
      "that none is missing (the certificate of fem::modes)");
}

modal::ReducedModel reduced(const System& system, const modal::Modes& modes,
                            const SparseMatrix& outputs, const SparseMatrix& inputs) {
  require_fit(system, modes, outputs, "outputs");
  require_fit(system, modes, inputs, "inputs");
  const SparseMatrix dampers = system.damping.size() > 0 ? dashpots(system.damping)
                                                         : SparseMatrix(system.stiffness.rows(), 0);
  const Eigen::MatrixXd moved = residual_flexibility(system, modes, side_by_side(inputs, dampers));
  const auto by_inputs = moved.leftCols(inputs.cols());
  const auto by_dampers = moved.rightCols(dampers.cols());
  modal::ReducedModel model;
  model.frequency_hz = modes.frequency_hz;
  model.damping_ratio = modes.damping_ratio;
  model.rigid_count = modes.rigid_count;
  model.output_shapes = outputs.transpose() * modes.shapes;
  model.input_shapes = modes.shapes.transpose() * inputs;
  model.residual = outputs.transpose() * by_inputs;
  model.dampers.shapes = dampers.transpose() * modes.shapes;
  model.dampers.to_outputs = outputs.transpose() * by_dampers;
  model.dampers.from_inputs = dampers.transpose() * by_inputs;
  const Eigen::MatrixXd among = dampers.transpose() * by_dampers;
  model.dampers.among = 0.5 * (among + among.transpose());
  return model;
}

}  // namespace chladni::fem
