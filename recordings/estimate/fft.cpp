#include "recordings/fft.h"

#include <fmt/format.h>

#include <fftw3.h>

#include <memory>
#include <mutex>
#include <string>
#include <type_traits>

#include "base/error.h"

namespace chladni::recordings {
namespace {

// Only one thread at a time may plan in FFTW; execution is free. Estimated plans give the
// same bits in each run.
std::mutex planning;  // NOLINT(cppcoreguidelines-avoid-non-const-global-variables)

struct Destroy {
  void operator()(fftw_plan plan) const {
    const std::lock_guard lock(planning);
    fftw_destroy_plan(plan);
  }
};
using Plan = std::unique_ptr<std::remove_pointer_t<fftw_plan>, Destroy>;

fftw_complex* raw(std::complex<double>* values) {
  return reinterpret_cast<fftw_complex*>(values);  // NOLINT: FFTW's manual says they are the same
}

Plan planned(auto plan_one) {
  const std::lock_guard lock(planning);
  Plan plan(plan_one());
  if (plan == nullptr) throw NumericalFailure("FFTW has no plan for this transform");
  return plan;
}

}  // namespace

Eigen::MatrixXcd fourier(const Eigen::Ref<const Eigen::MatrixXd>& signals) {
  const auto n = signals.rows();
  require(n >= 1 && n < (Eigen::Index{1} << 30), "Fourier transform: a signal of no samples");
  Eigen::VectorXd column(n);
  Eigen::VectorXcd lines(n / 2 + 1);
  const Plan plan = planned([&] {
    return fftw_plan_dft_r2c_1d(static_cast<int>(n), column.data(), raw(lines.data()),
                                FFTW_ESTIMATE);
  });
  Eigen::MatrixXcd result(n / 2 + 1, signals.cols());
  for (Eigen::Index j = 0; j < signals.cols(); ++j) {
    column = signals.col(j);
    fftw_execute(plan.get());
    result.col(j) = lines;
  }
  return result;
}

Eigen::MatrixXd inverse_fourier(const Eigen::MatrixXcd& lines, Eigen::Index samples) {
  require(samples >= 1 && samples < (Eigen::Index{1} << 30) && lines.rows() == samples / 2 + 1,
          "inverse Fourier transform: " + fmt::to_string(lines.rows()) + " lines for " +
              fmt::to_string(samples) + " samples");
  Eigen::VectorXcd column(lines.rows());
  Eigen::VectorXd signal(samples);
  const Plan plan = planned([&] {
    return fftw_plan_dft_c2r_1d(static_cast<int>(samples), raw(column.data()), signal.data(),
                                FFTW_ESTIMATE);
  });
  Eigen::MatrixXd result(samples, lines.cols());
  for (Eigen::Index j = 0; j < lines.cols(); ++j) {
    column = lines.col(j);
    fftw_execute(plan.get());
    result.col(j) = signal / static_cast<double>(samples);
  }
  return result;
}

}  // namespace chladni::recordings
