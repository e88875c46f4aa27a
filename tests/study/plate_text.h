// The body and the material of a study: a plate of aluminium, free.
#pragma once

namespace chladni::study {

inline constexpr const char* kPlateText = R"(
[geometry]
plate = { length = "400 mm", width = "300 mm", thickness = "12 mm" }
[material]
youngs_modulus = "70 GPa"
poissons_ratio = 0.33
density = "2700 kg/m^3"
)";

}  // namespace chladni::study
