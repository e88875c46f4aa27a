#include "fem/assemble.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <string>

#include "base/error.h"
#include "base/interrupt.h"
#include "fem/body/rigid_body.h"
#include "fem/element/element_matrices.h"
#include "host/parallel.h"

namespace chladni::fem {
namespace {

// For each node, the nodes with a higher number that share a cell with it, ascending. This is the
// lower triangle of the node graph, by columns.
struct NodeGraph {
  std::vector<std::int64_t> start;  // node_count + 1
  std::vector<std::int32_t> below;  // row indices
};

// For each node, the cells that it belongs to, ascending.
struct CellsOfNode {
  std::vector<std::int64_t> start;
  std::vector<std::int32_t> cell;
};

CellsOfNode cells_of_nodes(const mesh::TetMesh& body) {
  const auto n = static_cast<std::size_t>(body.node_count());
  CellsOfNode result{std::vector<std::int64_t>(n + 1, 0), {}};
  for (Eigen::Index k = 0; k < body.tets.size(); ++k) {
    ++result.start[static_cast<std::size_t>(body.tets.data()[k]) + 1];
  }
  for (std::size_t i = 0; i < n; ++i) result.start[i + 1] += result.start[i];
  result.cell.resize(static_cast<std::size_t>(body.tets.size()));
  auto next = result.start;
  for (Eigen::Index t = 0; t < body.tet_count(); ++t) {
    for (const auto node : body.tets.row(t)) {
      const auto place = next[static_cast<std::size_t>(node)]++;
      result.cell[static_cast<std::size_t>(place)] = static_cast<std::int32_t>(t);
    }
  }
  return result;
}

// The nodes of `node`'s cells whose number is above `node`. Each of them is marked with `node` in
// `seen`.
void neighbours_below(const mesh::TetMesh& body, const CellsOfNode& cells, std::size_t node,
                      std::vector<std::int32_t>& seen, std::vector<std::int32_t>& found) {
  found.clear();
  const auto own = static_cast<std::int32_t>(node);
  for (auto k = cells.start[node]; k < cells.start[node + 1]; ++k) {
    for (const auto other : body.tets.row(cells.cell[static_cast<std::size_t>(k)])) {
      auto& mark = seen[static_cast<std::size_t>(other)];
      if (other > own && mark != own) {
        mark = own;
        found.push_back(other);
      }
    }
  }
  std::sort(found.begin(), found.end());
}

NodeGraph node_graph(const mesh::TetMesh& body, const CellsOfNode& cells) {
  const auto n = static_cast<std::size_t>(body.node_count());
  NodeGraph graph{std::vector<std::int64_t>(n + 1, 0), {}};
  std::vector<std::vector<std::int32_t>> part(n == 0 ? 0 : 64);
  // There are 64 fixed parts for any number of threads. Each part lists its nodes in order.
  const auto first = [&](std::size_t p) { return p * n / part.size(); };
  parallel_ranges(part.size(), [&](std::size_t begin, std::size_t end) {
    std::vector<std::int32_t> seen(n, -1);
    std::vector<std::int32_t> found;
    for (auto p = begin; p < end; ++p) {
      for (auto node = first(p); node < first(p + 1); ++node) {
        neighbours_below(body, cells, node, seen, found);
        graph.start[node + 1] = static_cast<std::int64_t>(found.size());
        part[p].insert(part[p].end(), found.begin(), found.end());
      }
    }
  });
  for (std::size_t i = 0; i < n; ++i) graph.start[i + 1] += graph.start[i];
  graph.below.reserve(static_cast<std::size_t>(graph.start[n]));
  for (auto& list : part) graph.below.insert(graph.below.end(), list.begin(), list.end());
  return graph;
}

// Lower triangles in compressed form: three columns per node. Stiffness couples all axes, mass only
// equal ones.
struct Pattern {
  SparseMatrix stiffness, mass;
};

SparseMatrix empty_compressed(Eigen::Index size, std::int64_t entries) {
  require(entries < (std::int64_t{1} << 31), "assemble: the matrix has " + fmt::to_string(entries) +
                                                 " entries, more than 2^31; use a coarser mesh");
  SparseMatrix matrix(size, size);
  matrix.resizeNonZeros(static_cast<Eigen::Index>(entries));
  std::fill_n(matrix.valuePtr(), entries, 0.0);
  return matrix;
}

Pattern pattern(const NodeGraph& graph) {
  const auto n = static_cast<Eigen::Index>(graph.start.size()) - 1;
  const auto edges = graph.start.back();
  Pattern p{empty_compressed(3 * n, 6 * n + 9 * edges), empty_compressed(3 * n, 3 * n + 3 * edges)};
  std::int32_t k = 0;
  std::int32_t m = 0;
  for (Eigen::Index node = 0; node < n; ++node) {
    const auto* begin = graph.below.data() + graph.start[static_cast<std::size_t>(node)];
    const auto* end = graph.below.data() + graph.start[static_cast<std::size_t>(node) + 1];
    for (int axis = 0; axis < 3; ++axis) {
      p.stiffness.outerIndexPtr()[3 * node + axis] = k;
      p.mass.outerIndexPtr()[3 * node + axis] = m;
      for (int row = axis; row < 3; ++row) {
        p.stiffness.innerIndexPtr()[k++] = static_cast<std::int32_t>(3 * node + row);
      }
      p.mass.innerIndexPtr()[m++] = static_cast<std::int32_t>(3 * node + axis);
      for (const auto* other = begin; other != end; ++other) {
        for (int row = 0; row < 3; ++row) p.stiffness.innerIndexPtr()[k++] = 3 * *other + row;
        p.mass.innerIndexPtr()[m++] = 3 * *other + axis;
      }
    }
  }
  p.stiffness.outerIndexPtr()[3 * n] = k;
  p.mass.outerIndexPtr()[3 * n] = m;
  return p;
}

// Adds one cell's blocks to the columns of those nodes for which `mine` is true.
class Scatter {
 public:
  Scatter(const NodeGraph& graph, Pattern& into) : graph_(graph), into_(into) {}

