#include "identification/poles/missing_mode.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "host/parallel.h"
#include "identification/constants.h"

namespace chladni::identification {
namespace {

using Complex = std::complex<double>;

std::vector<double> damping_ratios(const ModalFit& fit) {
  std::vector<double> known;
  for (auto m = fit.model.rigid_count; m < fit.model.mode_count(); ++m) {
    known.push_back(fit.model.damping_ratio(m));
  }
  std::sort(known.begin(), known.end());
  const double high = known.empty() ? 0.05 : std::min(0.2, 4.0 * known.back());
  const double low = known.empty() ? 1e-3 : std::min(0.25 * known.front(), 0.25 * high);
  const int count = std::max(3, static_cast<int>(std::ceil(std::log2(high / low))));
  std::vector<double> ratios;
  for (int i = 0; i <= count; ++i) {
    ratios.push_back(low * std::pow(high / low, static_cast<double>(i) / count));
  }
  return ratios;
}

struct Scanned {
  const FitData& data;
  const Eigen::MatrixXcd& error;  // K×pq, times w²
  Eigen::MatrixXd weight;         // w²
  bool general;                   // residues of any phase
};

double gain_of(const Scanned& scanned, Complex pole) {
  const auto& f = scanned.data.frequency_hz;
  const double own = std::abs(pole) / (2.0 * std::numbers::pi);
  const double reach =
      Constants::missing_mode_reach * 2.0 * -pole.real() / (2.0 * std::numbers::pi);
  const double* begin = f.data();
  const auto first = std::lower_bound(begin, begin + f.size(), own - reach) - begin;
  const auto last = std::upper_bound(begin, begin + f.size(), own + reach) - begin;
  const auto count = last - first;
  if (count < 4) return 0.0;
  Eigen::VectorXcd h(count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const Complex s(0.0, 2.0 * std::numbers::pi * f(first + k));
    h(k) = std::norm(pole) / (s * s - 2.0 * pole.real() * s + std::norm(pole));
  }
  const Eigen::RowVectorXcd along = h.adjoint() * scanned.error.middleRows(first, count);
  const Eigen::RowVectorXd square =
      h.cwiseAbs2().transpose() * scanned.weight.middleRows(first, count);
  const Eigen::RowVectorXd explained = scanned.general
                                           ? Eigen::RowVectorXd(along.cwiseAbs2())
                                           : Eigen::RowVectorXd(along.real().cwiseAbs2());
  return explained.cwiseQuotient(square.cwiseMax(1e-300)).sum();
}

// Residues of any phase that explain most of the error at a pole, each response by itself.
Eigen::MatrixXcd residues_at(const Scanned& scanned, Complex pole) {
  const auto& lines = scanned.data.frequency_hz;
  const Eigen::VectorXcd h =
      (Complex(0.0, 2.0 * std::numbers::pi) * lines.cast<Complex>().array() - pole).inverse();
  const Eigen::RowVectorXcd along = h.adjoint() * scanned.error;
  const Eigen::RowVectorXd square = h.cwiseAbs2().transpose() * scanned.weight;
  return along.cwiseQuotient(square.cwiseMax(1e-300).cast<Complex>())
      .reshaped(scanned.data.outputs, scanned.data.inputs);
}

}  // namespace

MissingMode missing_mode(const FitData& data, const ModalFit& fit) {
  const Eigen::MatrixXd square = data.weight.cwiseAbs2();
  const Eigen::MatrixXcd error =
      (data.value - responses(fit, data.frequency_hz)).cwiseProduct(square.cast<Complex>());
  const Scanned scanned{data, error, square, fit.complex.has_value()};
  const double low = data.frequency_hz(0);
  const double high = data.frequency_hz(data.line_count() - 1);
  const double spacing = (high - low) / static_cast<double>(data.line_count() - 1);
  std::vector<Complex> candidates;
  for (const double ratio : damping_ratios(fit)) {
    for (double own = low; own <= high; own += std::max(0.5 * spacing, 2.0 * ratio * own / 3.0)) {
      candidates.push_back(2.0 * std::numbers::pi * own *
                           Complex(-ratio, std::sqrt(1.0 - ratio * ratio)));
    }
  }
  std::vector<double> gain(candidates.size());
  parallel_ranges(candidates.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) gain[c] = gain_of(scanned, candidates[c]);
  });
  const auto best = std::max_element(gain.begin(), gain.end()) - gain.begin();
  const auto pole = candidates[static_cast<std::size_t>(best)];
  return {pole, scanned.general ? residues_at(scanned, pole) : Eigen::MatrixXcd(),
          gain[static_cast<std::size_t>(best)]};
}

}  // namespace chladni::identification
