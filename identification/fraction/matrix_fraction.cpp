#include "identification/matrix_fraction.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <string>

#include "base/error.h"
#include "base/finite.h"
#include "identification/constants.h"
#include "identification/fraction/filled.h"
#include "identification/fraction/fraction_equations.h"
#include "identification/fraction/unrest.h"
#include "identification/poles/completion.h"
#include "identification/poles/residue_problem.h"

namespace chladni::identification {

namespace {

using std::numbers::pi;

Eigen::VectorXd in_units(const Eigen::VectorXd& frequency_hz, double scale) {
  return 2.0 * pi / scale * frequency_hz;
}

// Values of a fraction on the lines of the data.
struct OnLines {
  std::vector<Eigen::MatrixXcd> inverse;  // D⁻¹
  Eigen::MatrixXcd value;                 // K×pq
};

OnLines on_lines(const MatrixFraction& fraction, const Eigen::VectorXd& x) {
  const Eigen::MatrixXcd d_basis = values(fraction.denominator_basis, x);
  const Eigen::MatrixXcd n_basis = values(fraction.numerator_basis, x);
  const auto p = fraction.numerator.front().rows();
  const auto q = fraction.numerator.front().cols();
  OnLines lines{{}, Eigen::MatrixXcd(x.size(), p * q)};
  for (Eigen::Index k = 0; k < x.size(); ++k) {
    Eigen::MatrixXcd denominator = Eigen::MatrixXcd::Identity(p, p);
    denominator *= d_basis(k, d_basis.cols() - 1);
    Eigen::MatrixXcd numerator = Eigen::MatrixXcd::Zero(p, q);
    for (std::size_t a = 0; a < fraction.denominator.size(); ++a) {
      denominator += d_basis(k, static_cast<Eigen::Index>(a)) * fraction.denominator[a];
    }
    for (std::size_t a = 0; a < fraction.numerator.size(); ++a) {
      numerator += n_basis(k, static_cast<Eigen::Index>(a)) * fraction.numerator[a];
    }
    lines.inverse.emplace_back(denominator.inverse());
    lines.value.row(k) = (lines.inverse.back() * numerator).reshaped().transpose();
  }
  return lines;
}

double output_error(const FitData& data, const Eigen::MatrixXcd& value) {
  return ((data.value - value).array() * data.weight.array()).abs2().sum();
}

// Chooses bases that give the columns of the equations similar size. The weight of φ contains |G|.
void lay_bases(MatrixFraction& fraction, const FitData& data,
               const std::vector<Eigen::MatrixXcd>& divided, const MatrixFractionOptions& options) {
  const auto p = data.outputs;
  Eigen::VectorXd plain(data.line_count());
  Eigen::VectorXd sized(data.line_count());
  for (Eigen::Index k = 0; k < data.line_count(); ++k) {
    const Eigen::MatrixXd size = divided[static_cast<std::size_t>(k)].cwiseAbs2();
    const Eigen::MatrixXd weight = data.weight.row(k).reshaped(p, data.inputs).cwiseAbs2();
    const Eigen::RowVectorXd of_input = size.rowwise().sum().transpose() * weight;
    const Eigen::MatrixXd value = data.value.row(k).reshaped(p, data.inputs).cwiseAbs2();
    plain(k) = std::sqrt(of_input.sum());
    sized(k) = std::sqrt(of_input.dot(value.colwise().sum()));
  }
  const auto x = in_units(data.frequency_hz, fraction.scale);
  fraction.denominator_basis = orthonormal_basis(x, sized, options.degree);
  fraction.numerator_basis = orthonormal_basis(x, plain, options.numerator_degree);
}

void set_coefficients(MatrixFraction& fraction, const FractionEquations& equations,
                      const Eigen::VectorXd& coefficients) {
  fraction.denominator.clear();
  fraction.numerator.clear();
  for (Eigen::Index a = 0; a < fraction.denominator_basis.degree(); ++a) {
    fraction.denominator.push_back(equations.denominator(coefficients, a));
  }
  for (Eigen::Index a = 0; a <= fraction.numerator_basis.degree(); ++a) {
    fraction.numerator.push_back(equations.numerator(coefficients, a));
  }
}

// Scales all D⁻¹ to a mean square of 1. In its new basis D has the inverse size of the last D⁻¹,
// which would otherwise grow with each iteration.
void normalise(std::vector<Eigen::MatrixXcd>& divided) {
  double square = 0.0;
  for (const auto& one : divided) square += one.squaredNorm();
  const double factor = std::sqrt(static_cast<double>(divided.size()) / square);
  for (auto& one : divided) one *= factor;
}

// The least error, or what noise or rounding leaves if that is more.
double least_error(double least, const FitData& data) {
  constexpr double kRounding = 1e-12;  // of the squares: that is no error
  const double total =
      output_error(data, Eigen::MatrixXcd::Zero(data.value.rows(), data.value.cols()));
  const bool known = data.noise_known && data.weights_are_deviations;
  const double noise = known ? expected_cost(data, 0).mean : 0.0;
  return std::max({least, noise, kRounding * total});
}

// Returns the iterate of lowest output error; its `costs` are those of all iterates.
MatrixFraction by_sanathanan_koerner(const FitData& data, const MatrixFractionOptions& options) {
  MatrixFraction now;
  now.scale = 2.0 * pi * data.frequency_hz.maxCoeff();
  const auto x = in_units(data.frequency_hz, now.scale);
  std::vector<Eigen::MatrixXcd> divided(static_cast<std::size_t>(data.line_count()),
                                        Eigen::MatrixXcd::Identity(data.outputs, data.outputs));
  MatrixFraction best;
  best.cost = std::numeric_limits<double>::infinity();
  std::vector<double> costs;
  // An equation holds all outputs of one input: a zero would count as a response.
  const Eigen::MatrixXcd known = filled(data, options.progress);
  for (int iteration = 0; iteration < options.sanathanan_koerner; ++iteration) {
    tell(options.progress, "Sanathanan-Koerner",
         static_cast<double>(iteration) / options.sanathanan_koerner);
    lay_bases(now, data, divided, options);
    const Eigen::MatrixXcd d_basis = values(now.denominator_basis, x);
    const Eigen::MatrixXcd n_basis = values(now.numerator_basis, x);
    const FractionEquations equations(data, divided, known, d_basis, n_basis);
    Eigen::VectorXd coefficients = Eigen::VectorXd::Zero(equations.count());
    for (int pass = 0; pass < 2; ++pass) {  // the second pass removes rounding errors of squaring
      coefficients += equations.step(equations.gradient(equations.errors(coefficients, true)), 0.0);
    }
    set_coefficients(now, equations, coefficients);
    auto lines = on_lines(now, x);
    now.cost = output_error(data, lines.value);
    costs.push_back(now.cost);
    if (!std::isfinite(now.cost)) break;
    if (now.cost < best.cost) best = now;
    divided = std::move(lines.inverse);
    normalise(divided);
  }
  best.unrest = unrest_of(costs, least_error(best.cost, data));
  best.costs = std::move(costs);
  return best;
}

// One step that lowers the output error; adapts the damping. False if no step lowers it.
bool levenberg_step(MatrixFraction& fraction, const FitData& data, double& damping) {
  const auto x = in_units(data.frequency_hz, fraction.scale);
  const Eigen::MatrixXcd d_basis = values(fraction.denominator_basis, x);
  const Eigen::MatrixXcd n_basis = values(fraction.numerator_basis, x);
  const auto lines = on_lines(fraction, x);
  const FractionEquations equations(data, lines.inverse, lines.value, d_basis, n_basis);
  const Eigen::MatrixXcd errors =
      (data.value - lines.value).cwiseProduct(data.weight.cast<std::complex<double>>());
  const Eigen::VectorXd gradient = equations.gradient(errors);
  for (int attempt = 0; attempt < 12; ++attempt) {
    const Eigen::VectorXd step = equations.step(gradient, damping);
    auto moved = fraction;
    for (std::size_t a = 0; a < moved.denominator.size(); ++a) {
      moved.denominator[a] += equations.denominator(step, static_cast<Eigen::Index>(a));
    }
    for (std::size_t a = 0; a < moved.numerator.size(); ++a) {
      moved.numerator[a] += equations.numerator(step, static_cast<Eigen::Index>(a));
    }
    moved.cost = output_error(data, on_lines(moved, x).value);
    if (moved.cost < fraction.cost) {
      damping /= 10.0;
      fraction = std::move(moved);
      return true;
    }
    damping *= 8.0;
  }
  return false;
}

void check(const FitData& data, const MatrixFractionOptions& options) {
  require(options.degree >= 1 && options.numerator_degree >= 0,
          "matrix fraction: degrees of " + fmt::to_string(options.degree) + " and " +
              fmt::to_string(options.numerator_degree) + "; expected 1 and 0 or more");
  const auto of_d = data.outputs * data.outputs * options.degree;
  require(of_d <= Constants::most_denominator,
          "matrix fraction: a denominator of " + fmt::to_string(of_d) + " coefficients; at most " +
              fmt::to_string(Constants::most_denominator) + " are fitted");
  const auto unknowns = of_d + data.response_count() * (options.numerator_degree + 1);
  require(data.measured_count() > unknowns,
          "matrix fraction: " + fmt::to_string(data.measured_count()) + " measured numbers for " +
              fmt::to_string(unknowns) + " coefficients");
  require(data.line_count() > std::max(options.degree, options.numerator_degree),
          "matrix fraction: " + fmt::to_string(data.line_count()) + " lines for polynomials of " +
              fmt::to_string(std::max(options.degree, options.numerator_degree) + 1) +
              " coefficients");
}

// The oscillating poles, turned into the left half plane, without those of the modes at 0 Hz.
Eigen::VectorXcd resonances(const MatrixFraction& fraction, Eigen::Index rigid_count) {
  Eigen::VectorXcd all = poles(fraction);
  std::ranges::sort(all, {}, [](const std::complex<double>& pole) { return std::abs(pole); });
  std::vector<std::complex<double>> kept;
  for (Eigen::Index i = 2 * rigid_count; i < all.size(); ++i) {
    const auto pole = all(i);
    if (pole.imag() <= 1e-9 * std::abs(pole)) continue;
    kept.emplace_back(std::min(-std::abs(pole.real()), -1e-9 * std::abs(pole)), pole.imag());
  }
  return Eigen::Map<Eigen::VectorXcd>(kept.data(), std::ssize(kept));
}

// The n poles of highest significance, in order of frequency.
std::vector<Eigen::Index> worthiest(const Eigen::VectorXd& significance, Eigen::Index n) {
  std::vector<Eigen::Index> order(static_cast<std::size_t>(significance.size()));
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::ranges::stable_sort(order, std::ranges::greater{},
                           [&](Eigen::Index i) { return significance(i); });
  if (std::ssize(order) > n) order.resize(static_cast<std::size_t>(n));
  std::ranges::sort(order);
  return order;
}

Eigen::MatrixXd rank_one(const Eigen::MatrixXd& residue, const MeasuredResponses& measured) {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(finite(completed(residue, measured, 1), "residue"),
                                              Eigen::ComputeThinU | Eigen::ComputeThinV);
  return svd.singularValues()(0) * svd.matrixU().col(0) * svd.matrixV().col(0).transpose();
}

// The data without channels of which nothing was measured: no equation tells their rows of D.
FitData of_measured_channels(const FitData& data, const MeasuredResponses& measured) {
  const auto chosen = [](const auto& any) {
    std::vector<Eigen::Index> list;
    for (Eigen::Index c = 0; c < any.size(); ++c) {
      if (any(c)) list.push_back(c);
    }
    return list;
  };
  const auto outputs = chosen(measured.rowwise().any().eval());
  const auto inputs = chosen(measured.colwise().any().eval());
  std::vector<Eigen::Index> responses;
  for (const auto j : inputs) {
    for (const auto i : outputs) responses.push_back(i + data.outputs * j);
  }
  FitData part = data;
  part.outputs = std::ssize(outputs);
  part.inputs = std::ssize(inputs);
  part.value = data.value(Eigen::all, responses);
  part.weight = data.weight(Eigen::all, responses);
  return part;
}

}  // namespace

Eigen::MatrixXcd values(const PolynomialBasis& basis, const Eigen::VectorXd& x) {
  Eigen::MatrixXcd at(x.size(), basis.degree() + 1);
  at.col(0).setConstant(basis.first);
  const Eigen::VectorXcd s = std::complex<double>(0.0, 1.0) * x;
  for (Eigen::Index k = 0; k < basis.degree(); ++k) {
    at.col(k + 1) = s.cwiseProduct(at.col(k));
    if (k > 0) at.col(k + 1) += basis.recurrence(k - 1) * at.col(k - 1);
    at.col(k + 1) /= basis.recurrence(k);
  }
  return at;
}

MatrixFraction matrix_fraction(const FitData& data, const MatrixFractionOptions& options) {
  check(data, options);
  auto fraction = by_sanathanan_koerner(data, options);
  if (!std::isfinite(fraction.cost)) {
    throw NumericalFailure("matrix fraction: no iterate has a finite error");
  }
  double damping = 1e-4;
  for (int iteration = 0; iteration < options.levenberg_marquardt; ++iteration) {
    tell(options.progress, "Levenberg-Marquardt of the fraction",
         static_cast<double>(iteration) / options.levenberg_marquardt);
    if (!levenberg_step(fraction, data, damping)) break;
    fraction.costs.push_back(fraction.cost);
  }
  return fraction;
}

Eigen::VectorXcd poles(const MatrixFraction& fraction) {
  const auto p = fraction.numerator.front().rows();
  const auto d = std::ssize(fraction.denominator);
  const auto& gamma = fraction.denominator_basis.recurrence;
  Eigen::MatrixXd comrade = Eigen::MatrixXd::Zero(p * d, p * d);
  for (Eigen::Index a = 0; a < d; ++a) {
    if (a > 0) comrade.block(a * p, (a - 1) * p, p, p).diagonal().setConstant(-gamma(a - 1));
    if (a + 1 < d) comrade.block(a * p, (a + 1) * p, p, p).diagonal().setConstant(gamma(a));
  }
  for (Eigen::Index a = 0; a < d; ++a) {
    comrade.block((d - 1) * p, a * p, p, p) -=
        gamma(d - 1) * fraction.denominator[static_cast<std::size_t>(a)];
  }
  return fraction.scale *
         Eigen::EigenSolver<Eigen::MatrixXd>(finite(comrade, "matrix fraction"), false)
             .eigenvalues();
}

Eigen::MatrixXcd responses(const MatrixFraction& fraction, const Eigen::VectorXd& frequency_hz) {
  return on_lines(fraction, in_units(frequency_hz, fraction.scale)).value;
}

namespace {

struct FromFraction {
  Start start;
  double unrest = 1.0;
};

FromFraction started(const FitData& data, const ThesisOptions& options) {
  require(options.modes + options.rigid_count > 0 && options.modes >= 0 && options.rigid_count >= 0,
          "thesis fit: " + fmt::to_string(options.modes) + " modes and " +
              fmt::to_string(options.rigid_count) + " rigid-body modes; the number must be given");
  const auto measured = measured_responses(data.weight, data.outputs);
  require(measured.any(), "thesis fit: nothing was measured");
  const auto part = of_measured_channels(data, measured);
  const auto least = (2 * (options.modes + options.rigid_count) + part.outputs - 1) / part.outputs;
  const auto degree = options.degree > 0 ? options.degree : least;
  const auto fraction = matrix_fraction(
      part, {degree, options.residual ? degree : std::max<Eigen::Index>(degree - 2, 0),
             options.sanathanan_koerner, options.levenberg_marquardt, options.progress});
  const Eigen::VectorXcd found = resonances(fraction, options.rigid_count);
  if (found.size() == 0 && options.modes > 0) {
    throw NumericalFailure("thesis fit: no pole of the matrix fraction oscillates");
  }
  FromFraction result{{}, fraction.unrest};
  auto& start = result.start;
  start.rigid_count = options.rigid_count;
  if (options.modes == 0) return result;
  const ResidueProblem problem(data, found, options.rigid_count > 0);
  const auto chosen = worthiest(problem.residues().significance, options.modes);
  start.pole = found(chosen);
  for (const auto& residue : problem.residues(chosen).of_pole) {
    start.residue.push_back(rank_one(residue, measured));
  }
  return result;
}

}  // namespace

Start thesis_start(const FitData& data, const ThesisOptions& options) {
  return started(data, options).start;
}

ModalFit thesis_fit(const FitData& data, const ThesisOptions& options) {
  const auto [start, unrest] = started(data, options);
  FitOptions how;
  how.residual = options.residual;
  how.iterations = options.modal_iterations;
  how.progress = options.progress;
  auto fit = modal_fit(data, start, how);
  if (start.pole.size() < options.modes) {
    fit.start_notes.push_back("the matrix fraction has " + fmt::to_string(start.pole.size()) +
                              " resonances where " + fmt::to_string(options.modes) +
                              " were asked for");
  }
  if (unrest > Constants::unsettled) fit.start_notes.push_back(unrest_note(unrest));
  fit.notes.insert(fit.notes.end(), fit.start_notes.begin(), fit.start_notes.end());
  return fit;
}

}  // namespace chladni::identification