  template <typename Mine>
  void add(const std::int32_t* nodes, int count, const ElementMatrices& cell, const Mine& mine) {
    Eigen::Index pair = 0;
    for (int a = 0; a < count; ++a) {
      for (int b = 0; b <= a; ++b, ++pair) {
        if (nodes[a] == nodes[b]) {
          if (mine(nodes[a])) add_diagonal(nodes[a], cell, pair);
        } else if (nodes[a] > nodes[b]) {
          if (mine(nodes[b])) add_block(nodes[a], nodes[b], cell, pair, false);
        } else if (mine(nodes[a])) {
          add_block(nodes[b], nodes[a], cell, pair, true);
        }
      }
    }
  }

 private:
  void add_diagonal(std::int32_t node, const ElementMatrices& cell, Eigen::Index pair) {
    for (int column = 0; column < 3; ++column) {
      double* k = into_.stiffness.valuePtr() + into_.stiffness.outerIndexPtr()[3 * node + column];
      for (int row = column; row < 3; ++row)
        k[row - column] += cell.stiffness(pair, 3 * row + column);
      into_.mass.valuePtr()[into_.mass.outerIndexPtr()[3 * node + column]] += cell.mass(pair);
    }
  }

  // Adds the pair's block at (row node, column node), transposed where the pair is stored the other
  // way round.
  void add_block(std::int32_t row_node, std::int32_t column_node, const ElementMatrices& cell,
                 Eigen::Index pair, bool transposed) {
    const auto* begin = graph_.below.data() + graph_.start[static_cast<std::size_t>(column_node)];
    const auto* end = graph_.below.data() + graph_.start[static_cast<std::size_t>(column_node) + 1];
    const auto place = std::lower_bound(begin, end, row_node) - begin;
    for (int column = 0; column < 3; ++column) {
      const Eigen::Index c = 3 * Eigen::Index{column_node} + column;
      double* k = into_.stiffness.valuePtr() + into_.stiffness.outerIndexPtr()[c] + (3 - column) +
                  3 * place;
      for (int row = 0; row < 3; ++row) {
        k[row] += cell.stiffness(pair, transposed ? 3 * column + row : 3 * row + column);
      }
      into_.mass.valuePtr()[into_.mass.outerIndexPtr()[c] + 1 + place] += cell.mass(pair);
    }
  }

