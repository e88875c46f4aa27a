// A modal model identified from the measurement, on the study's channels.
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "identification/channel_gains.h"
#include "identification/cross_validation.h"
#include "identification/identified.h"
#include "identification/trust.h"
#include "identification/validation.h"
#include "modal/frf_set.h"
#include "recordings/data_quality.h"
#include "stage/solution.h"

namespace chladni::steps {

/// The measured responses on the study's channels. Names, directions and kinds are those of the
/// study. The gains, delays and low-passes that it states are removed.
struct MeasuredFrfs {
  std::string file;
  modal::FrfSet all;
  std::vector<Eigen::Index> outputs, inputs;       ///< channels that a fit may use
  std::optional<recordings::DataQuality> quality;  ///< of recordings
  double added_decay =
      0.0;  ///< [rad/s] by an exponential window: in the responses, not in the model
  identification::Folds folds;  ///< of periodic recordings, where they were wanted
  bool variance_stated = true;  ///< false: `all` has one that was estimated from its scatter
};

/// The model error ε that a fit assumes where no variance is stated.
inline constexpr double kAssumedModelError = 0.01;

/// True if `[measurement]` names a file of responses or recordings.
[[nodiscard]] bool has_responses(const study::MeasurementPlan& plan);

/// The file of `[measurement]`, or the FRFs estimated from its recordings.
/// @throws InvalidInput  no file is named; no channel of the study is in it; the unit of a channel
///                       does not fit the quantity in the study
/// @param with_folds  parts of periodic recordings that a fit does not see are wanted, too
[[nodiscard]] MeasuredFrfs measured_frfs(const study::Study& study, stage::Work& work,
                                         bool with_folds = false);

/// What the model says of `[measurement] validation`, in the band of the fit.
struct SecondRecord {
  std::string file;
  modal::FrfSet set;  ///< its responses in the band of the fit, between the channels of the fit
  double added_decay = 0.0;   ///< as in MeasuredFrfs
  bool noise_known = true;    ///< else the noise is estimated, or an error of the model is allowed
  bool freedom_known = true;  ///< else its variances are of an unknown number of averages
  identification::Validation left;  ///< what the prediction leaves of it
  double expected_level = 1.0;      ///< as in CrossValidation
};

struct IdentifiedModel : identification::ChannelGains {
  MeasuredFrfs measured;
  modal::FrfSet seen;            ///< responses used by the fit
  identification::FitData data;  ///< corrected to one structure if `drift` is not empty
  identification::Identified found;
  /// K, relative to |G|: model error that the data show, at most the study's; empty: not estimated.
  Eigen::VectorXd model_error;
  Eigen::VectorXd drift;  ///< per response of `seen`: relative shift of its resonances, corrected;
                          ///< empty: no significant drift
  std::vector<identification::StabilisationPoint> stabilisation;
  Eigen::MatrixXd error;  ///< per response of `seen`: |G − Ĝ| over |G|, over the lines
  /// Per response: standard deviation over |G|, likewise; NaN where the weights are no deviations.
  Eigen::MatrixXd noise;
  identification::Judgement judgement;
  identification::Validation validation;
  std::optional<identification::CrossValidation> cross_validation;  ///< of periodic recordings
  std::optional<SecondRecord> second_record;
};

/// All modes but those beyond the lines that nothing tells of (Judgement::beyond_lines).
[[nodiscard]] std::vector<Eigen::Index> modes_within(const IdentifiedModel& model);

/// Index of the first element with this name; −1: there is none.
template <typename Named>
[[nodiscard]] Eigen::Index index_of(const std::vector<Named>& all, const std::string& name) {
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const Named& one) { return one.name == name; });
  return found == all.end() ? -1 : found - all.begin();
}

/// True if springs to ground or supports hold the body. Attachments on the body do not hold it.
[[nodiscard]] bool is_held(const study::Study& study);
/// A body that is held has no rigid-body modes; on springs it has slow ones in their stead.
void take_support(const study::Study& study, identification::IdentificationOptions& options);
/// The kind of a response whose sensor measures "displacement", "velocity" or "acceleration".
[[nodiscard]] modal::FrfKind kind_of(const std::string& quantity);
/// Other responses of the same measurement, prepared as for the model's own fit.
[[nodiscard]] identification::FitData fit_data_of(const study::Study& study,
                                                  const IdentifiedModel& model,
                                                  const modal::FrfSet& set);
/// The same with the noise that responses of the model leave of them, where no variance is stated.
[[nodiscard]] identification::FitData reweighted_data(const study::Study& study,
                                                      const IdentifiedModel& model,
                                                      identification::FitData data,
                                                      const Eigen::MatrixXcd& fitted);
/// @param solution  of the study; null: solved only if the gains need a simulation
/// @throws as its steps
[[nodiscard]] IdentifiedModel identified(const study::Study& study, const stage::Solution* solution,
                                         stage::Work& work);

/// |G − Ĝ| over |G|, over all responses and lines.
[[nodiscard]] double overall_error(const IdentifiedModel& model);
/// Noise over |G|, over all responses and lines: the overall_error of a perfect model. Stated or
/// assumed model error is included.
[[nodiscard]] double noise(const IdentifiedModel& model);
/// Ends a verb that depends on the model, after its results are written.
/// @throws NumericalFailure  the fit is not to be trusted; the message says why
void require_trust(const IdentifiedModel& model);

}  // namespace chladni::steps
