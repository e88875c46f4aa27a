// Effects of the channels on measured responses: gains, signs, labels.
#include <algorithm>
#include <cmath>
#include <complex>

#include "diagnosis/comparison/compared_responses.h"
#include "diagnosis/constants.h"

namespace chladni::diagnosis {
namespace {

using Complex = std::complex<double>;

double median(const Eigen::VectorXd& of) {
  std::vector<double> values;
  for (const double value : of) {
    if (std::isfinite(value)) values.push_back(value);
  }
  if (values.empty()) return kNotMeasured;
  std::sort(values.begin(), values.end());
  const auto n = values.size();
  return n % 2 == 1 ? values[n / 2] : 0.5 * (values[n / 2 - 1] + values[n / 2]);
}

double log_ratio(const ComparedResponse& one) {
  Eigen::VectorXd ratios = Eigen::VectorXd::Constant(one.count(), kNotMeasured);
  for (Eigen::Index k = 0; k < one.count(); ++k) {
    const double size = std::abs(one.measured(k));
    const bool stated = one.variance.size() > 0;
    if (stated && size < kConstants.significant * std::sqrt(one.variance(k))) continue;
    ratios(k) = std::log(size / std::abs(one.simulated(k)));
  }
  return median(ratios);
}

// Subtracts the median of each row. @returns the medians; 0 for rows without any number
Eigen::VectorXd without_medians(Eigen::MatrixXd& values) {
  Eigen::VectorXd taken(values.rows());
  for (Eigen::Index i = 0; i < values.rows(); ++i) {
    const double m = median(values.row(i).transpose());
    taken(i) = std::isfinite(m) ? m : 0.0;
    values.row(i).array() -= taken(i);
  }
  return taken;
}

Complex compressed(Complex value) {
  const double size = std::abs(value);
  return size > 0.0 ? value / std::sqrt(size) : Complex(0.0);
}

// Correlation of measured(i, ·) with simulated(k, ·) over the others and lines, both compressed.
struct Correlation {
  Complex between = 0.0;
  double measured = 0.0, simulated = 0.0;

  void add(const ComparedResponse& one, const ComparedResponse& other) {
    // The simulation of another response is known only on the lines of that response.
    Eigen::Index l = 0;
    for (Eigen::Index k = 0; k < one.count(); ++k) {
      while (l < other.count() && other.frequency_hz(l) < one.frequency_hz(k)) ++l;
      if (l == other.count()) return;
      if (other.frequency_hz(l) != one.frequency_hz(k)) continue;
      const Complex g = compressed(one.measured(k));
      const Complex s = compressed(other.simulated(l));
      between += std::conj(s) * g;
      measured += std::norm(g);
      simulated += std::norm(s);
    }
  }
  [[nodiscard]] double cosine() const {
    return measured > 0.0 && simulated > 0.0 ? between.real() / std::sqrt(measured * simulated)
                                             : kNotMeasured;
  }
  [[nodiscard]] double alike() const {
    return measured > 0.0 && simulated > 0.0 ? std::norm(between) / (measured * simulated)
                                             : kNotMeasured;
  }
};

// The exchange with the largest gain, summed over the responses of the two channels.
void consider_swaps(const Eigen::MatrixXd& alike, bool outputs, Eigen::Index responses,
                    double& most, Swap& best) {
  for (Eigen::Index i = 0; i < alike.rows(); ++i) {
    for (Eigen::Index k = i + 1; k < alike.rows(); ++k) {
      Swap one{outputs, i, k};
      one.alike = 0.5 * (alike(i, i) + alike(k, k));
      one.alike_exchanged = 0.5 * (alike(i, k) + alike(k, i));
      const double least =
          std::max(one.alike + kConstants.exchange_better, kConstants.same_channel);
      if (!(one.alike_exchanged > least)) continue;
      const double gain = (one.alike_exchanged - one.alike) * static_cast<double>(responses);
      if (gain <= most) continue;
      most = gain;
      best = one;
    }
  }
}

}  // namespace

// Median polish (Tukey 1977): values = level + row + column + rest.
void set_gains(const ComparedResponses& of, ResponseComparison& result) {
  Eigen::MatrixXd left = per_response(of, log_ratio);
  Eigen::VectorXd rows = Eigen::VectorXd::Zero(of.outputs);
  Eigen::VectorXd columns = Eigen::VectorXd::Zero(of.inputs);
  for (int pass = 0; pass < 10; ++pass) {
    rows += without_medians(left);
    Eigen::MatrixXd turned = left.transpose();
    columns += without_medians(turned);
    left = turned.transpose();
  }
  // What has no number at all has no gain either.
  rows = (left.array().isNaN().rowwise().all()).select(kNotMeasured, rows.array()).matrix();
  columns = (left.array().isNaN().colwise().all().transpose())
                .select(kNotMeasured, columns.array())
                .matrix();
  const double row = median(rows);
  const double column = median(columns);
  result.level = std::exp(row + column);
  result.output_gain = (rows.array() - row).exp();
  result.input_gain = (columns.array() - column).exp();
}

// Likeness of measured channel i to simulated channel k.
Eigen::MatrixXd channels_alike(const ComparedResponses& of, bool outputs) {
  const Eigen::Index n = outputs ? of.outputs : of.inputs;
  const Eigen::Index others = outputs ? of.inputs : of.outputs;
  Eigen::MatrixXd result(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index k = 0; k < n; ++k) {
      Correlation sum;
      for (Eigen::Index o = 0; o < others; ++o) {
        outputs ? sum.add(of(i, o), of(k, o)) : sum.add(of(o, i), of(o, k));
      }
      result(i, k) = sum.alike();
    }
  }
  return result;
}

