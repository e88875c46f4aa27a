// constants_study [--cases a,b] [--constants a,b]
// halves and doubles constants of a diagnosis (diagnosis/constants.h) and prints what changes in
// some hidden cases, as docs/reference/constants.md has it. A case is searched once. Constants that
// act later are changed after the search: those of the verdict after the last fits, those that drop
// causes before. Constants of the search are changed before it.
#include <fmt/format.h>

#include <cstdio>
#include <ctime>
#include <functional>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "base/error.h"
#include "dense/blas.h"
#include "diagnosis/constants.h"
#include "diagnosis/search/simpler.h"
#include "diagnosis/verdict/last_fits.h"
#include "diagnosis/verdict/prepared.h"
#include "diagnosis/verdict/verdict.h"
#include "simulators/hidden/hidden_effect.h"
#include "simulators/plates/ritz_structure.h"

namespace chladni {
namespace {

using namespace diagnosis;

struct Case {
  std::vector<std::string> kinds;
  unsigned seed = 0;
  double severity = 0.5;
  bool deviates = false;  ///< a table that deviates by default tolerances; else an exact model
};

const std::map<std::string, Case> kCases{
    {"nothing", {{}, 1}},
    {"gain", {{"sensor_gain"}, 3}},
    {"faint_gain", {{"sensor_gain"}, 3, 0.1}},
    {"mass", {{"point_mass"}, 3}},
    {"spring_and_gain", {{"ground_spring", "actuator_gain"}, 2}},
    {"notch", {{"sensor_notch"}, 3, 0.7}},
    {"three_masses", {{"point_mass", "point_mass", "point_mass"}, 4}},
    {"deviating", {{}, 7, 0.6, true}},
    {"deviating_mass", {{"point_mass"}, 7, 0.6, true}},
};

// A search in all effects takes a minute; in these a second.
const std::vector<std::string> kCatalogue{"point_mass",     "ground_spring", "youngs_modulus",
                                          "sensor_gain",    "actuator_gain", "sensor_delay",
                                          "sensor_position"};
constexpr int kDegree = 8;

/// The values that a diagnosis may have otherwise, beside kConstants.
struct Settings {
  DiagnosisOptions options;
  SearchLimits limits;
  double solver_error = 1.0;  ///< factor of Prepared::solver_error
};

enum class From { verdict, last_fits, search };

struct Change {
  From from = From::verdict;
  std::function<void(Settings&, double factor)> apply;
};

template <class T>
Change of_verdict(T Constants::*which) {
  return {From::verdict, [which](Settings&, double factor) { kConstants.*which *= factor; }};
}

template <class T>
Change of_limits(From from, T SearchLimits::*which) {
  return {from, [which](Settings& settings, double factor) {
            settings.limits.*which = static_cast<T>(settings.limits.*which * factor);
          }};
}

const std::map<std::string, Change> kChanges{
    {"one_cause_prior", of_verdict(&Constants::one_cause_prior)},
    {"further_cause_prior", of_verdict(&Constants::further_cause_prior)},
    {"outside_prior", of_verdict(&Constants::outside_prior)},
    {"outside_excess", of_verdict(&Constants::outside_excess)},
    {"believed", of_verdict(&Constants::believed)},
    {"left_at_most", of_verdict(&Constants::left_at_most)},
    {"beside_unnamed", of_verdict(&Constants::beside_unnamed)},
    {"weight_of_unnamed", of_verdict(&Constants::weight_of_unnamed)},
    {"extended_prior", of_verdict(&Constants::extended_prior)},
    {"rival_within",
     {From::last_fits,
      [](Settings& settings, double factor) { settings.options.rival_within *= factor; }}},
    {"cause_over_response",
     {From::last_fits, [](Settings& settings, double factor) { settings.solver_error *= factor; }}},
    {"least_evidence", of_limits(From::last_fits, &SearchLimits::least_evidence)},
    {"least_share", of_limits(From::last_fits, &SearchLimits::least_share)},
    {"least_excess", of_limits(From::last_fits, &SearchLimits::least_excess)},
    {"sure_evidence", of_limits(From::last_fits, &SearchLimits::sure_evidence)},
    {"fits_per_level", of_limits(From::search, &SearchLimits::fits_per_level)},
    {"lines_of_scene", of_limits(From::search, &SearchLimits::lines_of_scene)},
    {"beam", of_limits(From::search, &SearchLimits::beam)},
    {"beam_within", of_limits(From::search, &SearchLimits::beam_within)},
};

Structure structure_of(const Case& hidden) {
  simulators::RitzStructureOptions options;
  options.modes = 32;
  options.cells = 6;
  options.fine = 12;
  options.scan = 21;
  const int degree = hidden.deviates ? kDegree - 1 : kDegree;
  return simulators::ritz_structure(simulators::believed_table(degree),
                                    simulators::table_channels(), options);
}

modal::FrfSet measured_of(const Case& hidden) {
  simulators::HiddenOptions options;
  options.lines = 60;
  options.degree = kDegree;
  options.severity = hidden.severity;
  options.deviation = hidden.deviates ? 1.0 : 0.0;
  return simulators::hidden_case(hidden.kinds, hidden.seed, options).measured;
}

/// A case, its search and its last fits.
class Searched {
 public:
  explicit Searched(const Case& hidden) {
    settings_.options.tolerances = hidden.deviates ? Tolerances{} : exact_model();
    settings_.options.only = kCatalogue;
    given_ = prepared(structure_of(hidden), measured_of(hidden), settings_.options.tolerances);
    settings_.limits = limits_of(given_, settings_.options);
    fine_ = thinned(given_.observed, kConstants.last_fit_lines * settings_.options.lines);
    deviations_ = given_.all_deviations();
    last_ = last_fits(settings_);
    trimmed_ = trimmed(settings_, last_);
    told_ = told(settings_, trimmed_);
  }

