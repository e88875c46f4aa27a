#include "recordings/estimate/transient.h"

#include <fmt/format.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>

#include "base/error.h"
#include "recordings/constants.h"

namespace chladni::recordings {
namespace {

// Mean powers over the records: of differences between periods, and of the outputs.
struct Powers {
  Eigen::MatrixXd difference;  // (P−1)×(channels·groups)
  Eigen::VectorXd output;      // channels·groups
  double values = 0.0;         // complex numbers in each mean
};

Powers powers(const SpectraSource& spectra, std::size_t periods) {
  const auto lines = spectra.head.line_count();
  const auto size = std::min(Constants::decay_group, lines);
  const auto groups = lines / size;
  const auto channels = static_cast<Eigen::Index>(spectra.head.outputs.size());
  Powers result{Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(periods) - 1, channels * groups),
                Eigen::VectorXd::Zero(channels * groups),
                static_cast<double>(size) * static_cast<double>(spectra.records.size())};
  for (std::size_t i = 0; i < spectra.records.size(); ++i) {
    auto now = spectra.period(i, 0);
    for (std::size_t p = 0; p < periods; ++p) {
      const bool is_last = p + 1 == periods;
      const auto next = is_last ? now : spectra.period(i, p + 1);
      for (Eigen::Index c = 0; c < channels; ++c) {
        for (Eigen::Index g = 0; g < groups; ++g) {
          const auto here = now.outputs->col(c).segment(g * size, size);
          if (is_last) {
            result.output(c * groups + g) += here.squaredNorm() / result.values;
          } else {
            result.difference(static_cast<Eigen::Index>(p), c * groups + g) +=
                (next.outputs->col(c).segment(g * size, size) - here).squaredNorm() / result.values;
          }
        }
      }
      now = next;
    }
  }
  return result;
}

// Decays of the powers 2σ² + A₁ρ₁^{2p} + A₂ρ₂^{2p} of a group: a slow one and a fast one.
using Decays = Eigen::Vector2d;

struct Fit {
  Eigen::Vector3d share = Eigen::Vector3d::Zero();  // 2σ², A₁, A₂
  double misfit = 0.0;  // −2 log likelihood over the number of values, without a constant
};

double misfit_of(const Eigen::VectorXd& found, const Eigen::VectorXd& model) {
  return 2.0 * (model.array().log() + found.array() / model.array()).sum();
}

Fit without_decay(const Eigen::VectorXd& found, double floor) {
  const double noise = std::max(found.mean(), floor);
  return {{noise, 0.0, 0.0}, misfit_of(found, Eigen::VectorXd::Constant(found.size(), noise))};
}

// Maximum likelihood of χ² powers with shares that are never negative. The multiplicative
// steps are those for Itakura and Saito's divergence (Févotte, Bertin, Durrieu 2009); they
// never raise the misfit.
Fit fitted(const Eigen::VectorXd& found, const Decays& decay, double floor, int steps) {
  const auto n = found.size();
  Eigen::MatrixX3d basis(n, 3);
  for (Eigen::Index p = 0; p < n; ++p) {
    const auto twice = 2.0 * static_cast<double>(p);
    basis.row(p) << 1.0, std::pow(decay(0), twice), std::pow(decay(1), twice);
  }
  Fit fit{Eigen::Vector3d(found.minCoeff(), 0.5 * found(0), 0.5 * found(0)), 0.0};
  for (int i = 0; i < steps; ++i) {
    const Eigen::VectorXd model = (basis * fit.share).cwiseMax(floor);
    const Eigen::VectorXd inverse = model.cwiseInverse();
    const Eigen::Vector3d up = basis.transpose() * inverse.cwiseAbs2().cwiseProduct(found);
    const Eigen::Vector3d down = basis.transpose() * inverse;
    fit.share = fit.share.cwiseProduct(up.cwiseQuotient(down).cwiseSqrt());
    fit.share(0) = std::max(fit.share(0), floor);
  }
  fit.misfit = misfit_of(found, basis * fit.share);
  const auto none = without_decay(found, floor);
  return fit.misfit < none.misfit ? fit : none;
}

struct Decay {
  Decays value = Decays::Zero();  // slow, fast
  std::vector<Fit> fits;          // per channel and group
  double gain = 0.0;              // misfit gained over no decay, in the best group
  double gains = 0.0;             // the same over all groups
};

double floor_of(const Powers& powers, Eigen::Index g) {
  return std::max(Constants::least_noise_power * powers.output(g), 1e-300);
}

// The groups in which a decay is clearest.
std::vector<Eigen::Index> telling(const Powers& powers) {
  std::vector<Eigen::Index> groups(static_cast<std::size_t>(powers.output.size()));
  for (std::size_t g = 0; g < groups.size(); ++g) groups[g] = static_cast<Eigen::Index>(g);
  const auto last = powers.difference.rows() - 1;
  const auto told = [&](Eigen::Index g) {
    return powers.difference(0, g) / (powers.difference(last, g) + floor_of(powers, g));
  };
  std::stable_sort(groups.begin(), groups.end(),
                   [&](Eigen::Index a, Eigen::Index b) { return told(a) > told(b); });
  if (groups.size() > Constants::decay_groups) groups.resize(Constants::decay_groups);
  return groups;
}

Decay likeliest(const Powers& powers) {
  const auto groups = telling(powers);
  Decay best;
  double least = std::numeric_limits<double>::infinity();
  for (double slow = 0.05; slow < 0.985; slow += 0.03) {
    for (double fast = 0.02; fast < slow; fast += 0.06) {
      double misfit = 0.0;
      for (const auto g : groups) {
        misfit += fitted(powers.difference.col(g), {slow, fast}, floor_of(powers, g), 40).misfit;
      }
      if (misfit < least) {
        least = misfit;
        best.value = {slow, fast};
      }
    }
  }
  for (Eigen::Index g = 0; g < powers.output.size(); ++g) {
    const double floor = floor_of(powers, g);
    best.fits.push_back(fitted(powers.difference.col(g), best.value, floor, 300));
    const double gain = powers.values * (without_decay(powers.difference.col(g), floor).misfit -
                                         best.fits.back().misfit);
    best.gain = std::max(best.gain, gain);
    best.gains += gain;
  }
  return best;
}

// Largest bias of the mean over the remaining periods, over the deviation of the mean.
double bias_after(const Decay& decay, double dropped, double periods) {
  const double left = periods - dropped;
  double largest = 0.0;
  for (const auto& fit : decay.fits) {
    double mean = 0.0;
    for (const int i : {0, 1}) {
      const double q = decay.value(i);
      const double start = std::sqrt(fit.share(i + 1)) * std::pow(q, dropped) / (1.0 - q);
      mean += start * (1.0 - std::pow(q, left)) / (left * (1.0 - q));
    }
    largest = std::max(largest, mean / std::sqrt(0.5 * fit.share(0) / left));
  }
  return largest;
}

// Without a decay, twice the gain in log likelihood is χ² of a few degrees.
bool significant(const Decay& decay) {
  const auto n = static_cast<double>(decay.fits.size());
  return decay.gain > Constants::decay_significant * Constants::decay_significant ||
         decay.gains > 2.0 * n + Constants::decay_significant * 2.0 * std::sqrt(n);
}

std::string told(const TransientReport& report, std::size_t periods) {
  if (periods < 3) {
    return "a transient cannot be told from noise in " + fmt::to_string(periods) +
           " period(s); three are needed";
  }
  if (!report.seen) return "no transient seen";
  return "a transient of which each period leaves " + fmt::format("{:.6g}", report.decay) +
         "; with " + fmt::to_string(report.drop) + " of " + fmt::to_string(periods) +
         " periods dropped it shifts the mean by at most " +
         fmt::format("{:.6g}", report.remaining) + " of its deviation" +
         (report.remaining > Constants::decay_tolerated
              ? ": too much; remove it with the poles of a first fit, or "
                "measure more periods"
              : "");
}

}  // namespace