// Signs of rows and columns whose products agree best with the signs of the responses. The row or
// column that disagrees most is turned, until every one agrees.
void set_signs(const ComparedResponses& of, ResponseComparison& result) {
  Eigen::MatrixXd cosine = per_response(of, [](const ComparedResponse& one) {
    Correlation sum;
    sum.add(one, one);
    return sum.cosine();
  });
  const Eigen::MatrixXd known = cosine.array().isFinite().select(cosine, 0.0);
  Eigen::VectorXd rows = Eigen::VectorXd::Ones(of.outputs);
  Eigen::VectorXd columns = Eigen::VectorXd::Ones(of.inputs);
  for (Eigen::Index turn = 0; turn < of.outputs + of.inputs; ++turn) {
    const Eigen::MatrixXd agreed = rows.asDiagonal() * known * columns.asDiagonal();
    Eigen::Index row = 0;
    Eigen::Index column = 0;
    const double worst_row = agreed.rowwise().sum().minCoeff(&row);
    const double worst_column = agreed.colwise().sum().minCoeff(&column);
    if (std::min(worst_row, worst_column) >= 0.0) break;
    (worst_row < worst_column ? rows(row) : columns(column)) *= -1.0;
  }
  const Eigen::MatrixXd agreed = rows.asDiagonal() * known * columns.asDiagonal();
  const Eigen::MatrixXd counted = cosine.array().isFinite().cast<double>();
  const auto said = [](double sign, double sum, double count) {
    return sum > kConstants.phases_say * count && count > 0.0 ? sign : kNotMeasured;
  };
  result.output_sign.resize(of.outputs);
  result.input_sign.resize(of.inputs);
  for (Eigen::Index i = 0; i < of.outputs; ++i) {
    result.output_sign(i) = said(rows(i), agreed.row(i).sum(), counted.row(i).sum());
  }
  for (Eigen::Index j = 0; j < of.inputs; ++j) {
    result.input_sign(j) = said(columns(j), agreed.col(j).sum(), counted.col(j).sum());
  }
}

std::vector<Swap> swaps(const modal::FrfSet& measured,
                        const std::vector<Eigen::MatrixXcd>& simulated,
                        const ComparisonOptions& options) {
  auto righted = measured;
  righted.variance.clear();
  std::vector<Swap> result;
  const auto most_swaps =
      static_cast<std::size_t>(measured.output_count() + measured.input_count());
  while (result.size() < most_swaps) {
    const ComparedResponses of = responses_of(righted, simulated, options);
    double gain = 0.0;
    Swap best;
    consider_swaps(channels_alike(of, true), true, of.inputs, gain, best);
    consider_swaps(channels_alike(of, false), false, of.outputs, gain, best);
    if (gain == 0.0) break;
    result.push_back(best);
    for (auto& value : righted.value) {
      if (best.outputs) {
        value.row(best.first).swap(value.row(best.second));
      } else {
        value.col(best.first).swap(value.col(best.second));
      }
    }
  }
  return result;
}

}  // namespace chladni::diagnosis
