#include "identification/fraction/filled.h"

#include <complex>
#include <numbers>

#include "identification/poles/completion.h"
#include "identification/poles/mode_choice.h"
#include "identification/poles/start_poles.h"

namespace chladni::identification {
namespace {

// Responses of poles with these residues, a constant and a term in 1/s².
Eigen::MatrixXcd values_of(const Eigen::VectorXcd& poles, const Residues& residues,
                           const Eigen::VectorXd& frequency_hz) {
  const Eigen::ArrayXcd s =
      std::complex<double>(0.0, 2.0 * std::numbers::pi) * frequency_hz.array();
  const auto along = [](const Eigen::ArrayXcd& function, const Eigen::MatrixXd& across) {
    return Eigen::MatrixXcd(function.matrix() * across.reshaped().transpose());
  };
  Eigen::MatrixXcd sum = along(Eigen::ArrayXcd::Ones(s.size()), residues.constant);
  sum += along(s.square().inverse(), residues.rigid);
  for (Eigen::Index m = 0; m < poles.size(); ++m) {
    const auto pole = poles(m);
    sum += along((s * s - 2.0 * pole.real() * s + std::norm(pole)).inverse(),
                 residues.of_pole[static_cast<std::size_t>(m)]);
  }
  return sum;
}

}  // namespace

Eigen::MatrixXcd filled(const FitData& data, const Progress& progress) {
  const auto has_value = (data.weight.array() > 0.0).eval();
  if (has_value.all()) return data.value;
  IdentificationOptions options;
  options.rigid_count = -1;
  options.fit.progress = progress;
  const auto found = start_poles(data, options);
  const auto poles = worthwhile(data, found.problem, found.pole, 0);
  auto residues = ResidueProblem(data, poles, true).residues();
  const auto measured = measured_responses(data.weight, data.outputs);
  for (auto& residue : residues.of_pole) residue = completed(residue, measured, 1);
  const auto rank = rigid_rank(data, residues, options.most_rigid);
  residues.rigid = completed(residues.rigid, measured, rank);
  return has_value.select(data.value, values_of(poles, residues, data.frequency_hz));
}

}  // namespace chladni::identification
