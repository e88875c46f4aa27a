// Random plates, beams and blocks with masses and springs on them, for the tests and the benchmarks
// that look for lost modes; and their frequencies by a dense solver.
#pragma once

#include <Eigen/Dense>
#include <cmath>
#include <numbers>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "fem/assemble.h"
#include "fem/modes.h"
#include "mesh/bodies.h"
#include "mesh/site.h"

extern "C" void dsygv_(const int*, const char*, const char*, const int*, double*, const int*,
                       double*, const int*, double*, double*, const int*, int*);

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

/// ω² of all modes, ascending, by LAPACK (an eighth of the time of Eigen's solver here).
inline Eigen::VectorXd dense_lambda(const System& system) {
  Eigen::MatrixXd k(system.stiffness);  // the lower triangles do
  Eigen::MatrixXd m(system.mass);
  const int n = static_cast<int>(k.rows());
  const int kind = 1;
  const int room = 64 * n;
  int info = 0;
  Eigen::VectorXd lambda(n);
  Eigen::VectorXd work(room);
  dsygv_(&kind, "N", "L", &n, k.data(), &n, m.data(), &n, lambda.data(), work.data(), &room, &info);
  if (info != 0) lambda.setConstant(std::nan(""));
  return lambda;
}

/// How many of the modes found are not those of the dense solver, one by one: its own error in ω²
/// is a few rounding errors of the largest.
inline int differing_modes(const Eigen::VectorXd& frequency_hz, const Eigen::VectorXd& expected) {
  const double rounding = 1e-13 * expected.maxCoeff();
  int differing = 0;
  for (Eigen::Index i = 0; i < frequency_hz.size(); ++i) {
    const double lambda = std::pow(2.0 * std::numbers::pi * frequency_hz(i), 2);
    if (!(std::abs(lambda - expected(i)) <= rounding + 1e-8 * std::abs(expected(i)))) ++differing;
  }
  return differing;
}

}  // namespace chladni::fem
