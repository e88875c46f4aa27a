#include "simulators/tables/plate_corrections.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace chladni::simulators {
namespace {

double cosine(int half_waves, double at, double length) {
  return std::cos(half_waves * std::numbers::pi * (at / length + 0.5));
}

// Adds the waves without the constant one. The prior's gamma represents the constant.
void add_waves(const KirchhoffPlate& plate, const PlateModes& modes,
               const PlateUncertainty& uncertain, std::vector<priors::Correction>& all) {
  const auto& grid = plate.grid;
  const int w = uncertain.waves;
  Eigen::MatrixXd fields(grid.cell_count(), w * w);
  for (Eigen::Index c = 0; c < fields.rows(); ++c) {
    const Eigen::Vector2d centre = grid.centre(c);
    for (int k = 0; k < w * w; ++k) {
      fields(c, k) = cosine(k / w, centre.x(), grid.length) * cosine(k % w, centre.y(), grid.width);
    }
  }
  const auto matrices = plate_field_matrices(plate, modes, fields);
  for (int k = 1; k < w * w; ++k) {
    const int a = k / w;
    const int b = k % w;
    all.push_back({fmt::format("stiffness wave {},{}", a, b),
                   matrices.stiffness[static_cast<std::size_t>(k)],
                   {},
                   uncertain.stiffness / std::sqrt(1.0 + 0.5 * (a * a + b * b))});
  }
}

void add_anisotropy(const KirchhoffPlate& plate, const PlateModes& modes, double deviation,
                    std::vector<priors::Correction>& all) {
  constexpr double kPart = 0.1;
  const Eigen::VectorXd ones = Eigen::VectorXd::Ones(plate.grid.cell_count());
  const Eigen::MatrixXd before = plate_field_matrices(plate, modes, ones).stiffness.front();
  const auto add = [&](const char* name, void (*change)(BendingStiffness&)) {
    auto changed = plate;
    for (auto& bending : changed.bending) change(bending);
    const Eigen::MatrixXd after = plate_field_matrices(changed, modes, ones).stiffness.front();
    all.push_back({name, (after - before) / kPart, {}, deviation});
  };
  add("stiffness x against y", [](BendingStiffness& b) {
    b.d11 *= 1.0 + kPart;
    b.d22 *= 1.0 - kPart;
  });
  add("stiffness across", [](BendingStiffness& b) { b.d12 *= 1.0 + kPart; });
  add("stiffness in twist", [](BendingStiffness& b) { b.d66 *= 1.0 + kPart; });
}

void add_masses(const KirchhoffPlate& plate, const PlateModes& modes,
                const PlateUncertainty& uncertain, std::vector<priors::Correction>& all) {
  const int n = uncertain.masses;
  const double share = plate.areal_mass.sum() * plate.grid.cell_area() / (n * n);
  for (int k = 0; k < n * n; ++k) {
    const Eigen::Vector2d place(plate.grid.length * (static_cast<double>(k % n) / (n - 1) - 0.5),
                                plate.grid.width * (static_cast<double>(k / n) / (n - 1) - 0.5));
    if (!covers(modes, place)) continue;
    const Eigen::MatrixXd shape = shapes_at(modes, place.transpose());
    all.push_back({fmt::format("kg at ({:.3f}, {:.3f}) m", place.x(), place.y()),
                   {},
                   shape.transpose() * shape,
                   uncertain.point_mass * share});
  }
}

}  // namespace

std::vector<priors::Correction> plate_corrections(const KirchhoffPlate& plate,
                                                  const PlateModes& modes,
                                                  const PlateUncertainty& uncertain) {
  std::vector<priors::Correction> all;
  if (uncertain.waves > 0) add_waves(plate, modes, uncertain, all);
  if (uncertain.anisotropy > 0.0) add_anisotropy(plate, modes, uncertain.anisotropy, all);
  if (uncertain.masses > 1) add_masses(plate, modes, uncertain, all);
  return all;
}

}  // namespace chladni::simulators
