// A modal model from what was measured, on the study's channels.
#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "app/stage/solution.h"
#include "identification/gain_match.h"
#include "identification/identified.h"
#include "identification/trust.h"
#include "modal/frf_set.h"

namespace chladni::app {

/// What was measured, on the study's channels alone; their names, directions and kinds are its, and
/// what it says of their gains, delays and low-passes is taken away.
struct MeasuredFrfs {
  std::string file;
  modal::FrfSet all;
  std::vector<Eigen::Index> outputs, inputs;  ///< of the channels that a fit may see
};

/// Whether `[measurement]` names a file of responses or recordings.
[[nodiscard]] bool has_responses(const MeasurementPlan& plan);

/// The file of `[measurement]`, or the FRFs estimated from its recordings.
/// @throws InvalidInput  none is named, no channel of the study is in it, a channel's unit is not
///                       of the quantity that the study says
[[nodiscard]] MeasuredFrfs measured_frfs(const Study& study, Run& run);

struct IdentifiedModel {
  MeasuredFrfs measured;
  modal::FrfSet seen;            ///< by the fit
  identification::FitData data;  ///< that of one structure, where `drift` is not empty
  identification::Identified found;
  /// K, of |G|: what of the study's the data leave room for; empty: that was not asked.
  Eigen::VectorXd model_error;
  Eigen::VectorXd drift;  ///< per response of `seen`: relative shift of its resonances, taken out;
                          ///< empty: none that matters
  identification::GainMatch match;
  std::vector<identification::CollocatedPair> pairs;
  bool corrects_gains = false;  ///< `gain_errors` names a side
  std::vector<identification::StabilisationPoint> stabilisation;
  Eigen::MatrixXd error;  ///< per response of `seen`: |G − Ĝ| over |G|, over the lines
  Eigen::MatrixXd noise;  ///< per response: its deviation over |G|, likewise
  identification::Judgement judgement;
};

/// Of the first with this name; −1: there is none.
template <typename Named>
[[nodiscard]] Eigen::Index index_of(const std::vector<Named>& all, const std::string& name) {
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const Named& one) { return one.name == name; });
  return found == all.end() ? -1 : found - all.begin();
}

/// The kind of a response whose sensor measures "displacement", "velocity" or "acceleration".
[[nodiscard]] modal::FrfKind kind_of(const std::string& quantity);
/// Other responses of the same measurement, as the model's own fit saw them.
[[nodiscard]] identification::FitData fit_data_of(const Study& study, const IdentifiedModel& model,
                                                  const modal::FrfSet& set);
/// Motion as a whole that so many rigid-body modes can be, all channels along z.
[[nodiscard]] identification::RigidMotion rigid_motion(Eigen::Index rigid_count);

/// @param solution  of the study; null: solved only where the gains need a simulation
/// @throws as its steps
[[nodiscard]] IdentifiedModel identified(const Study& study, const Solution* solution, Run& run);

/// |G − Ĝ| over |G|, over all responses and lines.
[[nodiscard]] double overall_error(const IdentifiedModel& model);
/// The noise over |G|, over all responses and lines: what overall_error is of a perfect model. With
/// it what the model is allowed to be off by, stated or assumed.
[[nodiscard]] double noise(const IdentifiedModel& model);
[[nodiscard]] std::string identification_table(const IdentifiedModel& model);
/// "trust: ...", then a line for each doubtful mode and outlying line.
[[nodiscard]] std::string trust_text(const IdentifiedModel& model);
[[nodiscard]] io::Json trust_json(const IdentifiedModel& model);
/// Ends a verb whose results stand on the model, once they are written.
/// @throws NumericalFailure  the fit is not to be trusted; the message says why
void require_trust(const IdentifiedModel& model);
[[nodiscard]] io::JsonObject identified_json(const IdentifiedModel& model);

/// Magnitudes of the responses, at most 24 of them, measured, fitted and what is left.
void draw_fit(const IdentifiedModel& model, const std::filesystem::path& png);
void draw_stabilisation(const IdentifiedModel& model, const std::filesystem::path& png);

/// identified.json, identified.mat (state space), identified_shapes.csv, fit.png and, where it was
/// asked for, stabilisation.png
void leave_identification(const Study& study, const IdentifiedModel& model, Run& run,
                          bool main_result);

}  // namespace chladni::app
