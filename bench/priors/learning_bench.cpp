// Learning of hyper-parameters from dense samples of twelve shapes; bench/peers/gaussian_process.py
// does the same with scikit-learn. The figures stand in bench/README.md.
#include <benchmark/benchmark.h>

#include <cmath>
#include <numbers>

#include "priors/learning.h"

namespace {

using chladni::Points;
namespace priors = chladni::priors;

// A sunflower in a square of 600 mm: even, and no grid. The same in bench/peers.
Points sample(Eigen::Index count) {
  Points points = Points::Zero(count, 3);
  for (Eigen::Index i = 0; i < count; ++i) {
    const double u = std::fmod(0.5 + static_cast<double>(i) * 0.7548776662466927, 1.0);
    const double v = std::fmod(0.5 + static_cast<double>(i) * 0.5698402909980532, 1.0);
    points.row(i) << 0.6 * u - 0.3, 0.6 * v - 0.3, 0.0;
  }
  return points;
}

// Twelve shapes like those of a free plate, of unit root mean square about.
Eigen::MatrixXd shapes(const Points& at) {
  Eigen::MatrixXd values(at.rows(), 12);
  for (Eigen::Index m = 0; m < 12; ++m) {
    const double kx = std::numbers::pi / 0.6 * static_cast<double>(1 + m % 4);
    const double ky = std::numbers::pi / 0.6 * static_cast<double>(1 + m / 4);
    values.col(m) =
        2.0 * (kx * (at.col(0).array() + 0.3)).cos() * (ky * (at.col(1).array() + 0.3)).cos();
  }
  return values;
}

void per_mode(benchmark::State& state) {
  const auto points = sample(state.range(0));
  const auto values = shapes(points);
  const priors::Kernel kernel(priors::kernel_family("squared_exponential"));
  std::vector<priors::Learned> found;
  for (auto _ : state) found = priors::learned(kernel, points, values);
  state.counters["factorisations"] = found.front().evaluations;
  state.counters["first_length_m"] = found.front().parameters(0);
  state.counters["last_length_m"] = found.back().parameters(0);
}
BENCHMARK(per_mode)->Arg(500)->Arg(1000)->Arg(2000)->Unit(benchmark::kMillisecond);

void shared(benchmark::State& state) {
  const auto points = sample(state.range(0));
  const auto values = shapes(points);
  const priors::Kernel kernel(priors::kernel_family("squared_exponential"));
  for (auto _ : state) {
    benchmark::DoNotOptimize(priors::learned(kernel, points, values, {.shared = true}));
  }
}
BENCHMARK(shared)->Arg(500)->Arg(1000)->Unit(benchmark::kMillisecond);

// One likelihood with its gradient, per axis: what a step of a search costs.
void likelihood_with_gradient(benchmark::State& state) {
  const auto points = sample(state.range(0));
  const auto values = shapes(points);
  const priors::Kernel kernel(priors::kernel_family("squared_exponential"),
                              priors::Scales::per_axis);
  const Eigen::VectorXd noise = Eigen::VectorXd::Constant(points.rows(), 1e-8);
  for (auto _ : state) {
    const priors::GaussianProcess process({kernel, Eigen::Vector3d(0.1, 0.1, 0.1), 1.0, {}}, points,
                                          noise);
    const auto score = process.score(priors::Merit::marginal_likelihood, values, true);
    benchmark::DoNotOptimize(
        process.slopes(priors::Merit::marginal_likelihood, values, score.factor));
  }
}
BENCHMARK(likelihood_with_gradient)->Arg(500)->Arg(1000)->Unit(benchmark::kMillisecond);

// One shape of 13 values at so many places, with its deviation.
void prediction(benchmark::State& state) {
  const auto points = sample(13);
  const auto places = sample(state.range(0));
  const priors::Kernel kernel(priors::kernel_family("squared_exponential"));
  const priors::GaussianProcess process({kernel, Eigen::VectorXd::Constant(1, 0.25), 1.0, {}},
                                        points, Eigen::VectorXd::Constant(13, 1e-4));
  const Eigen::VectorXd values = shapes(points).col(0);
  for (auto _ : state) benchmark::DoNotOptimize(process.at(places, values));
}
BENCHMARK(prediction)->Arg(1000000)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
