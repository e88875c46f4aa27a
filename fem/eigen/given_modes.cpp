#include "fem/given_modes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/turn.h"
#include "fem/eigen/found_modes.h"
#include "fem/eigen/mode_checks.h"
#include "fem/eigen/residual.h"
#include "fem/eigen/symmetric_product.h"

namespace chladni::fem {
namespace {

using Matrix = Eigen::MatrixXd;

constexpr double kOrthonormal = 1e-6;  // |ΦᵀMΦ − I| of a sound solver is below 1e-10
constexpr double kRigidShare = 1e-4;   // norm of a flexible mode's part along the rigid motions
constexpr double kSameEnergy = 1e-5;   // a given λ against φᵀKφ, relative
// A correction solves its equation to this part of the largest entry of K times the shape: rounding
// of a product with K leaves 1e-15 of it.
constexpr double kRoundingOfProduct = 3e-14;
constexpr double kSolved = 1e-4;  // and to this part of its right-hand side

void require_sizes(const System& system, const GivenModes& given) {
  const auto n = system.mass.rows();
  const auto m = given.lambda.size();
  require(
      given.shapes.rows() == n && given.shapes.cols() == m && given.corrections.rows() == n &&
          given.corrections.cols() == m,
      fmt::format("{} modes of {}x{} and {}x{} numbers, expected {} rows", m, given.shapes.rows(),
                  given.shapes.cols(), given.corrections.rows(), given.corrections.cols(), n));
  require(
      m > system.rigid.cols(),
      fmt::format("{} modes, of which {} are motions of the whole body", m, system.rigid.cols()));
  require(given.lambda.allFinite() && given.shapes.allFinite() && given.corrections.allFinite(),
          "numbers that are not finite");
  require(std::is_sorted(given.lambda.begin(), given.lambda.end()), "eigenvalues out of order");
  require(
      given.shift > 0.0 && given.bound > given.lambda.tail<1>()(0) && std::isfinite(given.bound),
      fmt::format("the highest eigenvalue is {} and the bound {}", given.lambda.tail<1>()(0),
                  given.bound));
}

void require_orthonormal(const System& system, const Matrix& shapes) {
  const Matrix gram = shapes.transpose() * (SymmetricProduct(system.mass) * shapes);
  const double off = (gram - Matrix::Identity(gram.rows(), gram.cols())).cwiseAbs().maxCoeff();
  require(off < kOrthonormal,
          fmt::format("shapes that are not orthonormal: max |ΦᵀMΦ − I| = {:.2g}", off));
}

// Φ and its corrections without the rigid-body modes and without what is left along them.
struct Flexible {
  Eigen::VectorXd lambda;
  Matrix shapes, corrections;
};

Flexible flexible_part(const System& system, const GivenModes& given) {
  const Matrix rigid = rigid_motions(system);
  const auto r = rigid.cols();
  const auto m = given.lambda.size() - r;
  const Matrix inertia = SymmetricProduct(system.mass) * rigid;
  Flexible part{given.lambda.tail(m), given.shapes.rightCols(m), given.corrections.rightCols(m)};
  const Matrix along = inertia.transpose() * part.shapes;
  require(r == 0 || along.cwiseAbs().maxCoeff() < kRigidShare,
          fmt::format("the first {} modes are not the motions of the whole body", r));
  part.shapes -= rigid * along;
  part.corrections -= rigid * (inertia.transpose() * part.corrections);
  return part;
}

// The largest diagonal entry of K, a lower bound of its norm.
double stiffest(const System& system) {
  double largest = 0.0;
  for (Eigen::Index i = 0; i < system.stiffness.cols(); ++i) {
    largest = std::max(largest, system.stiffness.coeff(i, i));
  }
  return largest;
}

// Refuses corrections that do not solve (K + sM) x = Kφ − λMφ, and eigenvalues that are not the
// energies of their shapes.
void require_equations(const System& system, const Flexible& part, double s,
                       const Matrix& stiffness_product) {
  SymmetricProduct mass(system.mass);
  const Matrix inertia = mass * part.shapes;
  const Matrix right = stiffness_product - inertia * part.lambda.asDiagonal();
  Matrix left = SymmetricProduct(system.stiffness) * part.corrections;
  left += s * (mass * part.corrections);
  const double norm = stiffest(system);
  for (Eigen::Index i = 0; i < part.lambda.size(); ++i) {
    const double energy = part.shapes.col(i).dot(stiffness_product.col(i));
    const double rounding = kRoundingOfProduct * norm * part.shapes.col(i).norm();
    require(std::abs(energy - part.lambda(i)) <=
                kSameEnergy * part.lambda(i) + rounding * part.shapes.col(i).norm(),
            fmt::format("the eigenvalue {:.9g} s^-2 of a shape with the energy {:.9g} s^-2",
                        part.lambda(i), energy));
    const double off = (left.col(i) - right.col(i)).norm();
    require(
        off <= rounding + kSolved * right.col(i).norm(),
        fmt::format("the correction of the mode at {:.6g} Hz does not solve its equation: {:.2g} "
                    "of {:.2g} N are left",
                    std::sqrt(std::max(part.lambda(i), 0.0)) / kTwoPi, off, right.col(i).norm()));
  }
}

// Rayleigh-Ritz, then one step of inverse iteration and Rayleigh-Ritz again. The residual is that
// of the first: with A = (K + sM)⁻¹M the corrections give AΦ = (Φ − X)(Λ + s)⁻¹, and so those of ΦT
// without another solve.
Found refined(const System& system, Flexible part, double s, Matrix product) {
  const Eigen::VectorXd shifted = part.lambda.array() + s;
  Matrix inverse = (part.shapes - part.corrections) * shifted.cwiseInverse().asDiagonal();
  Found found{part.lambda, {}, std::move(part.shapes)};
  inverse = (inverse * ritz(system, found.lambda, found.shapes, product)).eval();
  const Matrix correction =
      found.shapes - inverse * (found.lambda.array() + s).matrix().asDiagonal();
  const Matrix inertia = SymmetricProduct(system.mass) * correction;
  const Eigen::ArrayXd norm =
      correction.cwiseProduct(inertia).colwise().sum().transpose().cwiseMax(0.0).cwiseSqrt();
  found.residual = (norm * (found.lambda.array() + s) / found.lambda.array()).abs();
  found.shapes -= correction;
  product = stiffness_times(system, found.shapes);
  static_cast<void>(ritz(system, found.lambda, found.shapes, product));
  return found;
}

void take_count(const System& system, const GivenModes& given, const Found& found,
                ModesSummary& summary) {
  summary.counted_below_hz = std::sqrt(given.bound) / kTwoPi;
  summary.counted = static_cast<int>(given.counted);
  summary.found =
      static_cast<int>(system.rigid.cols() + (found.lambda.array() < given.bound).count());
  summary.complete = summary.counted == summary.found;
  if (!summary.complete) {
    throw NumericalFailure(fmt::format("modes: below {:.2f} Hz {} modes were counted but {} found",
                                       summary.counted_below_hz, summary.counted, summary.found));
  }
  summary.text = fmt::format("modes below {:.2f} Hz: {} found, {} counted",
                             summary.counted_below_hz, summary.found, summary.counted);
}

}  // namespace

ModesResult checked_modes(const System& system, const GivenModes& given,
                          const ModesOptions& options) {
  require_sizes(system, given);
  require_orthonormal(system, given.shapes);
  Flexible part = flexible_part(system, given);
  Matrix product = stiffness_times(system, part.shapes);
  require_equations(system, part, given.shift, product);
  Found found = refined(system, std::move(part), given.shift, std::move(product));
  require_energy(system, found.lambda, found.shapes);
  settle(system, found);
  ModesSummary summary;
  take_count(system, given, found, summary);
  if (found.lambda.size() < options.count) {
    throw NumericalFailure(fmt::format("modes: {} flexible modes were asked for and {} found",
                                       options.count, found.lambda.size()));
  }
  const auto kept = uncut(found.lambda, options.count);
  return assembled(system, found, kept, std::move(summary));
}

}  // namespace chladni::fem
