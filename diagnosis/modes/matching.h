// Which measured mode belongs to which mode of a hypothesis.
#pragma once

#include <vector>

#include "diagnosis/modes/partner.h"

namespace chladni::diagnosis {

/// What tells measured modes apart.
enum class PairBy { shape, frequency };

/// For each measured mode its mode of the hypothesis; −1: it has none.
struct Matching {
  std::vector<Eigen::Index> model;
  std::vector<std::vector<Eigen::Index>> span;  ///< span_of each of these; empty: none
};
/// Number of measured modes that have none.
[[nodiscard]] Eigen::Index count_alone(const Matching& matching);
/// At least total cost (modal::assigned): 1 − MAC plus the square of ln(frequency ratio) over
/// Constants::apart. Without shapes the frequency alone decides.
[[nodiscard]] Matching matched(const MeasuredModes& measured, const RecordedModes& model,
                               const ShapeUnits& units, PairBy by = PairBy::shape);
/// Given partners, with the spans that they have in this model. A mode that it lacks is none.
[[nodiscard]] Matching matching_of(const MeasuredModes& measured, const RecordedModes& model,
                                   const std::vector<Eigen::Index>& partners);

/// The partner of each measured mode; without parts: it has none.
[[nodiscard]] std::vector<Partner> partners_of(const Matching& matching,
                                               const MeasuredModes& measured,
                                               const RecordedModes& model, const ShapeUnits& units);
/// Their parts, n×m for n modes of the model; 0 where there is no partner.
[[nodiscard]] Eigen::MatrixXd parts_of(const std::vector<Partner>& partners, Eigen::Index modes);

}  // namespace chladni::diagnosis
