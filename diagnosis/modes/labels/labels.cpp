#include "diagnosis/modes/labels/labels.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include "base/index.h"
#include "diagnosis/modes/labels/label_orders.h"
#include "diagnosis/modes/modes_fit.h"
#include "diagnosis/modes/modes_verdict.h"
#include "diagnosis/modes/search/modes_search.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;

constexpr Index kFewest = 3;       // labels of a permutation; two are a swap
constexpr Index kFewestModes = 3;  // fewer shapes are alike in some order of their labels

// One side of measured modes: what to relabel, and what a person reads.
struct LabelSide {
  std::string effect, noun;
  Eigen::MatrixXcd MeasuredModes::*shapes;
  Eigen::MatrixXd MeasuredModes::*std;
  Eigen::MatrixXd RecordedModes::*model;
  std::vector<std::string> MeasuredModes::*names;
};

std::vector<LabelSide> sides() {
  return {{"permuted_sensors", "sensor", &MeasuredModes::output_shapes, &MeasuredModes::output_std,
           &RecordedModes::outputs, &MeasuredModes::outputs},
          {"permuted_actuators", "actuator", &MeasuredModes::input_shapes,
           &MeasuredModes::input_std, &RecordedModes::inputs, &MeasuredModes::inputs}};
}

// Each record in the row of the channel that it shows, turned where the order says so.
void relabel(const MeasuredModes& from, const LabelSide& side, const LabelOrder& order, bool turned,
             MeasuredModes& to) {
  for (std::size_t i = 0; i < order.channel_of.size(); ++i) {
    const Index channel = order.channel_of[i];
    const auto row = static_cast<Index>(i);
    const double sign = turned ? order.sign[i] : 1.0;
    (to.*side.shapes).row(channel) = sign * (from.*side.shapes).row(row);
    (to.*side.std).row(channel) = (from.*side.std).row(row);
  }
}

bool stays(const LabelOrder& order, std::size_t record) {
  return order.channel_of[record] == static_cast<Index>(record);
}

struct Judged {
  LabelOrder order;
  double log_evidence = 0.0;  // of the structure as it is
  double weight = 0.0;        // ln, with the priors
  bool is_believed = true;    // false: the error of the shapes is at its limit
};

// The evidence of orders of one side.
class Judge {
 public:
  Judge(const Structure& structure, const MeasuredModes& measured, const LabelSide& side,
        const DiagnosisOptions& options)
      : measured_(measured),
        side_(side),
        relabelled_(measured),
        problem_(structure, relabelled_, options.tolerances, options.levels == Levels::learned) {}

  [[nodiscard]] LabelScene scene() const {
    const auto model = problem_.modes(state_of(problem_.structure()), false);
    if (!model) return {};
    return {measured_.frequency_hz, model->frequency_hz, measured_.*side_.shapes,
            (*model).*side_.model};
  }

  // The order, once.
  void look_at(LabelOrder order) {
    for (const auto& known : all_) {
      if (known.order.channel_of == order.channel_of) return;
    }
    relabel(measured_, side_, order, true, relabelled_);
    const auto fit = problem_.nothing();
    const double evidence = fit.log_evidence;
    const auto turned = static_cast<double>(std::ranges::count(order.sign, -1.0));
    const double prior = log_prior(order) - kConstants.turned_record * turned;
    all_.push_back({std::move(order), evidence, evidence + prior,
                    !is_at_limit(problem_, fit, ErrorClass::shape)});
  }

  // Every order that differs from the best one by two labels, one of them moved, until none is
  // better.
  void look_around() {
    for (std::size_t best = best_index(), last = all_.size(); best != last;) {
      last = best;
      const LabelOrder from = all_[best].order;
      const auto n = from.channel_of.size();
      for (std::size_t a = 0; a < n; ++a) {
        for (std::size_t b = a + 1; b < n; ++b) {
          if (stays(from, a) && stays(from, b)) continue;  // swapped_sensors looks at these
          LabelOrder other = from;
          std::swap(other.channel_of[a], other.channel_of[b]);
          look_at(std::move(other));
        }
      }
      best = best_index();
    }
  }

  [[nodiscard]] const Judged& best() const { return all_[best_index()]; }
  [[nodiscard]] const Judged& as_they_are() const { return all_.front(); }
  // The probability of the best order among all that were looked at.
  [[nodiscard]] double probability() const {
    double sum = 0.0;
    for (const auto& one : all_) sum += std::exp(one.weight - best().weight);
    return 1.0 / sum;
  }

 private:
  [[nodiscard]] std::size_t best_index() const {
    const auto best = std::ranges::max_element(all_, {}, &Judged::weight);
    return static_cast<std::size_t>(best - all_.begin());
  }

  const MeasuredModes& measured_;
  const LabelSide& side_;
  MeasuredModes relabelled_;  // what `problem_` looks at
  ModesProblem problem_;
  std::vector<Judged> all_;  // the labels as they are come first
};

Cause cause_of(const Judge& judge, const LabelSide& side, const std::vector<std::string>& names) {
  Cause cause;
  cause.effect = side.effect;
  const auto& order = judge.best().order.channel_of;
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (order[i] == static_cast<Index>(i)) continue;
    cause.channels.push_back(names[i]);
    cause.truly.push_back(names[at(order[i])]);
    cause.option += fmt::format("{}record {} is {} {}", cause.option.empty() ? "" : ", ", names[i],
                                side.noun, names[at(order[i])]);
  }
  cause.log_evidence_gain = judge.best().log_evidence - judge.as_they_are().log_evidence;
  cause.probability = judge.probability();
  return cause;
}

