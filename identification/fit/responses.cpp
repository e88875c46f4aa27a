#include <complex>
#include <numbers>

#include "identification/modal_fit.h"
#include "modal/frf.h"

namespace chladni::identification {

Eigen::VectorXd response_delays(const ModalFit& fit) {
  const auto p = fit.model.output_count();
  Eigen::VectorXd all = Eigen::VectorXd::Constant(p * fit.model.input_count(), fit.delay_s);
  if (fit.channel_delay_s.size() == 0) return all;
  for (Eigen::Index e = 0; e < all.size(); ++e) {
    all(e) += fit.channel_delay_s(fit.delay_of == DelayOf::outputs ? e % p : e / p);
  }
  return all;
}

Eigen::MatrixXcd responses(const ModalFit& fit, const Eigen::VectorXd& frequency_hz) {
  const auto& model = fit.model;
  const auto p = model.output_count();
  const auto q = model.input_count();
  Eigen::MatrixXcd result(frequency_hz.size(), p * q);
  if (fit.complex) {
    result = responses(model, *fit.complex, frequency_hz);
  } else {
    const auto frf = modal::frf(model, frequency_hz);
    for (Eigen::Index k = 0; k < frequency_hz.size(); ++k) {
      const auto& line = frf.value[static_cast<std::size_t>(k)];
      result.row(k) = Eigen::Map<const Eigen::RowVectorXcd>(line.data(), p * q);
    }
  }
  for (Eigen::Index k = 0; k < frequency_hz.size(); ++k) {
    result.row(k) *= std::polar(1.0, -2.0 * std::numbers::pi * frequency_hz(k) * fit.delay_s);
  }
  if (fit.channel_delay_s.size() == 0) return result;
  const Eigen::VectorXd own = response_delays(fit).array() - fit.delay_s;
  for (Eigen::Index e = 0; e < result.cols(); ++e) {
    for (Eigen::Index k = 0; k < frequency_hz.size(); ++k) {
      result(k, e) *= std::polar(1.0, -2.0 * std::numbers::pi * frequency_hz(k) * own(e));
    }
  }
  return result;
}

}  // namespace chladni::identification
