// Complex shapes of an identified model, as JSON and as a table.
#pragma once

#include <string>

#include "identification/modal_fit.h"
#include "io/json.h"

namespace chladni::show {

[[nodiscard]] io::Json complex_json(const identification::ComplexShapes& shapes);
/// @param fit  with complex shapes
[[nodiscard]] std::string complex_table(const identification::ModalFit& fit);

}  // namespace chladni::show
