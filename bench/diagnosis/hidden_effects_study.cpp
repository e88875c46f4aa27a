// hidden_effects_study [--kinds a,b|all|pairs|outside|none] [--seeds N] [--first S] [--lines K]
//   [--write FILE] [--severity X] [--tolerance] [--changed-damping] [--degree D] [--modes M]
//   [--fine N] [--coarser C] [--deviation X] [--list] [--detectable [--check N]]
// hides effects in measurements of a Ritz plate, diagnoses them from a nominal one, and prints what
// was found, as bench/README.md has it. --tolerance: tables that deviate by X (1) default
// tolerances, diagnosed with these, from a structure of C (2) degrees less; else the exact model.
// --detectable: the smallest sizes that would be found instead; --check: N masses of 0.5, 1 and 1.5
// times theirs are hidden and sought.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <map>
#include <sstream>
#include <string>
#include <type_traits>
#include <vector>

#include "base/error.h"
#include "detectable_tables.h"
#include "diagnosis/diagnosed.h"
#include "io/frf_file.h"
#include "simulators/hidden_effect.h"
#include "simulators/hidden_score.h"
#include "simulators/ritz_structure.h"
#include "simulators/twins.h"

namespace chladni {
namespace {

using simulators::CaseScore;
using simulators::HiddenCase;
using simulators::Outcome;

struct Arguments {
  std::string kinds = "all";
  unsigned seeds = 2, first = 1;
  simulators::HiddenOptions hidden;
  simulators::RitzStructureOptions structure;
  bool tolerance = false, list = false, detectable = false;
  unsigned check = 0;      ///< masses hidden at each multiple of their smallest size
  double deviation = 1.0;  ///< of the tables, within tolerances
  int coarser = 2;         ///< degrees that the structure has less, within tolerances
  std::string write;       ///< a file for the first case instead of a diagnosis
};

struct Trial {
  std::string group;  // a row of the table
  std::vector<std::string> kinds;
  unsigned seed = 0;
};

struct Done {
  Trial trial;
  CaseScore score;
  double seconds = 0.0, evidence_there = 0.0, evidence_apart = HUGE_VAL;
  double excess_before = 0.0, excess_after = 0.0;  // z
};

// What each word that takes a value does with it.
std::map<std::string, std::function<void(const std::string&)>> words(Arguments& all) {
  const auto number = [](auto& into) {
    return [&into](const std::string& text) {
      into = static_cast<std::decay_t<decltype(into)>>(std::stod(text));
    };
  };
  return {{"--kinds", [&all](const std::string& text) { all.kinds = text; }},
          {"--write", [&all](const std::string& text) { all.write = text; }},
          {"--seeds", number(all.seeds)},
          {"--check", number(all.check)},
          {"--first", number(all.first)},
          {"--lines", number(all.hidden.lines)},
          {"--severity", number(all.hidden.severity)},
          {"--degree", number(all.hidden.degree)},
          {"--modes", number(all.structure.modes)},
          {"--fine", number(all.structure.fine)},
          {"--deviation", number(all.deviation)},
          {"--coarser", number(all.coarser)}};
}

Arguments arguments(int count, char** values) {
  Arguments all;
  const auto known = words(all);
  for (int i = 1; i < count; ++i) {
    const std::string word = values[i];
    if (word == "--tolerance") {
      all.tolerance = true;
    } else if (word == "--changed-damping") {
      all.hidden.damping_stays = false;
    } else if (word == "--detectable") {
      all.detectable = true;
    } else if (word == "--list") {
      all.list = true;
    } else {
      const auto found = known.find(word);
      require(found != known.end(), fmt::format("'{}' is not known here", word));
      require(i + 1 < count, fmt::format("{} needs a value", word));
      found->second(values[++i]);
    }
  }
  if (all.tolerance) all.hidden.deviation = all.deviation;
  return all;
}

std::vector<Trial> trials(const Arguments& wanted) {
  std::vector<Trial> all;
  std::stringstream words(wanted.kinds);
  for (std::string word; std::getline(words, word, ',');) {
    for (unsigned n = 0; n < wanted.seeds; ++n) {
      const unsigned seed = wanted.first + n;
      const auto add_each = [&](const std::vector<std::string>& names) {
        for (const auto& name : names) all.push_back({name, {name}, seed});
      };
      if (word == "all") {
        add_each(simulators::hidden_kinds());
      } else if (word == "outside") {
        add_each(simulators::outside_kinds());
      } else if (word == "pairs") {
        all.push_back({"pairs", simulators::hidden_pair(seed), seed});
      } else if (word == "none") {
        all.push_back({"none", {}, seed});
      } else {
        all.push_back({word, {word}, seed});
      }
    }
  }
  return all;
}

std::string sizes_of(const HiddenCase& hidden) {
  std::string text;
  for (const auto& effect : hidden.truth) {
    text += text.empty() ? "" : " + ";
    text += effect.kind;
    for (const auto& channel : effect.channels) text += "," + channel;
    for (const auto& [name, value] : effect.size) text += fmt::format(" {}={:.3g}", name, value);
    if (effect.place) {
      text +=
          fmt::format(" at ({:.0f}, {:.0f}) mm", 1e3 * effect.place->x(), 1e3 * effect.place->y());
    }
  }
  return text.empty() ? "nothing" : text;
}

void print_case(const Done& done, const HiddenCase& hidden) {
  fmt::print("  {:4} {:11} {:5.1f} s  {}  ->  {}", done.trial.seed, name(done.score.outcome),
             done.seconds, sizes_of(hidden), done.score.told);
  for (const auto& effect : done.score.effects) {
    if (effect.placed) fmt::print(" [{:.2f} mm]", 1e3 * effect.place_error);
    for (const auto& size : effect.sizes) {
      fmt::print(" {}={:.4g}(z {:.1f})", size.name, size.value, size.z());
    }
  }
  const std::string apart = std::isfinite(done.evidence_apart)
                                ? fmt::format(", its twin apart {:.2g}", done.evidence_apart)
                                : "";
  fmt::print("  ln there {:.3g}{}, z {:.1f} to {:.1f}\n", done.evidence_there, apart,
             done.excess_before, done.excess_after);
  std::fflush(stdout);
}

Done diagnosed(const Trial& trial, const Arguments& wanted, const diagnosis::Structure& structure) {
  const auto hidden = simulators::hidden_case(trial.kinds, trial.seed, wanted.hidden);
  diagnosis::DiagnosisOptions options;
  if (!wanted.tolerance) options.tolerances = diagnosis::exact_model();
  const auto start = std::chrono::steady_clock::now();
  Done done{trial, {}, 0.0, hidden.evidence_there, simulators::evidence_apart(hidden)};
  try {
    const auto told = diagnosis::diagnosed(structure, hidden.measured, options);
    done.score = scored(hidden, told);
    done.excess_before = told.excess_before;
    done.excess_after = told.best.excess;
  } catch (const std::exception& error) {
    done.score.outcome = Outcome::wrong;
    done.score.told = fmt::format("failed: {}", error.what());
  }
  done.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (wanted.list) print_case(done, hidden);
  return done;
}

double quantile(std::vector<double> values, double at) {
  if (values.empty()) return NAN;
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(at * static_cast<double>(values.size() - 1))];
}

// What nobody can tell from its twin is called ambiguous if it is called right.
bool is_a_twin(const Done& done) {
  return done.evidence_apart < 5.0 && done.score.outcome == Outcome::among;
}

// All cases of one kind.
struct Row {
  int cases = 0, twins = 0;  // twins: among those of Outcome::among
  std::map<Outcome, int> count;
  std::map<std::string, int> called;  // where not right
  std::vector<double> places, sizes;  // errors: mm, relative
};

void add(Row& row, const Done& done) {
  const CaseScore& score = done.score;
  ++row.cases;
  row.twins += is_a_twin(done) ? 1 : 0;
  ++row.count[score.outcome];
  if (score.outcome != Outcome::right) ++row.called[score.told];
  for (const auto& effect : score.effects) {
    if (effect.placed) row.places.push_back(1e3 * effect.place_error);
    for (const auto& size : effect.sizes) {
      const bool place = size.name == "u" || size.name == "v";
      if (!place && size.truth != 0.0) row.sizes.push_back(std::abs(size.relative_error()));
    }
  }
}

std::string text_of(const std::string& group, Row& row) {
  std::string others;
  for (const auto& [told, times] : row.called) {
    others += fmt::format("{}{}{}", others.empty() ? "" : "; ", told,
                          times > 1 ? fmt::format(" ({})", times) : "");
  }
  const auto of = [&](Outcome one) { return row.count[one]; };
  const std::string places =
      row.places.empty()
          ? ""
          : fmt::format("{:.2f}, {:.2f}", quantile(row.places, 0.5), quantile(row.places, 1.0));
  const std::string sizes =
      row.sizes.empty() ? "" : fmt::format("{:.2g}", quantile(row.sizes, 0.5));
  return fmt::format("| {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} |\n", group,
                     row.cases, of(Outcome::right), row.twins, of(Outcome::among) - row.twins,
                     of(Outcome::half), of(Outcome::wrong), of(Outcome::missed),
                     of(Outcome::unexplained), places, sizes, others);
}

void print_table(const std::vector<Done>& all) {
  fmt::print(
      "\n| hidden | cases | right | twins | among | half | wrong | missed | unexplained | "
      "place, mm (median, worst) | size error (median) | called, where not right |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  std::vector<std::string> groups;
  std::map<std::string, Row> rows;
  for (const auto& done : all) {
    if (!rows.contains(done.trial.group)) groups.push_back(done.trial.group);
    add(rows[done.trial.group], done);
  }
  for (const auto& group : groups) fmt::print("{}", text_of(group, rows[group]));
}

// z of the sizes where the name is right: 0.68, 0.95, 0.997 are expected.
void print_calibration(const std::vector<Done>& all) {
  std::vector<double> z;
  std::vector<double> seconds;
  int confident = 0;
  int cases_seen = 0;
  for (const auto& done : all) {
    seconds.push_back(done.seconds);
    ++cases_seen;
    confident += done.score.confidently_wrong ? 1 : 0;
    if (done.score.outcome != Outcome::right) continue;
    for (const auto& effect : done.score.effects) {
      for (const auto& size : effect.sizes) {
        if (std::isfinite(size.z())) z.push_back(std::abs(size.z()));
      }
    }
  }
  const auto within = [&z](double limit) {
    const auto n = std::count_if(z.begin(), z.end(), [&](double one) { return one < limit; });
    return static_cast<double>(n) / std::max(1.0, static_cast<double>(z.size()));
  };
  fmt::print(
      "\n{} sizes and places of right cases: |z| < 1: {:.3f}, < 2: {:.3f}, < 3: {:.3f}, "
      "median {:.2f}, 95 % {:.2f}\n",
      z.size(), within(1.0), within(2.0), within(3.0), quantile(z, 0.5), quantile(z, 0.95));
  fmt::print("a name given with more than 0.9 that is not of the truth: {} of {}\n", confident,
             cases_seen);
  fmt::print("seconds: median {:.1f}, 95 % {:.1f}, most {:.1f}\n", quantile(seconds, 0.5),
             quantile(seconds, 0.95), quantile(seconds, 1.0));
}

// The first case as a file of measured responses; what is true of it on standard output.
void write_first(const Arguments& wanted) {
  const auto trial = trials(wanted).front();
  const auto hidden = simulators::hidden_case(trial.kinds, trial.seed, wanted.hidden);
  for (const auto& truth : hidden.truth) {
    fmt::print("{}", truth.kind);
    if (truth.place) fmt::print(" at ({:.6g}, {:.6g}) m", truth.place->x(), truth.place->y());
    for (const auto& [name, value] : truth.size) fmt::print(" {} {:.6g}", name, value);
    fmt::print("\n");
  }
  for (const auto& lost : io::write_frf(wanted.write, hidden.measured)) fmt::print("{}\n", lost);
}

// What this experiment would find, and whether it does.
void print_smallest(const diagnosis::Structure& structure, const Arguments& wanted) {
  diagnosis::DiagnosisOptions options;
  if (!wanted.tolerance) options.tolerances = diagnosis::exact_model();
  const auto measured = simulators::hidden_case({}, wanted.first, wanted.hidden).measured;
  if (wanted.check == 0) print_detectable(structure, measured, options);
  if (wanted.check == 0 && wanted.tolerance) print_bounds(structure, measured, options);
  if (wanted.check > 0) {
    print_check(structure, options, wanted.hidden, wanted.first, wanted.check);
  }
}

int studied(int count, char** values) {
  const auto wanted = arguments(count, values);
  if (!wanted.write.empty()) {
    write_first(wanted);
    return 0;
  }
  const int degree = wanted.hidden.degree - (wanted.tolerance ? wanted.coarser : 0);
  const auto structure = simulators::ritz_structure(simulators::believed_table(degree),
                                                    simulators::table_channels(), wanted.structure);
  if (wanted.detectable) {
    print_smallest(structure, wanted);
    return 0;
  }
  std::vector<Done> all;
  for (const auto& trial : trials(wanted)) all.push_back(diagnosed(trial, wanted, structure));
  print_table(all);
  print_calibration(all);
  return 0;
}

}  // namespace
}  // namespace chladni

int main(int count, char** values) {
  try {
    return chladni::studied(count, values);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 2;
  }
}
