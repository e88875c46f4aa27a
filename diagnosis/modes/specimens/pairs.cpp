#include "diagnosis/modes/specimens/pairs.h"

#include <algorithm>
#include <cmath>

#include "base/index.h"
#include "diagnosis/modes/specimens/specimen_constants.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;

double pair_misfit(double measured_hz, double model_hz) {
  return std::min(std::pow(std::log(measured_hz / model_hz) / kSpecimens.pair_error, 2),
                  kSpecimens.pair_at_most);
}

// Alignment of two ascending sequences: least(i, k) is the misfit of the first i and k of them.
class Alignment {
 public:
  Alignment(const MeasuredModes& measured, const RecordedModes& model)
      : measured_(measured), model_(model) {
    const Index n = measured.count(), m = model.count();
    least_.setZero(n + 1, m + 1);
    for (Index i = 1; i <= n; ++i) least_(i, 0) = static_cast<double>(i) * kSpecimens.pair_at_most;
    for (Index k = 1; k <= m; ++k) least_(0, k) = least_(0, k - 1) + unseen(k);
    for (Index i = 1; i <= n; ++i) {
      for (Index k = 1; k <= m; ++k) {
        least_(i, k) = std::min({paired(i, k), least_(i - 1, k) + kSpecimens.pair_at_most,
                                 least_(i, k - 1) + unseen(k)});
      }
    }
  }

  [[nodiscard]] Matching matching() const {
    Matching result{std::vector<Index>(at(measured_.count()), -1), {}};
    result.span.resize(result.model.size());
    Index i = measured_.count(), k = model_.count();
    while (i > 0 && k > 0) {
      if (least_(i, k) == least_(i, k - 1) + unseen(k)) {
        --k;
      } else if (least_(i, k) == least_(i - 1, k) + kSpecimens.pair_at_most) {
        --i;
      } else {
        result.model[at(--i)] = --k;
        result.span[at(i)] = span_of(measured_, model_, i, k);
      }
    }
    return result;
  }

 private:
  [[nodiscard]] double paired(Index i, Index k) const {
    return least_(i - 1, k - 1) +
           pair_misfit(measured_.frequency_hz(i - 1), model_.frequency_hz(k - 1));
  }
  // Nobody looked for modes outside the band of those measured.
  [[nodiscard]] double unseen(Index k) const {
    const double hz = model_.frequency_hz(k - 1);
    const bool is_between = measured_.count() > 0 && hz > measured_.frequency_hz(0) &&
                            hz < measured_.frequency_hz(measured_.count() - 1);
    return is_between ? kSpecimens.unseen_mode : 0.0;
  }

  const MeasuredModes& measured_;
  const RecordedModes& model_;
  Eigen::MatrixXd least_;
};

}  // namespace

double square_misfit(const MeasuredModes& measured, const RecordedModes& model,
                     const Matching& matching) {
  double sum = 0.0;
  for (std::size_t i = 0; i < matching.model.size(); ++i) {
    const Index k = matching.model[i];
    sum += k < 0 ? kSpecimens.pair_at_most
                 : pair_misfit(measured.frequency_hz(static_cast<Index>(i)), model.frequency_hz(k));
  }
  return sum;
}

Matching pairs_in_order(const MeasuredModes& measured, const RecordedModes& model) {
  return Alignment(measured, model).matching();
}

Matching nearest_pairs(const ModesProblem& problem, const MeasuredModes& measured,
                       const RecordedModes& model) {
  const Index channels = measured.output_shapes.rows() + measured.input_shapes.rows();
  if (channels <= kSpecimens.few_channels) return pairs_in_order(measured, model);
  const auto ways = problem.matchings(model);
  return *std::ranges::min_element(
      ways, {}, [&](const Matching& way) { return square_misfit(measured, model, way); });
}

}  // namespace chladni::diagnosis
