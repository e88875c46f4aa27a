#include "diagnosis/hypothesis.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/error.h"
#include "base/index.h"
#include "diagnosis/fit/responses.h"
#include "diagnosis/modes/calibration/constants_held.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;

Eigen::VectorXd coordinates(const Cause& cause, const Effect& effect, const Structure& structure) {
  const auto parameters = effect.parameters(structure);
  Eigen::VectorXd x(static_cast<Index>(parameters.size()));
  for (std::size_t n = 0; n < parameters.size(); ++n) {
    const auto told =
        std::ranges::find(cause.parameters, parameters[n].name, &CauseParameter::name);
    require(told != cause.parameters.end(),
            fmt::format("the cause {} has no number \"{}\"", cause.effect, parameters[n].name));
    x(static_cast<Index>(n)) = parameters[n].coordinate(told->value);
  }
  return x;
}

// The choice of the cause that acts on these channels; −1: there is none.
Index option_of(const Cause& cause, const Effect& effect, const Structure& structure,
                const std::vector<std::string>& channels) {
  const Index options = effect.options(structure);
  for (Index option = 0; option < options; ++option) {
    if (choice_of(effect, option).text != cause.option) continue;
    if (effect.channels(structure, option) == channels) return option;
  }
  return -1;
}

// A permutation as exchanges of two labels, one after the other.
std::vector<Supposed> exchanges_of(const Cause& cause, const Structure& structure) {
  const bool sensors = cause.effect == "permuted_sensors";
  const auto& names = (sensors ? structure.outputs : structure.inputs).names;
  const auto& exchange = effect(sensors ? "swapped_sensors" : "swapped_actuators");
  std::vector<std::string> shown = names;  // the channel of each record, so far
  std::vector<Supposed> all;
  for (std::size_t i = 0; i < cause.channels.size(); ++i) {
    const auto record = std::ranges::find(names, cause.channels[i]) - names.begin();
    const auto other = std::ranges::find(shown, cause.truly[i]) - shown.begin();
    require(record < std::ssize(names) && other < std::ssize(names),
            fmt::format("the cause {} is of a channel that this structure does not have",
                        cause.effect));
    if (record == other) continue;
    const auto [a, b] = std::minmax(record, other);
    const Index option = option_of({}, exchange, structure, {names[at(a)], names[at(b)]});
    all.push_back({&exchange, option, Eigen::VectorXd()});
    std::swap(shown[at(a)], shown[at(b)]);
  }
  return all;
}

}  // namespace

std::vector<Supposed> supposed_of(const Cause& cause, const Structure& structure) {
  if (!cause.truly.empty()) return exchanges_of(cause, structure);
  const auto& effect = diagnosis::effect(cause.effect);
  const auto x = coordinates(cause, effect, structure);
  if (const Index option = option_of(cause, effect, structure, cause.channels); option >= 0) {
    return {{&effect, option, x}};
  }
  std::vector<Supposed> each;
  for (const auto& channel : cause.channels) {
    const Index option = option_of(cause, effect, structure, {channel});
    if (option >= 0) each.push_back({&effect, option, x});
  }
  require(!each.empty() && each.size() == cause.channels.size(),
          fmt::format("the cause {} of \"{}\" {} is none of this structure", cause.effect,
                      fmt::join(cause.channels, ", "), cause.option));
  return each;
}

std::vector<Eigen::MatrixXcd> predicted(const Structure& structure,
                                        const std::vector<Cause>& causes,
                                        const Eigen::VectorXd& frequency_hz) {
  return predicted(structure, {}, causes, frequency_hz);
}

std::vector<Eigen::MatrixXcd> predicted(const Structure& structure,
                                        const std::vector<CalibratedNumber>& constants,
                                        const std::vector<Cause>& causes,
                                        const Eigen::VectorXd& frequency_hz) {
  auto state = state_of(structure);
  for (const auto& constant : constants) {  // before the causes, as in the fits
    if (!constant.determined) continue;
    held_effect(constant.name, constant.effect)
        .apply(state, structure, 0,
               Eigen::VectorXd::Constant(1, std::log(constant.value / constant.of_study)));
  }
  for (const auto& cause : causes) {
    for (const auto& supposed : supposed_of(cause, structure)) {
      change_of(supposed, structure)(state);
    }
  }
  const Eigen::MatrixXcd all = responses(state, 2.0 * std::numbers::pi * frequency_hz);
  std::vector<Eigen::MatrixXcd> value;
  for (Index k = 0; k < frequency_hz.size(); ++k) {
    value.emplace_back(
        all.row(k).transpose().reshaped(structure.output_count(), structure.input_count()));
  }
  return value;
}

}  // namespace chladni::diagnosis
