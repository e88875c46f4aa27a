#include "identification/rigid_properties.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <array>
#include <cmath>
#include <limits>
#include <unsupported/Eigen/NonLinearOptimization>

#include "base/error.h"
#include "identification/constants.h"

namespace chladni::identification {
namespace {

constexpr double kNone = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kNotTold = 1e-7;  // singular values, relative to the largest

// Entries of a symmetric 3×3 matrix: xx, yy, zz, xy, xz, yz.
constexpr std::array<std::array<int, 2>, 6> kEntries{
    {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}}};

Eigen::Matrix3d symmetric(const Eigen::VectorXd& entries) {
  Eigen::Matrix3d matrix;
  for (Eigen::Index k = 0; k < 6; ++k) {
    const auto [a, b] = kEntries[static_cast<std::size_t>(k)];
    matrix(a, b) = matrix(b, a) = entries(k);
  }
  return matrix;
}

// Ten parameters without units: mobility 1/m over `mobility`, centre from `middle` over `distance`,
// inverse inertia over mobility / distance².
struct RigidModel {
  ChannelFrame outputs, inputs;
  Eigen::VectorXd measured, weight;  // pq
  Eigen::Vector3d middle;
  double distance = 1.0, mobility = 1.0;

  using Scalar = double;
  using InputType = Eigen::VectorXd;
  using ValueType = Eigen::VectorXd;
  using JacobianType = Eigen::MatrixXd;
  enum { InputsAtCompileTime = Eigen::Dynamic, ValuesAtCompileTime = Eigen::Dynamic };
  [[nodiscard]] int inputs_count() const { return 10; }
  [[nodiscard]] int values() const {
    return std::max(10, static_cast<int>(measured.size()));  // the method needs ten or more
  }

  [[nodiscard]] Eigen::Vector3d centre(const Eigen::VectorXd& t) const {
    return middle + distance * t.segment<3>(1);
  }
  // Arms of the channels, over `distance`: 3×n.
  [[nodiscard]] Eigen::Matrix3Xd arms(const ChannelFrame& frame, const Eigen::Vector3d& at) const {
    return rigid_motions(frame, at).rightCols<3>().transpose() / distance;
  }

  int operator()(const Eigen::VectorXd& t, Eigen::VectorXd& error) const {
    const Eigen::MatrixXd turn =
        arms(outputs, centre(t)).transpose() * symmetric(t.tail<6>()) * arms(inputs, centre(t));
    const Eigen::MatrixXd model =
        mobility * (t(0) * outputs.directions * inputs.directions.transpose() + turn);
    error.setZero(values());
    error.head(measured.size()) = weight.cwiseProduct(model.reshaped() - measured);
    return 0;
  }