  const NodeGraph& graph_;
  Pattern& into_;
};

// A node belongs to the part of its first cell. Cells are sorted in space, so few cells have nodes
// of two parts. One thread sums each column in the order of the cells, so the bits are the same for
// any number of threads.
void sum_cells(const mesh::TetMesh& body, const std::vector<Material>& materials,
               const CellsOfNode& cells, const NodeGraph& graph, Pattern& into) {
  const int count = static_cast<int>(body.tets.cols());
  const auto first_cell = [&](std::int32_t node) {
    return cells.cell[static_cast<std::size_t>(cells.start[static_cast<std::size_t>(node)])];
  };
  parallel_ranges(
      static_cast<std::size_t>(body.tet_count()), [&](std::size_t begin, std::size_t end) {
        const auto mine = [&](std::int32_t node) {
          const auto cell = static_cast<std::size_t>(first_cell(node));
          return begin <= cell && cell < end;
        };
        ElementIntegrator integrator(body, materials);
        Scatter scatter(graph, into);
        // A cell before `begin` cannot hold a node whose first cell is in [begin, end).
        for (auto t = begin; t < static_cast<std::size_t>(body.tet_count()); ++t) {
          const auto* nodes = body.tets.data() + t * static_cast<std::size_t>(count);
          if (t >= end && std::none_of(nodes, nodes + count, mine)) continue;
          if (t % 1024 == 0) throw_if_interrupted();
          scatter.add(nodes, count, integrator.matrices(static_cast<Eigen::Index>(t)), mine);
        }
      });
}

DofMap dof_map(const mesh::TetMesh& body, const std::vector<Support>& supports,
               Eigen::Index extras) {
  DofMap map{.free_dof = Eigen::VectorXi::Zero(3 * body.node_count() + extras),
             .node_count = body.node_count()};
  for (const auto& support : supports) {
    const auto patch = std::find(body.patch_names.begin(), body.patch_names.end(), support.patch);
    std::string known;
    for (const auto& name : body.patch_names) known.append(known.empty() ? "" : ", ").append(name);
    require(patch != body.patch_names.end(),
            "support: the body has no patch \"" + support.patch + "\"; there are: " + known);
    const auto index = patch - body.patch_names.begin();
    require((body.face_patch.array() == static_cast<int>(index)).any(),
            "support: the patch \"" + support.patch +
                "\" has no face on the outside of the body; between two regions it holds nothing");
    for (Eigen::Index f = 0; f < body.faces.rows(); ++f) {
      if (body.face_patch(f) != index) continue;
      for (const auto node : body.faces.row(f)) {
        if (support.x) map.free_dof(3 * node) = -1;
        if (support.y) map.free_dof(3 * node + 1) = -1;
        if (support.z) map.free_dof(3 * node + 2) = -1;
      }
    }
  }
  for (auto& dof : map.free_dof) {
    if (dof >= 0) dof = static_cast<int>(map.free_count++);
  }
  return map;
}

Points positions(const mesh::TetMesh& body, const DofMap& map, const AttachmentTerms& attached) {
  Points result(map.free_count, 3);
  for (Eigen::Index i = 0; i < map.free_dof.size(); ++i) {
    if (map.free_dof(i) < 0) continue;
    const Eigen::Index extra = i - 3 * map.node_count;
    if (extra < 0) {
      result.row(map.free_dof(i)) = body.points.row(i / 3);
    } else {
      result.row(map.free_dof(i)) = attached.extras[static_cast<std::size_t>(extra)].position;
    }
  }
  return result;
}

// The free rows and columns of the lower triangle `all`, plus the entries of `terms`. The extra
// degrees of freedom have entries from `terms` only.
SparseMatrix free_part(const SparseMatrix& all, const DofMap& map,
                       const std::vector<Eigen::Triplet<double>>& terms) {
  std::vector<Eigen::Triplet<double>> kept;
  for (const auto& term : terms) {
    const int row = map.free_dof(term.row());
    const int column = map.free_dof(term.col());
    if (row >= 0 && column >= 0) kept.emplace_back(row, column, term.value());
  }
  SparseMatrix added(map.free_count, map.free_count);
  added.setFromTriplets(kept.begin(), kept.end());
  SparseMatrix body(map.free_count, map.free_count);
  body.reserve(all.nonZeros());
  for (Eigen::Index column = 0; column < all.cols(); ++column) {
    if (map.free_dof(column) < 0) continue;
    body.startVec(map.free_dof(column));
    for (SparseMatrix::InnerIterator entry(all, column); entry; ++entry) {
      const int row = map.free_dof(entry.row());
      if (row >= 0) body.insertBack(row, map.free_dof(column)) = entry.value();
    }
  }
  for (Eigen::Index column = 3 * map.node_count; column < map.free_dof.size(); ++column) {
    body.startVec(map.free_dof(column));
  }
  body.finalize();
  return kept.empty() ? body : SparseMatrix(body + added);
}

void check_input(const mesh::TetMesh& body, const std::vector<Material>& materials) {
  require(body.tet_count() > 0, "assemble: the body has no tetrahedra");
  require(materials.size() >= body.region_names.size(),
          "assemble: the body has " + fmt::to_string(body.region_names.size()) + " regions but " +
              fmt::to_string(materials.size()) + " materials were given");
  require(body.region.size() == body.tet_count() && body.region.minCoeff() >= 0 &&
              body.region.maxCoeff() < static_cast<int>(materials.size()),
          "assemble: a cell belongs to a region without a material");
}

}  // namespace

System assemble(const mesh::TetMesh& body, const std::vector<Material>& materials,
                const std::vector<Support>& supports, const std::vector<Attachment>& attachments) {
  check_input(body, materials);
  const auto cells = cells_of_nodes(body);
  const auto graph = node_graph(body, cells);
  auto summed = pattern(graph);
  sum_cells(body, materials, cells, graph, summed);

  const auto extra = terms(body, attachments);
  System system;
  system.dofs = dof_map(body, supports, extra.extra_count());
  require(system.dofs.free_count > 0, "the supports hold the whole body: nothing of it can move");
  const bool untouched = system.dofs.free_count == 3 * body.node_count() && attachments.empty();
  if (untouched) {
    system.stiffness = std::move(summed.stiffness);
    system.mass = std::move(summed.mass);
  } else {
    system.stiffness = free_part(summed.stiffness, system.dofs, extra.stiffness);
    system.mass = free_part(summed.mass, system.dofs, extra.mass);
  }
  if (!extra.damping.empty()) {
    const SparseMatrix none(3 * body.node_count(), 3 * body.node_count());
    system.damping = free_part(none, system.dofs, extra.damping);
  }
  system.positions = positions(body, system.dofs, extra);
  system.rigid = rigid_motions(body, system, extra);
  auto [suspended, force] = suspension(body, system, extra);
  system.suspended = std::move(suspended);
  system.suspension_force = std::move(force);
  system.frequency_scale_hz = frequency_scale(body, materials);
  return system;
}

}  // namespace chladni::fem
