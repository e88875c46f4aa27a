// Each step of an identification on the beam (5 by 3, 799 lines) and the wafer table (4 by 13, 3981
// lines, 3 + 17 modes): the start by vector fitting, the maximum likelihood from true poles, the
// whole with its order, one iteration of the thesis' fraction, gain matching. Wall time of one
// thread.
#include <benchmark/benchmark.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "host/parallel.h"
#include "identification/fit_data.h"
#include "identification/gain_match.h"
#include "identification/identified.h"
#include "identification/matrix_fraction.h"
#include "identification/poles/vector_fit.h"
#include "simulators/frf_cases.h"

namespace chladni::identification {
namespace {

struct Measured {
  simulators::FrfCase made;
  FitData data;
};

const Measured& measured(std::int64_t which) {
  static const Measured kBeam = [] {
    auto made = simulators::beam5x3();
    auto data = fit_data(made.measured);
    return Measured{std::move(made), std::move(data)};
  }();
  static const Measured kTable = [] {
    auto made = simulators::oat4x13();
    auto data = fit_data(made.measured);
    return Measured{std::move(made), std::move(data)};
  }();
  return which == 0 ? kBeam : kTable;
}

void label(benchmark::State& state) { state.SetLabel(state.range(0) == 0 ? "beam5x3" : "oat4x13"); }

void weights(benchmark::State& state) {
  const auto& made = measured(state.range(0)).made;
  for (auto _ : state) benchmark::DoNotOptimize(fit_data(made.measured));
  label(state);
}

void start_by_vector_fitting(benchmark::State& state) {
  const auto& [made, data] = measured(state.range(0));
  VectorFitOptions options;
  options.order = made.truth.mode_count() - made.truth.rigid_count + 4;
  options.rigid = made.truth.rigid_count > 0;
  for (auto _ : state) benchmark::DoNotOptimize(vector_fit(data, options));
  label(state);
}

void maximum_likelihood(benchmark::State& state) {
  const auto& [made, data] = measured(state.range(0));
  const auto start = start_at(made.truth);
  int iterations = 0;
  for (auto _ : state) iterations = modal_fit(data, start).iterations;
  state.counters["iterations"] = iterations;
  label(state);
}

void whole(benchmark::State& state) {
  const auto& [made, data] = measured(state.range(0));
  IdentificationOptions options;
  options.rigid_count = made.truth.rigid_count;
  Eigen::Index modes = 0;
  for (auto _ : state) modes = identified(data, options).fit.model.mode_count();
  state.counters["modes"] = static_cast<double>(modes);
  label(state);
}

void iteration_of_the_fraction(benchmark::State& state) {
  const auto& [made, data] = measured(state.range(0));
  const auto degree = (2 * made.truth.mode_count() + data.outputs - 1) / data.outputs;
  for (auto _ : state) {
    benchmark::DoNotOptimize(matrix_fraction(data, {degree, degree, 1, 0, {}}));
  }
  label(state);
}

void gains(benchmark::State& state) {
  const auto& [made, data] = measured(state.range(0));
  const auto fit = modal_fit(data, start_at(made.truth));
  GainMatchOptions options;
  options.pairs = collocated_pairs(made.measured.outputs, made.measured.inputs, 0.11);
  for (auto _ : state) {
    benchmark::DoNotOptimize(gain_match(fit, made.measured.outputs, made.measured.inputs, options));
  }
  label(state);
}

BENCHMARK(weights)->DenseRange(0, 1)->Unit(benchmark::kMillisecond);
BENCHMARK(start_by_vector_fitting)->DenseRange(0, 1)->Unit(benchmark::kMillisecond);
BENCHMARK(maximum_likelihood)->DenseRange(0, 1)->Unit(benchmark::kMillisecond);
BENCHMARK(whole)->DenseRange(0, 1)->Unit(benchmark::kMillisecond);
BENCHMARK(iteration_of_the_fraction)->DenseRange(0, 1)->Unit(benchmark::kMillisecond);
BENCHMARK(gains)->DenseRange(0, 1)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace chladni::identification

int main(int argc, char** argv) {
  chladni::set_thread_count(1);
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
