// Numbers with units, as a study writes them: "20 mm", "70 GPa", "2700 kg/m^3".
#pragma once

#include <string>
#include <string_view>

namespace chladni {

/// The value of `text`, a number and a unit, in the SI unit `si_unit` ("m", "Pa", "kg/m^3", "N/m",
/// "rad", "1"). A unit that does not convert by a factor (degC, a reciprocal, rad/s for Hz) is
/// refused.
/// @throws InvalidInput  no number, no unit, an unknown unit, or a unit of another dimension; the
///                       message has the text, its interpretation and an example ("expected a
///                       length such as \"20 mm\"")
[[nodiscard]] double quantity(std::string_view text, std::string_view si_unit);

/// How many `si_unit` one `unit` is: unit_factor("mm", "m") = 1e-3. @throws as above.
[[nodiscard]] double unit_factor(std::string_view unit, std::string_view si_unit);

}  // namespace chladni
