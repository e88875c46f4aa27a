#include <algorithm>
#include <numeric>

#include "base/index.h"
#include "fem/factor/cholmod.h"
#include "fem/factor/elimination_tree.h"
#include "fem/factor/parts.h"
#include "host/parallel.h"

namespace chladni::fem {
namespace {

using Index = std::int32_t;

double front_flops(double w, double r) { return w * w * w / 3.0 + w * w * r + w * r * r; }

// Chooses subtrees so that all threads get nearly equal work. All threads work together on the
// nodes above the subtrees.
void choose_subtrees(Symbolic::Tree& tree, int threads) {
  std::vector<Index> chosen;
  for (std::size_t s = 0; s < tree.nodes.size(); ++s) {
    if (tree.nodes[s].parent == -1) chosen.push_back(static_cast<Index>(s));
  }
  const auto lighter = [&](Index a, Index b) {
    const double fa = tree.nodes[at(a)].subtree_flops;
    const double fb = tree.nodes[at(b)].subtree_flops;
    return fa != fb ? fa < fb : a < b;
  };
  std::make_heap(chosen.begin(), chosen.end(), lighter);
  std::vector<char> is_top(tree.nodes.size(), 0);
  const auto balanced = [&] {
    auto sorted = chosen;
    std::sort(sorted.begin(), sorted.end(), [&](Index a, Index b) { return lighter(b, a); });
    std::vector<double> load(static_cast<std::size_t>(threads), 0.0);
    double total = 0.0;
    for (const Index s : sorted) {
      *std::min_element(load.begin(), load.end()) += tree.nodes[at(s)].subtree_flops;
      total += tree.nodes[at(s)].subtree_flops;
    }
    return *std::max_element(load.begin(), load.end()) <= 1.12 * total / threads;
  };
  while (!chosen.empty() && chosen.size() < 200 && threads > 1 && !balanced()) {
    std::pop_heap(chosen.begin(), chosen.end(), lighter);
    const Index heaviest = chosen.back();
    chosen.pop_back();
    is_top[at(heaviest)] = 1;
    for (const Index child : tree.nodes[at(heaviest)].children) {
      chosen.push_back(child);
      std::push_heap(chosen.begin(), chosen.end(), lighter);
    }
  }
  std::sort(chosen.begin(), chosen.end(), [&](Index a, Index b) { return lighter(b, a); });
  tree.subtrees = std::move(chosen);
  for (std::size_t s = 0; s < tree.nodes.size(); ++s) {
    if (is_top[s] != 0) tree.top.push_back(static_cast<Index>(s));
  }
}

void sum_up(Symbolic::Tree& tree) {
  for (std::size_t s = tree.nodes.size(); s-- > 0;) {
    auto& node = tree.nodes[s];
    if (node.parent != -1) node.parity = 1 - tree.nodes[at(node.parent)].parity;
  }
  for (auto& node : tree.nodes) {
    node.flops = front_flops(node.width, static_cast<double>(node.rows.size()));
    node.subtree_flops += node.flops;
    tree.largest_panel = std::max(tree.largest_panel, panel_size(node));
    tree.tallest_front = std::max<std::int64_t>(
        tree.tallest_front, node.width + static_cast<std::int64_t>(node.rows.size()));
    const auto w = static_cast<double>(node.width);
    tree.entries_of_factor += w * (w + 1.0) / 2.0 + w * static_cast<double>(node.rows.size());
    tree.flops += node.flops;
    if (node.parent != -1) tree.nodes[at(node.parent)].subtree_flops += node.subtree_flops;
  }
}

// The largest size of the update blocks that wait on the stacks at one time. A node pushes on the
// stack of its parity and pops its children from the other stack, so the popped blocks are always
// on top.
void size_stacks(Symbolic::Tree& tree) {
  std::int64_t waiting[2] = {0, 0};
  const auto update_size = [](const Supernode& node) {
    return static_cast<std::int64_t>(node.rows.size() * node.rows.size());
  };
  const auto work = [&](const Supernode& node) {
    if (node.detached) {
      tree.detached_size += update_size(node);
    } else {
      waiting[node.parity] += update_size(node);
    }
    for (int k = 0; k < 2; ++k) tree.stack_size[k] = std::max(tree.stack_size[k], waiting[k]);
    for (const Index child : node.children) {
      const auto& below = tree.nodes[at(child)];
      if (!below.detached) waiting[below.parity] -= update_size(below);
    }
  };
  for (const Index root : tree.subtrees) {
    tree.nodes[at(root)].detached = tree.nodes[at(root)].parent != -1;
  }
  for (const Index root : tree.subtrees) {
    for (Index s = first_descendant(tree, root); s <= root; ++s) work(tree.nodes[at(s)]);
  }
  for (const Index s : tree.top) work(tree.nodes[at(s)]);
}

// The supernodes of the groups as supernodes of their degrees of freedom.
void expand(const GroupSupernodes& found, const QuotientGraph& graph, Symbolic::Tree& tree) {
  std::vector<Index> place(found.order.size() + 1, 0);  // new number of a group's first dof
  for (std::size_t j = 0; j < found.order.size(); ++j) {
    const auto old = at(found.order[j]);
    for (Index dof = graph.first[old]; dof < graph.first[old + 1]; ++dof) tree.order.push_back(dof);
    place[j + 1] = static_cast<Index>(tree.order.size());
  }
  tree.position.resize(tree.order.size());
  for (std::size_t i = 0; i < tree.order.size(); ++i) {
    tree.position[at(tree.order[i])] = static_cast<Index>(i);
  }
  tree.nodes.resize(found.first.size() - 1);
  for (std::size_t s = 0; s < tree.nodes.size(); ++s) {
    auto& node = tree.nodes[s];
    node.first = place[at(found.first[s])];
    node.width = place[at(found.first[s + 1])] - node.first;
    const auto each_row = [&](auto&& visit) {
      for (auto k = found.start[s]; k < found.start[s + 1]; ++k) {
        const Index group = found.rows[at(k)];
        if (group < found.first[s + 1]) continue;
        for (Index dof = place[at(group)]; dof < place[at(group) + 1]; ++dof) visit(dof);
      }
    };
    std::size_t rows = 0;
    each_row([&](Index) { ++rows; });
    node.rows.reserve(rows);
    each_row([&](Index dof) { node.rows.push_back(dof); });
  }
}

// The parent of a supernode is the one that holds its first row below.
void link(Symbolic::Tree& tree) {
  std::vector<Index> node_of(tree.order.size());
  for (std::size_t s = 0; s < tree.nodes.size(); ++s) {
    const auto first = node_of.begin() + tree.nodes[s].first;
    std::fill(first, first + tree.nodes[s].width, static_cast<Index>(s));
  }
  for (std::size_t s = 0; s < tree.nodes.size(); ++s) {
    auto& node = tree.nodes[s];
    if (node.rows.empty()) continue;
    node.parent = node_of[at(node.rows.front())];
    tree.nodes[at(node.parent)].children.push_back(static_cast<Index>(s));
  }
}

Symbolic::Tree build(const SparseMatrix& pattern) {
  const auto graph = quotient_graph(pattern);
  Symbolic::Tree tree;
  expand(supernodes(graph, nested_dissection(graph)), graph, tree);
  link(tree);
  sum_up(tree);
  tree.entries = static_cast<double>(pattern.nonZeros());
  tree.threads = thread_count();
  choose_subtrees(tree, tree.threads);
  size_stacks(tree);
  choose_parts(tree);
  return tree;
}

// Whether the pattern of a contains the pattern of b. This is true unless a mass is spread over
// several elements.
bool holds(const SparseMatrix& a, const SparseMatrix& b) {
  for (Eigen::Index c = 0; c < b.cols(); ++c) {
    SparseMatrix::InnerIterator x(a, c);
    for (SparseMatrix::InnerIterator y(b, c); y; ++y) {
      while (x && x.row() < y.row()) ++x;
      if (!x || x.row() != y.row()) return false;
    }
  }
  return true;
}

}  // namespace

std::int64_t panel_size(const Supernode& node) {
  const auto rows = node.width + static_cast<std::int64_t>(node.rows.size());
  std::int64_t size = 0;
  for (std::int64_t before = 0; before < node.width; before += kStripWidth) {
    size += (rows - before) * std::min<std::int64_t>(kStripWidth, node.width - before);
  }
  return size;
}

std::int32_t first_descendant(const Symbolic::Tree& tree, std::int32_t root) {
  while (!tree.nodes[at(root)].children.empty()) root = tree.nodes[at(root)].children.front();
  return root;
}

Symbolic::Symbolic(const SparseMatrix& pattern) : tree_(std::make_unique<Tree>(build(pattern))) {}

Symbolic::Symbolic(const SparseMatrix& a, const SparseMatrix& b)
    : tree_(std::make_unique<Tree>(build(holds(a, b) ? a : SparseMatrix(a + b)))) {}
Symbolic::~Symbolic() = default;
Symbolic::Symbolic(Symbolic&&) noexcept = default;
Symbolic& Symbolic::operator=(Symbolic&&) noexcept = default;

int Symbolic::threads() const { return tree_->threads; }

namespace {

double analysis_bytes(const Symbolic::Tree& tree) {
  double numbers = static_cast<double>(tree.order.size() + tree.position.size());
  for (const auto& node : tree.nodes) {
    numbers += static_cast<double>(node.rows.capacity() + node.children.capacity());
  }
  for (const auto& part : tree.parts) {
    numbers += static_cast<double>(part.nodes.capacity() + part.border.capacity());
  }
  return 4.0 * numbers + static_cast<double>(sizeof(Supernode) * tree.nodes.size());
}

// Doubles of a count: the waiting update blocks, and for each thread one front's panel, a strip of
// it and the rows' places; pivots with what they are judged by.
double size_of_count(const Symbolic::Tree& tree) {
  const auto n = static_cast<double>(tree.order.size());
  const auto each_thread =
      static_cast<double>(tree.stack_size[0] + tree.stack_size[1] + tree.largest_panel +
                          tree.tallest_front * kStripWidth) +
      1.5 * n;
  return tree.threads * each_thread + static_cast<double>(tree.detached_size) + 3.0 * n;
}

}  // namespace

FactorForecast Symbolic::forecast() const {
  const auto& tree = *tree_;
  const auto n = static_cast<double>(tree.order.size());
  const double matrix = 1.5 * tree.entries + n;
  return {.entries = tree.entries_of_factor,
          .flops = tree.flops,
          .factor_bytes = 8.0 * static_cast<double>(tree.factor_size),
          .work_bytes = 8.0 * (matrix + static_cast<double>(work_of_parts(tree))),
          .count_bytes = 8.0 * (matrix + size_of_count(tree)),
          .analysis_bytes = analysis_bytes(tree)};
}

}  // namespace chladni::fem
