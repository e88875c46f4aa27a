// identification_study [case] [seeds] [method]: modes found, errors over the Cramér-Rao bound and
// CPU seconds, of the default and of the thesis' own path on the same data; figures in
// bench/README.md. identification_study export CASE FILE.csv: the responses, for
// bench/peers/modal_fits.py. identification_study many [channels] [modes] [lines]: as many sensors
// as actuators, on all cores.
#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "base/error.h"
#include "host/parallel.h"
#include "identification/fit_data.h"
#include "identification/identified.h"
#include "identification/matrix_fraction.h"
#include "modal/mac.h"
#include "simulators/frf_bounds.h"
#include "simulators/frf_cases.h"

namespace chladni {
namespace {

using identification::FitData;
using identification::ModalFit;
using simulators::FrfCase;
using simulators::FrfFaults;

struct Trial {
  std::string name;
  std::function<FrfCase(const FrfFaults&)> make;
  double relative_noise = 0.01, floor_noise = 0.0;
};

std::vector<Trial> trials() {
  const auto pair_of = [](double split) {
    return
        [split](const FrfFaults& faults) { return simulators::pairs(split, 0.01, 0.01, faults); };
  };
  return {{"beam5x3", simulators::beam5x3},
          {"beam5x3_10", simulators::beam5x3, 0.1},
          {"beam5x3_floor", simulators::beam5x3, 0.0, 0.3},
          {"beam5x5", simulators::beam5x5},
          {"pairs_1e-2", pair_of(1e-2)},
          {"pairs_1e-3", pair_of(1e-3)},
          {"oat4x13", simulators::oat4x13},
          {"oat4x13_floor", simulators::oat4x13, 0.0, 0.3}};
}

FrfCase case_of(const Trial& trial, unsigned seed) {
  FrfFaults faults;
  faults.relative_noise = trial.relative_noise;
  faults.floor_noise = trial.floor_noise;
  faults.seed = seed;
  return trial.make(faults);
}

// What one method found of the true flexible modes.
struct Score {
  Eigen::Index found = 0, modes = 0;
  double frequency = 0.0, damping = 0.0;  // largest error over the bound, of the modes found
  double mac = 1.0, seconds = 0.0;
  std::string failure;
};

// Found: within half a half-power bandwidth, each estimate once.
void compare(const ModalFit& fit, const FrfCase& made, const simulators::FrfBounds& bounds,
             Score& score) {
  const auto& truth = made.truth;
  const auto p = truth.output_count();
  const Eigen::MatrixXd mac = modal::mac(truth.output_shapes, fit.model.output_shapes);
  std::vector<bool> used(static_cast<std::size_t>(fit.model.mode_count()), false);
  for (Eigen::Index m = truth.rigid_count; m < truth.mode_count(); ++m) {
    ++score.modes;
    Eigen::Index nearest = -1;
    double best = 0.0;
    for (Eigen::Index i = fit.model.rigid_count; i < fit.model.mode_count(); ++i) {
      const double off = std::abs(fit.model.frequency_hz(i) - truth.frequency_hz(m));
      const bool near = off < truth.damping_ratio(m) * truth.frequency_hz(m);
      if (used[static_cast<std::size_t>(i)] || !near || (p > 1 && mac(m, i) <= best)) continue;
      nearest = i;
      best = mac(m, i);
    }
    if (nearest < 0) continue;
    used[static_cast<std::size_t>(nearest)] = true;
    ++score.found;
    score.mac = std::min(score.mac, best);
    const double frequency = std::abs(fit.model.frequency_hz(nearest) - truth.frequency_hz(m));
    const double damping = std::abs(fit.model.damping_ratio(nearest) - truth.damping_ratio(m));
    score.frequency = std::max(score.frequency, frequency / bounds.frequency_hz(m));
    score.damping = std::max(score.damping, damping / bounds.damping(m));
  }
}

using Method = std::function<ModalFit(const FrfCase&)>;

FitData weighted(const FrfCase& made, identification::Weighting weighting) {
  identification::FitDataOptions options;
  options.weighting = weighting;
  return identification::fit_data(made.measured, options);
}

ModalFit thesis(const FrfCase& made, identification::Weighting weighting, Eigen::Index degree) {
  const auto rigid = made.truth.rigid_count;
  identification::ThesisOptions options;
  options.modes = made.truth.mode_count() - rigid;
  options.rigid_count = rigid;
  options.degree = degree;
  return identification::thesis_fit(weighted(made, weighting), options);
}

// What the thesis' fraction needs to hold all modes of the table at its four corners.
constexpr Eigen::Index kDegreeOfTable = 12;

std::vector<std::pair<std::string, Method>> methods(const FrfCase& made) {
  using identification::Weighting;
  std::vector<std::pair<std::string, Method>> list;
  list.emplace_back("default, order found", [](const FrfCase& data) {
    identification::IdentificationOptions options;
    options.rigid_count = data.truth.rigid_count;
    return identification::identified(weighted(data, Weighting::variance), options).fit;
  });
  list.emplace_back("thesis, its weights", [](const FrfCase& data) {
    return thesis(data, Weighting::inverse_magnitude, 0);
  });
  list.emplace_back("thesis, 1/sigma",
                    [](const FrfCase& data) { return thesis(data, Weighting::variance, 0); });
  if (made.truth.rigid_count > 0) {
    list.emplace_back("thesis, 1/sigma, degree 12", [](const FrfCase& data) {
      return thesis(data, Weighting::variance, kDegreeOfTable);
    });
  }
  return list;
}

Score score_of(const Method& method, const FrfCase& made, const simulators::FrfBounds& bounds) {
  Score score;
  const auto start = std::clock();
  try {
    const auto fit = method(made);
    score.seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    compare(fit, made, bounds, score);
  } catch (const std::exception& failure) {
    score.failure = failure.what();
  }
  return score;
}

void run(const Trial& trial, unsigned seeds, const std::string& wanted) {
  for (unsigned seed = 1; seed <= seeds; ++seed) {
    const auto made = case_of(trial, seed);
    const auto bounds = simulators::cramer_rao(made);
    for (const auto& [name, method] : methods(made)) {
      if (name.find(wanted) == std::string::npos) continue;
      const auto score = score_of(method, made, bounds);
      if (!score.failure.empty()) {
        fmt::print("{:14} {:27} {}\n", trial.name, name, score.failure);
        continue;
      }
      fmt::print("{:14} {:27} {:2}/{:2} {:10.2f} {:10.2f} {:9.6f} {:8.2f}\n", trial.name, name,
                 score.found, score.modes, score.frequency, score.damping, score.mac,
                 score.seconds);
      std::fflush(stdout);
    }
  }
}

void write_csv(const FrfCase& made, const char* path) {
  std::FILE* file = std::fopen(path, "w");
  require(file != nullptr, std::string("cannot write ") + path);
  fmt::print(file, "freq_hz");
  for (const auto& input : made.measured.inputs) {
    for (const auto& output : made.measured.outputs) {
      fmt::print(file, ",re_{0}{1},im_{0}{1}", output.name, input.name);
    }
  }
  for (std::size_t k = 0; k < made.measured.value.size(); ++k) {
    fmt::print(file, "\n{:.17g}", made.measured.frequency_hz(static_cast<Eigen::Index>(k)));
    for (const auto& g : made.measured.value[k].reshaped()) {
      fmt::print(file, ",{:.17g},{:.17g}", g.real(), g.imag());
    }
  }
  fmt::print(file, "\n");
  std::fclose(file);
}

// The largest memory since the last reset [GB].
double peak_memory(bool reset) {
  if (reset) {
    std::ofstream("/proc/self/clear_refs") << 5;
    return 0.0;
  }
  std::ifstream status("/proc/self/status");
  std::string word;
  double kilobytes = 0.0;
  while (status >> word) {
    if (word == "VmHWM:") status >> kilobytes;
  }
  return 1e-6 * kilobytes;
}

// Errors over stated deviations, root mean square of the modes found.
struct Many {
  Eigen::Index found = 0;
  double frequency = 0.0, damping = 0.0, largest = 0.0, mac = 1.0;
};

Many compare_many(const ModalFit& fit, const modal::ReducedModel& truth) {
  Many result;
  const Eigen::MatrixXd mac = modal::mac(truth.output_shapes, fit.model.output_shapes);
  for (auto m = truth.rigid_count; m < truth.mode_count(); ++m) {
    Eigen::Index i = 0;
    const double alike = mac.row(m).maxCoeff(&i);
    const double off = fit.model.frequency_hz(i) - truth.frequency_hz(m);
    if (alike < 0.9 || std::abs(off) > truth.damping_ratio(m) * truth.frequency_hz(m)) continue;
    const double frequency = off / fit.frequency_std_hz(i);
    const double damping =
        (fit.model.damping_ratio(i) - truth.damping_ratio(m)) / fit.damping_std(i);
    ++result.found;
    result.frequency += frequency * frequency;
    result.damping += damping * damping;
    result.largest = std::max({result.largest, std::abs(frequency), std::abs(damping)});
    result.mac = std::min(result.mac, alike);
  }
  const auto count = static_cast<double>(std::max<Eigen::Index>(1, result.found));
  result.frequency = std::sqrt(result.frequency / count);
  result.damping = std::sqrt(result.damping / count);
  return result;
}

int many(Eigen::Index channels, Eigen::Index modes, Eigen::Index lines) {
  modal::ReducedModel truth;
  FitData data;
  {
    FrfFaults faults;
    faults.relative_noise = 0.0;
    faults.floor_noise = 1.0;
    const auto made = simulators::big(channels, channels, modes, lines, faults);
    truth = made.truth;
    data = identification::fit_data(made.measured);
  }
  peak_memory(true);
  identification::IdentificationOptions options;
  options.rigid_count = 3;
  const auto cpu = std::clock();
  const auto wall = std::chrono::steady_clock::now();
  const auto result = identification::identified(data, options);
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - wall;
  const double busy = static_cast<double>(std::clock() - cpu) / CLOCKS_PER_SEC;
  const auto score = compare_many(result.fit, truth);
  const double n = 2.0 * result.fit.expected_cost;
  fmt::print(
      "{} of {} modes, {} fitted; errors over deviations {:.2f} (f), {:.2f} (damping), "
      "largest {:.2f}; MAC {:.5f}; z {:.2f}\n",
      score.found, modes - 3, result.fit.model.mode_count(), score.frequency, score.damping,
      score.largest, score.mac, (2.0 * result.fit.cost - n) / std::sqrt(2.0 * n));
  for (const auto& step : result.steps) {
    fmt::print("  {} flexible modes: cost {:.17g}, z {:.2f}{}\n", step.modes, step.cost,
               step.excess, step.taken ? "" : ", not taken");
  }
  fmt::print("{:.2f} s, {:.2f} CPU s, {:.2f} GB\n", seconds.count(), busy, peak_memory(false));
  return 0;
}

int study(int argc, char** argv) {
  const std::string wanted = argc > 1 ? argv[1] : "all";
  if (wanted == "export") {
    require(argc == 4, "identification_study export CASE FILE.csv");
    for (const auto& trial : trials()) {
      if (trial.name == argv[2]) write_csv(case_of(trial, 1), argv[3]);
    }
    return 0;
  }
  if (wanted == "many") {
    const auto number = [&](int at, int otherwise) {
      return static_cast<Eigen::Index>(argc > at ? std::atoi(argv[at]) : otherwise);
    };
    return many(number(2, 100), number(3, 30), number(4, 2000));
  }
  const auto seeds = static_cast<unsigned>(argc > 2 ? std::atoi(argv[2]) : 1);
  fmt::print("{:14} {:27} {:5} {:>10} {:>10} {:>9} {:>8}\n", "case", "method", "found", "freq/CRB",
             "damp/CRB", "min MAC", "CPU s");
  for (const auto& trial : trials()) {
    if (wanted == "all" || wanted == trial.name) run(trial, seeds, argc > 3 ? argv[3] : "");
  }
  return 0;
}

}  // namespace
}  // namespace chladni

int main(int argc, char** argv) {
  if (argc < 2 || std::string(argv[1]) != "many") chladni::set_thread_count(1);
  try {
    return chladni::study(argc, argv);
  } catch (const std::exception& failure) {
    fmt::print(stderr, "{}\n", failure.what());
    return 1;
  }
}
