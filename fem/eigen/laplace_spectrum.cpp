#include "fem/laplace_spectrum.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <string>

#include "base/error.h"
#include "fem/modes.h"

namespace chladni::fem {
namespace {

// The functions that are constant on one piece and 0 on the other pieces, mass-orthonormal.
Eigen::MatrixXd constants(const mesh::Laplacian& laplacian) {
  const auto k = laplacian.piece.size();
  Eigen::MatrixXd functions = Eigen::MatrixXd::Zero(k, laplacian.piece.maxCoeff() + 1);
  for (Eigen::Index i = 0; i < k; ++i) functions(i, laplacian.piece(i)) = 1.0;
  const Eigen::MatrixXd image = laplacian.mass.selfadjointView<Eigen::Lower>() * functions;
  for (Eigen::Index c = 0; c < functions.cols(); ++c) {
    functions.col(c) /= std::sqrt(functions.col(c).dot(image.col(c)));
  }
  return functions;
}

}  // namespace

LaplaceSpectrum laplace_spectrum(const mesh::Laplacian& laplacian, int count) {
  System system;
  system.stiffness = laplacian.stiffness;
  system.mass = laplacian.mass;
  system.rigid = constants(laplacian);
  system.positions = laplacian.positions;
  const auto pieces = static_cast<int>(system.rigid.cols());
  require(count > 0 && count <= laplacian.mass.rows(),
          "spectrum: " + fmt::to_string(count) + " functions of " +
              fmt::to_string(laplacian.mass.rows()) + " points; expected 1 to as many");
  const double across =
      (laplacian.positions.colwise().maxCoeff() - laplacian.positions.colwise().minCoeff()).norm();
  system.frequency_scale_hz = 0.5 / across;  // (2π · this)² = μ = (π / across)²
  LaplaceSpectrum spectrum;
  Eigen::MatrixXd functions = system.rigid;
  spectrum.eigenvalue = Eigen::VectorXd::Zero(pieces);
  if (count > pieces) {
    const auto found = modes(system, {.count = count - pieces}).modes;
    functions = found.shapes;
    spectrum.eigenvalue = (2.0 * std::numbers::pi * found.frequency_hz).cwiseAbs2();
  }
  spectrum.functions = laplacian.on_nodes * functions;
  return spectrum;
}

Eigen::MatrixXd functions_at(const LaplaceSpectrum& spectrum,
                             const std::vector<mesh::Site>& sites) {
  Eigen::MatrixXd values(static_cast<Eigen::Index>(sites.size()), spectrum.functions.cols());
  for (std::size_t k = 0; k < sites.size(); ++k) {
    const auto& site = sites[k];
    require(site.nodes.maxCoeff() < spectrum.functions.rows() && site.nodes.minCoeff() >= 0,
            "spectrum: a site's node is not below " + fmt::to_string(spectrum.functions.rows()));
    values.row(static_cast<Eigen::Index>(k)) =
        site.weights.transpose() * spectrum.functions(site.nodes, Eigen::all);
  }
  return values;
}

}  // namespace chladni::fem
