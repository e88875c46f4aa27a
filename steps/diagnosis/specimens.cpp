#include "steps/specimens.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "stage/diagnosis_structure.h"
#include "stage/solution.h"
#include "steps/diagnosis/by_modes.h"
#include "steps/diagnosis/responses_in_band.h"
#include "steps/identification.h"
#include "steps/measured_modes.h"

namespace chladni::steps {
namespace {

std::vector<std::filesystem::path> folders_for(const study::Study& study, const stage::Work& work) {
  auto allowed = work.choices().allowed;
  allowed.push_back(std::filesystem::absolute(study.file).parent_path());
  return allowed;
}

// Adds the name of a specimen to what is wrong with it.
template <typename Step>
auto of_specimen(const std::string& name, Step step) {
  try {
    return step();
  } catch (const InvalidInput& e) {
    throw InvalidInput(name + ": " + e.what());
  }
}

// A mass is compared with the sheet only by the deviation that it states.
void warn_of_unused_mass(const std::string& name, const study::Study& one, stage::Work& work) {
  const bool is_compared =
      std::ranges::any_of(one.sheet, [](const auto& entry) { return entry.effect == "mass"; });
  if (!(one.measurement->mass > 0.0) || is_compared) return;
  work.warn(
      fmt::format("{}: {}: [measurement] mass is not compared, since it states no deviation; "
                  "write mass = {{ value = \"{:.4g} g\", measured = \"0.3 %\" }}",
                  name, one.file.string(), 1e3 * one.measurement->mass));
}

study::Study read_one(const study::Study& study, const study::SpecimenPlan& plan,
                      stage::Work& work) {
  return of_specimen(plan.name, [&] {
    auto one = study::read_study(plan.file, folders_for(study, work));
    require(one.specimens.empty(), one.file.string() + " has specimens of its own");
    require(one.measurement.has_value(), one.file.string() + " has no [measurement]");
    require(!one.constants.empty(),
            one.file.string() +
                ": no constant states how well it is known; expected some, such as youngs_modulus "
                "= { value = \"70 GPa\", within = \"10 %\" }");
    warn_of_unused_mass(plan.name, one, work);
    return one;
  });
}

// The modes of a specimen, of its file or of its responses.
diagnosis::MeasuredModes modes_of_specimen(const study::Study& study, stage::Work& work) {
  if (has_modes(*study.measurement)) return measured_modes(study, work);
  const auto measured =
      within_band(measured_frfs(study, work), study, plan_of(study), HUGE_VAL, work);
  const auto seen = modal::part(measured.all, measured.outputs, measured.inputs);
  const auto fit = modes_of(seen, measured.variance_stated, study, work);
  require(fit.has_value(), "no modes can be identified from its responses");
  const auto& lines = seen.frequency_hz;
  const auto all =
      diagnosis::measured_modes(*fit, modal::names_of(seen.outputs), modal::names_of(seen.inputs),
                                lines(0), lines.tail(1)(0));
  return clear_modes(all, work);
}

std::vector<diagnosis::CalibratedConstant> numbers_of(const study::Study& study,
                                                      const diagnosis::Surface& chart) {
  auto all = constants_of(study, chart);
  const bool is_crossed = chart.axis_u.cwiseAbs().y() > chart.axis_u.cwiseAbs().x();
  for (auto one : study.sheet) {
    if (is_crossed && one.effect.starts_with("length_along")) {
      one.effect = one.effect == "length_along_u" ? "length_along_v" : "length_along_u";
    }
    all.push_back(std::move(one));
  }
  return all;
}

diagnosis::Specimen specimen_of(const study::SpecimenPlan& plan, const study::Study& study,
                                const diagnosis::MeasuredModes& modes, stage::Work& work) {
  return of_specimen(plan.name, [&] {
    const auto part = work.part(plan.name + ": ");
    const auto solution = stage::solved(stage::with_modes_for_diagnosis(study), work);
    diagnosis::Specimen one{plan.name, plan.group, plan.same_as, {}, {}, {}};
    one.measured = modes_below(0.9 * solution.modes.frequency_hz.tail(1)(0), modes, study, work);
    one.structure = stage::structure_of(study, solution, one.measured.frequency_hz.tail(1)(0));
    one.constants = numbers_of(study, one.structure.surface);
    return one;
  });
}

}  // namespace

DiagnosedSpecimens diagnosed_specimens(const study::Study& study, stage::Work& work) {
  DiagnosedSpecimens all;
  for (const auto& plan : study.specimens) all.studies.push_back(read_one(study, plan, work));
  std::vector<diagnosis::MeasuredModes> modes;
  for (std::size_t i = 0; i < all.studies.size(); ++i) {
    modes.push_back(of_specimen(study.specimens[i].name, [&] {
      return work.timed(study.specimens[i].name + ": measured modes",
                        [&] { return modes_of_specimen(all.studies[i], work); });
    }));
  }
  for (std::size_t i = 0; i < all.studies.size(); ++i) {
    all.specimens.push_back(specimen_of(study.specimens[i], all.studies[i], modes[i], work));
  }
  all.result = work.timed("diagnosis", [&] {
    return diagnosis::diagnosed(all.specimens, options_of(plan_of(study), work));
  });
  return all;
}

}  // namespace chladni::steps
