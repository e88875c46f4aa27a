#include "diagnosis/modes/matching.h"

#include <cmath>

#include "base/index.h"
#include "diagnosis/constants.h"
#include "modal/pairing.h"

namespace chladni::diagnosis {

using Eigen::Index;

Matching matched(const MeasuredModes& measured, const RecordedModes& model, const ShapeUnits& units,
                 PairBy by) {
  Matching result{std::vector<Index>(at(measured.count()), -1), {}};
  result.span.resize(result.model.size());
  if (model.count() == 0) return result;
  Eigen::MatrixXd cost(measured.count(), model.count());
  const double most = 1.0 - kConstants.least_mac;
  for (Index i = 0; i < measured.count(); ++i) {
    for (Index k = 0; k < model.count(); ++k) {
      const double apart =
          std::log(measured.frequency_hz(i) / model.frequency_hz(k)) / kConstants.apart;
      cost(i, k) = apart * apart;
      if (by == PairBy::shape && cost(i, k) < most) {
        cost(i, k) +=
            1.0 - partner(measured, model, units, i, span_of(measured, model, i, k)).likeness();
      }
    }
  }
  for (const auto& [i, k] : modal::assigned(cost, most)) {
    result.model[at(i)] = k;
    result.span[at(i)] = span_of(measured, model, i, k);
  }
  return result;
}

Index count_alone(const Matching& matching) {
  return std::ranges::count(matching.model, Index{-1});
}

Matching matching_of(const MeasuredModes& measured, const RecordedModes& model,
                     const std::vector<Index>& partners) {
  Matching result{partners, {}};
  result.span.resize(partners.size());
  for (std::size_t i = 0; i < partners.size(); ++i) {
    if (partners[i] >= model.count()) result.model[i] = -1;
    if (result.model[i] < 0) continue;
    result.span[i] = span_of(measured, model, static_cast<Index>(i), result.model[i]);
  }
  return result;
}

std::vector<Partner> partners_of(const Matching& matching, const MeasuredModes& measured,
                                 const RecordedModes& model, const ShapeUnits& units) {
  std::vector<Partner> all(matching.model.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (matching.model[i] < 0) continue;
    all[i] = partner(measured, model, units, static_cast<Index>(i), matching.span[i]);
  }
  return all;
}

Eigen::MatrixXd parts_of(const std::vector<Partner>& partners, Index modes) {
  Eigen::MatrixXd parts = Eigen::MatrixXd::Zero(modes, std::ssize(partners));
  for (std::size_t i = 0; i < partners.size(); ++i) {
    if (partners[i].parts.size() > 0) parts.col(static_cast<Index>(i)) = partners[i].parts;
  }
  return parts;
}

}  // namespace chladni::diagnosis
