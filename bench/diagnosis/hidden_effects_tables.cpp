#include "hidden_effects_tables.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <map>

namespace chladni {
namespace {

using simulators::HiddenCase;
using simulators::Outcome;

constexpr std::array<Outcome, 9> kOutcomes{Outcome::right,   Outcome::twin,   Outcome::open,
                                           Outcome::phantom, Outcome::among,  Outcome::half,
                                           Outcome::wrong,   Outcome::missed, Outcome::unexplained};

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

double quantile(std::vector<double> values, double at) {
  if (values.empty()) return NAN;
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(at * static_cast<double>(values.size() - 1))];
}

bool is_place(const simulators::SizeScore& size) { return size.name == "u" || size.name == "v"; }

// All cases of one row.
struct Row {
  int cases = 0;
  std::map<Outcome, int> count;
  std::map<std::string, int> called;       // where not right
  std::vector<double> places, sizes, off;  // errors: mm, relative, in deviations
};

void add(Row& row, const Done& done) {
  const auto& score = done.score;
  ++row.cases;
  ++row.count[score.outcome];
  if (score.outcome != Outcome::right) ++row.called[score.told];
  for (const auto& effect : score.effects) {
    if (effect.placed) row.places.push_back(1e3 * effect.place_error);
    for (const auto& size : effect.sizes) {
      if (is_place(size) || size.truth == 0.0) continue;
      row.sizes.push_back(std::abs(size.relative_error()));
      if (std::isfinite(size.z())) row.off.push_back(std::abs(size.z()));
    }
  }
}

std::string text_of(const std::string& group, Row& row) {
  std::string others;
  for (const auto& [told, times] : row.called) {
    others += fmt::format("{}{}{}", others.empty() ? "" : "; ", told,
                          times > 1 ? fmt::format(" ({})", times) : "");
  }
  std::string counts;
  for (const auto outcome : kOutcomes) counts += fmt::format(" {} |", row.count[outcome]);
  const auto median = [](const std::vector<double>& values) {
    return values.empty() ? "" : fmt::format("{:.2g}", quantile(values, 0.5));
  };
  const std::string places =
      row.places.empty()
          ? ""
          : fmt::format("{:.2f}, {:.2f}", quantile(row.places, 0.5), quantile(row.places, 1.0));
  return fmt::format("| {} | {} |{} {} | {} | {} | {} |\n", group, row.cases, counts, places,
                     median(row.sizes), median(row.off), others);
}

// @param row_of  the row's name of a case
template <typename RowOf>
void print_table(const std::string& what, const std::vector<Done>& all, RowOf row_of) {
  std::string head = fmt::format("\n| {} | cases |", what);
  std::string rule = "|---|---|";
  for (const auto outcome : kOutcomes) {
    head += fmt::format(" {} |", name(outcome));
    rule += "---|";
  }
  fmt::print(
      "{} place, mm (median, worst) | size error (median) | in deviations | called, where not "
      "right |\n{}---|---|---|---|\n",
      head, rule);
  std::vector<std::string> groups;
  std::map<std::string, Row> rows;
  for (const auto& done : all) {
    const auto group = row_of(done);
    if (!rows.contains(group)) groups.push_back(group);
    add(rows[group], done);
  }
  for (const auto& group : groups) fmt::print("{}", text_of(group, rows[group]));
}

// NaN and infinity are no numbers of JSON.
std::string number(double value) {
  return std::isfinite(value) ? fmt::format("{:.6g}", value) : "null";
}

std::string effects_json(const Done& done) {
  std::vector<std::string> effects;
  for (const auto& effect : done.score.effects) {
    std::vector<std::string> sizes;
    for (const auto& size : effect.sizes) {
      sizes.push_back(fmt::format(R"({{"name": "{}", "truth": {}, "value": {}, "deviation": {}}})",
                                  size.name, number(size.truth), number(size.value),
                                  number(size.std)));
    }
    effects.push_back(fmt::format(
        R"({{"kind": "{}", "named": {}, "place_error_mm": {}, "sizes": [{}]}})", effect.kind,
        effect.named, effect.placed ? number(1e3 * effect.place_error) : "null",
        fmt::join(sizes, ", ")));
  }
  return fmt::format("[{}]", fmt::join(effects, ", "));
}

}  // namespace

