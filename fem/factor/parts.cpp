// Cholesky by CHOLMOD, one call per part of the tree. The cores work on different subtrees, each of
// which leaves a block for its border; then one core works on the nodes above. BLAS stays on one
// thread. Sums are in a fixed order, so the bits do not depend on which core does what.
#include "fem/factor/parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <numeric>

#include "base/error.h"
#include "base/index.h"
#include "base/interrupt.h"
#include "dense/blas.h"
#include "fem/factor/cholmod.h"
#include "fem/factor/fronts.h"

namespace chladni::fem {
namespace {

using Tree = Symbolic::Tree;

std::int64_t square(std::size_t size) { return static_cast<std::int64_t>(size * size); }

std::int32_t as_index(std::int64_t entry) {
  if (entry > std::numeric_limits<std::int32_t>::max()) {
    throw OutOfResources("factorization: a matrix of " + fmt::to_string(entry) +
                         " entries, expected less than 2^31");
  }
  return static_cast<std::int32_t>(entry);
}

// Row in the order of elimination -> row of the part. Only the part's own rows and its border are
// set.
void number(const Tree& tree, const Part& part, std::vector<std::int32_t>& local) {
  local.resize(tree.order.size());
  std::int32_t next = 0;
  for (const auto s : part.nodes) {
    const auto& node = tree.nodes[at(s)];
    for (std::int32_t j = 0; j < node.width; ++j) local[at(node.first + j)] = next++;
  }
  for (const auto row : part.border) local[at(row)] = next++;
}

PartShape shape_of(const Tree& tree, const Part& part, const std::vector<std::int32_t>& local) {
  PartShape shape;
  shape.columns = part.columns;
  shape.border = static_cast<std::int32_t>(part.border.size());
  shape.panels = part.panels;
  for (const auto s : part.nodes) {
    const auto& node = tree.nodes[at(s)];
    const auto first = local[at(node.first)];
    shape.first.push_back(first);
    shape.start.push_back(static_cast<std::int64_t>(shape.rows.size()));
    shape.place.push_back(node.place);
    for (std::int32_t j = 0; j < node.width; ++j) shape.rows.push_back(first + j);
    for (const auto row : node.rows) shape.rows.push_back(local[at(row)]);
  }
  shape.start.push_back(static_cast<std::int64_t>(shape.rows.size()));
  return shape;
}

// The columns of a subtree, which are consecutive. Their rows are renumbered where they lie.
PartMatrix columns_of(const Tree& tree, std::size_t k, const std::vector<std::int32_t>& local,
                      Permuted& matrix) {
  const auto& part = tree.parts[k];
  const auto first = at(tree.nodes[at(part.nodes.front())].first);
  PartMatrix found;
  found.row = matrix.row.data();
  found.value = matrix.value.data();
  found.room = as_index(matrix.start.back() + static_cast<std::int64_t>(k));
  for (auto c = first; c < first + at(part.columns); ++c) {
    found.start.push_back(as_index(matrix.start[c]));
    found.count.push_back(as_index(matrix.start[c + 1] - matrix.start[c]));
    for (auto i = matrix.start[c]; i < matrix.start[c + 1]; ++i) {
      matrix.row[at(i)] = local[at(matrix.row[at(i)])];
    }
  }
  return found;
}

// The matrix of the nodes above the subtrees: its own entries, and the blocks of the subtrees'
// borders. Their sum fills the panels, so every entry of a panel has its place.
class TopMatrix {
 public:
  TopMatrix(const Tree& tree, const std::vector<std::int32_t>& local) : tree_(tree) {
    for (const auto s : tree.top) {
      const auto& node = tree.nodes[at(s)];
      for (std::int32_t j = 0; j < node.width; ++j) {
        start_.push_back(static_cast<std::int64_t>(row_.size()));
        for (std::int32_t i = j; i < node.width; ++i) row_.push_back(local[at(node.first + i)]);
        for (const auto row : node.rows) row_.push_back(local[at(row)]);
      }
    }
    start_.push_back(static_cast<std::int64_t>(row_.size()));
    row_.push_back(0);  // free
    value_.resize(row_.size());
    in_front_.resize(tree.order.size());
  }

  void add(const Permuted& matrix, const std::vector<Storage>& parts) {
    std::vector<std::size_t> next(tree_.subtrees.size(), 0);  // column of each border
    std::size_t column = 0;
    for (const auto s : tree_.top) {
      const auto& node = tree_.nodes[at(s)];
      number_front(node);
      for (std::int32_t j = 0; j < node.width; ++j, ++column) {
        const auto row = node.first + j;
        double* target = value_.data() + start_[column] - j;
        for (auto i = matrix.start[at(row)]; i < matrix.start[at(row) + 1]; ++i) {
          target[in_front_[at(matrix.row[at(i)])]] += matrix.value[at(i)];
        }
        for (std::size_t k = 0; k < next.size(); ++k) add_border(k, row, parts[k], next[k], target);
      }
    }
  }

  [[nodiscard]] PartMatrix seen() {
    PartMatrix found;
    found.row = row_.data();
    found.value = value_.data();
    found.room = as_index(start_.back());
    for (std::size_t j = 0; j + 1 < start_.size(); ++j) {
      found.start.push_back(as_index(start_[j]));
      found.count.push_back(as_index(start_[j + 1] - start_[j]));
    }
    return found;
  }

