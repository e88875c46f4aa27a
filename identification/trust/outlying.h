// Values of the data that their neighbours contradict, and whether they decide a fit.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "identification/trust.h"

namespace chladni::identification {

/// Weighted power |w h l r|² of mode m of a fit, taken by itself; K lines × pq responses.
[[nodiscard]] Eigen::MatrixXd powers_of(const ModalFit& fit, Eigen::Index m, const FitData& data);

/// Puts the outlying values, and the reason where they decide the result, into the judgement, whose
/// level and unexplained power are known. `again` as in judged().
void look_for_outliers(const Identified& found, const FitData& data,
                       const std::optional<IdentificationOptions>& again, Judgement& judgement);

}  // namespace chladni::identification