void print_case(const Done& done, const HiddenCase& hidden) {
  fmt::print("  {:9} {:4} {:11} {:5.1f} s  {}  ->  {}", done.trial.rig, done.trial.seed,
             name(done.score.outcome), done.seconds, sizes_of(hidden), done.score.told);
  for (const auto& effect : done.score.effects) {
    if (effect.placed) fmt::print(" [{:.2f} mm]", 1e3 * effect.place_error);
    for (const auto& size : effect.sizes) {
      fmt::print(" {}={:.4g}(z {:.1f})", size.name, size.value, size.z());
    }
  }
  if (!done.score.phantoms.empty()) fmt::print("  not there: {}", done.score.phantoms);
  const std::string apart = std::isfinite(done.evidence_apart)
                                ? fmt::format(", its twin apart {:.2g}", done.evidence_apart)
                                : "";
  fmt::print("  ln there {:.3g}{}, z {:.1f} to {:.1f}\n", done.evidence_there, apart,
             done.excess_before, done.excess_after);
  std::fflush(stdout);
}

std::string json_line(const Done& done, const HiddenCase& hidden) {
  return fmt::format(
      R"({{"rig": "{}", "seed": {}, "kinds": [{}], "hidden": "{}", "outcome": "{}", "told": "{}", )"
      R"("phantoms": "{}", "effects": {}, "surest_phantom": {}, "evidence_there": {}, "evidence_apart": {}, )"
      R"("z_before": {}, "z_after": {}, "seconds": {:.2f}, "cpu_seconds": {:.2f}}})",
      done.trial.rig, done.trial.seed,
      done.trial.kinds.empty() ? "" : fmt::format("\"{}\"", fmt::join(done.trial.kinds, "\", \"")),
      sizes_of(hidden), name(done.score.outcome), done.score.told, done.score.phantoms,
      effects_json(done), number(done.score.surest_phantom), number(done.evidence_there),
      number(done.evidence_apart), number(done.excess_before), number(done.excess_after),
      done.seconds, done.cpu_seconds);
}

void print_tables(const std::vector<Done>& all) {
  print_table("hidden", all, [](const Done& done) { return done.trial.group; });
  const auto another = [&](const Done& done) { return done.trial.rig != all.front().trial.rig; };
  if (std::ranges::none_of(all, another)) return;
  print_table("rig", all, [](const Done& done) { return done.trial.rig; });
}

void print_calibration(const std::vector<Done>& all) {
  std::vector<double> z;
  std::vector<double> seconds;
  for (const auto& done : all) {
    seconds.push_back(done.cpu_seconds);
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
  const auto surer = [&](double limit) {
    return std::ranges::count_if(
        all, [&](const Done& done) { return done.score.surest_phantom > limit; });
  };
  fmt::print(
      "\n{} sizes and places of right cases: |z| < 1: {:.3f}, < 2: {:.3f}, < 3: {:.3f}, "
      "median {:.2f}, 95 % {:.2f}\n",
      z.size(), within(1.0), within(2.0), within(3.0), quantile(z, 0.5), quantile(z, 0.95));
  fmt::print("a name that is not of the truth, of more than 0.9: {}, of more than 0.7: {}, of {}\n",
             surer(0.9), surer(0.7), all.size());
  fmt::print("CPU seconds: median {:.1f}, 95 % {:.1f}, most {:.1f}\n", quantile(seconds, 0.5),
             quantile(seconds, 0.95), quantile(seconds, 1.0));
}

}  // namespace chladni
