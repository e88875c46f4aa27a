// A study is also a test: compares its expectations with the results.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "steps/expectations.h"

namespace chladni::steps {
namespace {

double found_for(const study::Expectation& expectation, const stage::Solution& solution) {
  if (expectation.key == "mass") return solution.model.mass.mass_kg;
  if (expectation.key == "volume") return mesh::volume(solution.model.body);
  if (expectation.key == "rigid_body_modes") return static_cast<double>(solution.modes.rigid_count);
  const auto number = std::stol(expectation.key.substr(expectation.key.find('_') + 1));
  const Eigen::Index index = solution.modes.rigid_count + number - 1;
  return index < solution.modes.mode_count() ? solution.modes.frequency_hz(index)
                                             : std::numeric_limits<double>::quiet_NaN();
}

std::string unit_text(const study::Expectation& expectation) {
  return expectation.unit == "1" ? "" : " " + expectation.unit;
}

std::string verdict_line(const JudgedExpectation& one) {
  const auto& [expectation, found, met] = one;
  const std::string unit = unit_text(expectation);
  const double off = found - expectation.value;
  const std::string relative =
      expectation.value != 0.0 ? fmt::format(" ({:+.3f} %)", 100.0 * off / expectation.value) : "";
  return fmt::format("{}  {:<18} expected {:.7g}{} within {:.4g}{}, found {:.7g}{}{}\n",
                     met ? "met   " : "FAILED", expectation.key, expectation.value, unit,
                     expectation.within, unit, found, unit, relative);
}

/// An implicit expectation of every study: the modes satisfy their equation.
constexpr double kLargestResidual = 1e-8;

double largest_residual(const stage::Solution& solution) {
  return solution.summary.residual.size() > 0 ? solution.summary.residual.maxCoeff() : 0.0;
}

}  // namespace

void require_expectations(const study::Study& study) {
  require(!study.expectations.empty(),
          study.file.string() +
              " expects nothing; add a table [expect], such as frequency_1 = { "
              "value = \"183.8 Hz\", within = \"1 %\" }");
}

std::vector<JudgedExpectation> judged(const study::Study& study, const stage::Solution& solution,
                                      stage::Work& work) {
  std::vector<JudgedExpectation> all;
  for (const auto& expectation : study.expectations) {
    const double found = found_for(expectation, solution);
    const bool met = std::abs(found - expectation.value) <= expectation.within * (1.0 + 1e-12);
    all.push_back({expectation, found, met});
    work.show(verdict_line(all.back()));
  }
  const double residual = largest_residual(solution);
  work.show(fmt::format("{}  {:<18} expected at most {:.0e}, found {:.1e}\n",
                        residual <= kLargestResidual ? "met   " : "FAILED", "residual",
                        kLargestResidual, residual));
  return all;
}

void require_met(const study::Study& study, const std::vector<JudgedExpectation>& all,
                 const stage::Solution& solution) {
  const auto failed = std::ranges::count(all, false, &JudgedExpectation::met);
  if (failed > 0) {
    throw NumericalFailure(
        fmt::format("{}: {} of {} expectations not met", study.file.string(), failed, all.size()));
  }
  if (!(largest_residual(solution) <= kLargestResidual)) {
    throw NumericalFailure(study.file.string() + ": a residual above what can be trusted");
  }
}

void judge(const study::Study& study, const stage::Solution& solution, stage::Work& work) {
  require_expectations(study);
  require_met(study, judged(study, solution, work), solution);
}

}  // namespace chladni::steps
