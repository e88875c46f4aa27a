#include "identification/damping_coupling.h"
#include "base/turn.h"

#include <Eigen/Cholesky>
#include <cmath>

#include "base/error.h"
#include "identification/constants.h"

namespace chladni::identification {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// The mode of the simulation that is nearest to a frequency.
Index nearest(const VectorXd& frequency_hz, double hz) {
  Index own = 0;
  (frequency_hz.array() - hz).abs().minCoeff(&own);
  return own;
}

// Standard deviations of the parts of the simulation's modes that coupling adds to mode m. For the
// mode's own twin it is the damping ratio, the uncertainty of the phase.
VectorXd spread(const ModalFit& fit, Index m, const VectorXd& frequency_hz) {
  const Index rigid = fit.model.rigid_count;
  const double mean = fit.model.damping_ratio.tail(fit.model.mode_count() - rigid).mean();
  const double own = kTwoPi * fit.model.frequency_hz(m);
  const double ratio = fit.model.damping_ratio(m);
  const Index twin = nearest(frequency_hz, fit.model.frequency_hz(m));
  VectorXd result(frequency_hz.size());
  for (Index k = 0; k < result.size(); ++k) {
    const double other = kTwoPi * frequency_hz(k);
    const double bound = 2.0 * std::sqrt(ratio * own * mean * other);
    const double apart = std::abs(other * other - own * own);
    result(k) = k == twin ? ratio : std::min(1.0, own * bound / std::sqrt(3.0) / apart);
  }
  return result;
}

// Scale of the fit's shapes relative to the simulation's.
double scale(const ModalFit& fit, const GainMatch& match, const CouplingBasis& basis) {
  double there = 0.0;
  double own = 0.0;
  for (Index m = fit.model.rigid_count; m < fit.model.mode_count(); ++m) {
    there += match.shapes.col(m).squaredNorm();
    own += basis.at_rows.col(nearest(basis.frequency_hz, fit.model.frequency_hz(m))).squaredNorm();
  }
  return own > 0.0 ? std::sqrt(there / own) : 1.0;
}

}  // namespace

ImaginaryParts imaginary_parts(const ModalFit& fit, const GainMatch& match,
                               const CouplingBasis& basis) {
  const Index n = match.imaginary.rows();
  const Index k = basis.at_places.rows();
  const Index r = basis.frequency_hz.size();
  require(fit.complex && match.imaginary.cols() == fit.model.mode_count() && n > 0,
          "imaginary parts: the fit has real shapes; expected those of general damping");
  require(basis.at_rows.rows() == n && basis.at_rows.cols() == r && basis.at_places.cols() == r,
          "imaginary parts: shapes of the simulation at other rows than the match has");
  const double unit = scale(fit, match, basis);
  ImaginaryParts result{MatrixXd::Zero(k, fit.model.mode_count()), {}};
  result.deviation = result.mean;
  for (Index m = fit.model.rigid_count; m < fit.model.mode_count(); ++m) {
    const VectorXd deviation = unit * spread(fit, m, basis.frequency_hz);
    const MatrixXd rows = basis.at_rows * deviation.asDiagonal();
    const MatrixXd places = basis.at_places * deviation.asDiagonal();
    const VectorXd seen = match.imaginary.col(m);
    const double slack =
        Constants::imaginary_slack * seen.norm() / std::sqrt(static_cast<double>(n));
    MatrixXd covariance = rows * rows.transpose();
    covariance.diagonal() += match.imaginary_deviation.col(m).cwiseAbs2();
    covariance.diagonal().array() += slack * slack + 1e-12 * covariance.trace();
    const Eigen::LDLT<MatrixXd> factor(covariance);
    const MatrixXd across = rows * places.transpose();
    result.mean.col(m) = across.transpose() * factor.solve(seen);
    const VectorXd known = across.cwiseProduct(factor.solve(across)).colwise().sum();
    result.deviation.col(m) = (places.rowwise().squaredNorm() - known).cwiseMax(0.0).cwiseSqrt();
  }
  return result;
}

}  // namespace chladni::identification
