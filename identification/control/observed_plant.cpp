#include "identification/observed_plant.h"

#include <Eigen/QR>
#include <algorithm>
#include <complex>
#include <vector>

#include "base/error.h"
#include "identification/control/scaled_model.h"

namespace chladni::identification {
namespace {

struct Sizes {
  Eigen::Index sensors = 0, actuators = 0, modes = 0, points = 0, forces = 0, floors = 0;

  [[nodiscard]] Eigen::Index outputs() const { return sensors + points; }
  [[nodiscard]] Eigen::Index inputs() const { return actuators + forces + floors; }
};

Sizes sizes(const ModalFit& fit, const ObservedPlaces& places) {
  const Sizes n{fit.model.output_count(),  fit.model.input_count(),
                fit.model.mode_count(),    std::ssize(places.points),
                std::ssize(places.forces), places.floor.size() > 0 ? 1 : 0};
  const auto fits = [&](const PlacesOfInterest& rows, Eigen::Index count) {
    const auto complex = fit.complex && count > 0 ? count : 0;
    return rows.shapes.rows() == count && (count == 0 || rows.shapes.cols() == n.modes) &&
           (complex == 0 || rows.imaginary.rows() == complex);
  };
  require(fits(places.at_points, n.points) && fits(places.at_forces, n.forces) &&
              (n.points == 0 || (places.at_points.residual.rows() == n.points &&
                                 places.at_points.residual.cols() == n.actuators)) &&
              (n.floors == 0 || places.floor.size() == n.modes),
          "observed plant: shapes at the points and forces do not fit the modes of the fit");
  return n;
}

// Rows of the points below those of the sensors, columns of forces beside those of actuators.
template <typename Matrix>
void append(const Sizes& n, const Matrix& at_points, const Matrix& at_forces,
            const Eigen::VectorXd& floor, Matrix& outputs, Matrix& inputs) {
  using Number = typename Matrix::Scalar;
  outputs.conservativeResize(n.outputs(), Eigen::NoChange);
  if (n.points > 0) outputs.bottomRows(n.points) = at_points;
  inputs.conservativeResize(Eigen::NoChange, n.inputs());
  if (n.forces > 0) inputs.middleCols(n.actuators, n.forces) = at_forces.transpose();
  if (n.floors > 0) inputs.rightCols(1) = -floor.cast<Number>();
}

Eigen::MatrixXcd complex_rows(const PlacesOfInterest& rows) {
  if (rows.shapes.rows() == 0) return {};
  return rows.shapes.cast<std::complex<double>>() +
         std::complex<double>(0.0, 1.0) * rows.imaginary.cast<std::complex<double>>();
}

// Rows of a match with a deviation in one mode or more: a channel that was not measured has none,
// and its values say nothing. All rows where no mode has a scale.
std::vector<Eigen::Index> rows_that_tell(const GainMatch& match) {
  std::vector<Eigen::Index> all;
  std::vector<Eigen::Index> told;
  for (Eigen::Index i = 0; i < match.shapes.rows(); ++i) {
    all.push_back(i);
    if (i < match.deviation.rows() && match.deviation.row(i).array().isFinite().any()) {
      told.push_back(i);
    }
  }
  return told.empty() ? all : told;
}

modal::ReducedModel enlarged(const Sizes& n, const ObservedPlaces& places,
                             modal::ReducedModel model) {
  append<Eigen::MatrixXd>(n, places.at_points.shapes, places.at_forces.shapes, places.floor,
                          model.output_shapes, model.input_shapes);
  Eigen::MatrixXd residual = Eigen::MatrixXd::Zero(n.outputs(), n.inputs());
  residual.topLeftCorner(n.sensors, n.actuators) = model.residual;
  if (n.points > 0) residual.bottomLeftCorner(n.points, n.actuators) = places.at_points.residual;
  model.residual = residual;
  return model;
}

}  // namespace

modal::ControlModel observed_plant(const ModalFit& fit, const GainMatch& match,
                                   const std::vector<modal::MeasuredChannel>& outputs,
                                   const std::vector<modal::MeasuredChannel>& inputs,
                                   const ObservedPlaces& places) {
  const auto n = sizes(fit, places);
  std::vector<modal::OutputChannel> rows;
  std::vector<std::string> columns;
  for (const auto& output : outputs) rows.push_back({output.name, output.kind});
  for (const auto& point : places.points) rows.push_back({point, modal::FrfKind::receptance});
  for (const auto& input : inputs) columns.push_back(input.name);
  columns.insert(columns.end(), places.forces.begin(), places.forces.end());
  if (n.floors > 0) columns.emplace_back("floor");
  require(n.floors == 0 || std::ranges::all_of(outputs,
                                               [](const auto& output) {
                                                 return output.kind == modal::FrfKind::receptance;
                                               }),
          "a floor that moves: sensors of velocity or acceleration do not stand on it; expected "
          "sensors of displacement");
  const auto whole = enlarged(n, places, in_scale_of(match, fit.model));
  modal::ControlModel model;
  if (fit.complex) {
    auto shapes = in_scale_of(match, fit, *fit.complex);
    append<Eigen::MatrixXcd>(n, complex_rows(places.at_points), complex_rows(places.at_forces),
                             places.floor, shapes.outputs, shapes.inputs);
    model =
        modal::control_model(state_space(whole, shapes), complex_states(fit.model), rows, columns);
  } else {
    model = modal::control_model(whole, rows, columns);
  }
  if (n.floors > 0) model.inputs.back().unit = "m/s^2";
  set_delays(fit, model);
  return model;
}

Eigen::VectorXd floor_participation(const GainMatch& match, const std::vector<Eigen::Index>& rigid,
                                    const Eigen::VectorXd& along) {
  if (rigid.empty() || along.size() != match.shapes.rows()) return {};
  const auto rows = rows_that_tell(match);
  const Eigen::MatrixXd shapes = match.shapes(rows, rigid);
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(shapes);
  if (qr.rank() < shapes.cols()) return {};
  Eigen::VectorXd result = Eigen::VectorXd::Zero(match.shapes.cols());
  const Eigen::VectorXd parts = qr.solve(Eigen::VectorXd(along(rows)));
  result(rigid) = parts;
  return result;
}

}  // namespace chladni::identification
