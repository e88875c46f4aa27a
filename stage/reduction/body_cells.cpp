#include "stage/reduction/body_cells.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "diagnosis/body_fields.h"
#include "fem/field_matrices.h"
#include "host/parallel.h"
#include "stage/plane_stress.h"
#include "stage/reduction/modal_stiffness.h"

namespace chladni::stage {
namespace {

constexpr int kCells = 100;      // of a face
constexpr int kCellsAlong = 24;  // of a line

// Points spread over a tetrahedron, 20×4 barycentric coordinates, of equal weight.
Eigen::Matrix<double, 20, 4> samples_of_tet() {
  Eigen::Matrix<double, 20, 4> points;
  Eigen::Index n = 0;
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; i + j < 4; ++j) {
      for (int k = 0; i + j + k < 4; ++k) {
        const Eigen::Vector4d lattice(i, j, k, 3 - i - j - k);
        points.row(n++) = (lattice.array() + 0.25) / 4.0;
      }
    }
  }
  return points;
}

// Places of the samples of a tetrahedron on the chart, one per row.
Eigen::MatrixX2d sampled_places(const mesh::TetMesh& body, const Chart& chart,
                                const Eigen::Matrix<double, 20, 4>& samples, Eigen::Index tet) {
  Eigen::Matrix<double, 4, 3> corners;
  for (int a = 0; a < 4; ++a) corners.row(a) = body.points.row(body.tets(tet, a));
  Eigen::MatrixX2d places(samples.rows(), 2);
  for (Eigen::Index n = 0; n < samples.rows(); ++n) {
    places.row(n) = chart.place((samples.row(n) * corners).transpose()).transpose();
  }
  return places;
}

// The tetrahedra of a cell, and the part of each that lies in it.
struct CellPart {
  Eigen::Index number = 0;  // of the cell
  std::vector<Eigen::Index> tets;
  std::vector<double> part;
  Eigen::Vector2d moment = Eigen::Vector2d::Zero();  // of the volume [m⁴]
  double volume = 0.0;                               // [m³]

  [[nodiscard]] Eigen::Vector2d middle() const { return moment / volume; }
  [[nodiscard]] mesh::TetMesh piece(const mesh::TetMesh& body) const {
    mesh::TetMesh result;
    result.points = body.points;
    result.tets = body.tets(tets, Eigen::all);
    result.region = body.region(tets);
    return result;
  }
  [[nodiscard]] Eigen::MatrixXd field() const {
    return Eigen::Map<const Eigen::VectorXd>(part.data(), static_cast<Eigen::Index>(part.size()));
  }
  [[nodiscard]] Eigen::MatrixXd no_field() const {
    return {static_cast<Eigen::Index>(part.size()), 0};
  }
};

// @param part  of the tetrahedron, for which the sample stands
// @param volume  of this part
void add_sample(CellPart& cell, Eigen::Index tet, double part, double volume,
                const Eigen::Vector2d& place) {
  if (cell.tets.empty() || cell.tets.back() != tet) {
    cell.tets.push_back(tet);
    cell.part.push_back(0.0);
  }
  cell.part.back() += part;
  cell.moment += volume * place;
  cell.volume += volume;
}

double flat_volume(const mesh::TetMesh& body, Eigen::Index tet) {
  Eigen::Matrix3d edges;
  for (int a = 0; a < 3; ++a) {
    edges.row(a) = body.points.row(body.tets(tet, a + 1)) - body.points.row(body.tets(tet, 0));
  }
  return std::abs(edges.determinant()) / 6.0;
}

// The parts of all cells that contain some of the body.
std::vector<CellPart> parts_of(const mesh::TetMesh& body, const Chart& chart,
                               const Eigen::Array2i& counts) {
  std::vector<CellPart> cells(static_cast<std::size_t>(counts.prod()));
  const auto samples = samples_of_tet();
  const double weight = 1.0 / static_cast<double>(samples.rows());
  for (Eigen::Index t = 0; t < body.tet_count(); ++t) {
    const auto places = sampled_places(body, chart, samples, t);
    const double volume = flat_volume(body, t);
    for (Eigen::Index n = 0; n < places.rows(); ++n) {
      const Eigen::Vector2d at = places.row(n);
      Eigen::Vector2i cell;
      for (int k = 0; k < 2; ++k) {
        const double fraction = (at(k) - chart.from(k)) / chart.size(k);
        cell(k) = std::clamp(static_cast<int>(std::floor(fraction * counts(k))), 0, counts(k) - 1);
      }
      add_sample(cells[static_cast<std::size_t>(cell(0) * counts(1) + cell(1))], t, weight,
                 weight * volume, at);
    }
  }
  for (std::size_t c = 0; c < cells.size(); ++c) cells[c].number = static_cast<Eigen::Index>(c);
  std::erase_if(cells, [](const CellPart& cell) { return cell.tets.empty(); });
  return cells;
}