TransientReport transient(const Spectra& spectra) { return transient(source_of(spectra)); }

TransientReport transient(const SpectraSource& spectra) {
  require(!spectra.records.empty(), "transient: no records");
  std::size_t periods = spectra.records.front().periods;
  for (const auto& record : spectra.records) periods = std::min(periods, record.periods);
  TransientReport report;
  report.drop = periods >= 2 ? 1 : 0;
  if (periods >= 3 && spectra.head.line_count() > 0) {
    const auto all = powers(spectra, periods);
    const auto decay = likeliest(all);
    report.seen = significant(decay);
    const auto count = static_cast<double>(periods);
    if (report.seen) {
      report.decay = decay.value(0);
      report.first = bias_after(decay, 0.0, count);
      double least = std::numeric_limits<double>::infinity();
      for (Eigen::Index d = 1; d + 2 <= static_cast<Eigen::Index>(periods); ++d) {
        const auto dropped = static_cast<double>(d);
        const double bias = bias_after(decay, dropped, count);
        const double error = (1.0 + bias * bias) / (count - dropped);
        if (error < least || bias < Constants::decay_tolerated) {
          report.drop = d;
          report.remaining = bias;
          least = error;
        }
        if (bias < Constants::decay_tolerated) break;
      }
    }
  }
  report.text = told(report, periods);
  return report;
}

