#include "simulators/frf_bounds.h"

#include <Eigen/Dense>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "base/error.h"

namespace chladni::simulators {

namespace {

using std::numbers::pi;

// The order of the parameters: ω, ζ, L, R per flexible mode; rigid L by columns, rigid R by
// columns; residual by columns; delay.
struct Places {
  Eigen::Index p = 0, q = 0, flexible = 0, rigid = 0;
  FrfNuisance nuisance;

  [[nodiscard]] Eigen::Index mode(Eigen::Index m) const { return m * (2 + p + q); }
  [[nodiscard]] Eigen::Index rigid_outputs() const { return mode(flexible); }
  [[nodiscard]] Eigen::Index rigid_inputs() const { return rigid_outputs() + p * rigid; }
  [[nodiscard]] Eigen::Index residual() const { return rigid_inputs() + rigid * q; }
  [[nodiscard]] Eigen::Index delay() const { return residual() + (nuisance.residual ? p * q : 0); }
  [[nodiscard]] Eigen::Index count() const {
    return delay() + (nuisance.output_delays ? p : nuisance.delay ? 1 : 0);
  }
};

// The modes with the gains included, scaled so that |L_m| = |R_m|.
struct Balanced {
  Eigen::VectorXd omega, damping;
  Eigen::MatrixXd outputs, inputs, rigid_outputs, rigid_inputs;
  Eigen::VectorXd ratio;  // |L_m| / |R_m|
};

Balanced balanced(const FrfCase& record) {
  const auto& truth = record.truth;
  const auto r = truth.rigid_count;
  const auto n = truth.mode_count() - r;
  Eigen::MatrixXd outputs = truth.output_shapes;
  Eigen::MatrixXd inputs = truth.input_shapes;
  if (record.faults.output_gain.size() > 0) {
    outputs = record.faults.output_gain.asDiagonal() * outputs;
  }
  if (record.faults.input_gain.size() > 0) inputs = inputs * record.faults.input_gain.asDiagonal();
  Balanced modes{2.0 * pi * truth.frequency_hz.tail(n),
                 truth.damping_ratio.tail(n),
                 outputs.rightCols(n),
                 inputs.bottomRows(n),
                 outputs.leftCols(r),
                 inputs.topRows(r),
                 Eigen::VectorXd(n)};
  for (Eigen::Index m = 0; m < n; ++m) {
    modes.ratio(m) = modes.outputs.col(m).norm() / modes.inputs.row(m).norm();
    modes.outputs.col(m) /= std::sqrt(modes.ratio(m));
    modes.inputs.row(m) *= std::sqrt(modes.ratio(m));
  }
  return modes;
}

// Derivatives of one response with respect to the parameters that it depends on.
struct Slopes {
  std::vector<Eigen::Index> place;
  Eigen::MatrixXcd value;  // k×places
};

// jω of all lines.
Eigen::ArrayXcd laplace(const FrfCase& record) {
  Eigen::ArrayXcd s = Eigen::ArrayXcd::Zero(record.measured.line_count());
  s.imag() = 2.0 * pi * record.measured.frequency_hz.array();
  return s;
}

double delay_of(const FrfCase& record, Eigen::Index i) {
  const auto& own = record.faults.output_delay_s;
  return record.faults.delay_s + (own.size() > 0 ? own(i) : 0.0);
}

Slopes slopes(const FrfCase& record, const Balanced& modes, const Places& places, Eigen::Index i,
              Eigen::Index j) {
  const Eigen::ArrayXcd s = laplace(record);
  const Eigen::ArrayXcd turn = (-s * delay_of(record, i)).exp();
  Slopes all;
  all.value.resize(s.size(), 4 * places.flexible + 2 * places.rigid + 2);
  const auto add = [&](Eigen::Index place, const Eigen::ArrayXcd& value) {
    all.value.col(std::ssize(all.place)) = value;
    all.place.push_back(place);
  };
  for (Eigen::Index m = 0; m < places.flexible; ++m) {
    const double w = modes.omega(m);
    const double z = modes.damping(m);
    const Eigen::ArrayXcd h = (s * s + 2.0 * z * w * s + w * w).inverse();
    const double l = modes.outputs(i, m);
    const double r = modes.inputs(m, j);
    add(places.mode(m), -l * r * turn * h * h * (2.0 * z * s + 2.0 * w));
    add(places.mode(m) + 1, -l * r * turn * h * h * (2.0 * w * s));
    add(places.mode(m) + 2 + i, r * turn * h);
    add(places.mode(m) + 2 + places.p + j, l * turn * h);
  }
  for (Eigen::Index m = 0; m < places.rigid; ++m) {
    const Eigen::ArrayXcd h = turn * (s * s).inverse();
    add(places.rigid_outputs() + m * places.p + i, modes.rigid_inputs(m, j) * h);
    add(places.rigid_inputs() + m + places.rigid * j, modes.rigid_outputs(i, m) * h);
  }
  if (places.nuisance.residual) add(places.residual() + i + places.p * j, turn);
  if (places.nuisance.delay || places.nuisance.output_delays) {
    Eigen::ArrayXcd exact(s.size());
    for (std::size_t k = 0; k < record.exact.size(); ++k) {
      exact(static_cast<Eigen::Index>(k)) = record.exact[k](i, j);
    }
    add(places.delay() + (places.nuisance.output_delays ? i : 0), -s * exact);
  }
  all.value.conservativeResize(Eigen::NoChange, std::ssize(all.place));
  return all;
}

Eigen::MatrixXd information(const FrfCase& record, const Balanced& modes, const Places& places) {
  Eigen::MatrixXd fisher = Eigen::MatrixXd::Zero(places.count(), places.count());
  for (Eigen::Index i = 0; i < places.p; ++i) {
    for (Eigen::Index j = 0; j < places.q; ++j) {
      auto response = slopes(record, modes, places, i, j);
      for (Eigen::Index k = 0; k < response.value.rows(); ++k) {
        const auto line = static_cast<std::size_t>(k);
        const double measured = std::abs(record.measured.value[line](i, j));
        const double sigma = std::sqrt(record.measured.variance[line](i, j));
        response.value.row(k) *= std::isfinite(measured) ? std::sqrt(2.0) / sigma : 0.0;
      }
      Eigen::MatrixXd stacked(2 * response.value.rows(), response.value.cols());
      stacked << response.value.real(), response.value.imag();
      const Eigen::MatrixXd gram = stacked.transpose() * stacked;
      fisher(response.place, response.place) += gram;
    }
  }
  return fisher;
}

// Orthonormal columns that span the parameter changes with an effect on the responses.
Eigen::MatrixXd effective(const Eigen::MatrixXd& change) {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(change, Eigen::ComputeThinV);
  const double most = svd.singularValues()(0);
  const auto rank = (svd.singularValues().array() > 1e-10 * most).count();
  return svd.matrixV().leftCols(rank);
}

// The derivative of vec(L R) with respect to (vec L, vec R).
Eigen::MatrixXd product_change(const Eigen::MatrixXd& outputs, const Eigen::MatrixXd& inputs) {
  const auto p = outputs.rows();
  const auto r = outputs.cols();
  const auto q = inputs.cols();
  Eigen::MatrixXd change = Eigen::MatrixXd::Zero(p * q, r * (p + q));
  for (Eigen::Index j = 0; j < q; ++j) {
    for (Eigen::Index m = 0; m < r; ++m) {
      change.block(j * p, m * p, p, p).diagonal().setConstant(inputs(m, j));
      change.block(j * p, r * p + j * r + m, p, 1) = outputs.col(m);
    }
  }
  return change;
}

// The matrix that gives all parameters from the free ones.
Eigen::MatrixXd free_directions(const Balanced& modes, const Places& places) {
  Eigen::MatrixXd basis = Eigen::MatrixXd::Zero(places.count(), places.count());
  Eigen::Index column = 0;
  const auto add = [&](Eigen::Index row, const Eigen::MatrixXd& block) {
    basis.block(row, column, block.rows(), block.cols()) = block;
    column += block.cols();
  };
  for (Eigen::Index m = 0; m < places.flexible; ++m) {
    add(places.mode(m), Eigen::MatrixXd::Identity(2, 2));
    add(places.mode(m) + 2, effective(product_change(modes.outputs.col(m), modes.inputs.row(m))));
  }
  if (places.rigid > 0) {
    add(places.rigid_outputs(), effective(product_change(modes.rigid_outputs, modes.rigid_inputs)));
  }
  const auto rest = places.count() - places.residual();
  add(places.residual(), Eigen::MatrixXd::Identity(rest, rest));
  return basis.leftCols(column);
}

Eigen::MatrixXd inverse(const Eigen::MatrixXd& information) {
  const Eigen::VectorXd scale = information.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * information * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(scaled);
  if (!(solver.eigenvalues()(0) > 1e-13)) {
    throw NumericalFailure("cramer_rao: the record does not tell all parameters");
  }
  return scale.asDiagonal() * solver.eigenvectors() *
         solver.eigenvalues().cwiseInverse().asDiagonal() * solver.eigenvectors().transpose() *
         scale.asDiagonal();
}

// The places of (ω, ζ, L, R) of a mode. Rigid-body modes come first and have no ω and ζ.
std::vector<Eigen::Index> places_of_mode(const Places& places, Eigen::Index mode) {
  std::vector<Eigen::Index> where;
  if (mode >= places.rigid) {
    for (Eigen::Index i = 0; i < 2 + places.p + places.q; ++i) {
      where.push_back(places.mode(mode - places.rigid) + i);
    }
    return where;
  }
  for (Eigen::Index i = 0; i < places.p; ++i) {
    where.push_back(places.rigid_outputs() + mode * places.p + i);
  }
  for (Eigen::Index j = 0; j < places.q; ++j) {
    where.push_back(places.rigid_inputs() + mode + places.rigid * j);
  }
  return where;
}

void take_mode(FrfBounds& bounds, const Eigen::MatrixXd& covariance, const Balanced& modes,
               const Places& places, Eigen::Index mode) {
  const auto where = places_of_mode(places, mode);
  const auto size = std::ssize(where);
  const double ratio = mode < places.rigid ? 1.0 : modes.ratio(mode - places.rigid);
  Eigen::VectorXd scale = Eigen::VectorXd::Ones(2 + places.p + places.q);
  scale.segment(2, places.p).setConstant(std::sqrt(ratio));
  scale.tail(places.q).setConstant(1.0 / std::sqrt(ratio));
  Eigen::MatrixXd own = Eigen::MatrixXd::Zero(scale.size(), scale.size());
  own.bottomRightCorner(size, size) = covariance(where, where);
  own = scale.asDiagonal() * own * scale.asDiagonal();
  const Eigen::VectorXd deviation = own.diagonal().cwiseMax(0.0).cwiseSqrt();
  bounds.frequency_hz(mode) = deviation(0) / (2.0 * pi);
  bounds.damping(mode) = deviation(1);
  bounds.outputs.col(mode) = deviation.segment(2, places.p);
  bounds.inputs.row(mode) = deviation.tail(places.q).transpose();
  bounds.covariance.push_back(own);
}

}  // namespace

FrfBounds cramer_rao(const FrfCase& record, const FrfNuisance& nuisance) {
  const auto& truth = record.truth;
  require(truth.damper_count() == 0, "cramer_rao: the truth has dampers in places");
  const auto r = truth.rigid_count;
  const Places places{truth.output_count(), truth.input_count(), truth.mode_count() - r, r,
                      nuisance};
  const auto modes = balanced(record);
  const Eigen::MatrixXd basis = free_directions(modes, places);
  const Eigen::MatrixXd fisher = information(record, modes, places);
  const Eigen::MatrixXd covariance =
      basis * inverse(basis.transpose() * fisher * basis) * basis.transpose();
  FrfBounds bounds;
  bounds.parameters = basis.cols();
  bounds.frequency_hz = bounds.damping = Eigen::VectorXd::Zero(truth.mode_count());
  bounds.outputs = Eigen::MatrixXd::Zero(places.p, truth.mode_count());
  bounds.inputs = Eigen::MatrixXd::Zero(truth.mode_count(), places.q);
  for (Eigen::Index m = 0; m < truth.mode_count(); ++m) {
    take_mode(bounds, covariance, modes, places, m);
  }
  if (r > 0) {
    const Eigen::MatrixXd change = product_change(modes.rigid_outputs, modes.rigid_inputs);
    const auto size = change.cols();
    bounds.rigid_covariance =
        covariance.block(places.rigid_outputs(), places.rigid_outputs(), size, size);
    const Eigen::VectorXd spread = (change * bounds.rigid_covariance)
                                       .cwiseProduct(change)
                                       .rowwise()
                                       .sum()
                                       .cwiseMax(0.0)
                                       .cwiseSqrt();
    bounds.rigid = spread.reshaped(places.p, places.q);
  }
  if (nuisance.output_delays) {
    bounds.output_delay_s = covariance.diagonal().tail(places.p).cwiseSqrt();
  } else if (nuisance.delay) {
    bounds.delay_s = std::sqrt(covariance(places.delay(), places.delay()));
  }
  return bounds;
}

}  // namespace chladni::simulators