// Materials with only the stiffness against transverse shear: the shear with the chart's normal.
std::vector<fem::Material> shear_only(std::vector<fem::Material> materials, const Chart& chart) {
  for (auto& material : materials) {
    fem::Material own = fem::turned(material, chart.axes.transpose());  // in the chart's frame
    const Eigen::Matrix<double, 6, 6> whole = own.stiffness;
    own.stiffness.setZero();
    for (const Eigen::Index s : {shear_of(0, 2), shear_of(1, 2)}) own.stiffness(s, s) = whole(s, s);
    material = fem::turned(own, chart.axes);
  }
  return materials;
}

Eigen::MatrixXd symmetric(const Eigen::MatrixXd& matrix) {
  return 0.5 * (matrix + matrix.transpose());
}

// Parts of a bending body that go with another power of its thickness.
struct BendingParts {
  std::vector<fem::Material> shearing;
  Eigen::MatrixXd turning;  // the shapes, in-plane components only
  BendingParts(const Model& model, const modal::Modes& modes, const Chart& chart) {
    shearing = shear_only(model.materials, chart);
    turning = modes.shapes;
    const Eigen::Matrix3d in_plane =
        chart.axes.leftCols<2>() * chart.axes.leftCols<2>().transpose();
    for (Eigen::Index row = 0; row < turning.rows(); row += 3) {
      turning.middleRows<3>(row) = (in_plane * turning.middleRows<3>(row)).eval();
    }
  }
};

// Computes the matrices of the cells.
class CellMatrices {
 public:
  CellMatrices(const Model& model, const modal::Modes& modes,
               const std::optional<BendingParts>& bending)
      : model_(model), modes_(modes), bending_(bending) {}

  void add(const CellPart& part, diagnosis::BodyCells& cells, std::size_t at) const {
    const auto piece = part.piece(model_.body);
    const auto field = part.field();
    const auto none = part.no_field();
    auto whole = fem::field_matrices(piece, model_.materials, modes_.shapes, field, field);
    cells.stiffness[at] = unstrained(std::move(whole.stiffness.front()), modes_.frequency_hz);
    cells.mass[at] = symmetric(whole.mass.front());
    if (!bending_) return;
    auto sheared = fem::field_matrices(piece, bending_->shearing, modes_.shapes, field, none);
    cells.shear[at] = unstrained(std::move(sheared.stiffness.front()), modes_.frequency_hz);
    cells.rotary[at] = symmetric(
        fem::field_matrices(piece, model_.materials, bending_->turning, none, field).mass.front());
  }

 private:
  const Model& model_;
  const modal::Modes& modes_;
  const std::optional<BendingParts>& bending_;
};

// Mean of the fields over the samples of each tetrahedron.
Eigen::MatrixXd fields_of(const mesh::TetMesh& body, const Chart& chart,
                          const diagnosis::BodyCells& cells) {
  const auto samples = samples_of_tet();
  const Eigen::Index each = samples.rows();
  Eigen::MatrixX2d places(each * body.tet_count(), 2);
  for (Eigen::Index t = 0; t < body.tet_count(); ++t) {
    places.middleRows(each * t, each) = sampled_places(body, chart, samples, t);
  }
  const Eigen::MatrixXd fields = diagnosis::smooth_fields(cells, places);
  Eigen::MatrixXd means(body.tet_count(), fields.cols());
  for (Eigen::Index t = 0; t < body.tet_count(); ++t) {
    means.row(t) = fields.middleRows(each * t, each).colwise().mean();
  }
  return means;
}