namespace {

using Complex = std::complex<double>;

// Free decays within one period and from period to period.
struct DecayBasis {
  Eigen::MatrixXcd within;  // N×m: λ^n
  Eigen::MatrixXcd across;  // P×m: q^p − mean
  Eigen::MatrixXcd full;    // P×m: q^p
};

DecayBasis decays(const Eigen::VectorXcd& pole, double sample_time, Eigen::Index period,
                  Eigen::Index periods) {
  const auto m = pole.size();
  DecayBasis basis{Eigen::MatrixXcd(period, m), {}, Eigen::MatrixXcd(periods, m)};
  for (Eigen::Index j = 0; j < m; ++j) {
    for (Eigen::Index n = 0; n < period; ++n) {
      basis.within(n, j) = std::exp(pole(j) * sample_time * static_cast<double>(n));
    }
    for (Eigen::Index p = 0; p < periods; ++p) {
      basis.full(p, j) = std::exp(pole(j) * sample_time * static_cast<double>(period * p));
    }
  }
  basis.across = basis.full.rowwise() - basis.full.colwise().mean();
  return basis;
}

// Normal matrix: sums over all samples of products of the real functions Re(b λⁿ q^p). The unknowns
// are Re b, then Im b.
Eigen::MatrixXd normal_matrix(const DecayBasis& basis) {
  const auto m = basis.within.cols();
  const Eigen::MatrixXcd same = basis.within.adjoint() * basis.within;
  const Eigen::MatrixXcd turned = basis.within.transpose() * basis.within;
  const Eigen::MatrixXcd same_p = basis.across.adjoint() * basis.across;
  const Eigen::MatrixXcd turned_p = basis.across.transpose() * basis.across;
  const Eigen::MatrixXcd a = same.cwiseProduct(same_p);      // Σ conj(f_i) f_j
  const Eigen::MatrixXcd b = turned.cwiseProduct(turned_p);  // Σ f_i f_j
  Eigen::MatrixXd result(2 * m, 2 * m);
  result.topLeftCorner(m, m) = 0.5 * (a + b).real();
  result.topRightCorner(m, m) = -0.5 * (a + b).imag();
  result.bottomRightCorner(m, m) = 0.5 * (a - b).real();
  result.bottomLeftCorner(m, m) = result.topRightCorner(m, m).transpose();
  return result;
}

// Least-squares amplitudes b, m×channels, of the part of `samples` that does not repeat.
Eigen::MatrixXcd amplitudes(const DecayBasis& basis, const Eigen::MatrixXd& samples,
                            const Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd>& solver,
                            const Eigen::VectorXd& scale) {
  const auto n = basis.within.rows();
  const auto m = basis.within.cols();
  Eigen::MatrixXcd sum = Eigen::MatrixXcd::Zero(m, samples.cols());
  for (Eigen::Index p = 0; p < basis.across.rows(); ++p) {
    sum += basis.across.row(p).transpose().asDiagonal() *
           (basis.within.transpose() * samples.middleRows(p * n, n));
  }
  Eigen::MatrixXd right(2 * m, samples.cols());
  right << sum.real(), -sum.imag();
  const Eigen::MatrixXd found =
      scale.asDiagonal() * solver.solve(Eigen::MatrixXd(scale.asDiagonal() * right));
  Eigen::MatrixXcd result(m, samples.cols());
  result.real() = found.topRows(m);
  result.imag() = found.bottomRows(m);
  return result;
}

void subtract(const DecayBasis& basis, const Eigen::MatrixXcd& amplitude,
              Eigen::MatrixXd& samples) {
  const auto n = basis.within.rows();
  for (Eigen::Index p = 0; p < basis.full.rows(); ++p) {
    const Eigen::MatrixXcd now = basis.full.row(p).transpose().asDiagonal() * amplitude;
    samples.middleRows(p * n, n) -= (basis.within * now).real();
  }
}

bool repeats(const Eigen::MatrixXd& samples, Eigen::Index period) {
  return samples.bottomRows(samples.rows() - period) == samples.topRows(samples.rows() - period);
}

}  // namespace

WithoutTransient without_transient(const TimeData& data, const Eigen::VectorXcd& pole) {
  check(data);
  require(data.period >= 1, "transient: the data state no period");
  for (const auto& p : pole) {
    require(p.real() < 0.0 && p.imag() > 0.0,
            "transient: the pole " + fmt::format("{:.6g}", p.real()) + " + " +
                fmt::format("{:.6g}", p.imag()) +
                "j rad/s; expected one that decays, of positive frequency");
  }
  WithoutTransient result{data, {}};
  for (auto& record : result.data.records) {
    const auto samples = record.outputs.rows();
    require(samples >= 2 * data.period && samples % data.period == 0,
            "transient: a record of " + fmt::to_string(samples) +
                " samples; expected two or more whole periods of " + fmt::to_string(data.period));
    const auto basis = decays(pole, data.sample_time_s, data.period, samples / data.period);
    const auto normal = normal_matrix(basis);
    const Eigen::VectorXd scale = normal.diagonal().cwiseSqrt().cwiseInverse();
    Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver;
    solver.setThreshold(1e-10);
    solver.compute(scale.asDiagonal() * normal * scale.asDiagonal());
    const auto found = amplitudes(basis, record.outputs, solver, scale);
    subtract(basis, found, record.outputs);
    if (!repeats(record.inputs, data.period)) {
      subtract(basis, amplitudes(basis, record.inputs, solver, scale), record.inputs);
    }
    result.amplitude.push_back(0.5 * found);
  }
  return result;
}

}  // namespace chladni::recordings
