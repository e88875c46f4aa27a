// The free 600 x 600 x 20 mm plate of docs and tests, tet10, 20 flexible modes: each step apart and
// the whole, in 22, 40 and 72 bricks each way and two layers (30, 98 and 315 thousand degrees of
// freedom). CPU time of all threads.
#include <benchmark/benchmark.h>

#include <cmath>
#include <map>
#include <numbers>

#include "bench/peers/cholmod.h"
#include "dense/blas.h"
#include "fem/assemble.h"
#include "fem/error_estimate.h"
#include "fem/factor/factorization.h"
#include "fem/modes.h"
#include "mesh/bodies.h"

namespace chladni {
namespace {

const std::vector<fem::Material> kAluminium{fem::isotropic(70e9, 0.33, 2700.0)};
const double kShift = std::pow(2.0 * std::numbers::pi * 400.0, 2);

struct Plate {
  mesh::TetMesh body;
  fem::System system;
};

const Plate& plate(std::int64_t bricks) {
  static std::map<std::int64_t, Plate> kept;
  auto& found = kept[bricks];
  if (found.body.tet_count() == 0) {
    found.body = mesh::with_order(
        mesh::layered(mesh::Plate{0.6, 0.6, 0.02}, 0.6 / static_cast<double>(bricks), 2), 2);
    found.system = fem::assemble(found.body, kAluminium);
  }
  return found;
}

void describe(benchmark::State& state, const Plate& p) {
  state.counters["dof"] = static_cast<double>(p.system.mass.rows());
}

void assemble(benchmark::State& state) {
  const auto& p = plate(state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(fem::assemble(p.body, kAluminium));
  describe(state, p);
}

void order_and_analyse(benchmark::State& state) {
  const auto& p = plate(state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(fem::Symbolic(p.system.stiffness));
  describe(state, p);
}

void factorise(benchmark::State& state) {
  const auto& p = plate(state.range(0));
  const fem::Symbolic symbolic(p.system.stiffness);
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        fem::Factorization(symbolic, p.system.stiffness, kShift, p.system.mass));
  }
  describe(state, p);
  state.counters["entries"] = symbolic.forecast().entries;
}

void certify(benchmark::State& state) {
  const auto& p = plate(state.range(0));
  const fem::Symbolic symbolic(p.system.stiffness);
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        fem::inertia(symbolic, p.system.stiffness, -6.0 * kShift, p.system.mass));
  }
  describe(state, p);
}

void modes(benchmark::State& state) {
  const auto& p = plate(state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(fem::modes(p.system, {.count = 20}));
  describe(state, p);
}

void estimate_error(benchmark::State& state) {
  const auto& p = plate(state.range(0));
  const auto found = fem::modes(p.system, {.count = 20, .certificate = false}).modes;
  for (auto _ : state) {
    benchmark::DoNotOptimize(fem::frequency_error(p.body, kAluminium, p.system, found));
  }
  describe(state, p);
}

// CHOLMOD as it is: its own order, its own OpenMP threads.
void peer_cholmod(benchmark::State& state) {
  const auto& p = plate(state.range(0));
  double entries = 0.0;
  for (auto _ : state) {
    entries = bench::cholmod_entries(p.system.stiffness, kShift, p.system.mass);
  }
  describe(state, p);
  state.counters["entries"] = entries;
}
BENCHMARK(peer_cholmod)
    ->Arg(22)
    ->Arg(40)
    ->Arg(72)
    ->Unit(benchmark::kSecond)
    ->MeasureProcessCPUTime();

#define CHLADNI_SIZES Arg(22)->Arg(40)->Arg(72)->Unit(benchmark::kSecond)->MeasureProcessCPUTime()
BENCHMARK(assemble)->CHLADNI_SIZES;
BENCHMARK(order_and_analyse)->CHLADNI_SIZES;
BENCHMARK(factorise)->CHLADNI_SIZES;
BENCHMARK(certify)->CHLADNI_SIZES;
BENCHMARK(modes)->CHLADNI_SIZES;
BENCHMARK(estimate_error)->CHLADNI_SIZES;

}  // namespace
}  // namespace chladni

int main(int argc, char** argv) {
  chladni::dense::use_best_blas_kernel(argv);
  benchmark::Initialize(&argc, argv);
  benchmark::AddCustomContext("blas_kernel", chladni::dense::blas_kernel());
  benchmark::RunSpecifiedBenchmarks();
}