// Thickness waves: t³ except for transverse shear, t except for rotary inertia.
diagnosis::BodyCells::Waves waves_of(const Model& model, const modal::Modes& modes,
                                     const Chart& chart, const diagnosis::BodyCells& cells,
                                     const BendingParts& parts) {
  const auto fields = fields_of(model.body, chart, cells);
  const Eigen::MatrixXd none(fields.rows(), 0);
  diagnosis::BodyCells::Waves waves;
  auto whole = fem::field_matrices(model.body, model.materials, modes.shapes, fields, fields);
  auto sheared =
      fem::field_matrices(model.body, parts.shearing, modes.shapes, fields, none).stiffness;
  const auto turning =
      fem::field_matrices(model.body, model.materials, parts.turning, none, fields).mass;
  for (std::size_t f = 0; f < whole.stiffness.size(); ++f) {
    const auto modulus = unstrained(std::move(whole.stiffness[f]), modes.frequency_hz);
    const auto shear = unstrained(std::move(sheared[f]), modes.frequency_hz);
    waves.bent.emplace_back(3.0 * (modulus - shear) + shear);
    waves.thickened.push_back(symmetric(whole.mass[f] + 2.0 * turning[f]));
    waves.modulus.push_back(modulus);
  }
  return waves;
}

}  // namespace

diagnosis::BodyCells cells_of(const Model& model, const modal::Modes& modes, const Chart& chart,
                              const UpperFace& face, bool bends) {
  const auto counts = grid_counts(chart, kCells, kCellsAlong);
  const Eigen::MatrixXd covered = coverage(chart, face, counts);
  const double area = chart.size.prod() / static_cast<double>(counts.prod());
  const auto parts = parts_of(model.body, chart, counts);
  diagnosis::BodyCells cells;
  const auto count = static_cast<Eigen::Index>(parts.size());
  cells.centres.resize(count, 2);
  cells.area.resize(count);
  cells.from = chart.from;
  cells.size = chart.size;
  for (auto* matrices : {&cells.stiffness, &cells.mass}) matrices->resize(parts.size());
  for (auto* matrices : {&cells.shear, &cells.rotary}) matrices->resize(bends ? parts.size() : 0);
  std::optional<BendingParts> bending;
  if (bends) bending.emplace(model, modes, chart);
  const CellMatrices matrices(model, modes, bending);
  parallel_tasks(parts.size(), [&](std::size_t i) {
    const auto& part = parts[i];
    matrices.add(part, cells, i);
    cells.centres.row(static_cast<Eigen::Index>(i)) = part.middle().transpose();
    cells.area(static_cast<Eigen::Index>(i)) =
        covered(part.number / counts(1), part.number % counts(1)) * area;
  });
  if (bends) cells.waves = waves_of(model, modes, chart, cells, *bending);
  return cells;
}

diagnosis::FineCells fine_cells_of(const Model& model, const modal::Modes& modes, Eigen::Index used,
                                   const Chart& chart) {
  Eigen::Array2i counts = grid_counts(chart, kCells, kCellsAlong);
  counts = (counts > 1).select(2 * counts, counts);
  const auto parts = parts_of(model.body, chart, counts);
  const Eigen::Index above = modes.mode_count() - used;
  Eigen::VectorXd unit = Eigen::VectorXd::Ones(modes.mode_count());
  unit.tail(above) = (2.0 * std::numbers::pi * modes.frequency_hz.tail(above)).cwiseInverse();
  diagnosis::FineCells fine;
  fine.pitch = (counts > 1).select(chart.size.array() / counts.cast<double>(), 0.0);
  fine.centres.resize(static_cast<Eigen::Index>(parts.size()), 2);
  fine.stiffness.resize(parts.size());
  parallel_tasks(parts.size(), [&](std::size_t i) {
    const auto& part = parts[i];
    auto whole = fem::field_matrices(part.piece(model.body), model.materials, modes.shapes,
                                     part.field(), part.no_field());
    const auto stiffness = unstrained(std::move(whole.stiffness.front()), modes.frequency_hz);
    fine.stiffness[i] = unit.asDiagonal() * stiffness * unit.asDiagonal();
    fine.centres.row(static_cast<Eigen::Index>(i)) = part.middle().transpose();
  });
  return fine;
}

}  // namespace chladni::stage
