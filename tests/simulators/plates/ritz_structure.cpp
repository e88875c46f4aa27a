#include "simulators/plates/ritz_structure.h"

#include <Eigen/Dense>
#include <memory>
#include <numbers>

#include "base/error.h"
#include "host/parallel.h"

namespace chladni::simulators {
namespace {

using Eigen::Index;
using std::numbers::pi;

// Number of higher modes with a static contribution at attachments. Further modes belong to the
// basis, not to the plate.
constexpr Index kUpper = 240;

// The rows of the modes from the r-th on, each divided by its angular frequency.
Eigen::MatrixXd upper_part(const RitzModes& plate, const Eigen::MatrixXd& rows, Index r) {
  const Index rest = std::min<Index>(kUpper, plate.mode_count() - r);
  const Eigen::VectorXd omega = 2.0 * pi * plate.frequency_hz.segment(r, rest);
  return rows.middleCols(r, rest) * omega.cwiseInverse().asDiagonal();
}

diagnosis::ChannelSide side(const RitzModes& plate, const std::vector<std::string>& names,
                            const Eigen::MatrixX2d& places, Index r) {
  const auto rows = modal_rows(plate, places);
  const double top = 0.5 * plate.body.thickness(0, 0);
  return {names,
          rows.deflection.leftCols(r),
          rows.slope_x.leftCols(r),
          rows.slope_y.leftCols(r),
          top * rows.turn_x.leftCols(r),
          top * rows.turn_y.leftCols(r),
          places,
          upper_part(plate, rows.deflection, r)};
}

Eigen::MatrixXd residual(const RitzModes& plate, const TableChannels& channels, Index r) {
  const Index rest = plate.mode_count() - r;
  const Eigen::VectorXd lambda = (2.0 * pi * plate.frequency_hz.tail(rest)).cwiseAbs2();
  return modal_rows(plate, channels.outputs).deflection.rightCols(rest) *
         lambda.cwiseInverse().asDiagonal() *
         modal_rows(plate, channels.inputs).deflection.rightCols(rest).transpose();
}

// Sets the scan places, including the rim. Each place represents the area nearest to it.
void scan(diagnosis::Surface& surface, const RitzBody& body, int count) {
  const Index n = count;
  surface.places.resize(n * n, 2);
  surface.area.resize(n * n);
  const double dx = body.length / (count - 1);
  const double dy = body.width / (count - 1);
  const auto share = [n](Index i) { return i == 0 || i == n - 1 ? 0.5 : 1.0; };
  for (Index j = 0, k = 0; j < n; ++j) {
    for (Index i = 0; i < n; ++i, ++k) {
      surface.places.row(k) << dx * static_cast<double>(i) - 0.5 * body.length,
          dy * static_cast<double>(j) - 0.5 * body.width;
      surface.area(k) = dx * dy * share(i) * share(j);
    }
  }
}

diagnosis::Surface surface(const RitzModes& plate, Index r, int count) {
  diagnosis::Surface top;
  scan(top, plate.body, count);
  top.shapes = modal_rows(plate, top.places).deflection.leftCols(r);
  const Index kept = std::min<Index>(r + kUpper, plate.mode_count());
  auto seen = std::make_shared<RitzModes>();
  seen->body = plate.body;
  seen->frequency_hz = plate.frequency_hz.head(kept);
  seen->coefficients = plate.coefficients.leftCols(kept);
  const auto slowness = std::make_shared<Eigen::VectorXd>(
      (2.0 * pi * seen->frequency_hz.tail(kept - r)).cwiseInverse());
  top.at = [seen, slowness,
            r](const Eigen::Vector2d& place) -> std::optional<diagnosis::PointMotion> {
    if (std::abs(place.x()) > 0.5 * seen->body.length ||
        std::abs(place.y()) > 0.5 * seen->body.width) {
      return std::nullopt;
    }
    const Eigen::MatrixX3d motion = deflection_at(*seen, place);
    const Eigen::MatrixX3d upper = slowness->asDiagonal() * motion.bottomRows(slowness->size());
    return diagnosis::PointMotion{motion.col(0).head(r), motion.col(1).head(r),
                                  motion.col(2).head(r), upper.col(0),
                                  upper.col(1),          upper.col(2)};
  };
  return top;
}

diagnosis::BodyCells cells(const RitzModes& plate, Index r, int count) {
  const Eigen::Vector2d size(plate.body.length / count, plate.body.width / count);
  const Eigen::Vector2d corner(-0.5 * plate.body.length, -0.5 * plate.body.width);
  // The parts proportional to t and to t³ follow from the same motion of a thicker plate.
  constexpr double kThicker = 1.5;
  constexpr double cubed = kThicker * kThicker * kThicker;
  RitzModes thicker = plate;
  thicker.body.thickness *= kThicker;
  diagnosis::BodyCells all;
  all.from = corner;
  all.size = -2.0 * corner;
  all.centres.resize(Index{count} * count, 2);
  all.area = Eigen::VectorXd::Constant(Index{count} * count, size.prod());
  for (int j = 0, k = 0; j < count; ++j) {
    for (int i = 0; i < count; ++i, ++k) {
      const Eigen::Vector2d low = corner + Eigen::Vector2d(i * size.x(), j * size.y());
      auto cell = modal_cell(plate, r, low, low + size);
      const auto thick = modal_cell(thicker, r, low, low + size);
      all.shear.emplace_back((cubed * cell.stiffness - thick.stiffness) / (cubed - kThicker));
      all.rotary.emplace_back((thick.mass - kThicker * cell.mass) / (cubed - kThicker));
      all.centres.row(k) = (low + 0.5 * size).transpose();
      all.stiffness.push_back(std::move(cell.stiffness));
      all.mass.push_back(std::move(cell.mass));
    }
  }
  return all;
}

// The waves of thickness, by differences of its Legendre coefficients. The parts proportional to t
// and to t³ follow from the same motion of a thicker plate.
diagnosis::BodyCells::Waves waves(const RitzModes& plate, Index r) {
  constexpr std::array<std::pair<Index, Index>, 5> kWaves{{{1, 0}, {0, 1}, {2, 0}, {1, 1}, {0, 2}}};
  constexpr double kStep = 1e-3;
  constexpr double kThicker = 1.5;
  constexpr double cubed = kThicker * kThicker * kThicker;
  require(plate.body.thickness.size() == 1, "waves over a plate of one thickness only");
  const double t = plate.body.thickness(0, 0);
  const Eigen::Vector2d half(0.5 * plate.body.length, 0.5 * plate.body.width);
  diagnosis::BodyCells::Waves all;
  for (const auto& [a, b] : kWaves) {
    const auto slope = [&](double times) {
      const auto cell = [&](double by) {
        RitzModes waved = plate;
        waved.body.thickness = Eigen::MatrixXd::Zero(3, 3);
        waved.body.thickness(0, 0) = times * t;
        waved.body.thickness(a, b) = times * t * by;
        return modal_cell(waved, r, -half, half);
      };
      auto plus = cell(kStep);
      const auto minus = cell(-kStep);
      plus.stiffness = (plus.stiffness - minus.stiffness) / (2.0 * kStep);
      plus.mass = (plus.mass - minus.mass) / (2.0 * kStep);
      return plus;
    };
    auto own = slope(1.0);
    const Eigen::MatrixXd shear =
        (cubed * own.stiffness - slope(kThicker).stiffness) / (cubed - kThicker);
    all.modulus.emplace_back((own.stiffness - shear) / 3.0 + shear);
    all.bent.push_back(std::move(own.stiffness));
    all.thickened.push_back(std::move(own.mass));
  }
  return all;
}

// The fine cells, with so many higher modes that there are twice as many modes in all.
diagnosis::FineCells fine_cells(const RitzModes& plate, Index r, int count) {
  const Index all = std::min(2 * r, std::min(r + kUpper, plate.mode_count()));
  const Eigen::Vector2d size(plate.body.length / count, plate.body.width / count);
  const Eigen::Vector2d corner(-0.5 * plate.body.length, -0.5 * plate.body.width);
  Eigen::VectorXd unit = Eigen::VectorXd::Ones(all);
  unit.tail(all - r) = (2.0 * pi * plate.frequency_hz.segment(r, all - r)).cwiseInverse();
  diagnosis::FineCells fine;
  fine.pitch = size;
  fine.centres.resize(Index{count} * count, 2);
  fine.stiffness.resize(static_cast<std::size_t>(fine.centres.rows()));
  parallel_tasks(fine.stiffness.size(), [&](std::size_t k) {
    const auto at = static_cast<Index>(k);
    const Eigen::Array2d step(static_cast<double>(at % count), static_cast<double>(at / count));
    const Eigen::Vector2d low = corner + (step * size.array()).matrix();
    fine.centres.row(at) = (low + 0.5 * size).transpose();
    fine.stiffness[k] =
        unit.asDiagonal() * modal_cell(plate, all, low, low + size).stiffness * unit.asDiagonal();
  });
  return fine;
}

diagnosis::Directional directional(const RitzModes& plate, Index r) {
  const Eigen::Vector2d half(0.5 * plate.body.length, 0.5 * plate.body.width);
  const auto part = [&](StiffnessPart one) {
    return modal_cell(plate, r, -half, half, one).stiffness;
  };
  return {part(StiffnessPart::along_x), part(StiffnessPart::along_y), part(StiffnessPart::across),
          part(StiffnessPart::shear)};
}

}  // namespace

diagnosis::Structure ritz_structure(const RitzModes& plate, const TableChannels& channels,
                                    const RitzStructureOptions& options) {
  const Index r = options.modes;
  require(r > 3 && r <= plate.mode_count(), "more modes than the plate has, or no flexible one");
  diagnosis::Structure structure;
  structure.frequency_hz = plate.frequency_hz.head(r);
  structure.damping_ratio = Eigen::VectorXd::Constant(r, options.damping_ratio);
  structure.damping_ratio.head(3).setZero();
  structure.rigid_count = 3;
  structure.outputs = side(plate, channels.output_names, channels.outputs, r);
  structure.inputs = side(plate, channels.input_names, channels.inputs, r);
  structure.residual = residual(plate, channels, r);
  structure.surface = surface(plate, r, options.scan);
  structure.cells = cells(plate, r, options.cells);
  structure.cells.waves = waves(plate, r);
  structure.fine = fine_cells(plate, r, options.fine);
  structure.directional = directional(plate, r);
  structure.thickness = plate.body.thickness(0, 0);
  structure.mass_kg =
      plate.body.density * plate.body.length * plate.body.width * plate.body.thickness(0, 0);
  return structure;
}

}  // namespace chladni::simulators