 private:
  void number_front(const Supernode& node) {
    for (std::int32_t j = 0; j < node.width; ++j) in_front_[at(node.first + j)] = j;
    for (std::size_t i = 0; i < node.rows.size(); ++i) {
      in_front_[at(node.rows[i])] = node.width + static_cast<std::int32_t>(i);
    }
  }

  void add_border(std::size_t k, std::int32_t row, const Storage& storage, std::size_t& next,
                  double* target) const {
    const auto& part = tree_.parts[k];
    if (next >= part.border.size() || part.border[next] != row) return;
    const auto size = part.border.size();
    const double* column = storage.data() + part.panels + static_cast<std::int64_t>(next * size);
    for (auto i = next; i < size; ++i) target[in_front_[at(part.border[i])]] += column[i];
    ++next;
  }

  const Tree& tree_;
  std::vector<std::int64_t> start_;
  std::vector<std::int32_t> row_, in_front_;
  std::vector<double> value_;
};

bool factorise_subtrees(const Tree& tree, Permuted& matrix, std::vector<Storage>& parts) {
  std::vector<std::vector<std::int32_t>> local(at(tree.threads));
  std::atomic<bool> definite{true};
  each_subtree(tree, [&](std::size_t k, std::size_t thread) {
    throw_if_interrupted();
    if (!definite) return;
    const auto& part = tree.parts[k];
    number(tree, part, local[thread]);
    const auto shape = shape_of(tree, part, local[thread]);
    const auto columns = columns_of(tree, k, local[thread], matrix);
    parts[k] = Storage(part.panels + square(part.border.size()), true);
    if (!factorise(shape, columns, parts[k].data())) definite = false;
  });
  throw_if_interrupted();
  return definite;
}

bool factorise_top(const Tree& tree, const Permuted& matrix, std::vector<Storage>& parts) {
  const auto& part = tree.parts.back();
  std::vector<std::int32_t> local;
  number(tree, part, local);
  TopMatrix sum(tree, local);
  sum.add(matrix, parts);
  for (std::size_t k = 0; k < tree.subtrees.size(); ++k) parts[k].shrink(tree.parts[k].panels);
  parts.back() = Storage(part.panels, true);
  const auto factorised = [&] {
    const LongStep step;
    return factorise(shape_of(tree, part, local), sum.seen(), parts.back().data());
  };
  const bool definite = factorised();
  throw_if_interrupted();
  return definite;
}

}  // namespace

void choose_parts(Tree& tree) {
  for (const auto root : tree.subtrees) {
    const auto first = first_descendant(tree, root);
    Part part;
    part.nodes.resize(at(root - first + 1));
    std::iota(part.nodes.begin(), part.nodes.end(), first);
    part.border = tree.nodes[at(root)].rows;
    tree.parts.push_back(std::move(part));
  }
  if (!tree.top.empty()) tree.parts.emplace_back().nodes = tree.top;
  for (std::size_t k = 0; k < tree.parts.size(); ++k) {
    auto& part = tree.parts[k];
    for (const auto s : part.nodes) {
      auto& node = tree.nodes[at(s)];
      node.part = static_cast<std::int32_t>(k);
      node.place = part.panels;
      part.columns += node.width;
      part.panels += node.width * (node.width + static_cast<std::int64_t>(node.rows.size()));
    }
    tree.factor_size += part.panels;
  }
}

std::int64_t work_of_parts(const Tree& tree) {
  std::vector<std::int32_t> local;
  std::int64_t borders = 0;
  std::int64_t largest = 0;
  std::int64_t above = 0;
  for (std::size_t k = 0; k < tree.parts.size(); ++k) {
    const auto& part = tree.parts[k];
    number(tree, part, local);
    const auto work = work_size(shape_of(tree, part, local));
    borders += square(part.border.size());
    if (k < tree.subtrees.size()) {
      largest = std::max(largest, work);
    } else {  // values and rows of the lower triangle, beside CHOLMOD's work
      above = part.panels * 3 / 2 + work;
    }
  }
  return borders + std::max(tree.threads * largest, above);
}

void Factorization::Numeric::factorize(const SparseMatrix& a, double s, const SparseMatrix* b) {
  const dense::OneBlasThread one_thread;
  auto matrix = permuted(tree, a, s, b, tree.subtrees.size());
  if (!factorise_subtrees(tree, matrix, parts) ||
      (!tree.top.empty() && !factorise_top(tree, matrix, parts))) {
    throw NumericalFailure("factorization: the matrix is not positive definite");
  }
}

Factorization::Factorization(const SparseMatrix& matrix)
    : numeric_(std::make_unique<Numeric>(matrix)) {
  numeric_->factorize(matrix, 0.0, nullptr);
}

Factorization::Factorization(const Symbolic& symbolic, const SparseMatrix& a, double s,
                             const SparseMatrix& b)
    : numeric_(std::make_unique<Numeric>(symbolic.tree())) {
  numeric_->factorize(a, s, &b);
}

Factorization::Factorization(std::shared_ptr<const Symbolic> symbolic, const SparseMatrix& a,
                             double s, const SparseMatrix& b)
    : numeric_(std::make_unique<Numeric>(std::move(symbolic))) {
  numeric_->factorize(a, s, &b);
}

Factorization::~Factorization() = default;
Factorization::Factorization(Factorization&&) noexcept = default;
Factorization& Factorization::operator=(Factorization&&) noexcept = default;

}  // namespace chladni::fem