  int df(const Eigen::VectorXd& t, Eigen::MatrixXd& jacobian) const {
    const Eigen::Matrix3Xd left = arms(outputs, centre(t));
    const Eigen::Matrix3Xd right = arms(inputs, centre(t));
    const Eigen::Matrix3d inverse = symmetric(t.tail<6>());
    jacobian.setZero(values(), 10);
    const auto set = [&](Eigen::Index k, const Eigen::MatrixXd& column) {
      jacobian.col(k).head(measured.size()) = mobility * weight.cwiseProduct(column.reshaped());
    };
    set(0, outputs.directions * inputs.directions.transpose());
    for (Eigen::Index k = 0; k < 3; ++k) {
      // ((p − c) × n) changes by n × e_k with c_k.
      const auto moved = [&](const Eigen::MatrixX3d& directions) {
        Eigen::Matrix3Xd change(3, directions.rows());
        for (Eigen::Index i = 0; i < directions.rows(); ++i) {
          change.col(i) =
              Eigen::Vector3d(directions.row(i)).cross(Eigen::Vector3d(Eigen::Vector3d::Unit(k)));
        }
        return change;
      };
      set(1 + k, moved(outputs.directions).transpose() * inverse * right +
                     left.transpose() * inverse * moved(inputs.directions));
    }
    for (Eigen::Index k = 0; k < 6; ++k) {
      set(4 + k, left.transpose() * symmetric(Eigen::VectorXd::Unit(6, k)) * right);
    }
    return 0;
  }
};

bool is_known(double variance) { return std::isfinite(variance); }

// One over the deviation of each product; equal ones where the deviations are not known, and 0 for
// a product of which nothing is known.
Eigen::VectorXd weights(const RigidProduct& product, double mobility) {
  const Eigen::VectorXd variance = product.covariance.diagonal();
  require(variance.size() == product.value.size(),
          "rigid body: the numbers of products and of their deviations differ");
  const double least = std::pow(1e-9 * mobility, 2);
  const bool all = (variance.array() > least).all();
  Eigen::VectorXd weight(variance.size());
  for (Eigen::Index k = 0; k < variance.size(); ++k) {
    weight(k) = !is_known(variance(k)) ? 0.0 : 1.0 / (all ? std::sqrt(variance(k)) : mobility);
  }
  return weight;
}

RigidModel model_of(const RigidProduct& product, const ChannelFrame& outputs,
                    const ChannelFrame& inputs) {
  require(outputs.places.rows() == product.value.rows() &&
              inputs.places.rows() == product.value.cols() && product.value.size() > 0,
          "rigid body: the numbers of channels and of products differ");
  RigidModel model{outputs, inputs, product.value.reshaped(), {}, {}};
  model.middle = (outputs.places.colwise().sum() + inputs.places.colwise().sum()).transpose() /
                 static_cast<double>(outputs.places.rows() + inputs.places.rows());
  const double squares = (outputs.places.rowwise() - model.middle.transpose()).squaredNorm() +
                         (inputs.places.rowwise() - model.middle.transpose()).squaredNorm();
  if (squares > 0.0) {
    model.distance =
        std::sqrt(squares / static_cast<double>(outputs.places.rows() + inputs.places.rows()));
  }
  model.mobility = std::max(product.value.cwiseAbs().maxCoeff(), 1e-300);
  model.weight = weights(product, model.mobility);
  return model;
}

// Mass and inertia for the centre in the middle, then all ten parameters together.
Eigen::VectorXd fitted(RigidModel& model) {
  Eigen::VectorXd t = Eigen::VectorXd::Zero(10);
  Eigen::MatrixXd jacobian;
  Eigen::VectorXd error;
  model.df(t, jacobian);
  model(t, error);
  jacobian.middleCols(1, 3).setZero();
  t = -jacobian.completeOrthogonalDecomposition().solve(error);
  Eigen::LevenbergMarquardt<RigidModel> search(model);
  search.parameters.ftol = search.parameters.xtol = 1e-14;
  search.minimize(t);
  return t;
}

// What the data tell of the parameters: their covariance, infinite on the diagonal where nothing.
struct Told {
  Eigen::MatrixXd covariance;
  std::array<bool, 10> known{};
};

// Rows and columns of infinite variance as 0: their values have no weight.
Eigen::MatrixXd without_unknown(Eigen::MatrixXd covariance) {
  for (Eigen::Index k = 0; k < covariance.rows(); ++k) {
    if (is_known(covariance(k, k))) continue;
    covariance.row(k).setZero();
    covariance.col(k).setZero();
  }
  return covariance;
}

// Infinite where the variance is not a number: what is not known is not exact.
double deviation_of(double variance) {
  return is_known(variance) ? std::sqrt(std::max(0.0, variance)) : kNone;
}

// Covariance of the weighted products. Where it is not stated, what the body leaves tells it.
// Products that contradict a rigid body by more than can be chance are as far off as they do.
// @param basis  orthonormal columns: what parameters can explain of the products
Eigen::MatrixXd weighted_covariance(const RigidModel& model, const Eigen::VectorXd& t,
                                    const RigidProduct& product, const Eigen::MatrixXd& basis) {
  Eigen::VectorXd error;
  model(t, error);
  const double left = error.squaredNorm();
  const Eigen::MatrixXd stated = without_unknown(product.covariance);
  const bool known = stated.diagonal().maxCoeff() > 0.0;
  const Eigen::VectorXd counts = (model.weight.array() > 0.0).cast<double>();
  Eigen::MatrixXd covariance = counts.asDiagonal();
  if (known) covariance = model.weight.asDiagonal() * stated * model.weight.asDiagonal();
  Eigen::MatrixXd rest = covariance - basis * (basis.transpose() * covariance);
  rest -= Eigen::MatrixXd(rest * basis) * basis.transpose();
  const double expected = rest.trace();
  const bool tells = expected > 1e-9 * covariance.trace();  // else any products are a body's
  if (!known) return (tells ? left / expected : kNone) * covariance;
  const double chance = expected + Constants::no_chance * std::sqrt(2.0) * rest.norm();
  return (tells && left > chance ? left / expected : 1.0) * covariance;
}

Told told(const RigidModel& model, const Eigen::VectorXd& t, const RigidProduct& product) {
  Eigen::MatrixXd jacobian;
  model.df(t, jacobian);
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(jacobian, Eigen::ComputeThinU | Eigen::ComputeThinV);
  const auto& values = svd.singularValues();
  const Eigen::Index rank = (values.array() > kNotTold * values(0)).count();
  const Eigen::MatrixXd inverse = svd.matrixV().leftCols(rank) *
                                  values.head(rank).cwiseInverse().asDiagonal() *
                                  svd.matrixU().leftCols(rank).transpose();
  const auto n = model.measured.size();
  const Eigen::MatrixXd map = inverse.leftCols(n);
  const Eigen::MatrixXd basis = svd.matrixU().leftCols(rank).topRows(n);
  Told result{map * weighted_covariance(model, t, product, basis) * map.transpose(), {}};
  for (Eigen::Index k = 0; k < 10; ++k) {
    const double free = svd.matrixV().row(k).tail(10 - rank).norm();
    result.known[static_cast<std::size_t>(k)] = free < 1e-3;
  }
  return result;
}

// Inertia about the axes that are told, from J⁻¹ there and its covariance.
void set_inertia(const RigidModel& model, const Eigen::VectorXd& t, const Told& told,
                 RigidProperties& body) {
  body.inertia.setConstant(kNaN);
  body.inertia_std.setConstant(kNone);
  std::vector<int> axes;
  for (int a = 0; a < 3; ++a) {
    if (told.known[static_cast<std::size_t>(4 + a)]) axes.push_back(a);
  }
  for (int k = 3; k < 6; ++k) {  // an axis without its products says nothing of a full block
    const auto [a, b] = kEntries[static_cast<std::size_t>(k)];
    const bool both =
        std::count(axes.begin(), axes.end(), a) + std::count(axes.begin(), axes.end(), b) == 2;
    if (both && !told.known[static_cast<std::size_t>(4 + k)]) return;
  }
  if (axes.empty()) return;
  const double unit = model.mobility / (model.distance * model.distance);
  const Eigen::MatrixXd inverse = unit * symmetric(t.tail<6>())(axes, axes);
  if (Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(inverse).eigenvalues()(0) <= 0.0) {
    throw NumericalFailure(
        "rigid body: its inertia is not positive: a polarity or a place is wrong, or the modes are "
        "not those of a rigid body");
  }
  const Eigen::MatrixXd inertia = inverse.inverse();
  const auto n = static_cast<Eigen::Index>(axes.size());
  Eigen::MatrixXd change(n * n, 6);  // of the inertia with the six entries of J⁻¹
  for (Eigen::Index k = 0; k < 6; ++k) {
    const Eigen::MatrixXd entry = symmetric(Eigen::VectorXd::Unit(6, k))(axes, axes);
    change.col(k) = (-unit * inertia * entry * inertia).reshaped();
  }
  const Eigen::MatrixXd deviation =
      (change * told.covariance.bottomRightCorner<6, 6>() * change.transpose())
          .diagonal()
          .unaryExpr([](double variance) { return deviation_of(variance); })
          .reshaped(n, n);
  body.inertia(axes, axes) = inertia;
  body.inertia_std(axes, axes) = deviation;
}

void say_what_is_not_told(const Told& told, RigidProperties& body) {
  constexpr std::array<const char*, 3> kAxes{"x", "y", "z"};
  for (std::size_t a = 0; a < 3; ++a) {
    if (!told.known[1 + a]) {
      body.not_told.push_back(fmt::format("the centre of mass along {}", kAxes[a]));
    }
  }
  for (Eigen::Index a = 0; a < 3; ++a) {
    if (!std::isnan(body.inertia(a, a))) continue;
    body.not_told.push_back(
        fmt::format("the inertia about {}", kAxes[static_cast<std::size_t>(a)]));
  }
}

}  // namespace

