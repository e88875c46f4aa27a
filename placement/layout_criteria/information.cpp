// Value of the sampled modal matrix: Fisher information of the modal amplitudes.
#include <Eigen/Cholesky>
#include <Eigen/SVD>
#include <cmath>

#include "modal/mac.h"
#include "placement/layout.h"
#include "placement/layout_criteria/undefined.h"

namespace chladni::placement {
namespace {

// Singular values below it are rounding: the layout does not see this combination of the modes
// [points of average motion].
constexpr double kOnlyRounding = 1e-9;

// Empty if there are fewer points than modes; 0 where there is nothing but rounding.
Eigen::VectorXd singular_values(const LayoutView& view) {
  const Eigen::MatrixXd seen = observed(view);
  if (seen.rows() < seen.cols()) return {};
  const Eigen::VectorXd values = seen.jacobiSvd().singularValues();
  return (values.array() < kOnlyRounding).select(0.0, values);
}

double log_determinant_of(const LayoutView& view) {
  const auto values = singular_values(view);
  return values.size() == 0 ? kUndefined : 2.0 * values.array().log().sum();
}

double amplitude_deviation(const LayoutView& view) {
  const auto values = singular_values(view);
  return values.size() == 0 ? kUndefined : std::sqrt(values.array().square().inverse().mean());
}

double smallest_value(const LayoutView& view) {
  const auto values = singular_values(view);
  return values.size() == 0 ? kUndefined : values.minCoeff();
}

double condition_number(const LayoutView& view) {
  const auto values = singular_values(view);
  return values.size() == 0 ? kUndefined : values.maxCoeff() / values.minCoeff();
}

// Largest squared cosine of an angle between the spans of two groups.
double largest_mac(const LayoutView& view) {
  const Eigen::MatrixXd seen = observed(view);
  double largest = 0.0;
  for (const auto& a : view.groups) {
    for (const auto& b : view.groups) {
      if (b.first <= a.first) continue;
      if (seen.rows() < std::max(a.size, b.size)) return kUndefined;
      const Eigen::MatrixXd one = seen.middleCols(a.first, a.size);
      const Eigen::MatrixXd two = seen.middleCols(b.first, b.size);
      if (one.jacobiSvd().singularValues().minCoeff() < kOnlyRounding ||
          two.jacobiSvd().singularValues().minCoeff() < kOnlyRounding) {
        return 1.0;
      }
      largest = std::max(largest, modal::subspace_mac(one, two).maxCoeff());
    }
  }
  return largest;
}

// The least of diag Φ (ΦᵀΦ)⁻¹ Φᵀ: it is small for a point that the others make redundant.
double least_independence(const LayoutView& view) {
  const Eigen::MatrixXd seen = observed(view);
  if (seen.rows() < seen.cols()) return kUndefined;
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(seen, Eigen::ComputeThinU);
  if (svd.singularValues().minCoeff() < kOnlyRounding) return kUndefined;
  return svd.matrixU().rowwise().squaredNorm().minCoeff();
}

double energy_share(const LayoutView& view) {
  const Eigen::MatrixXd seen = observed(view);
  return seen.rows() == 0 ? kUndefined : seen.cwiseAbs2().mean();
}

}  // namespace

extern const LayoutCriterion determinant, a_optimality, smallest_singular_value, condition,
    auto_mac, effective_independence, kinetic_energy;
constinit const LayoutCriterion determinant{
    "determinant", "log det of the Fisher information of the modal amplitudes (D-optimality)",
    "Kammer 1991", "1",
    true,          log_determinant_of};
constinit const LayoutCriterion a_optimality{
    "a_optimality",
    "root mean square deviation of the modal amplitudes per deviation of a sample (A-optimality)",
    "Pukelsheim 1993",
    "1",
    false,
    amplitude_deviation};
constinit const LayoutCriterion smallest_singular_value{
    "smallest_singular_value",
    "of the sampled modal matrix, modes of mean square 1 (E-optimality)",
    "Pukelsheim 1993",
    "1",
    true,
    smallest_value};
constinit const LayoutCriterion condition{"condition",
                                          "condition number of the sampled modal matrix",
                                          "Golub and Van Loan 2013",
                                          "1",
                                          false,
                                          condition_number};
constinit const LayoutCriterion auto_mac{
    "auto_mac",
    "largest MAC between different modes: what these points cannot tell apart",
    "Allemang and Brown 1982",
    "1",
    false,
    largest_mac};
constinit const LayoutCriterion effective_independence{
    "effective_independence",
    "the least that a point adds to the linear independence of the modes",
    "Kammer 1991",
    "1",
    true,
    least_independence};
constinit const LayoutCriterion kinetic_energy{
    "kinetic_energy",
    "mean square motion of the modes at the points, over that of the whole surface",
    "Salama et al. 1987",
    "1",
    true,
    energy_share};

}  // namespace chladni::placement
