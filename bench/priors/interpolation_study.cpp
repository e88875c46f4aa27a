// interpolation_study [tables] [method] [first] [case | parameters]: every way to interpolate, on
// plates that the simulation does not know. Prints one table per case; figures in bench/README.md.
// A method or case (such as "rings P0 1") of "all" is every one; with "parameters" also what was
// learned of each plate. The last column is how much worse than the thin-plate spline a mode of a
// table came out at most.
#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "host/parallel.h"
#include "placement/interpolation.h"
#include "priors/interpolator.h"
#include "simulators/tables/plate_corrections.h"
#include "simulators/tables/plate_study.h"
#include "simulators/tables/real_tables.h"

namespace chladni {
namespace {

constexpr int kModes = 12;
constexpr int kBelieved = 40;  // flexible modes of the simulation
constexpr int kFirst = 9;      // modes 1 to 9 are what 13 places can resolve

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

// The thirteen mounts that are expected to leave the smallest mean error, by the simulation alone.
Eigen::MatrixX2d best_places(const simulators::PlateModes& believed, double noise) {
  const auto mounts = simulators::mounts();
  const auto candidates = simulators::plate_places(believed, mounts);
  const auto surface = simulators::plate_surface(believed);
  std::vector<Eigen::Index> wanted;
  for (Eigen::Index i = 0; i < kModes; ++i) wanted.push_back(3 + i);
  placement::InterpolationProblem problem;
  problem.rows = candidates.shapes;
  problem.noise = Eigen::VectorXd::Constant(kModes, noise);
  problem.there.resize(0, candidates.shapes.cols());
  problem.there_noise.resize(0, kModes);
  problem.prior = placement::shape_prior(simulators::shapes_at(believed, surface.places),
                                         surface.area, believed.frequency_hz, wanted);
  problem.count = 13;
  problem.position = candidates.position;
  const auto choice = placement::best_interpolation(problem);
  Eigen::MatrixX2d places(problem.count, 2);
  for (Eigen::Index k = 0; k < problem.count; ++k) {
    places.row(k) = mounts.row(choice.sites[static_cast<std::size_t>(k)]);
  }
  return places;
}

// What is believed in a case, and where it is measured.
struct Belief {
  simulators::PlateModes modes;
  std::vector<priors::Correction> corrections;
  Eigen::MatrixX2d places;
};

Belief belief_of(const Case& one) {
  const auto plate = believed_plate(one.prior);
  Belief belief{simulators::plate_modes(plate, kBelieved), {}, {}};
  belief.corrections = simulators::plate_corrections(plate, belief.modes);
  belief.places = one.layout == "I-optimal" ? best_places(belief.modes, one.noise)
                                            : simulators::layout(one.layout);
  return belief;
}

struct Wish {
  int count = 20;
  std::string method;  // empty: all
  unsigned first = 1;
  bool parameters = false;
};

void print_parameters(unsigned seed, const priors::FitSummary& summary) {
  std::string line = fmt::format("table {}:", seed);
  for (const auto& one : summary.parameters) {
    line += fmt::format("\n  {} =", one.name);
    for (const double value : one.value) line += fmt::format(" {:.3g}", value);
  }
  for (const auto& note : summary.notes) line += "\n  " + note;
  fmt::print("{}\n", line);
}

Scores scores_of(const Case& one, const Belief& belief,
                 const std::vector<simulators::PlateModes>& tables,
                 const priors::Interpolator& method, const Wish& wish) {
  const auto count = static_cast<Eigen::Index>(tables.size());
  Scores scores{Eigen::MatrixXd(count, kModes), Eigen::MatrixXd(count, kModes)};
  parallel_ranges(tables.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      const auto seed = wish.first + static_cast<unsigned>(t);
      const auto surface = simulators::plate_surface(tables[t]);
      const auto test = simulators::plate_test(tables[t], belief.modes, surface, belief.places,
                                               kModes, one.noise, 99 + seed);
      auto simulation = simulators::plate_simulation(belief.modes, surface);
      simulation.corrections = belief.corrections;
      const auto fitted = priors::mode_field(method, test.measured, simulation);
      if (wish.parameters) print_parameters(seed, fitted->summary());
      const auto field = fitted->at(simulation.surface);
      const auto row = static_cast<Eigen::Index>(t);
      scores.error.row(row) = priors::squared_error(field.mean, test.truth, simulation.area);
      scores.covered.row(row) = priors::coverage(field, test.truth, simulation.area);
    }
  });
  return scores;
}

// Methods that need what a plate's simulation lacks are left out.
bool wanted(const priors::Interpolator& method, const Wish& wish) {
  const std::string name = method.name;
  return wish.method.empty() ? name != "ensemble" && name != "surface_matern" : name == wish.method;
}

void print_case(const Case& one, const std::vector<simulators::PlateModes>& tables,
                const Wish& wish) {
  const auto belief = belief_of(one);
  const auto spline =
      scores_of(one, belief, tables, priors::interpolator("thin_plate_spline"), wish);
  fmt::print("\n{} {} noise {:.0f} %\n", one.layout, one.prior, 100.0 * one.noise);
  fmt::print("{:32} {:>7} {:>7} {:>7} {:>7} {:>6} {:>6} {:>7}\n", "method", "m1-9", "m10-12", "geo",
             "worst", "cov", "least", "margin");
  for (const auto* method : priors::interpolators()) {
    if (!wanted(*method, wish)) continue;
    const auto scores = scores_of(one, belief, tables, *method, wish);
    const Eigen::RowVectorXd mean = scores.error.colwise().mean();
    const Eigen::RowVectorXd covered = scores.covered.colwise().mean();
    fmt::print("{:32} {:7.4f} {:7.4f} {:7.4f} {:7.3f} {:6.3f} {:6.3f} {:7.4f}\n", method->name,
               mean.head(kFirst).mean(), mean.tail(kModes - kFirst).mean(),
               std::exp(scores.error.array().log().mean()), scores.error.maxCoeff(), covered.mean(),
               covered.minCoeff(), (scores.error - spline.error).maxCoeff());
    std::fflush(stdout);
  }
}

}  // namespace
}  // namespace chladni

int main(int argc, char** argv) {
  using chladni::Case;
  chladni::Wish wish;
  if (argc > 1) wish.count = std::atoi(argv[1]);
  if (argc > 2 && std::string(argv[2]) != "all") wish.method = argv[2];
  if (argc > 3) wish.first = static_cast<unsigned>(std::atoi(argv[3]));
  const std::string last = argc > 4 ? argv[4] : "all";
  wish.parameters = last == "parameters";
  const bool every_case = wish.parameters || last == "all";
  std::vector<chladni::simulators::PlateModes> tables(static_cast<std::size_t>(wish.count));
  chladni::parallel_ranges(tables.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      const auto seed = wish.first + static_cast<unsigned>(t);
      tables[t] =
          chladni::simulators::plate_modes(chladni::simulators::real_table(seed), chladni::kModes);
    }
  });
  for (const auto& one :
       {Case{"quincunx", "P0"}, Case{"rings", "P0"}, Case{"rand1", "P0"}, Case{"rand2", "P0"},
        Case{"rings", "P1"}, Case{"rings", "P2"}, Case{"rings", "P0", 0.05},
        Case{"I-optimal", "P0"}, Case{"I-optimal", "P2"}}) {
    const auto name = fmt::format("{} {} {:.0f}", one.layout, one.prior, 100.0 * one.noise);
    if (every_case || name == last) chladni::print_case(one, tables, wish);
  }
}