RigidProduct rigid_product(const ModalFit& fit, const GainMatch& match,
                           const std::vector<Eigen::Index>& suspended) {
  const auto p = fit.model.output_count();
  const auto q = fit.model.input_count();
  const auto rigid = fit.model.rigid_count;
  RigidProduct product{Eigen::MatrixXd::Zero(p, q), Eigen::MatrixXd::Zero(p * q, p * q), 0};
  Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic> unknown =
      Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic>::Constant(p, q, false);
  // Change of the products with the entries of l and r of `count` modes, and their covariance.
  const auto add = [&](Eigen::Index first, Eigen::Index count, const Eigen::MatrixXd& covariance) {
    const Eigen::MatrixXd l = fit.model.output_shapes.middleCols(first, count);
    const Eigen::MatrixXd r = fit.model.input_shapes.middleRows(first, count);
    product.value +=
        match.shapes.block(0, first, p, count) * match.input_shapes.middleRows(first, count);
    product.modes += count;
    if (covariance.rows() != (p + q) * count) return;
    // Factors of which nothing is known make their products unknown.
    const Eigen::MatrixXd finite = without_unknown(covariance);
    for (Eigen::Index k = 0; k < covariance.rows(); ++k) {
      if (is_known(covariance(k, k))) continue;
      const bool of_output = k < p * count;
      if (of_output) unknown.row(k % p).setConstant(true);
      if (!of_output) unknown.col((k - p * count) / count).setConstant(true);
    }
    Eigen::MatrixXd change = Eigen::MatrixXd::Zero(p * q, (p + q) * count);
    for (Eigen::Index i = 0; i < p; ++i) {
      for (Eigen::Index j = 0; j < q; ++j) {
        for (Eigen::Index m = 0; m < count; ++m) {
          change(i + p * j, i + p * m) = r(m, j);
          change(i + p * j, p * count + m + count * j) = l(i, m);
        }
      }
    }
    product.covariance += change * finite * change.transpose();
  };
  // The rows of a rigid body leave nothing of a rigid body: what the fit's own left is told.
  const double misfit = match.rigid ? std::max(1.0, match.rigid->misfit) : 1.0;
  if (rigid > 0) add(0, rigid, misfit * fit.rigid_covariance);
  for (const auto m : suspended) {
    require(m >= rigid && m < fit.model.mode_count(), "rigid body: no such suspended mode");
    Eigen::MatrixXd own;
    if (static_cast<std::size_t>(m) < fit.mode_covariance.size() &&
        fit.mode_covariance[static_cast<std::size_t>(m)].rows() >= 2 + p + q) {
      own = fit.mode_covariance[static_cast<std::size_t>(m)].block(2, 2, p + q, p + q);
    }
    add(m, 1, own);
  }
  for (Eigen::Index k = 0; k < p * q; ++k) {
    if (unknown(k % p, k / p)) product.covariance(k, k) = kNone;
  }
  return product;
}

