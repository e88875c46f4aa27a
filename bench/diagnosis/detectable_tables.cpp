#include "detectable_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

namespace chladni {
namespace {

using diagnosis::Detectable;
using diagnosis::Tolerances;

constexpr Eigen::Index kPlaces = 100;

std::string number(const Detectable& one) {
  if (one.parameter.empty()) return fmt::format("ln {:.2g}", one.log_evidence);
  if (!std::isfinite(one.size)) return "never";
  if (one.unit == "m") return fmt::format("{:.2g} mm", 1e3 * one.size);
  if (one.unit == "s") return fmt::format("{:.2g} us", 1e6 * one.size);
  if (one.unit == "kg" && one.size < 1.0) return fmt::format("{:.2g} g", 1e3 * one.size);
  if (one.unit == "rad") return fmt::format("{:.2g} mrad", 1e3 * one.size);
  if (one.unit != "1") return fmt::format("{:.3g} {}", one.size, one.unit);
  if (one.effect == "modal_damping") return fmt::format("{:.2g} %", 100.0 * (one.size - 1.0));
  return fmt::format("{:.2g} %", 100.0 * one.size);
}

std::string where(const Detectable& one) {
  std::string text;
  for (const auto& channel : one.channels) text += (text.empty() ? "" : ", ") + channel;
  if (one.place) {
    text = fmt::format("({:.0f}, {:.0f}) mm", 1e3 * one.place->x(), 1e3 * one.place->y());
  }
  if (one.frequency_hz) {
    text += fmt::format("{}{:.0f} Hz", text.empty() ? "" : ", ", *one.frequency_hz);
  }
  return text;
}

// The result for one effect.
const Detectable& of(const std::vector<Detectable>& all, std::string_view effect,
                     std::string_view which) {
  return *std::ranges::find_if(
      all, [&](const Detectable& one) { return one.effect == effect && one.of == which; });
}

double smallest_at(const diagnosis::Structure& structure, const modal::FrfSet& measured,
                   const diagnosis::DiagnosisOptions& options, const Eigen::Vector2d& place) {
  const auto experiment = diagnosis::experiment_of(structure, measured, options);
  diagnosis::Probe probe;
  probe.x = Eigen::Vector3d(1e-5 * structure.mass_kg, place.x(), place.y());
  const diagnosis::Detector detector(experiment);
  return detector.sizes(diagnosis::effect("point_mass"), {probe}).front().x;
}

}  // namespace

void print_detectable(const diagnosis::Structure& structure, const modal::FrfSet& measured,
                      const diagnosis::DiagnosisOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  const auto all = detectable(structure, measured, options, kPlaces);
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  fmt::print("| effect | size | best | median | worst | worst at |\n|---|---|---|---|---|---|\n");
  for (const auto& one : all) {
    if (one.of != "worst") continue;
    fmt::print("| {} | {} | {} | {} | {}{} | {} |\n", one.effect, one.parameter,
               number(of(all, one.effect, "best")), number(of(all, one.effect, "median")),
               number(one), one.from_above ? " or less" : "", where(one));
  }
  fmt::print("\n{:.2f} s\n", seconds);
}

void print_bounds(const diagnosis::Structure& structure, const modal::FrfSet& measured,
                  const diagnosis::DiagnosisOptions& options) {
  const std::array<std::pair<const char*, double Tolerances::*>, 12> each{
      {{"gain", &Tolerances::gain},
       {"position", &Tolerances::position},
       {"delay", &Tolerances::delay},
       {"modulus", &Tolerances::modulus},
       {"density", &Tolerances::density},
       {"thickness", &Tolerances::thickness},
       {"orthotropy", &Tolerances::orthotropy},
       {"frequency", &Tolerances::frequency},
       {"damping", &Tolerances::damping},
       {"response", &Tolerances::response},
       {"residual", &Tolerances::residual},
       {"mass", &Tolerances::mass}}};
  const auto tell = [&](const std::string& what, Tolerances tolerances) {
    diagnosis::DiagnosisOptions own = options;
    own.only = {"point_mass"};
    own.tolerances = tolerances;
    const auto all = detectable(structure, measured, own, kPlaces);
    fmt::print("| {} | {} | {} | {} |\n", what, number(of(all, "point_mass", "best")),
               number(of(all, "point_mass", "median")), number(of(all, "point_mass", "worst")));
  };
  fmt::print("| point_mass | best | median | worst |\n|---|---|---|---|\n");
  tell("all tolerances", options.tolerances);
  for (const auto& [name, member] : each) {
    Tolerances less = options.tolerances;
    less.*member = diagnosis::exact_model().*member;
    tell(fmt::format("without {}", name), less);
    Tolerances alone = diagnosis::exact_model();
    alone.*member = options.tolerances.*member;
    tell(fmt::format("{} alone", name), alone);
  }
}

void print_check(const diagnosis::Structure& structure, const diagnosis::DiagnosisOptions& options,
                 const simulators::HiddenOptions& hidden, unsigned first, unsigned seeds) {
  diagnosis::DiagnosisOptions masses = options;
  masses.only = {"point_mass"};
  for (const double times : {1.0, 0.5, 1.5}) {
    int found = 0;
    int tried = 0;
    double most = 0.0;
    for (unsigned seed = first; seed < first + seeds; ++seed) {
      auto own = hidden;
      own.severity = 0.0;
      const auto place = *simulators::hidden_case({"point_mass"}, seed, own).truth[0].place;
      const auto sound = simulators::hidden_case({}, seed, own);
      const double mass = times * smallest_at(structure, sound.measured, masses, place);
      own.severity = std::log(mass / 2e-3) / std::log(1e3);  // as the kind has it, from 2 g on
      if (own.severity < 0.0) continue;
      ++tried;
      const auto made = simulators::hidden_case({"point_mass"}, seed, own);
      const auto told = diagnosed(structure, made.measured, masses);
      const bool there = !told.best.causes.empty();
      found += there ? 1 : 0;
      most = std::max(most, made.truth[0].size.at("mass"));
      fmt::print("  {} {:.1f} x: {:.2f} g at ({:.0f}, {:.0f}) mm: {} (ln {:.1f})\n", seed, times,
                 1e3 * made.truth[0].size.at("mass"), 1e3 * place.x(), 1e3 * place.y(),
                 there ? "found" : "not found", told.best.log_evidence);
      std::fflush(stdout);
    }
    fmt::print("{:.1f} x the smallest size: {} of {} found, masses up to {:.2f} g\n", times, found,
               tried, 1e3 * most);
  }
}

}  // namespace chladni
