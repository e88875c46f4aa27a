// Solves with the factor that CHOLMOD made, all right-hand sides at once: up the tree for L y = b,
// then down the tree for L^T x = y.
#include <algorithm>

#include "base/index.h"
#include "dense/panel_kernels.h"
#include "fem/factor/parts.h"

namespace chladni::fem {
namespace {

using Tree = Symbolic::Tree;
using dense::Block;
// A degree of freedom's values for all right-hand sides lie together.
using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// The right-hand sides of one front, column-major: first its own columns, then the rows below.
class FrontVectors {
 public:
  FrontVectors(const Tree& tree, Eigen::Index columns)
      : columns_(columns), values_(at(tree.tallest_front * columns)) {}

  Block of(const Supernode& node) {
    const long rows = node.width + static_cast<long>(node.rows.size());
    return {values_.data(), rows, columns_, rows};
  }

 private:
  Eigen::Index columns_;
  std::vector<double> values_;
};

void gather_own(const Supernode& node, const Rows& x, Block front) {
  for (long i = 0; i < node.width; ++i) {
    for (long c = 0; c < front.columns; ++c) front(i, c) = x(node.first + i, c);
  }
}

void scatter_own(const Supernode& node, Block front, Rows& x) {
  for (long i = 0; i < node.width; ++i) {
    for (long c = 0; c < front.columns; ++c) x(node.first + i, c) = front(i, c);
  }
}

// Goes up through one node. Rows up to `last` are changed in x. Later rows (of ancestors) are
// changed in `outer`, where row i of the order of elimination is row local[i].
void step_up(const Supernode& node, Block panel, Block front, Rows& x, std::int32_t last,
             Rows& outer, const std::vector<std::int32_t>& local) {
  gather_own(node, x, front);
  const auto rows = static_cast<long>(node.rows.size());
  for (long c = 0; c < front.columns; ++c) std::fill_n(&front(node.width, c), rows, 0.0);
  dense::sweep_up(panel, front);
  scatter_own(node, front, x);
  for (long i = 0; i < rows; ++i) {
    const auto row = node.rows[at(i)];
    double* to = row <= last ? &x(row, 0) : &outer(local[at(row)], 0);
    for (long c = 0; c < front.columns; ++c) to[c] += front(node.width + i, c);
  }
}

void step_down(const Supernode& node, Block panel, Block front, Rows& x) {
  gather_own(node, x, front);
  for (std::size_t i = 0; i < node.rows.size(); ++i) {
    const double* from = &x(node.rows[i], 0);
    for (long c = 0; c < front.columns; ++c) front(node.width + long(i), c) = from[c];
  }
  dense::sweep_down(panel, front);
  scatter_own(node, front, x);
}

// Each subtree's changes to the rows above it are kept apart. They are added in the order of the
// subtrees, so the bits do not depend on which thread is first.
void go_up(const Factorization::Numeric& factor, Rows& x) {
  const auto& tree = factor.tree;
  std::vector<FrontVectors> fronts(at(tree.threads), {tree, x.cols()});
  std::vector<std::vector<std::int32_t>> local(at(tree.threads));
  std::vector<Rows> outer(tree.subtrees.size());
  each_subtree(tree, [&](std::size_t k, std::size_t thread) {
    const auto root = tree.subtrees[k];
    const auto& top = tree.nodes[at(root)];
    outer[k] = Rows::Zero(static_cast<Eigen::Index>(top.rows.size()), x.cols());
    local[thread].resize(tree.order.size());
    for (std::size_t i = 0; i < top.rows.size(); ++i) {
      local[thread][at(top.rows[i])] = static_cast<std::int32_t>(i);
    }
    for (auto s = first_descendant(tree, root); s <= root; ++s) {
      const auto& node = tree.nodes[at(s)];
      step_up(node, factor.panel(node), fronts[thread].of(node), x, top.first + top.width - 1,
              outer[k], local[thread]);
    }
  });
  for (std::size_t k = 0; k < outer.size(); ++k) {
    const auto& rows = tree.nodes[at(tree.subtrees[k])].rows;
    for (std::size_t i = 0; i < rows.size(); ++i) x.row(rows[i]) += outer[k].row(long(i));
  }
  const auto last = static_cast<std::int32_t>(tree.order.size());
  for (const auto s : tree.top) {
    const auto& node = tree.nodes[at(s)];
    step_up(node, factor.panel(node), fronts[0].of(node), x, last, x, {});
  }
}

void go_down(const Factorization::Numeric& factor, Rows& x) {
  const auto& tree = factor.tree;
  std::vector<FrontVectors> fronts(at(tree.threads), {tree, x.cols()});
  for (auto s = tree.top.rbegin(); s != tree.top.rend(); ++s) {
    const auto& node = tree.nodes[at(*s)];
    step_down(node, factor.panel(node), fronts[0].of(node), x);
  }
  each_subtree(tree, [&](std::size_t k, std::size_t thread) {
    const auto root = tree.subtrees[k];
    const auto first = first_descendant(tree, root);
    for (auto s = root; s >= first; --s) {
      const auto& node = tree.nodes[at(s)];
      step_down(node, factor.panel(node), fronts[thread].of(node), x);
    }
  });
}

}  // namespace

Eigen::MatrixXd Factorization::solve(const Eigen::Ref<const Eigen::MatrixXd>& b) const {
  if (b.cols() == 0) return Eigen::MatrixXd(b.rows(), 0);
  const auto& order = numeric_->tree.order;
  Rows x(b.rows(), b.cols());
  const auto each_row = [&](const auto& work) {
    constexpr std::size_t kWorthThreads = 50'000;
    if (order.size() < kWorthThreads) return work(0, order.size());
    parallel_ranges(order.size(), work);
  };
  each_row([&](std::size_t begin, std::size_t end) {
    for (auto i = begin; i < end; ++i) x.row(static_cast<Eigen::Index>(i)) = b.row(order[i]);
  });
  go_up(*numeric_, x);
  go_down(*numeric_, x);
  Eigen::MatrixXd result(b.rows(), b.cols());
  each_row([&](std::size_t begin, std::size_t end) {
    for (auto i = begin; i < end; ++i) result.row(order[i]) = x.row(static_cast<Eigen::Index>(i));
  });
  return result;
}

}  // namespace chladni::fem
