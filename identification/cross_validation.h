// Parts of periodic recordings that a fit does not see, and how well it predicts them.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "identification/modal_fit.h"
#include "identification/validation.h"
#include "recordings/frf_estimate.h"
#include "recordings/time_data.h"

namespace chladni::identification {

/// The responses of one part of the recordings and those of all others, on the same lines.
struct Fold {
  std::string name;        ///< "realisation 3"
  modal::FrfSet left_out;  ///< its variance is that of `rest`, scaled: it knows nothing of itself
  modal::FrfSet rest;
  double times = 1.0;  ///< variance of `left_out` over that of `rest`
};

struct Folds {
  std::string by;           ///< "realisations", "periods"
  std::vector<Fold> folds;  ///< at most 10; empty: the recordings have no two such parts
};

/// The estimate of recordings in open loop or in a loop: frf_estimate, closed_loop_estimate.
using Estimator = std::function<recordings::FrfEstimate(const recordings::Spectra&,
                                                        const recordings::FrfEstimateOptions&)>;

/// Each realisation in turn; of more than 10 every tenth one together. Where there is one only, its
/// stretches of two periods or more in turn, all of one length, of four periods and more.
/// The variance of one realisation is that of the others' mean times their number. With two
/// realisations it is that of the noise alone, since one does not tell the distortion.
/// @param data     the recordings of `all`
/// @param all      as prepared() gives them
/// @param dropped  periods that the estimate of all dropped
/// @throws InvalidInput  as the estimator
/// Cost: that of the estimator, twice per fold.
[[nodiscard]] Folds folds(const recordings::TimeData& data, const recordings::Spectra& all,
                          const recordings::FrfEstimateOptions& options, Eigen::Index dropped,
                          const Estimator& estimator);

/// What fits that did not see some data say of them, beside the noise that is expected there.
struct LeftOut {
  std::string name;
  BandResidual whole;
};

struct CrossValidation {
  std::string by;  ///< as in Folds
  Validation all;  ///< of all parts together; columns are p×(q parts)
  /// The level of `all` that noise and the uncertainty of the fits leave of a right model.
  double expected_level = 1.0;
  std::vector<LeftOut> parts;  ///< each by itself
};

/// One part as data, and what the fit of the others says on its lines.
struct PredictedPart {
  std::string name;
  FitData data;
  Eigen::MatrixXcd predicted;  ///< K×pq
  double fit_error = 0.0;      ///< fit_error_over_noise
};

/// @param parts         of equal lines and channels, one or more; their variances are estimates
///                      from nearly the same recordings and err together
/// @param frequency_hz  of the modes that are not rigid, ascending
[[nodiscard]] CrossValidation cross_validation(const std::string& by,
                                               const std::vector<PredictedPart>& parts,
                                               const Eigen::VectorXd& frequency_hz);

/// What the uncertainty of the fit of a right model adds to the mean square of its error on data
/// that it has not seen, over their variance. The variance of the fit is that of the data it has
/// seen, times P/2N for P parameters and N complex numbers (the mean over all of them); on other
/// lines that of the nearest.
/// @param seen  the data of `fit`, of the same channels
[[nodiscard]] double fit_error_over_noise(const FitData& data, const FitData& seen,
                                          const ModalFit& fit);

}  // namespace chladni::identification
