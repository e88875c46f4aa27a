#include "real_rigs_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <map>
#include <sstream>

#include "base/error.h"

namespace chladni {
namespace {

using simulators::RigVerdict;

std::vector<std::string> parts(const std::string& text) {
  std::vector<std::string> all;
  std::stringstream words(text);
  for (std::string word; std::getline(words, word, ',');) all.push_back(word);
  return all;
}

void read_seeds(const std::string& text, RealArguments& all) {
  const auto dots = text.find("..");
  all.first = static_cast<unsigned>(std::stoul(text));
  all.last = dots == std::string::npos ? all.first
                                       : static_cast<unsigned>(std::stoul(text.substr(dots + 2)));
}

RealData data_named(const std::string& text) {
  if (text == "modes") return RealData::modes;
  if (text == "frf") return RealData::responses;
  require(text == "study", "--data is modes, frf or study");
  return RealData::study;
}

std::map<std::string, std::function<void(const std::string&)>> words(RealArguments& all) {
  const auto number = [](double& into) {
    return [&into](const std::string& text) { into = std::stod(text); };
  };
  return {{"--body",
           [&all](const std::string& text) {
             all.bodies = text == "all" ? "table,strip,disc,ell" : text;
           }},
          {"--kinds", [&all](const std::string& text) { all.kinds = text; }},
          {"--seeds", [&all](const std::string& text) { read_seeds(text, all); }},
          {"--data",
           [&all](const std::string& text) {
             all.data = data_named(text);
           }},
          {"--edge", number(all.edge_length)},
          {"--nature", number(all.options.nature)},
          {"--frequency-error", number(all.options.frequency_error)},
          {"--shape-error", number(all.options.shape_error)},
          {"--severity", number(all.options.severity)},
          {"--frequency-noise", number(all.options.frequency_noise)},
          {"--shape-noise", number(all.options.shape_noise)},
          {"--mass", number(all.options.mass)}};
}

// The kinds of a word; for "pairs" another for each seed.
std::vector<std::string> kinds_of(const std::string& word, unsigned seed) {
  if (word == "all") return simulators::real_kinds();
  if (word == "outside") return simulators::real_outside_kinds();
  if (word == "pairs") return {simulators::real_pair(seed)};
  return {word};
}

// The cause to show: the surest false one where one is sure, else the surest true one, else the
// surest.
const simulators::Statement* shown(const simulators::RigScore& score) {
  const auto surest = [&](bool is_true) {
    const simulators::Statement* best = nullptr;
    for (const auto& one : score.statements) {
      if (one.is_true == is_true && (best == nullptr || one.probability > best->probability)) {
        best = &one;
      }
    }
    return best;
  };
  const auto* truth = surest(true);
  const auto* wrong = surest(false);
  return score.has_false_sure() || truth == nullptr ? wrong : truth;
}

std::string number(double value, const char* unit = "") {
  return std::isnan(value) ? "-" : fmt::format("{:.3g}{}", value, unit);
}

struct Totals {
  int cases = 0, failed = 0, clear = 0, clear_right = 0;
  simulators::Coverage sizes, places;
  std::array<int, 6> verdicts{};
  std::vector<double> place_errors, seconds;
};

bool is_clear(const RealDone& one) {
  return !one.score.effects.empty() && one.clear >= simulators::kClear;
}

void add(simulators::Coverage& sum, const simulators::Coverage& one) {
  sum.count += one.count;
  sum.good += one.good;
}

double median(std::vector<double> values) {
  if (values.empty()) return NAN;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

void add(Totals& sum, const RealDone& one) {
  ++sum.cases;
  sum.seconds.push_back(one.seconds);
  sum.clear += is_clear(one) ? 1 : 0;
  if (!one.failure.empty()) {
    ++sum.failed;
    return;
  }
  const auto verdict = one.score.verdict;
  ++sum.verdicts[static_cast<std::size_t>(verdict)];
  const bool is_right = verdict == RigVerdict::right || verdict == RigVerdict::as_class;
  sum.clear_right += is_clear(one) && is_right ? 1 : 0;
  if (const double place = one.score.place_error(); !std::isnan(place)) {
    sum.place_errors.push_back(place);
  }
  add(sum.sizes, one.score.sizes());
  add(sum.places, one.score.places());
}

void print_row(const std::string& name, const Totals& sum) {
  fmt::print("{:<28} {:>5}", name, sum.cases);
  for (const int count : sum.verdicts) fmt::print(" {:>10}", count);
  const auto part = [](int good, int count) { return fmt::format("{}/{}", good, count); };
  fmt::print(" {:>6} {:>9} {:>9} {:>9} {:>9} {:>7}\n", sum.failed, part(sum.clear_right, sum.clear),
             number(1e3 * median(sum.place_errors), " mm"), part(sum.sizes.good, sum.sizes.count),
             part(sum.places.good, sum.places.count), number(median(sum.seconds)));
}

void print_reliability(const std::vector<RealDone>& all) {
  constexpr std::array<double, 6> kEdges{0.0, 0.2, 0.5, 0.8, 0.95, 1.0 + 1e-12};
  fmt::print("\nprobability   statements   true   stated\n");
  for (std::size_t b = 0; b + 1 < kEdges.size(); ++b) {
    int count = 0;
    int correct = 0;
    double stated = 0.0;
    for (const auto& done : all) {
      for (const auto& one : done.score.statements) {
        if (one.probability < kEdges[b] || one.probability >= kEdges[b + 1]) continue;
        ++count;
        correct += one.is_true ? 1 : 0;
        stated += one.probability;
      }
    }
    fmt::print("{:.2f} to {:.2f}  {:>10}   {:>4}   {:>6}\n", kEdges[b], kEdges[b + 1], count,
               count > 0 ? fmt::format("{:.2f}", static_cast<double>(correct) / count) : "-",
               count > 0 ? fmt::format("{:.2f}", stated / count) : "-");
  }
}

}  // namespace

RealArguments real_arguments(int count, char** values) {
  RealArguments all;
  const auto known = words(all);
  for (int i = 1; i < count; ++i) {
    const std::string word = values[i];
    if (word == "--truth") {
      all.truth = true;
      continue;
    }
    if (word == "--truth-fit") {
      all.truth_fit = true;
      continue;
    }
    if (word == "--rivals") {
      all.rivals = true;
      continue;
    }
    if (word == "--reference") {
      all.reference = all.options.errors_of_body = true;
      continue;
    }
    if (word == "--unscaled") {
      all.options.scaled = false;
      continue;
    }
    const auto found = known.find(word);
    require(found != known.end(), fmt::format("'{}' is not known here; see --help", word));
    require(i + 1 < count, fmt::format("{} needs a value", word));
    found->second(values[++i]);
  }
  return all;
}

std::vector<RealTrial> real_trials(const RealArguments& wanted) {
  std::vector<RealTrial> all;
  for (const auto& body : parts(wanted.bodies)) {
    for (const auto& word : parts(wanted.kinds)) {
      for (unsigned seed = wanted.first; seed <= wanted.last; ++seed) {
        for (const auto& kind : kinds_of(word, seed)) {
          all.push_back({body, word == "pairs" ? word : kind, kind, seed});
        }
      }
    }
  }
  return all;
}

void print_truth(const RealTrial& trial, const simulators::RealRigCase& rig) {
  fmt::print("{:>5} {:<6} {:<18} clear {:>5.2f}, {} modes", trial.seed, trial.body, trial.kind,
             rig.clear, rig.modes.count());
  for (const auto& effect : rig.truth) {
    for (const auto& channel : effect.channels) fmt::print(" {}", channel);
    for (const auto& [name, value] : effect.size) fmt::print(" {}={:.4g}", name, value);
    if (effect.place) fmt::print(" at {:.3f}, {:.3f} m", effect.place->x(), effect.place->y());
  }
  for (const auto& one : rig.present) {
    fmt::print(" [string {:.3g} g, {:.4g} Hz]", 1e3 * one.size.at("mass"),
               one.size.at("frequency"));
  }
  fmt::print("\n");
}

void print_case(const RealDone& done) {
  const auto* cause = shown(done.score);
  const std::string verdict =
      done.failure.empty() ? std::string(simulators::name(done.score.verdict)) : "failed";
  const std::string told = !done.failure.empty() ? done.failure
                           : cause == nullptr    ? done.score.told
                                                 : cause->cause;
  fmt::print("{:>5} {:<6} {:<30} {:<10} {:<11} {:<28} {:>5} {:>9} {:>6} {:>6.2f} {:<6} {:>6.1f}\n",
             done.trial.seed, done.trial.body, done.trial.kind, verdict, done.score.told, told,
             cause == nullptr ? "-" : fmt::format("{:.3f}", cause->probability),
             number(1e3 * done.score.place_error(), " mm"), number(done.score.worst_z()),
             done.clear, is_clear(done) ? "clear" : "-", done.seconds);
  std::fflush(stdout);
}

void print_steps(const hidden_effects::ShippedAnswer& told) {
  fmt::print("        responses off by {:.1f} %, after {:.1f} %;", 100.0 * told.gain.fit_before,
             100.0 * told.gain.fit_after);
  for (const auto& [name, seconds] : told.steps) {
    if (seconds > 0.1) fmt::print(" {} {:.1f} s", name, seconds);
  }
  fmt::print("\n");
  for (const auto& mode : told.result.modes) {
    fmt::print("        {:.2f} +- {:.2g} Hz; {:.2f}, MAC {:.3f}; {:.2f}, MAC {:.3f}\n",
               mode.measured_hz, mode.measured_std_hz, mode.before_hz, mode.mac_before,
               mode.after_hz, mode.mac_after);
  }
  for (const auto& note : told.result.notes) fmt::print("        note: {}\n", note);
}

void print_rivals(const diagnosis::Diagnosis& told) {
  constexpr std::size_t kMost = 6;
  const auto print = [](const diagnosis::Explanation& one) {
    fmt::print("        {:.3f} ln {:>6.1f}", one.probability, one.log_evidence);
    for (const auto& cause : one.causes) {
      fmt::print("; {} {:.3f}", cause.effect, cause.probability);
      for (const auto& channel : cause.channels) fmt::print(" {}", channel);
      for (const auto& n : cause.parameters)
        fmt::print(" {}={:.3g}~{:.2g}", n.name, n.value, n.std);
    }
    fmt::print("\n");
  };
  print(told.best);
  for (std::size_t i = 0; i < std::min(kMost, told.rivals.size()); ++i) print(told.rivals[i]);
  fmt::print("        levels");
  for (const auto& level : told.levels_after) fmt::print(" {} {:.3g}", level.of, level.value);
  fmt::print("\n");
}

void print_totals(const std::vector<RealDone>& all) {
  std::map<std::string, Totals> rows, bodies, kinds;
  Totals sum;
  for (const auto& one : all) {
    add(rows[one.trial.body + " " + one.trial.group], one);
    add(bodies["all of " + one.trial.body], one);
    add(kinds["all of " + one.trial.group], one);
    add(sum, one);
  }
  fmt::print(
      "\n{:<28} {:>5} {:>10} {:>10} {:>10} {:>10} {:>10} {:>10} {:>6} {:>9} {:>9} {:>9} {:>9} "
      "{:>7}\n",
      "body kind", "cases", "right", "class", "half", "phantom", "wrong-sure", "missed", "failed",
      "of clear", "place", "size<2sd", "place<2sd", "seconds");
  for (const auto* some : {&rows, &bodies, &kinds}) {
    for (const auto& [name, row] : *some) print_row(name, row);
  }
  print_row("all", sum);
  print_reliability(all);
}

}  // namespace chladni
