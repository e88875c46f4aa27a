#include <fmt/format.h>

#include <algorithm>

#include "diagnosis/modes/given.h"
#include "diagnosis/modes/modes_fit.h"
#include "real_rigs_tables.h"

namespace chladni {
namespace {

using diagnosis::ModesFit;
using diagnosis::Supposed;
using Eigen::Index;

// The choice of the effect that acts on these channels; -1: none.
Index option_of(const diagnosis::Effect& effect, const diagnosis::Structure& structure,
                std::vector<std::string> channels) {
  std::ranges::sort(channels);
  for (Index option = 0; option < effect.options(structure); ++option) {
    auto own = effect.channels(structure, option);
    std::ranges::sort(own);
    if (own == channels) return option;
  }
  return -1;
}

// The hidden effect as the catalogue says it; numbers that it does not state have their centres.
std::optional<Supposed> supposed_of(const simulators::HiddenEffect& hidden,
                                    const diagnosis::Structure& structure) {
  const auto known = diagnosis::effects();
  const auto found = std::ranges::find_if(
      known, [&](const diagnosis::Effect* one) { return one->name == hidden.kind; });
  if (found == known.end()) return std::nullopt;
  Supposed cause{*found, option_of(**found, structure, hidden.channels), {}};
  if (cause.option < 0) return std::nullopt;
  const auto parameters = cause.effect->parameters(structure);
  cause.x.resize(static_cast<Index>(parameters.size()));
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const auto& one = parameters[i];
    auto& x = cause.x(static_cast<Index>(i));
    const auto size = hidden.size.find(std::string(one.name));
    x = one.centre;
    if (one.is_place() && hidden.place) {
      x = (*hidden.place)(one.role == diagnosis::Parameter::Role::place_u ? 0 : 1);
    } else if (size != hidden.size.end()) {
      x = one.coordinate(size->second);
    }
  }
  return cause;
}

void print_fit(const std::string& name, const ModesFit& fit, double than) {
  fmt::print("        {:<16} ln {:>7.2f}  objective {:>8.2f}  x", name, fit.log_evidence - than,
             fit.objective);
  for (const auto& cause : fit.causes) {
    for (const double x : cause.x) fmt::print(" {:.4g}", x);
  }
  fmt::print("  levels");
  for (const double level : fit.levels) fmt::print(" {:.3g}", level);
  fmt::print("\n");
}

}  // namespace

void print_truth_fit(const diagnosis::Structure& structure, const simulators::RealRigCase& rig,
                     const diagnosis::DiagnosisOptions& options) {
  const auto own = diagnosis::given(structure, rig.modes);
  const diagnosis::ModesProblem problem(own.structure, own.measured, options.tolerances, true);
  const auto nothing = problem.nothing();
  print_fit("nothing", nothing, nothing.log_evidence);
  ModesFit start = nothing;
  for (const auto& hidden : rig.truth) {
    const auto cause = supposed_of(hidden, own.structure);
    if (!cause) return;
    start.causes.push_back(*cause);
  }
  if (start.causes.empty()) return;
  print_fit("truth as it is", problem.fitted(start, 0), nothing.log_evidence);
  print_fit("truth fitted", problem.fitted(start), nothing.log_evidence);
  start.levels = problem.prior().usual;
  print_fit("from usual", problem.fitted(start), nothing.log_evidence);
}

}  // namespace chladni
