#include "priors/methods/shape_symmetry.h"

#include <Eigen/Geometry>
#include <cmath>

#include "modal/groups.h"
#include "priors/constants.h"
#include "priors/simulated_lengths.h"

namespace chladni::priors {
namespace {

// Columns: two axes across the direction, then the direction.
Eigen::Matrix3d frame_of(const Eigen::RowVector3d& direction) {
  const Eigen::Vector3d normal = direction.transpose();
  const Eigen::Vector3d axis =
      std::abs(normal.x()) < 0.9 ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitY();
  Eigen::Matrix3d frame;
  frame.col(0) = (axis - normal.dot(axis) * normal).normalized();
  frame.col(1) = normal.cross(frame.col(0));
  frame.col(2) = normal;
  return frame;
}

std::vector<Eigen::Matrix3d> operations_of_a_square(const Eigen::Matrix3d& frame) {
  std::vector<Eigen::Matrix3d> operations;
  for (const bool swap : {false, true}) {
    for (const double a : {1.0, -1.0}) {
      for (const double b : {1.0, -1.0}) {
        Eigen::Matrix3d plain = Eigen::Vector3d(a, b, 1.0).asDiagonal();
        if (swap) plain.row(0).swap(plain.row(1));
        operations.push_back(frame * plain * frame.transpose());
      }
    }
  }
  return operations;  // the first is the identity
}

Eigen::RowVector3d middle_of(const Points& points, const Eigen::Matrix3d& frame) {
  const Eigen::MatrixXd local = points * frame;
  const Eigen::RowVector3d middle = 0.5 * (local.colwise().maxCoeff() + local.colwise().minCoeff());
  return middle * frame.transpose();
}

// For each sample, the point of the surface nearest to its image; empty if too many images miss.
std::vector<Eigen::Index> images(const Places& surface, const std::vector<Eigen::Index>& samples,
                                 const Eigen::Matrix3d& operation, const Eigen::RowVector3d& centre,
                                 double reach) {
  std::vector<Eigen::Index> found;
  std::size_t missed = 0;
  for (const auto row : samples) {
    const Eigen::RowVector3d image =
        centre + (surface.position.row(row) - centre) * operation.transpose();
    Eigen::Index nearest = 0;
    const double square =
        (surface.position.rowwise() - image).rowwise().squaredNorm().minCoeff(&nearest);
    if (square > reach * reach) ++missed;
    found.push_back(nearest);
  }
  const auto all = static_cast<double>(samples.size());
  if (static_cast<double>(missed) > (1.0 - Constants::mapped) * all) found.clear();
  return found;
}

// Correlation of each shape with its image, r.
Eigen::VectorXd correlations(const Eigen::MatrixXd& shapes, const Eigen::MatrixXd& there) {
  const Eigen::VectorXd product = shapes.cwiseProduct(there).colwise().sum();
  const Eigen::VectorXd size =
      shapes.colwise().norm().cwiseProduct(there.colwise().norm()).transpose();
  return product.cwiseQuotient(size.cwiseMax(1e-300));
}

bool is_group(const Symmetry& symmetry) {
  for (std::size_t g = 0; g < symmetry.operations.size(); ++g) {
    for (std::size_t h = 0; h < symmetry.operations.size(); ++h) {
      const Eigen::Matrix3d both = symmetry.operations[g] * symmetry.operations[h];
      bool found = false;
      for (std::size_t k = 0; k < symmetry.operations.size(); ++k) {
        found =
            found || ((symmetry.operations[k] - both).norm() < 1e-9 &&
                      symmetry.characters[k] == symmetry.characters[g] * symmetry.characters[h]);
      }
      if (!found) return false;
    }
  }
  return true;
}

// `characters` is r×operations: ±1, or 0 if a shape does not have the symmetry.
Symmetry symmetry_of(const modal::ModeGroup& group, const Eigen::MatrixXd& characters,
                     const std::vector<Eigen::Matrix3d>& operations,
                     const Eigen::RowVector3d& centre) {
  Symmetry symmetry{centre, {}, {}};
  for (std::size_t g = 0; g < operations.size(); ++g) {
    const Eigen::VectorXd of_group =
        characters.col(static_cast<Eigen::Index>(g)).segment(group.first, group.size);
    const double first = of_group(0);
    if (first == 0.0 || (of_group.array() != first).any()) continue;
    symmetry.operations.push_back(operations[g]);
    symmetry.characters.push_back(first);
  }
  if (!is_group(symmetry)) return {centre, {Eigen::Matrix3d::Identity()}, {1.0}};
  return symmetry;
}

}  // namespace

std::vector<Symmetry> shape_symmetries(const Simulation& simulation,
                                       const Eigen::RowVector3d& direction) {
  const auto& surface = simulation.surface;
  const auto operations = operations_of_a_square(frame_of(direction));
  const Eigen::RowVector3d centre = middle_of(surface.position, frame_of(direction));
  const auto samples = spread_points(surface.position, Constants::symmetry_samples);
  const Eigen::MatrixXd shapes = surface.shapes(samples, Eigen::all);
  const double grain = std::sqrt(simulation.area.sum() / static_cast<double>(surface.count()));
  Eigen::MatrixXd characters =
      Eigen::MatrixXd::Zero(shapes.cols(), static_cast<Eigen::Index>(operations.size()));
  characters.col(0).setOnes();
  for (std::size_t g = 1; g < operations.size(); ++g) {
    const auto there =
        images(surface, samples, operations[g], centre, Constants::image_reach * grain);
    if (there.empty()) continue;
    const Eigen::ArrayXd kept = correlations(shapes, surface.shapes(there, Eigen::all)).array();
    characters.col(static_cast<Eigen::Index>(g)) = (kept > Constants::same_shape).cast<double>() -
                                                   (kept < -Constants::same_shape).cast<double>();
  }
  std::vector<Symmetry> symmetries;
  for (const auto& group : modal::groups(simulation.frequency_hz, Constants::repeated_frequency)) {
    const auto one = symmetry_of(group, characters, operations, centre);
    symmetries.insert(symmetries.end(), static_cast<std::size_t>(group.size), one);
  }
  return symmetries;
}

}  // namespace chladni::priors