  [[nodiscard]] const std::string& told() const { return told_; }

  /// What is told with the change.
  [[nodiscard]] std::string changed(const Change& change, double factor) const {
    const Constants before = kConstants;
    Settings settings = settings_;
    change.apply(settings, factor);
    std::string text;
    if (change.from == From::verdict) text = told(settings, trimmed_);
    if (change.from == From::last_fits) text = told(settings, trimmed(settings, last_));
    if (change.from == From::search) text = told(settings, trimmed(settings, last_fits(settings)));
    kConstants = before;
    return text;
  }

 private:
  [[nodiscard]] Problem problem(const Settings& settings) const {
    return {*given_.structure, fine_, deviations_, settings.solver_error * given_.solver_error};
  }

  [[nodiscard]] Found last_fits(const Settings& settings) const {
    const Observed coarse = given_.for_search(settings.options.lines);
    const double error = settings.solver_error * given_.solver_error;
    const Found first = searched({*given_.structure, coarse, given_.tolerable, error},
                                 catalogue_of(settings.options), settings.limits);
    return fitted_again(problem(settings), first);
  }

  [[nodiscard]] Found trimmed(const Settings& settings, Found found) const {
    trim(problem(settings), found, settings.limits, settings.options.rival_within);
    return found;
  }

  // "named: point_mass 0.99".
  [[nodiscard]] std::string told(const Settings& settings, const Found& found) const {
    const Problem problem = this->problem(settings);
    const auto all = explanations(problem, found, settings.options.rival_within);
    std::string text(name(judged(problem, found, all, settings.options)));
    for (const auto& cause : all.front().causes) {
      text += fmt::format(" {} {:.2f}", cause.effect, cause.probability);
    }
    return text;
  }

  Settings settings_;
  Prepared given_;
  Observed fine_;
  std::vector<Deviation> deviations_;
  Found last_, trimmed_;
  std::string told_;
};

std::vector<std::string> parts(const std::string& text) {
  std::vector<std::string> all;
  std::stringstream words(text);
  for (std::string word; std::getline(words, word, ',');) all.push_back(word);
  return all;
}

template <class Map>
std::vector<std::string> names_of(const Map& map) {
  std::vector<std::string> names;
  for (const auto& [name, value] : map) names.push_back(name);
  return names;
}

void study(const std::string& name, const std::vector<std::string>& constants) {
  const auto found = kCases.find(name);
  require(found != kCases.end(), fmt::format("no case '{}'", name));
  const Searched searched(found->second);
  fmt::print("{}: {}\n", name, searched.told());
  for (const auto& constant : constants) {
    const auto change = kChanges.find(constant);
    require(change != kChanges.end(), fmt::format("'{}' cannot be changed here", constant));
    for (const double factor : {0.5, 2.0}) {
      const auto text = searched.changed(change->second, factor);
      fmt::print("{} {} x{}: {}\n", name, constant, factor,
                 text == searched.told() ? "the same" : text);
      std::fflush(stdout);
    }
  }
  fmt::print("{}: {:.0f} s of CPU so far\n", name,
             static_cast<double>(std::clock()) / CLOCKS_PER_SEC);
}

void studied(int count, char** values) {
  auto cases = names_of(kCases);
  auto constants = names_of(kChanges);
  for (int i = 1; i < count; i += 2) {
    const std::string word = values[i];
    require((word == "--cases" || word == "--constants") && i + 1 < count,
            fmt::format("'{}' is not known here, or lacks its value", word));
    (word == "--cases" ? cases : constants) = parts(values[i + 1]);
  }
  const dense::OneBlasThread one_thread;
  for (const auto& name : cases) study(name, constants);
}

}  // namespace
}  // namespace chladni

int main(int count, char** values) {
  try {
    chladni::studied(count, values);
    return 0;
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 2;
  }
}
