// Layouts of 13 sites for the 3 rigid-body and the first 9 flexible modes of the 600 x 600 x 20 mm
// plate that move its face: on the 9 x 9
// mounting grid and on 101 x 101 points of its face. Wall time of one thread; "efficiency" is the
// D-efficiency that the bound makes certain, "error" the expected error of interpolation.
#include <benchmark/benchmark.h>

#include <Eigen/Dense>
#include <map>

#include "dense/blas.h"
#include "fem/assemble.h"
#include "fem/modes.h"
#include "host/parallel.h"
#include "mesh/bodies.h"
#include "placement/determinant.h"
#include "placement/interpolation.h"
#include "placement/sites.h"

namespace chladni::placement {
namespace {

constexpr Eigen::Index kModes = 12, kSites = 13, kRigid = 6, kRigidSeen = 3;

struct Face {
  Sites sites;
  Eigen::VectorXd frequency_hz;
};

// n by n points over `width` [m].
const Face& face(std::int64_t n) {
  static std::map<std::int64_t, Face> kept;
  Face& found = kept[n];
  if (found.sites.count() > 0) return found;
  const auto body = mesh::with_order(mesh::layered(mesh::Plate{0.6, 0.6, 0.02}, 0.05, 1), 3);
  const auto system = fem::assemble(body, {fem::isotropic(70e9, 0.33, 2700.0)});
  auto modes = fem::modes(system, {.count = 20, .certificate = false}).modes;
  modes.shapes = fem::on_nodes(system.dofs, modes.shapes);
  const Sampler sampler(body, modes, {Eigen::Vector3d::UnitZ(), 0.0});
  const double width = n == 9 ? 0.48 : 0.6;
  std::vector<mesh::Site> places;
  for (std::int64_t i = 0; i < n * n; ++i) {
    const double step = width / static_cast<double>(n - 1);
    places.push_back(*sampler.finder().from_above(step * static_cast<double>(i % n) - 0.5 * width,
                                                  step * static_cast<double>(i / n) - 0.5 * width));
  }
  found = {sampler.at(places), modes.frequency_hz};
  return found;
}

DeterminantProblem determinant_problem(std::int64_t n) {
  const auto& sites = face(n).sites;
  DeterminantProblem problem;
  problem.rows.resize(sites.count(), kModes);
  Eigen::Index column = 0;
  for (Eigen::Index i = 0; i < kRigid; ++i) {
    if (sites.shapes.col(i).norm() > 1e-6 * sites.shapes.norm()) {
      problem.rows.col(column++) = sites.shapes.col(i);
    }
  }
  problem.rows.rightCols(kModes - kRigidSeen) =
      sites.shapes.middleCols(kRigid, kModes - kRigidSeen);
  const Eigen::RowVectorXd rms =
      problem.rows.colwise().norm() / std::sqrt(static_cast<double>(problem.rows.rows()));
  problem.rows = problem.rows * rms.cwiseInverse().asDiagonal();
  problem.prior = Eigen::MatrixXd::Zero(kModes, kModes);
  problem.count = kSites;
  problem.position = sites.position;
  return problem;
}

// Against the best bound there is for these candidates.
double efficiency(const DeterminantProblem& problem, double score) {
  static std::map<Eigen::Index, double> bounds;
  double& bound = bounds[problem.rows.rows()];
  if (bound == 0.0) {
    const bool small = problem.rows.rows() < 100;
    bound = best_determinant(problem, {.node_limit = small ? 100000 : 0}).bound;
  }
  return std::exp((score - bound) / kModes);
}

void qr_pivoting(benchmark::State& state) {  // as PySensors places; its first r sites
  const auto problem = determinant_problem(state.range(0));
  std::vector<Eigen::Index> sites;
  for (auto _ : state) {
    const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(problem.rows.transpose());
    sites.assign(qr.colsPermutation().indices().data(),
                 qr.colsPermutation().indices().data() + kSites);
  }
  state.counters["efficiency"] = efficiency(problem, log_determinant(problem, sites));
}

void plain_greedy(benchmark::State& state) {
  const auto problem = determinant_problem(state.range(0));
  std::vector<Eigen::Index> sites;
  for (auto _ : state) sites = greedy(problem);
  state.counters["efficiency"] = efficiency(problem, log_determinant(problem, sites));
}

void determinant_with_bound(benchmark::State& state) {
  const auto problem = determinant_problem(state.range(0));
  Choice choice;
  for (auto _ : state) choice = best_determinant(problem);
  state.counters["efficiency"] = choice.certificate(kModes);
}

void determinant_proven(benchmark::State& state) {
  const auto problem = determinant_problem(state.range(0));
  Choice choice;
  for (auto _ : state) choice = best_determinant(problem, {.node_limit = 100000});
  state.counters["efficiency"] = choice.certificate(kModes);
  state.counters["nodes"] = choice.nodes;
  state.counters["proven"] = choice.proven ? 1 : 0;
}

void interpolation(benchmark::State& state) {
  const auto& [sites, frequency_hz] = face(state.range(0));
  const auto& surface = face(101).sites;
  std::vector<Eigen::Index> wanted;
  for (Eigen::Index i = 0; i < kModes; ++i) wanted.push_back(kRigid + i);
  InterpolationProblem problem;
  problem.rows = sites.shapes;
  problem.noise = Eigen::VectorXd::Constant(kModes, 0.01);
  problem.there.resize(0, sites.shapes.cols());
  problem.there_noise.resize(0, kModes);
  problem.prior =
      shape_prior(surface.shapes, Eigen::VectorXd::Ones(surface.count()), frequency_hz, wanted);
  problem.count = kSites;
  problem.position = sites.position;
  Choice choice;
  for (auto _ : state) choice = best_interpolation(problem);
  state.counters["error"] = -choice.score;
}

#define CHLADNI_SIZES Arg(9)->Arg(101)->Unit(benchmark::kMillisecond)
BENCHMARK(qr_pivoting)->CHLADNI_SIZES;
BENCHMARK(plain_greedy)->CHLADNI_SIZES;
BENCHMARK(determinant_with_bound)->CHLADNI_SIZES;
BENCHMARK(determinant_proven)->Arg(9)->Unit(benchmark::kMillisecond);
BENCHMARK(interpolation)->CHLADNI_SIZES;

}  // namespace
}  // namespace chladni::placement

int main(int argc, char** argv) {
  chladni::dense::use_best_blas_kernel(argv);
  chladni::set_thread_count(1);
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
}
