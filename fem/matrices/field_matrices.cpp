#include "fem/field_matrices.h"

#include "base/error.h"
#include "base/interrupt.h"
#include "dense/blas.h"
#include "dense/blocks.h"
#include "fem/element/element_matrices.h"
#include "host/parallel.h"

namespace chladni::fem {
namespace {

// Number of partial sums, each over consecutive cells. It does not depend on the number of threads.
constexpr Eigen::Index kParts = 32;

Eigen::MatrixXd on_cell(const mesh::TetMesh& body, const Eigen::MatrixXd& shapes,
                        Eigen::Index tet) {
  Eigen::MatrixXd local(3 * body.tets.cols(), shapes.cols());
  for (Eigen::Index a = 0; a < body.tets.cols(); ++a) {
    const Eigen::Index node = body.tets(tet, a);
    local.middleRows<3>(3 * a) = shapes.middleRows<3>(3 * node);
  }
  return local;
}

// The element's matrices with all their entries.
struct Full {
  Eigen::MatrixXd stiffness, mass;
};

void unpack(const ElementMatrices& packed, Eigen::Index nodes, Full& full) {
  full.stiffness.resize(3 * nodes, 3 * nodes);
  full.mass.setZero(3 * nodes, 3 * nodes);
  for (Eigen::Index a = 0, pair = 0; a < nodes; ++a) {
    for (Eigen::Index b = 0; b <= a; ++b, ++pair) {
      for (Eigen::Index i = 0; i < 3; ++i) {
        for (Eigen::Index j = 0; j < 3; ++j) {
          const double value = packed.stiffness(pair, 3 * i + j);
          full.stiffness(3 * a + i, 3 * b + j) = value;
          full.stiffness(3 * b + j, 3 * a + i) = value;
        }
        full.mass(3 * a + i, 3 * b + i) = packed.mass(pair);
        full.mass(3 * b + i, 3 * a + i) = packed.mass(pair);
      }
    }
  }
}

// Computes Lᵀ A L for one cell after another and keeps the work space.
class Reduced {
 public:
  // Adds Lᵀ A L, times the sum's weight, to each of the sums.
  void add(const Eigen::RowVectorXd& weights, const Eigen::MatrixXd& a,
           const Eigen::MatrixXd& local, std::vector<Eigen::MatrixXd>& sums) {
    if (weights.size() == 0) return;
    minus_.setZero(local.rows(), local.cols());
    value_.setZero(local.cols(), local.cols());
    using dense::block;
    dense::subtract_product(block(a), block(local), block(minus_));
    dense::subtract_transposed_product(block(local), block(minus_), block(value_));
    for (Eigen::Index f = 0; f < weights.size(); ++f) {
      sums[static_cast<std::size_t>(f)] += weights(f) * value_;
    }
  }

 private:
  Eigen::MatrixXd minus_, value_;
};

void add(FieldMatrices& sum, const FieldMatrices& part) {
  for (std::size_t f = 0; f < sum.stiffness.size(); ++f) sum.stiffness[f] += part.stiffness[f];
  for (std::size_t f = 0; f < sum.mass.size(); ++f) sum.mass[f] += part.mass[f];
}

}  // namespace

FieldMatrices field_matrices(const mesh::TetMesh& body, const std::vector<Material>& materials,
                             const Eigen::MatrixXd& shapes, const Eigen::MatrixXd& stiffness_fields,
                             const Eigen::MatrixXd& mass_fields) {
  require(shapes.rows() == 3 * body.node_count(), "field matrices: the shapes do not fit the mesh");
  require(stiffness_fields.rows() == body.tet_count() && mass_fields.rows() == body.tet_count(),
          "field matrices: a field has another number of rows than the mesh has cells");
  const Eigen::Index modes = shapes.cols();
  const Eigen::MatrixXd zero = Eigen::MatrixXd::Zero(modes, modes);
  const FieldMatrices empty{
      std::vector<Eigen::MatrixXd>(static_cast<std::size_t>(stiffness_fields.cols()), zero),
      std::vector<Eigen::MatrixXd>(static_cast<std::size_t>(mass_fields.cols()), zero)};
  const auto first_cell = [&](std::size_t part) {
    return static_cast<Eigen::Index>(part) * body.tet_count() / kParts;
  };
  std::vector<FieldMatrices> parts(static_cast<std::size_t>(kParts), empty);
  const dense::OneBlasThread one_thread;
  parallel_ranges(parts.size(), [&](std::size_t begin, std::size_t end) {
    ElementIntegrator integrator(body, materials);
    Full full;
    Reduced stiffness, mass;
    for (std::size_t part = begin; part < end; ++part) {
      for (Eigen::Index tet = first_cell(part); tet < first_cell(part + 1); ++tet) {
        if (tet % 256 == 0) throw_if_interrupted();
        unpack(integrator.matrices(tet), body.tets.cols(), full);
        const Eigen::MatrixXd local = on_cell(body, shapes, tet);
        stiffness.add(stiffness_fields.row(tet), full.stiffness, local, parts[part].stiffness);
        mass.add(mass_fields.row(tet), full.mass, local, parts[part].mass);
      }
    }
  });
  FieldMatrices sum = empty;
  for (const auto& part : parts) add(sum, part);
  return sum;
}

}  // namespace chladni::fem
