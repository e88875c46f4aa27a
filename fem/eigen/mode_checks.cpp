#include "fem/eigen/mode_checks.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/error.h"
#include "base/interrupt.h"
#include "fem/eigen/symmetric_product.h"
#include "host/parallel.h"

namespace chladni::fem {
namespace {

using Matrix = Eigen::MatrixXd;

double hertz(double lambda) { return std::sqrt(std::max(lambda, 0.0)) / (2.0 * std::numbers::pi); }

// Where a shape moves most, in words.
std::string largest_motion(const System& system, const Eigen::VectorXd& shape) {
  Eigen::Index at = 0;
  shape.cwiseAbs().maxCoeff(&at);
  if (system.positions.rows() != shape.size()) return fmt::format("degree of freedom {}", at);
  const Eigen::RowVector3d mm = 1e3 * system.positions.row(at);
  return fmt::format("({:.4g}, {:.4g}, {:.4g}) mm", mm.x(), mm.y(), mm.z());
}

Matrix without(const System& system, const Matrix& known, const Matrix& shapes) {
  if (known.cols() == 0) return shapes;
  const Matrix inertia = SymmetricProduct(system.mass) * known;
  return shapes - known * (inertia.transpose() * shapes);
}

// |x|ᵀ|A||x| of up to eight x. Row i of `rows` holds |x_i| of all eight; A is a lower triangle.
constexpr Eigen::Index kAtOnce = 8;
using Rows = Eigen::Matrix<double, Eigen::Dynamic, kAtOnce, Eigen::RowMajor>;
using Eight = Eigen::Array<double, 1, kAtOnce>;

Eight absolute_energy(const SparseMatrix& a, const Rows& rows) {
  Eight total = Eight::Zero();
  for (Eigen::Index c = 0; c < a.cols(); ++c) {
    Eight sum = Eight::Zero();
    for (SparseMatrix::InnerIterator entry(a, c); entry; ++entry) {
      const double twice = entry.row() == c ? 1.0 : 2.0;
      sum += twice * std::abs(entry.value()) * rows.row(entry.row()).array();
    }
    total += sum * rows.row(c).array();
  }
  return total;
}

// The energy of the rigid-body motions as a fraction of the first flexible mode's energy; 0 where
// this energy is only rounding.
Eigen::VectorXd strains(const System& system, double first) {
  constexpr double kSafe = 100.0;
  const Matrix forces = SymmetricProduct(system.stiffness) * system.rigid;
  const Eigen::VectorXd energy =
      system.rigid.cwiseProduct(forces).colwise().sum().transpose().cwiseAbs();
  const Eigen::VectorXd rounding =
      energy_rounding(system, Matrix(system.rigid.rows(), 0), system.rigid);
  return (energy.array() > kSafe * rounding.array()).select(energy / first, 0.0 * energy);
}

std::string advice(const System& system, double lambda) {
  if (system.suspended.cols() > 0) {
    return "stiffnesses this far apart are beyond double precision: leave out the softest springs, "
           "or hold what is stiff";
  }
  const auto why = precision_advice(system, lambda);
  return why.empty() ? "ask for another count of modes, or another seed" : why;
}

}  // namespace

Eigen::VectorXd energy_rounding(const System& system, const Matrix& known, const Matrix& shapes) {
  Eigen::VectorXd result(shapes.cols());
  const auto blocks = static_cast<std::size_t>((shapes.cols() + kAtOnce - 1) / kAtOnce);
  parallel_ranges(blocks, [&](std::size_t begin, std::size_t end) {
    Rows rows(shapes.rows(), kAtOnce);
    for (auto block = begin; block < end; ++block) {
      throw_if_interrupted();
      const auto first = static_cast<Eigen::Index>(block) * kAtOnce;
      const auto count = std::min(kAtOnce, shapes.cols() - first);
      rows.setZero();
      rows.leftCols(count) = without(system, known, shapes.middleCols(first, count)).cwiseAbs();
      const Eight energy = absolute_energy(system.stiffness, rows);
      result.segment(first, count) = 2.2e-16 * energy.head(count).matrix().transpose();
    }
  });
  return result;
}

std::string precision_advice(const System& system, double lambda) {
  if (!(lambda > 0.0)) return "";
  double stiffest = 0.0;
  for (Eigen::Index i = 0; i < system.mass.rows(); ++i) {
    stiffest = std::max(stiffest, system.stiffness.coeff(i, i) / system.mass.coeff(i, i));
  }
  constexpr double kDigits = 1e12;  // up to this ratio a count or a solve can be trusted
  if (!(stiffest > kDigits * lambda)) return "";
  return fmt::format(
      "the mesh's stiffest motion has {:.0e} times this eigenvalue, and of that double precision "
      "keeps 16 digits: for a plate it is about (length / thickness)^4, so make the body thicker "
      "or smaller; cells finer than the thickness make it worse (mesh.edge_length)",
      stiffest / lambda);
}

void require_energy(const System& system, const Eigen::VectorXd& lambda, const Matrix& shapes) {
  if (lambda.size() == 0) return;
  const auto rounding = energy_rounding(system, system.suspended, shapes);
  for (Eigen::Index i = 0; i < lambda.size(); ++i) {
    if (lambda(i) > 2.0 * rounding(i)) continue;
    constexpr double kBeyond = 10.0;
    const auto where = largest_motion(system, shapes.col(i));
    if (!(lambda(i) >= -kBeyond * rounding(i))) {
      throw NumericalFailure(fmt::format(
          "modes: the stiffness matrix is not positive semidefinite: a motion that is largest at "
          "{} has the eigenvalue {:.4g} s^-2, expected 0 or more (rounding leaves {:.2g})",
          where, lambda(i), rounding(i)));
    }
    const auto why =
        precision_advice(system, std::pow(2.0 * std::numbers::pi * system.frequency_scale_hz, 2));
    if (!why.empty()) {
      throw NumericalFailure(fmt::format(
          "modes: a motion that is largest at {} cannot be told from one that costs no energy "
          "({:.2g} s^-2, of which rounding is {:.2g}): {}",
          where, lambda(i), rounding(i), why));
    }
    throw NumericalFailure(fmt::format(
        "modes: beside the {} rigid-body motions there is one that costs no energy (0 Hz; {:.2g} "
        "s^-2, of which rounding is {:.2g}), largest at {}: is the body in one piece, are its "
        "parts "
        "joined by more than an edge or a node?",
        system.rigid.cols(), lambda(i), rounding(i), where));
  }
}

std::vector<std::string> judged(const System& system, const Eigen::VectorXd& lambda,
                                const Eigen::VectorXd& residual) {
  double worst = 0.0;
  std::string named;
  Eigen::Index count = 0;
  const auto judge = [&](double found, const std::string& name) {
    if (!(found < kNotTrusted)) {
      throw NumericalFailure(fmt::format("modes: {} solves its equation only to {:.3g}; {}", name,
                                         found, advice(system, lambda(0))));
    }
    if (found <= kWorthAWarning) return;
    ++count;
    if (found > worst) named = name;
    worst = std::max(worst, found);
  };
  if (system.rigid.cols() > 0 && lambda.size() > 0) {
    const auto strain = strains(system, lambda(0));
    for (Eigen::Index i = 0; i < strain.size(); ++i) {
      judge(strain(i), fmt::format("rigid-body motion {}", i + 1));
    }
  }
  for (Eigen::Index i = 0; i < lambda.size(); ++i) {
    judge(residual(i), fmt::format("the mode at {:.6g} Hz", hertz(lambda(i))));
  }
  if (count == 0) return {};
  return {fmt::format(
      "modes: {} of {} modes solve their equation to more than {:.0e} (worst: {}, {:.2g} of its "
      "eigenvalue): {}",
      count, system.rigid.cols() + lambda.size(), kWorthAWarning, named, worst,
      advice(system, lambda(0)))};
}

}  // namespace chladni::fem
