#include "diagnosis/proposal.h"

#include <fmt/format.h>

namespace chladni::diagnosis {

std::string place_in_words(const Eigen::Vector2d& place) {
  constexpr int kMicrometre = 3;  // decimals of a millimetre
  const double largest = 1e3 * place.cwiseAbs().maxCoeff();
  int decimals = 0;
  for (double size = largest; size > 0.0 && size < 10.0 && decimals < kMicrometre; size *= 10.0) {
    ++decimals;
  }
  return fmt::format("({:.{}f}, {:.{}f}) mm", 1e3 * place(0), decimals, 1e3 * place(1), decimals);
}

namespace {

std::string task_of(const Proposal& proposal) {
  using What = Proposal::What;
  switch (proposal.what) {
    case What::repetition:
      return "measure " + proposal.of + " again";
    case What::exchange:
      return "put another channel in the place of " + proposal.of;
    case What::mass:
      return fmt::format("lay a known mass of {:.2g} g at {}, and measure the frequencies again",
                         1e3 * proposal.mass, place_in_words(proposal.place.value()));
    case What::dimension:
      return "measure " + proposal.of;
    case What::sensor:
      return "a sensor at " + place_in_words(proposal.place.value());
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
