// Fitting twelve shapes at thirteen places, and their values at many points.
#include <benchmark/benchmark.h>

#include "priors/interpolator.h"
#include "simulators/tables/plate_corrections.h"
#include "simulators/tables/plate_study.h"
#include "simulators/tables/real_tables.h"

namespace chladni {
namespace {

struct Made {
  simulators::PlateModes believed;
  priors::Simulation simulation;
  priors::MeasuredShapes measured;
};

// The minimal model with 20 flexible modes, or 40 with corrections.
Made made(bool corrections) {
  const auto plate = simulators::minimal_table(25);
  const auto table = simulators::plate_modes(simulators::real_table(1), 12);
  const auto surface = simulators::plate_surface(table);
  Made made;
  made.believed = simulators::plate_modes(plate, corrections ? 40 : 20);
  made.simulation = simulators::plate_simulation(made.believed, surface);
  if (corrections) {
    made.simulation.corrections = simulators::plate_corrections(plate, made.believed);
  }
  made.measured = simulators::plate_test(table, made.believed, surface, simulators::layout("rings"),
                                         12, 0.01, 101)
                      .measured;
  return made;
}

priors::Places many_places(const simulators::PlateModes& modes, Eigen::Index count) {
  Eigen::MatrixX2d at(count, 2);
  for (Eigen::Index k = 0; k < count; ++k) {
    at(k, 0) = -0.3 + 0.6 * static_cast<double>((k * 7919) % count) / static_cast<double>(count);
    at(k, 1) = -0.3 + 0.6 * static_cast<double>(k) / static_cast<double>(count);
  }
  return simulators::plate_places(modes, at);
}

void fit(benchmark::State& state, const char* method, bool corrections) {
  const auto one = made(corrections);
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        priors::mode_field(priors::interpolator(method), one.measured, one.simulation));
  }
}

void evaluate(benchmark::State& state) {
  const auto one = made(false);
  const auto field =
      priors::mode_field(priors::interpolator("dynamic_residual"), one.measured, one.simulation);
  const auto places = many_places(one.believed, state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(field->at(places));
}

BENCHMARK_CAPTURE(fit, orthogonal, "dynamic_residual_orthogonal", false)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();
BENCHMARK_CAPTURE(fit, corrected, "dynamic_residual", true)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();
BENCHMARK(evaluate)
    ->Arg(10000)
    ->Arg(1000000)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();

}  // namespace
}  // namespace chladni

BENCHMARK_MAIN();
