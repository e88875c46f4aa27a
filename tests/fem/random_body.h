// Random plates, beams and blocks with masses and springs on them, for the tests and the benchmarks
// that look for lost modes; and their frequencies by a dense solver.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "dense/blas.h"
#include "fem/assemble.h"
#include "fem/eigen/mode_checks.h"
#include "fem/modes.h"
#include "mesh/bodies.h"
#include "mesh/site.h"

extern "C" void dsygvx_(const int*, const char*, const char*, const char*, const int*, double*,
                        const int*, double*, const int*, const double*, const double*, const int*,
                        const int*, const double*, int*, double*, double*, const int*, double*,
                        const int*, int*, int*, int*);

namespace chladni::fem {

struct RandomBody {
  System system;
  ModesOptions options;  ///< count, block and start at random
  std::string text;      ///< what it is, for a failure
};

/// The same body for the same seed. A third are square, half of these with masses or springs on all
/// four corners so that repeated modes stay repeated; the others carry up to three attachments.
/// About 450 degrees of freedom.
inline RandomBody random_body(unsigned seed) {
  std::mt19937 random(seed);
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * double(random()) / 4294967296.0;
  };
  const double length = uniform(0.1, 0.6);
  const bool square = random() % 3 == 0;
  const double width = square ? length : length * uniform(0.05, 1.0);
  const double thickness = width * uniform(0.01, random() % 4 == 0 ? 1.0 : 0.2);
  const auto body =
      mesh::with_order(mesh::layered(mesh::Plate{length, width, thickness}, length / 3.0, 1), 2);
  const double mass = 2700.0 * length * width * thickness;
  const double stiffness = mass * std::pow(2.0 * std::numbers::pi * uniform(1.0, 2000.0), 2);

  const mesh::SiteFinder sites(body);
  std::vector<Attachment> attached;
  const auto attach = [&](double x, double y, unsigned kind, double size) {
    const auto site = sites.nearest({x, y, 0.0});
    const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
    if (kind == 0) attached.push_back({"mass", site, 0.0, PointMass{.mass = size * mass}});
    if (kind == 1) attached.push_back({"spring", site, 0.0, GroundSpring{up, size * stiffness}});
    if (kind == 2) {
      const Resonator resonator{up, 0.1 * size * mass, 0.1 * size * stiffness};
      attached.push_back({"resonator", site, 0.0, resonator});
    }
  };
  const auto kind = static_cast<unsigned>(random() % 3);
  const double size = uniform(0.01, 0.5);
  if (square && random() % 2 == 0) {
    for (const double x : {-0.5, 0.5}) {
      for (const double y : {-0.5, 0.5}) attach(x * length, y * length, kind, size);
    }
  } else {
    for (auto left = random() % 4; left > 0; --left) {
      attach(uniform(-0.5, 0.5) * length, uniform(-0.5, 0.5) * width,
             static_cast<unsigned>(random() % 3), uniform(0.01, 0.5));
    }
  }

  RandomBody result;
  result.system = assemble(body, {isotropic(70e9, 0.33, 2700.0)}, {}, attached);
  result.options.count = 1 + static_cast<int>(random() % 25);
  result.options.block = 1 + static_cast<int>(random() % 6);
  result.options.seed = static_cast<unsigned>(random());
  std::ostringstream text;
  text << "seed " << seed << ": " << length << " x " << width << " x " << thickness << " m, "
       << attached.size() << " attachments, " << result.options.count << " modes, block "
       << result.options.block;
  result.text = text.str();
  return result;
}

