// interpolation_study [tables]: every way to interpolate, on plates that the simulation does not
// know. Prints one table per case; figures in bench/README.md.
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

#include "base/parallel.h"
#include "priors/interpolator.h"
#include "simulators/plate_study.h"
#include "simulators/real_tables.h"

namespace chladni {
namespace {

constexpr int kModes = 12;
constexpr int kFirst = 9;  // modes 1 to 9 are what 13 places can resolve

struct Case {
  std::string layout, prior;
  double noise = 0.01;
};

struct Scores {
  Eigen::MatrixXd error, covered;  // tables×modes
};

simulators::KirchhoffPlate believed_plate(const std::string& prior) {
  if (prior == "P0") return simulators::minimal_table(25);
  if (prior == "P1") return simulators::minimal_table_with_corner_masses(25);
  return simulators::accurate_table();
}

Scores scores_of(const Case& one, const simulators::PlateModes& believed,
                 const std::vector<simulators::PlateModes>& tables,
                 const priors::Interpolator& method) {
  const auto count = static_cast<Eigen::Index>(tables.size());
  Scores scores{Eigen::MatrixXd(count, kModes), Eigen::MatrixXd(count, kModes)};
  parallel_ranges(tables.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      const auto surface = simulators::plate_surface(tables[t]);
      const auto test =
          simulators::plate_test(tables[t], believed, surface, simulators::layout(one.layout),
                                 kModes, one.noise, static_cast<unsigned>(100 + t));
      const auto simulation = simulators::plate_simulation(believed, surface);
      const auto field =
          priors::mode_field(method, test.measured, simulation)->at(simulation.surface);
      const auto row = static_cast<Eigen::Index>(t);
      scores.error.row(row) = priors::squared_error(field.mean, test.truth, simulation.area);
      scores.covered.row(row) = priors::coverage(field, test.truth, simulation.area);
    }
  });
  return scores;
}

void print_case(const Case& one, const std::vector<simulators::PlateModes>& tables,
                const std::string& only) {
  const auto believed = simulators::plate_modes(
      believed_plate(one.prior), std::getenv("NM") ? std::atoi(std::getenv("NM")) : 20);
  fmt::print("\n{} {} noise {:.0f} %\n", one.layout, one.prior, 100.0 * one.noise);
  fmt::print("{:28} {:>7} {:>7} {:>7} {:>7} {:>6} {:>6}\n", "method", "m1-9", "m10-12", "geo",
             "worst", "cov", "least");
  for (const auto* method : priors::interpolators()) {
    if (!only.empty() && only != method->name) continue;
    if (std::string(method->name) == "ensemble") continue;
    const auto scores = scores_of(one, believed, tables, *method);
    const Eigen::RowVectorXd mean = scores.error.colwise().mean();
    const Eigen::RowVectorXd covered = scores.covered.colwise().mean();
    fmt::print("{:28} {:7.4f} {:7.4f} {:7.4f} {:7.3f} {:6.3f} {:6.3f}\n", method->name,
               mean.head(kFirst).mean(), mean.tail(kModes - kFirst).mean(),
               std::exp(scores.error.array().log().mean()), scores.error.maxCoeff(), covered.mean(),
               covered.minCoeff());
  }
}

}  // namespace
}  // namespace chladni

int main(int argc, char** argv) {
  using chladni::Case;
  const int count = argc > 1 ? std::atoi(argv[1]) : 20;
  const std::string only = argc > 2 ? argv[2] : "";
  std::vector<chladni::simulators::PlateModes> tables(static_cast<std::size_t>(count));
  chladni::parallel_ranges(tables.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      tables[t] = chladni::simulators::plate_modes(
          chladni::simulators::real_table(static_cast<unsigned>(t + 1)), chladni::kModes);
    }
  });
  for (const auto& one :
       {Case{"quincunx", "P0"}, Case{"rings", "P0"}, Case{"rand1", "P0"}, Case{"rand2", "P0"},
        Case{"rings", "P1"}, Case{"rings", "P2"}, Case{"rings", "P0", 0.05}}) {
    chladni::print_case(one, tables, only);
  }
}