RigidProperties rigid_properties(const RigidProduct& product, const ChannelFrame& outputs,
                                 const ChannelFrame& inputs) {
  auto model = model_of(product, outputs, inputs);
  const auto t = fitted(model);
  const auto known = told(model, t, product);
  if (!known.known[0]) {
    throw NumericalFailure("rigid body: the channels do not tell its mass");
  }
  if (!(t(0) > 0.0)) {
    throw NumericalFailure(
        "rigid body: its mass is not positive: a polarity or a place is wrong, or the modes are "
        "not those of a rigid body");
  }
  RigidProperties body;
  body.mass = 1.0 / (model.mobility * t(0));
  body.mass_std = body.mass * deviation_of(known.covariance(0, 0)) / t(0);
  body.about = model.centre(t);
  for (Eigen::Index a = 0; a < 3; ++a) {
    const bool is_told = known.known[static_cast<std::size_t>(1 + a)];
    if (!is_told) body.about(a) = model.middle(a);
    body.centre(a) = is_told ? body.about(a) : kNaN;
    body.centre_std(a) =
        is_told ? model.distance * deviation_of(known.covariance(1 + a, 1 + a)) : kNone;
  }
  set_inertia(model, t, known, body);
  say_what_is_not_told(known, body);
  return body;
}

}  // namespace chladni::identification
