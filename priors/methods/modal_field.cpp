#include "priors/methods/modal_field.h"

#include <fmt/format.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "priors/methods/blocks.h"
#include "priors/residual/random_coefficients.h"

namespace chladni::priors {
namespace {

// The lower triangular root of F Fᵀ.
Eigen::MatrixXd triangular(const Eigen::MatrixXd& root) {
  const Eigen::Index r = root.rows();
  const Eigen::HouseholderQR<Eigen::MatrixXd> factor(Eigen::MatrixXd(root.transpose()));
  Eigen::MatrixXd lower = Eigen::MatrixXd::Zero(r, r);
  const auto rows = std::min(r, root.cols());
  lower.leftCols(rows) =
      factor.matrixQR().topRows(rows).triangularView<Eigen::Upper>().toDenseMatrix().transpose();
  return lower;
}

}  // namespace

ModalField::ModalField(std::vector<ShapeCoefficients> shapes, FitSummary summary)
    : ModeField(std::move(summary)), shapes_(std::move(shapes)) {
  means_.resize(shapes_.front().mean.size(), static_cast<Eigen::Index>(shapes_.size()));
  for (std::size_t i = 0; i < shapes_.size(); ++i) {
    means_.col(static_cast<Eigen::Index>(i)) = shapes_[i].mean;
    roots_.push_back(triangular(shapes_[i].root));
  }
}

// Deviations at places [first, first + count).
void ModalField::add_deviations(const Places& places, Eigen::Index first, Eigen::Index count,
                                Eigen::MatrixXd& deviation) const {
  const Eigen::MatrixXd block = places.shapes.middleRows(first, count);
  Eigen::MatrixXd spread(count, block.cols());
  for (std::size_t i = 0; i < shapes_.size(); ++i) {
    spread.noalias() = block * roots_[i].triangularView<Eigen::Lower>();
    deviation.col(static_cast<Eigen::Index>(i)).segment(first, count) =
        (spread.rowwise().squaredNorm().array() + shapes_[i].beyond).sqrt();
  }
}

Field ModalField::field_at(const Places& places) const {
  const auto n = places.count();
  require(places.shapes.rows() == n && places.shapes.cols() == means_.rows(),
          "mode field: the places carry " + fmt::to_string(places.shapes.cols()) +
              " modes of the simulation; expected " + fmt::to_string(means_.rows()));
  Field field{Eigen::MatrixXd(n, means_.cols()), Eigen::MatrixXd(n, means_.cols())};
  for_blocks(n, [&](Eigen::Index first, Eigen::Index count) {
    field.mean.middleRows(first, count).noalias() = places.shapes.middleRows(first, count) * means_;
    add_deviations(places, first, count, field.deviation);
  });
  return field;
}

FittedShape fitted_shape(const MeasuredShapes& measured, const ModalBasis& basis, Eigen::Index mode,
                         const Eigen::MatrixXd& root, double noise, double beyond) {
  const auto deviation = deviation_of_values(measured, mode, noise, beyond);
  const RandomCoefficients random(measured.places.shapes * root, measured.values.col(mode),
                                  deviation);
  const auto known = random.posterior();
  const auto left_out = random.left_out();
  FittedShape shape;
  const double square =
      measured.values.col(mode).squaredNorm() / static_cast<double>(measured.values.rows());
  shape.coefficients = {root * known.mean, root * known.root, beyond * square};
  shape.log_evidence = random.log_evidence();
  shape.left_out_log_density = left_out.log_density;
  shape.misfit = left_out.standardised.squaredNorm() / static_cast<double>(deviation.size());
  shape.vanishes = random.vanishes();
  const auto& known_of = shape.coefficients;
  const double left =
      (basis.gram * known_of.root).cwiseProduct(known_of.root).sum() + known_of.beyond;
  const double seen = known_of.mean.dot(basis.gram * known_of.mean);
  shape.expected_error = left / (seen + left);
  return shape;
}

FitSummary modal_summary(const std::vector<FittedShape>& shapes) {
  const auto m = static_cast<Eigen::Index>(shapes.size());
  FitSummary summary;
  Eigen::VectorXd misfit(m);
  Eigen::VectorXd expected(m);
  summary.log_evidence.resize(m);
  for (Eigen::Index i = 0; i < m; ++i) {
    const auto& shape = shapes[static_cast<std::size_t>(i)];
    misfit(i) = shape.misfit;
    expected(i) = shape.expected_error;
    summary.log_evidence(i) = shape.log_evidence;
    if (shape.vanishes) {
      summary.notes.push_back(fmt::format(
          "mode {}: its values are no more than their noise, all places may lie on its nodal lines",
          i + 1));
    } else if (shape.expected_error > kHardlySeen) {
      summary.notes.push_back(
          fmt::format("mode {}: the places hardly see it, {:.0f} % of its mean square is expected "
                      "to be wrong",
                      i + 1, 100.0 * shape.expected_error));
    }
  }
  summary.parameters = {{"misfit", "1", misfit}, {"expected_error", "1", expected}};
  return summary;
}

}  // namespace chladni::priors
