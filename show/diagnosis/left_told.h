// What the causes of a diagnosis leave of the misfit, and where.
#pragma once

#include <string>
#include <vector>

#include "io/json.h"
#include "steps/diagnosis.h"

namespace chladni::show {

/// The responses [k] with the causes, each p×q as MeasuredFrfs::all: those of the fitted model, or
/// else of the extended study; empty: nothing was predicted anew.
[[nodiscard]] const std::vector<Eigen::MatrixXcd>& with_the_causes(const steps::Diagnosed& one);

/// A residue as chi² per measured number of each sensor, actuator and band, with its correlation
/// between neighbouring lines and its excess.
[[nodiscard]] io::JsonObject misfit_json(const diagnosis::Residue& residue, double excess);

/// `left` of diagnosis.json: the misfit with the causes where they are those of responses, and each
/// response with them where they were predicted; null where neither is known.
/// Cost: one comparison of responses.
/// @throws InvalidInput  as diagnosis::compared
[[nodiscard]] io::Json left_json(const steps::Diagnosed& one);

/// The response that is off most with the causes, and how alike errors of neighbouring lines are,
/// before and after; empty where nothing was predicted anew, or no response was seen.
/// @throws InvalidInput  as diagnosis::compared
[[nodiscard]] std::string left_line(const steps::Diagnosed& one);

}  // namespace chladni::show