bool is_sought(const DiagnosisOptions& options, const std::string& effect) {
  return options.most_causes > 0 &&
         (options.only.empty() || std::ranges::find(options.only, effect) != options.only.end());
}

// Puts the labels of one side right.
void put_right(const Structure& structure, const LabelSide& side, const DiagnosisOptions& options,
               Labels& labels) {
  const MeasuredModes measured = labels.measured;
  const auto& names = measured.*side.names;
  const bool has_few = std::ssize(names) < kFewest || measured.count() < kFewestModes;
  if (has_few || !is_sought(options, side.effect)) return;
  Judge judge(structure, measured, side, options);
  const auto scene = judge.scene();
  if (scene.model_hz.size() == 0) return;
  auto orders = label_orders(scene);
  if (orders.size() < 2) return;
  for (auto& order : orders) judge.look_at(std::move(order));
  judge.look_around();
  const double gain = judge.best().weight - judge.as_they_are().weight;
  const auto& best = judge.best().order;
  if (moved_count(best) < kFewest || gain < options.least_evidence) return;
  if (!judge.best().is_believed) {
    labels.notes.push_back(fmt::format(
        "the shapes fit the model in no order of the labels of {}s: none is put right", side.noun));
    return;
  }
  if (judge.probability() < kConstants.sure) {
    labels.notes.push_back(fmt::format(
        "labels of {}s are mixed, but these modes do not tell which record is which {}: the best "
        "of several orders has the probability {:.2f}",
        side.noun, side.noun, judge.probability()));
    return;
  }
  relabel(measured, side, best, false, labels.measured);
  labels.causes.push_back(cause_of(judge, side, names));
  labels.log_evidence += labels.causes.back().log_evidence_gain;
}

// The structure as it is beside the labels as they are.
void tell_before(const Structure& structure, const MeasuredModes& measured,
                 const DiagnosisOptions& options, Labels& labels) {
  const ModesProblem problem(structure, measured, options.tolerances,
                             options.levels == Levels::learned);
  ModesFound found;
  found.nothing = problem.nothing();
  const auto told = answer(problem, found, options);
  labels.levels_before = told.levels_before;
  labels.modes_before = told.modes;
}

// The verdict of relabelled data, beside labels that are sure. A level at its limit leaves nothing
// believed; a mode or a channel that is not believed leaves the labels sure.
Verdict with_labels(const Diagnosis& diagnosis) {
  switch (diagnosis.verdict) {
    case Verdict::no_discrepancy:
    case Verdict::named:
      return Verdict::named;
    case Verdict::unexplained:
      return diagnosis.superclass ? Verdict::partial : Verdict::unexplained;
    case Verdict::ambiguous:
    case Verdict::partial:
      break;
  }
  return Verdict::partial;
}

// True for what acts on the record of a channel. A place, a direction, crosstalk and an exchange
// are of the channels themselves: they act before the labels are mixed.
bool is_of_record(std::string_view effect) {
  return !effect.ends_with("_position") && !effect.ends_with("_direction") &&
         !effect.ends_with("_crosstalk") && !effect.starts_with("swapped_");
}

// Relabelled data have each record in the row of the channel that it shows. A cause of a record
// gets the label that the record really carries. Causes of all records stay in the order of the
// channels.
void name_records(const Cause& mixed, Cause& cause) {
  const bool is_other_side =
      cause.effect.starts_with("actuator_") != (mixed.effect == "permuted_actuators");
  if (is_other_side || !is_of_record(cause.effect)) return;
  auto records = cause.channels;
  for (auto& name : records) {
    const auto shown = std::ranges::find(mixed.truly, name);
    if (shown != mixed.truly.end()) name = mixed.channels[at(shown - mixed.truly.begin())];
  }
  if (!std::ranges::is_permutation(records, cause.channels)) cause.channels = std::move(records);
}

}  // namespace

Labels labels_of(const Structure& structure, const MeasuredModes& measured,
                 const DiagnosisOptions& options) {
  Labels labels;
  labels.measured = measured;
  for (const auto& side : sides()) put_right(structure, side, options, labels);
  if (!labels.causes.empty()) tell_before(structure, measured, options, labels);
  return labels;
}

void add(const Labels& labels, Diagnosis& diagnosis) {
  diagnosis.notes.insert(diagnosis.notes.end(), labels.notes.begin(), labels.notes.end());
  if (labels.causes.empty()) return;
  const auto add_to = [&](Explanation& one) {
    one.log_evidence += labels.log_evidence;
    for (auto& cause : one.causes) {
      cause.share = std::clamp(cause.log_evidence_gain / one.log_evidence, 0.0, 1.0);
      for (const auto& mixed : labels.causes) name_records(mixed, cause);
    }
    for (auto cause : labels.causes) {
      cause.share = std::clamp(cause.log_evidence_gain / one.log_evidence, 0.0, 1.0);
      one.causes.push_back(std::move(cause));
    }
  };
  diagnosis.verdict = with_labels(diagnosis);
  add_to(diagnosis.best);
  for (auto& rival : diagnosis.rivals) add_to(rival);
  diagnosis.levels_before = labels.levels_before;
  for (std::size_t i = 0; i < diagnosis.modes.size(); ++i) {
    diagnosis.modes[i].before_hz = labels.modes_before[i].before_hz;
    diagnosis.modes[i].mac_before = labels.modes_before[i].mac_before;
  }
}

}  // namespace chladni::diagnosis
