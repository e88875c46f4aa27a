#include "steps/identification/unseen.h"

#include <fmt/format.h>

#include <cmath>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/interrupt.h"
#include "base/turn.h"
#include "recordings/hammer.h"

namespace chladni::steps {
namespace {

using identification::FitData;
using identification::ModalFit;

constexpr Eigen::Index kFewestLines = 9;

Eigen::VectorXd flexible_hz(const ModalFit& fit) {
  return fit.model.frequency_hz.tail(fit.flexible_count());
}

modal::FrfSet seen_part(const MeasuredFrfs& measured, const modal::FrfSet& set) {
  return modal::part(set, measured.outputs, measured.inputs);
}

std::vector<identification::PredictedPart> predicted_parts(const study::Study& study,
                                                           const IdentifiedModel& model,
                                                           const Refit& refit, stage::Work& work) {
  std::vector<identification::PredictedPart> parts;
  for (const auto& fold : model.measured.folds.folds) {
    const auto rest = fit_data_of(study, model, seen_part(model.measured, fold.rest));
    const auto fit = refit(rest);
    if (work.choices().keep_best && interrupted()) return {};
    auto data = fit_data_of(study, model, seen_part(model.measured, fold.left_out));
    Eigen::MatrixXcd predicted = identification::responses(fit, data.frequency_hz);
    const double fit_error = identification::fit_error_over_noise(data, rest, fit);
    parts.push_back({fold.name, std::move(data), std::move(predicted), fit_error});
  }
  return parts;
}

std::vector<Eigen::Index> places_of(const std::vector<modal::MeasuredChannel>& wanted,
                                    const std::vector<modal::MeasuredChannel>& there,
                                    const std::string& file, const IdentifiedModel& model) {
  std::vector<Eigen::Index> places;
  for (const auto& channel : wanted) {
    places.push_back(index_of(there, channel.name));
    require(places.back() >= 0,
            fmt::format("{}: the channel \"{}\" is not in it; expected every channel of {}, of "
                        "whose fit it is a validation",
                        file, channel.name, model.measured.file));
  }
  return places;
}

// A fit whose modes decay faster: what a window has done to the responses of a second record.
ModalFit with_decay(ModalFit fit, double added) {
  if (added == 0.0) return fit;
  const auto poles = recordings::true_poles(identification::start_at(fit.model).pole, -added);
  for (Eigen::Index k = 0; k < poles.size(); ++k) {
    fit.model.frequency_hz(k) = std::abs(poles(k)) / kTwoPi;
    fit.model.damping_ratio(k) = -poles(k).real() / std::abs(poles(k));
  }
  return fit;
}

// The second record's responses in the band of the fit.
modal::FrfSet in_band(const modal::FrfSet& set, const FitData& seen, const std::string& file) {
  const double low = seen.frequency_hz(0) * (1.0 - 1e-9);
  const double high = seen.frequency_hz.tail(1)(0) * (1.0 + 1e-9);
  const auto lines = (set.frequency_hz.array() >= low && set.frequency_hz.array() <= high).count();
  require(
      lines >= kFewestLines,
      fmt::format("{}: {} lines from {:.6g} to {:.6g} Hz, the band of the fit, and it has those "
                  "from {:.6g} to {:.6g} Hz; expected {} lines or more in that band",
                  file, lines, low, high, set.frequency_hz(0), set.frequency_hz.tail(1)(0),
                  kFewestLines));
  return modal::band(set, low, high);
}

// The study with the second record in the place of the first.
study::Study of_second(const study::Study& study) {
  auto second = study;
  auto& plan = *second.measurement;
  (plan.frf.empty() ? plan.time : plan.frf) = plan.validation;
  plan.validation.clear();
  return second;
}

FitData data_of(const study::Study& study, const IdentifiedModel& model,
                const SecondRecord& second) {
  try {
    return fit_data_of(study, model, second.set);
  } catch (const InvalidInput& error) {
    throw InvalidInput(second.file + ": " + error.what());
  }
}

// The responses that a second record has and the fit has not: what it says of them is a guess.
std::vector<Eigen::Index> untold_responses(const FitData& fitted, const FitData& second) {
  std::vector<Eigen::Index> untold;
  for (Eigen::Index e = 0; e < second.response_count(); ++e) {
    const bool is_new = fitted.weight.col(e).isZero(0.0) && !second.weight.col(e).isZero(0.0);
    if (is_new) untold.push_back(e);
  }
  return untold;
}

void note_untold(const IdentifiedModel& model, const FitData& data, const std::string& file,
                 stage::Work& work) {
  const auto untold = untold_responses(model.data, data);
  if (untold.empty()) return;
  std::vector<std::string> names;
  for (const auto e : untold) {
    names.push_back(model.seen.outputs[static_cast<std::size_t>(e % data.outputs)].name + "/" +
                    model.seen.inputs[static_cast<std::size_t>(e / data.outputs)].name);
  }
  work.note(fmt::format("{}: responses that {} lacks are left out of its score: {}", file,
                        model.measured.file, fmt::join(names, ", ")));
}

std::nullopt_t without_parts(const std::exception& failure, stage::Work& work) {
  work.note(std::string("nothing is left out in turn: a fit without one part fails: ") +
            failure.what());
  return std::nullopt;
}

}  // namespace

std::optional<identification::CrossValidation> cross_validated(const study::Study& study,
                                                               const IdentifiedModel& model,
                                                               const Refit& refit,
                                                               stage::Work& work) {
  const auto& folds = model.measured.folds;
  if (folds.folds.empty()) return std::nullopt;
  try {
    const auto parts = predicted_parts(study, model, refit, work);
    if (parts.empty()) {
      forget_interrupt();
      work.warn("Ctrl-C: nothing is left out in turn");
      return std::nullopt;
    }
    return identification::cross_validation(folds.by, parts, flexible_hz(model.found.fit));
  } catch (const NumericalFailure& failure) {
    return without_parts(failure, work);
  } catch (const InvalidInput& failure) {  // of the data of one part, not of the study's
    return without_parts(failure, work);
  }
}

std::optional<SecondRecord> read_second_record(const study::Study& study,
                                               const IdentifiedModel& model, stage::Work& work) {
  if (study.measurement->validation.empty()) return std::nullopt;
  const auto measured = measured_frfs(of_second(study), work);
  const auto& file = measured.file;
  const auto set =
      modal::part(measured.all, places_of(model.seen.outputs, measured.all.outputs, file, model),
                  places_of(model.seen.inputs, measured.all.inputs, file, model));
  SecondRecord second{.file = file,
                      .set = in_band(set, model.data, file),
                      .added_decay = measured.added_decay,
                      .left = {}};
  note_untold(model, data_of(study, model, second), file, work);  // refuses what cannot be used
  return second;
}

void score_second_record(const study::Study& study, IdentifiedModel& model) {
  if (!model.second_record) return;
  auto& second = *model.second_record;
  auto data = data_of(study, model, second);
  for (const auto e : untold_responses(model.data, data)) {
    data.weight.col(e).setZero();
    data.value.col(e).setZero();
  }
  const auto fit = with_decay(model.found.fit, second.added_decay);
  const Eigen::MatrixXcd predicted = identification::responses(fit, data.frequency_hz);
  if (second.set.variance.empty()) data = reweighted_data(study, model, data, predicted);
  second.expected_level = 1.0 + identification::fit_error_over_noise(data, model.data, fit);
  second.noise_known = data.noise_known;
  second.freedom_known = data.freedom_known;
  second.left = identification::validation(data, predicted, flexible_hz(fit));
}

}  // namespace chladni::steps