/// Shapes of the lowest `count` modes by LAPACK (an eighth of the time of Eigen's solver here),
/// n×count; n×0 where it failed.
inline Eigen::MatrixXd dense_shapes(const System& system, Eigen::Index count) {
  const dense::OneBlasThread one_thread;  // for matrices of this size more cost more
  const int n = static_cast<int>(system.mass.rows());
  Eigen::MatrixXd k(system.stiffness);  // the lower triangles do
  Eigen::MatrixXd m(system.mass);
  Eigen::MatrixXd vectors(n, count);
  const int kind = 1, first = 1, last = static_cast<int>(count), room = 64 * n;
  const double none = 0.0;
  int there = 0, info = 0;
  Eigen::VectorXd lambda(n), work(room);
  std::vector<int> places(static_cast<std::size_t>(5 * n)), failed(static_cast<std::size_t>(n));
  dsygvx_(&kind, "V", "I", "L", &n, k.data(), &n, m.data(), &n, &none, &none, &first, &last, &none,
          &there, lambda.data(), vectors.data(), &n, work.data(), &room, places.data(),
          failed.data(), &info);
  return info == 0 ? vectors : Eigen::MatrixXd(n, 0);
}

/// ω² of the lowest `count` modes, ascending, and what of each rounding may be: `value` ±
/// `rounding`.
struct DenseLambda {
  Eigen::VectorXd value, rounding;
};

/// A dense solver's own values are off by rounding errors of the largest, 1e-2 of the first mode of
/// a slender body. Its vectors are off by that over their distance from others, and a Rayleigh
/// quotient by the square of it: taken in long double, the rigid-body motions taken out before.
inline DenseLambda dense_lambda(const System& system, Eigen::Index count) {
  const Eigen::MatrixXd vectors = dense_shapes(system, count);
  const double largest =  // about
      3.0 * system.stiffness.diagonal().cwiseQuotient(system.mass.diagonal()).maxCoeff();
  DenseLambda result{Eigen::VectorXd::Constant(count, std::nan("")), Eigen::VectorXd::Zero(count)};
  if (vectors.cols() < count) return result;
  using Long = Eigen::Matrix<long double, Eigen::Dynamic, 1>;
  const Eigen::SparseMatrix<long double> k_long =
      SparseMatrix(system.stiffness.selfadjointView<Eigen::Lower>()).cast<long double>();
  const Eigen::SparseMatrix<long double> m_long =
      SparseMatrix(system.mass.selfadjointView<Eigen::Lower>()).cast<long double>();
  for (Eigen::Index i = 0; i < count; ++i) {
    Long v = vectors.col(i).cast<long double>();
    if (i >= system.rigid.cols()) {
      for (Eigen::Index r = 0; r < system.rigid.cols(); ++r) {
        const Long motion = system.rigid.col(r).cast<long double>();
        v -= motion * motion.dot(m_long * v);
      }
    }
    const long double value = v.dot(k_long * v) / v.dot(m_long * v);
    result.value(i) = i < system.rigid.cols() ? 0.0 : static_cast<double>(value);
    const double mixed = 1e-15 * largest / std::max(result.value(i), 1e-300);
    result.rounding(i) =
        i < system.rigid.cols() ? 0.0 : result.value(i) * std::min(1.0, mixed * mixed);
  }
  // `modes` takes the springs of suspended bodies at their word, and K has them in rounded entries.
  if (system.suspended.cols() > 0) {
    const Eigen::MatrixXd none(vectors.rows(), 0);
    const auto flexible = count - system.rigid.cols();
    result.rounding.tail(flexible) += energy_rounding(system, none, vectors.rightCols(flexible));
  }
  std::sort(result.value.begin(), result.value.end());
  return result;
}

/// How many of the modes found are not those of the dense solver, one by one.
inline int differing_modes(const Eigen::VectorXd& frequency_hz, const DenseLambda& expected) {
  int differing = 0;
  for (Eigen::Index i = 0; i < frequency_hz.size(); ++i) {
    const double lambda = std::pow(2.0 * std::numbers::pi * frequency_hz(i), 2);
    const double allowed = expected.rounding(i) + 1e-8 * expected.value(i);
    if (!(std::abs(lambda - expected.value(i)) <= allowed)) ++differing;
  }
  return differing;
}

}  // namespace chladni::fem
