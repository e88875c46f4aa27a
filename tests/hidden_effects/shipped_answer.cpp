#include "hidden_effects/shipped_answer.h"

#include <chrono>
#include <fstream>
#include <map>
#include <utility>

#include "app/quiet_run.h"
#include "io/frf_file.h"
#include "simulators/tables/rig.h"
#include "stage/diagnosis_structure.h"
#include "study/study.h"

namespace chladni::hidden_effects {
namespace {

// The study of a rig, as somebody writes it who has its responses in a file and knows nothing else.
std::string text_of(const simulators::Rig& rig, double edge_length) {
  return simulators::study_text(rig, edge_length) +
         "\n[measurement]\nfrf = \"frf.csv\"\n\n[identification]\nunit = \"m\"\n";
}

study::Study study_in(const app::TestFolder& folder, const simulators::Rig& rig,
                      const modal::FrfSet& measured, double edge_length) {
  if (!rig.surface.empty()) std::ofstream(folder.path() / "body.off") << rig.surface;
  static_cast<void>(io::write_frf(folder.path() / "frf.csv", measured));
  return study::parse_study(text_of(rig, edge_length), folder.path() / "study.toml");
}

stage::WorkOptions without_certificate(const app::TestFolder& folder) {
  stage::WorkOptions options;
  options.certificate = false;
  options.folder = folder.path();
  return options;
}

const stage::Solution& solution_of(const study::Study& study, const std::string& body,
                                   const stage::WorkOptions& options) {
  static std::map<std::string, stage::Solution> kept;
  const auto found = kept.find(body);
  if (found != kept.end()) return found->second;
  stage::Work work(options);
  return kept.emplace(body, stage::solved(stage::with_modes_for_diagnosis(study), work))
      .first->second;
}

}  // namespace

ShippedAnswer shipped_answer(const simulators::Rig& rig, const modal::FrfSet& measured,
                             double edge_length) {
  const app::TestFolder folder("rig_" + rig.name);
  const auto study = study_in(folder, rig, measured, edge_length);
  const auto options = without_certificate(folder);
  const auto& before = solution_of(study, rig.name, options);
  stage::Work work(options);
  const auto start = std::chrono::steady_clock::now();
  auto told = steps::diagnosed(study, before, work);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  return {std::move(told.result), told.gain, took.count(), work.seconds()};
}

}  // namespace chladni::hidden_effects
