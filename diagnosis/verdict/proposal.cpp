#include "diagnosis/proposal.h"

#include <fmt/format.h>

namespace chladni::diagnosis {
namespace {

std::string place_text(const Eigen::Vector2d& place) {
  return fmt::format("at ({:.0f}, {:.0f}) mm", 1e3 * place(0), 1e3 * place(1));
}

std::string task_of(const Proposal& proposal) {
  using What = Proposal::What;
  switch (proposal.what) {
    case What::repetition:
      return "measure " + proposal.of + " again";
    case What::exchange:
      return "put another channel in the place of " + proposal.of;
    case What::mass:
      return fmt::format("lay a known mass of {:.2g} g {}, and measure the frequencies again",
                         1e3 * proposal.mass, place_text(proposal.place.value()));
    case What::dimension:
      return "measure " + proposal.of;
    case What::sensor:
      return "a sensor " + place_text(proposal.place.value());
    case What::weighing:
      return "weigh " + proposal.of;
  }
  return "";
}

}  // namespace

std::string in_words(const Proposal& proposal) {
  return fmt::format("{}: ln of the Bayes factor about {:.2g}", task_of(proposal),
                     proposal.evidence);
}

std::string_view name(Proposal::What what) {
  using What = Proposal::What;
  switch (what) {
    case What::repetition:
      return "repetition";
    case What::exchange:
      return "exchange";
    case What::mass:
      return "mass";
    case What::dimension:
      return "dimension";
    case What::sensor:
      return "sensor";
    case What::weighing:
      return "weighing";
  }
  return "";
}

}  // namespace chladni::diagnosis
