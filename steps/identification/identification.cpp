#include "steps/identification.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/error.h"
#include "base/interrupt.h"
#include "base/turn.h"
#include "identification/constants.h"
#include "identification/delay_scan.h"
#include "identification/matrix_fraction.h"
#include "identification/model_error.h"
#include "recordings/hammer.h"
#include "steps/identification/identification_gains.h"
#include "steps/identification/unseen.h"

namespace chladni::steps {
namespace {

identification::FitDataOptions data_options(const study::IdentificationPlan& plan,
                                            const modal::FrfSet& set) {
  identification::FitDataOptions options{.low_hz = plan.low_hz, .high_hz = plan.high_hz};
  if (plan.weighting == "inverse_magnitude") {
    options.weighting = identification::Weighting::inverse_magnitude;
  }
  options.cut_off_db = plan.cut_off_db;
  options.clip_db = plan.clip_db;
  options.model_error = plan.model_error.value_or(set.variance.empty() ? kAssumedModelError : 0.0);
  return options;
}

identification::DelayOf delay_of(const study::IdentificationPlan& plan) {
  if (plan.delay_of == "sensors") return identification::DelayOf::outputs;
  if (plan.delay_of == "actuators") return identification::DelayOf::inputs;
  return identification::DelayOf::all;
}

identification::IdentificationOptions fit_options(const study::IdentificationPlan& plan,
                                                  const study::Study& study, stage::Work& work) {
  identification::IdentificationOptions options;
  options.modes = plan.modes;
  options.rigid_count = plan.rigid_body_modes;
  if (plan.rigid_body_modes < 0) take_support(study, options);
  if (plan.damping == "general") options.fit.damping = identification::Damping::general;
  options.fit.delay = plan.delay;
  options.fit.delay_of = delay_of(plan);
  options.fit.residual = plan.residual;
  options.fit.keep_best = work.choices().keep_best;
  options.fit.progress = work.progress();
  return options;
}

void add_errors(IdentifiedModel& model) {
  const auto& data = model.data;
  const Eigen::MatrixXcd fitted = identification::responses(model.found.fit, data.frequency_hz);
  model.error.resize(data.outputs, data.inputs);
  model.noise.resize(data.outputs, data.inputs);
  for (Eigen::Index e = 0; e < data.response_count(); ++e) {
    const Eigen::ArrayXd measured = (data.weight.col(e).array() > 0.0).cast<double>();
    const double size = data.value.col(e).norm();
    const auto i = e % data.outputs;
    const auto j = e / data.outputs;
    const Eigen::ArrayXd wrong = (data.value.col(e) - fitted.col(e)).cwiseAbs().array() * measured;
    model.error(i, j) = wrong.matrix().norm() / size;
    model.noise(i, j) =
        data.weights_are_deviations
            ? (measured / data.weight.col(e).array().max(1e-300) * measured).matrix().norm() / size
            : std::nan("");
  }
  const auto& fit = model.found.fit;
  model.validation =
      identification::validation(data, fitted, fit.model.frequency_hz.tail(fit.flexible_count()));
}

}  // namespace

std::vector<Eigen::Index> modes_within(const IdentifiedModel& model) {
  const auto& beyond = model.judgement.beyond_lines;
  std::vector<Eigen::Index> modes;
  for (Eigen::Index m = 0; m < model.found.fit.model.mode_count(); ++m) {
    if (std::ranges::find(beyond, m) == beyond.end()) modes.push_back(m);
  }
  return modes;
}

bool is_held(const study::Study& study) {
  return !study.supports.empty() ||
         std::any_of(study.attachments.begin(), study.attachments.end(),
                     [](const auto& attachment) {
                       return std::holds_alternative<fem::GroundSpring>(attachment.what) ||
                              std::holds_alternative<fem::GroundTorsionSpring>(attachment.what);
                     });
}

void take_support(const study::Study& study, identification::IdentificationOptions& options) {
  if (!is_held(study)) return;
  options.rigid_count = 0;
  options.on_springs = study.supports.empty();
}

identification::FitData fit_data_of(const study::Study& study, const IdentifiedModel& model,
                                    const modal::FrfSet& set) {
  return identification::fit_data(set, data_options(identification_plan(study), model.seen));
}

identification::FitData reweighted_data(const study::Study& study, const IdentifiedModel& model,
                                        identification::FitData data,
                                        const Eigen::MatrixXcd& fitted) {
  const auto plan = identification_plan(study);
  if (plan.weighting != "variance") return data;
  return identification::reweighted(data, fitted, data_options(plan, model.seen));
}

namespace {

identification::Identified found(const study::IdentificationPlan& plan, const study::Study& study,
                                 const identification::FitData& data, stage::Work& work) {
  const auto options = fit_options(plan, study, work);
  if (plan.method != "thesis") return identification::identified(data, options);
  require(plan.modes > 0, study.file.string() +
                              ": the thesis' path does not find the number of modes; expected "
                              "identification.modes");
  identification::ThesisOptions thesis{.modes = plan.modes};
  thesis.rigid_count = std::max<Eigen::Index>(0, options.rigid_count);
  thesis.residual = plan.residual;
  thesis.degree = plan.fraction_degree;
  thesis.sanathanan_koerner = plan.sanathanan_koerner;
  thesis.levenberg_marquardt = plan.levenberg_marquardt;
  thesis.modal_iterations = plan.modal_iterations;
  thesis.progress = options.fit.progress;
  // Delays are compensated before the fit (4.1).
  const auto delays = identification::delays_at_start(data, options);
  identification::Identified result;
  const auto undelayed = identification::undelayed(data, delays);
  result.fit = identification::thesis_fit(undelayed, thesis);
  if (plan.delay) {
    auto free = options.fit;
    free.iterations = plan.modal_iterations;
    free.damping = result.fit.damping();
    identification::free_delay(undelayed, free, result.fit);
    identification::put_back(delays, options.fit.delay_of, result.fit);
  }
  return result;
}

// The data in the form that the fit uses: without drift.
void take_out_drift(IdentifiedModel& model) {
  if (!model.found.drift) return;
  const auto& shift = model.found.drift->shift;
  model.data = identification::without_drift(model.data, model.found.fit, shift);
  if (model.drift.size() == 0) model.drift.setZero(shift.size());
  model.drift += shift;
}

// True if a closer fit is possible. The stated model error of a study is an upper limit. When its
// modes are known, the data show the actual error, and the fit may be as close as that.
bool may_come_nearer(const study::IdentificationPlan& plan, const IdentifiedModel& model) {
  const auto& fit = model.found.fit;
  const bool single = std::none_of(fit.groups.begin(), fit.groups.end(),
                                   [](const auto& group) { return group.size > 1; });
  return !model.seen.variance.empty() && plan.weighting == "variance" && plan.method != "thesis" &&
         plan.damping == "modal" && plan.model_error.value_or(0.0) > 0.0 && single &&
         model.data.response_count() <= identification::Constants::many_responses && fit.converged;
}

// Fits again with the model error that the data show. Model errors are correlated along the lines
// and do not average out like noise. So the deviations stay those of the first fit. The delays stay
// too, because phases of complex modes could look like delays.
void come_nearer(const study::IdentificationPlan& plan, const study::Study& study,
                 IdentifiedModel& model, stage::Work& work) {
  constexpr int kRounds = 2;
  auto how = fit_options(plan, study, work).fit;
  how.delay = false;
  auto noise_only = data_options(plan, model.seen);
  noise_only.model_error = 0.0;
  const auto delays = identification::response_delays(model.found.fit);
  const auto data =
      identification::undelayed(identification::fit_data(model.seen, noise_only), delays);
  auto fit = model.found.fit;
  for (int round = 0; round < kRounds; ++round) {
    fit.delay_s = 0.0;
    fit.channel_delay_s.resize(0);
    const Eigen::MatrixXcd fitted = identification::responses(fit, data.frequency_hz);
    model.model_error = identification::remaining_model_error(data, fitted, *plan.model_error);
    fit = identification::refitted(
        identification::with_model_error(data, fitted, model.model_error), fit, how);
  }
  identification::take_values(fit, model.found.fit);
}

// Judges the fit, also by the same method without outlying values. The thesis' method cannot search
// for modes, so it has no second fit.
identification::Judgement judged(const study::IdentificationPlan& plan, const study::Study& study,
                                 const IdentifiedModel& model, stage::Work& work) {
  std::optional<identification::IdentificationOptions> again;
  if (plan.method != "thesis") again = fit_options(plan, study, work);
  return identification::judged(model.found, model.data, again);
}

std::string drift_warning(const IdentifiedModel& model) {
  const auto name = [&](Eigen::Index e) {
    return model.seen.outputs[static_cast<std::size_t>(e % model.data.outputs)].name + "/" +
           model.seen.inputs[static_cast<std::size_t>(e / model.data.outputs)].name;
  };
  Eigen::Index low = 0;
  Eigen::Index high = 0;
  const double least = model.drift.minCoeff(&low);
  const double most = model.drift.maxCoeff(&high);
  return fmt::format(
      "the resonances of {} lie {:.0f} millionths of their frequency above those of {}: the "
      "structure changed between the measurements; the responses are fitted as if it had not",
      name(high), 1e6 * (most - least), name(low));
}

// The modes without the decay of an exponential window, and the data as they would be without it:
// what the fit left of them stays. Residues do not change (recordings/hammer.h). Deviations of
// damping ratios go with the frequency.
void take_off_window(IdentifiedModel& model) {
  const double added = model.measured.added_decay;
  if (added == 0.0) return;
  auto& fit = model.found.fit;
  require(!fit.complex && fit.model.rigid_count == 0,
          model.measured.file +
              ": an exponential window beside general damping or modes at 0 Hz; expected longer "
              "records, or damping = \"modal\" and rigid_body_modes = 0");
  const Eigen::MatrixXcd windowed = identification::responses(fit, model.data.frequency_hz);
  const auto poles = recordings::true_poles(identification::start_at(fit.model).pole, added);
  for (Eigen::Index k = 0; k < poles.size(); ++k) {
    const double before = fit.model.frequency_hz(k);
    fit.model.frequency_hz(k) = std::abs(poles(k)) / kTwoPi;
    fit.model.damping_ratio(k) = -poles(k).real() / std::abs(poles(k));
    const double scale = before / fit.model.frequency_hz(k);
    fit.damping_std(k) *= scale;
    auto& covariance = fit.mode_covariance[static_cast<std::size_t>(k)];
    covariance.row(1) *= scale;
    covariance.col(1) *= scale;
  }
  model.data.value += identification::responses(fit, model.data.frequency_hz) - windowed;
}

double cost(const identification::FitData& data, const identification::ModalFit& fit) {
  const Eigen::MatrixXcd fitted = identification::responses(fit, data.frequency_hz);
  return ((data.value - fitted).cwiseAbs2().array() * data.weight.array().square()).sum();
}

// Fits the data with other weights. It starts at poles anew, since more modes may show; where it
// then misses the modes that are known it starts at these.
void fit_again(const study::IdentificationPlan& plan, const study::Study& study,
               IdentifiedModel& model, stage::Work& work) {
  auto again = work.timed("fit again", [&] { return found(plan, study, model.data, work); });
  const bool is_lost =
      plan.method != "thesis" && again.fit.cost > cost(model.data, model.found.fit);
  if (is_lost) {
    again.fit =
        identification::refitted(model.data, model.found.fit, fit_options(plan, study, work).fit);
  }
  model.found = std::move(again);
}

// The fit of the study's responses, as close as their noise and the study's model error allow.
IdentifiedModel fitted_model(const study::IdentificationPlan& plan, const study::Study& study,
                             stage::Work& work) {
  IdentifiedModel model;
  model.measured =
      work.timed("read", [&] { return measured_frfs(study, work, plan.cross_validation); });
  model.seen = modal::part(model.measured.all, model.measured.outputs, model.measured.inputs);
  model.data = identification::fit_data(model.seen, data_options(plan, model.seen));
  model.second_record = read_second_record(study, model, work);
  model.found = work.timed("fit", [&] { return found(plan, study, model.data, work); });
  take_out_drift(model);
  const auto stopped = [&] { return work.choices().keep_best && interrupted(); };
  if (!stopped() && may_come_nearer(plan, model)) {
    come_nearer(plan, study, model, work);
  } else if (!stopped() && model.seen.variance.empty() && plan.weighting == "variance") {
    // The noise is known better when the resonances are known.
    model.data = identification::reweighted(
        model.data, identification::responses(model.found.fit, model.data.frequency_hz),
        data_options(plan, model.seen));
    fit_again(plan, study, model, work);
    take_out_drift(model);
  }
  if (stopped()) {
    forget_interrupt();
    work.warn("the fit was stopped by Ctrl-C: its best so far is written");
  }
  take_off_window(model);
  return model;
}

// Predicts what the fit has not seen: parts of its recordings in turn, and the second record.
void look_at_unseen(const study::IdentificationPlan& plan, const study::Study& study,
                    IdentifiedModel& model, stage::Work& work) {
  const Refit refit = [&](const identification::FitData& data) {
    if (plan.method == "thesis") return found(plan, study, data, work).fit;
    return identification::refitted(data, model.found.fit, fit_options(plan, study, work).fit);
  };
  if (!model.measured.folds.folds.empty()) {
    model.cross_validation =
        work.timed("leave out in turn", [&] { return cross_validated(study, model, refit, work); });
    work.clear_progress();
  }
  score_second_record(study, model);
}

}  // namespace

IdentifiedModel identified(const study::Study& study, const stage::Solution* solution,
                           stage::Work& work) {
  const auto plan = identification_plan(study);
  auto model = fitted_model(plan, study, work);
  work.clear_progress();
  if (model.drift.size() > 0) work.warn(drift_warning(model));
  for (const auto& note : model.found.fit.notes) work.warn(note);
  static_cast<identification::ChannelGains&>(model) =
      work.timed("gains", [&] { return gains_of(study, solution, model, work); });
  for (const auto& warning : model.match.warnings) work.warn(warning);
  add_errors(model);
  model.judgement = work.timed("judge", [&] { return judged(plan, study, model, work); });
  look_at_unseen(plan, study, model, work);
  if (plan.stabilisation > 0) {
    model.stabilisation = work.timed("stabilisation", [&] {
      const auto data =
          identification::undelayed(model.data, identification::response_delays(model.found.fit));
      return identification::stabilisation(data, plan.stabilisation,
                                           model.found.fit.model.rigid_count > 0, work.progress());
    });
  }
  return model;
}

double overall_error(const IdentifiedModel& model) {
  const auto& data = model.data;
  const Eigen::MatrixXcd fitted = identification::responses(model.found.fit, data.frequency_hz);
  const Eigen::ArrayXXd measured = (data.weight.array() > 0.0).cast<double>();
  return ((data.value - fitted).array().abs() * measured).matrix().norm() / data.value.norm();
}

double noise(const IdentifiedModel& model) {
  return identification::noise_of(model.data) / model.data.value.norm();
}

void require_trust(const IdentifiedModel& model) {
  const auto& judgement = model.judgement;
  if (judgement.trust != identification::Trust::none) return;
  std::string text = "the identified model is not to be trusted, though the results are written";
  for (const auto& reason : judgement.reasons) text += "; " + reason;
  throw NumericalFailure(text +
                         ". See \"trust\" in identified.json; look at fit.png, at the "
                         "lines named measured and at identification.band");
}

}  // namespace chladni::steps
