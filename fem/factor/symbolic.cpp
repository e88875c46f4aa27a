#include <algorithm>
#include <numeric>

#include "base/index.h"
#include "base/parallel.h"
#include "fem/factor/elimination_tree.h"

namespace chladni::fem {
namespace {

using Index = std::int32_t;

// An order of the quotient graph's groups, with the elimination tree of that order.
struct Ordered {
  std::vector<Index> order, position;  // new -> old group and back
  std::vector<Index> parent;
};

std::vector<Index> inverse(const std::vector<Index>& order) {
  std::vector<Index> position(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) position[at(order[i])] = static_cast<Index>(i);
  return position;
}

// The parent of each group, by Liu's algorithm with path compression (Liu 1990, SIAM J. Matrix
// Anal. 11, 134-172).
std::vector<Index> elimination_tree(const QuotientGraph& graph, const std::vector<Index>& order,
                                    const std::vector<Index>& position) {
  std::vector<Index> parent(order.size(), -1);
  std::vector<Index> ancestor(order.size(), -1);
  for (Index j = 0; j < static_cast<Index>(order.size()); ++j) {
    const auto old = at(order[at(j)]);
    for (auto k = graph.start[old]; k < graph.start[old + 1]; ++k) {
      Index i = position[at(graph.neighbour[at(k)])];
      while (i != -1 && i < j) {
        const Index next = ancestor[at(i)];
        ancestor[at(i)] = j;
        if (next == -1) parent[at(i)] = j;
        i = next;
      }
    }
  }
  return parent;
}

// An order in which children come right before their parents, so that each subtree is contiguous.
std::vector<Index> postorder(const std::vector<Index>& parent) {
  const auto n = static_cast<Index>(parent.size());
  std::vector<Index> first_child(parent.size(), -1);
  std::vector<Index> sibling(parent.size(), -1);
  std::vector<Index> roots;
  for (Index j = n - 1; j >= 0; --j) {
    const Index p = parent[at(j)];
    if (p == -1) {
      roots.push_back(j);
    } else {
      sibling[at(j)] = first_child[at(p)];
      first_child[at(p)] = j;
    }
  }
  std::vector<Index> result;
  result.reserve(parent.size());
  std::vector<Index> stack = roots;  // last in, first out: roots ascending
  while (!stack.empty()) {
    const Index j = stack.back();
    const Index child = first_child[at(j)];
    if (child == -1) {
      result.push_back(j);
      stack.pop_back();
    } else {
      first_child[at(j)] = sibling[at(child)];
      stack.push_back(child);
    }
  }
  return result;
}

Ordered ordered(const QuotientGraph& graph) {
  Ordered o;
  o.order = nested_dissection(graph);
  o.position = inverse(o.order);
  const auto post = postorder(elimination_tree(graph, o.order, o.position));
  std::vector<Index> order(post.size());
  for (std::size_t i = 0; i < post.size(); ++i) order[i] = o.order[at(post[i])];
  o.order = std::move(order);
  o.position = inverse(o.order);
  o.parent = elimination_tree(graph, o.order, o.position);
  return o;
}

// The number of entries in each column of L, diagonal included. Every row's subtree is walked once.
std::vector<Index> column_counts(const QuotientGraph& graph, const Ordered& o) {
  std::vector<Index> count(o.order.size(), 1);
  std::vector<Index> mark(o.order.size(), -1);
  for (Index row = 0; row < static_cast<Index>(o.order.size()); ++row) {
    mark[at(row)] = row;
    const auto old = at(o.order[at(row)]);
    for (auto k = graph.start[old]; k < graph.start[old + 1]; ++k) {
      Index j = o.position[at(graph.neighbour[at(k)])];
      while (j < row && mark[at(j)] != row) {
        ++count[at(j)];
        mark[at(j)] = row;
        j = o.parent[at(j)];
      }
    }
  }
  return count;
}

// A run of columns to be joined into one supernode. Sizes are in degrees of freedom.
struct Run {
  Index first = 0, last = 0;  // groups
  double width = 0.0, below = 0.0, zeros = 0.0;
};

// Whether joining is worth it: a few more zeros are cheaper than many small fronts. The thresholds
// are those of Chen et al. (2008, CHOLMOD), widened for three degrees of freedom per node.
bool worth_joining(const Run& child, const Run& parent, double& zeros) {
  const double width = child.width + parent.width;
  zeros = child.zeros + parent.zeros +
          child.width * std::max(0.0, parent.width + parent.below - child.below);
  const double entries = width * (width + 1.0) / 2.0 + width * parent.below;
  const double share = zeros / entries;
  return width <= 12.0 || (width <= 32.0 && share < 0.8) || (width <= 96.0 && share < 0.1) ||
         share < 0.03;
}

std::vector<Run> runs(const QuotientGraph& graph, const Ordered& o) {
  const auto count = column_counts(graph, o);
  const auto size = [&](Index j) {
    const auto old = at(o.order[at(j)]);
    return graph.first[old + 1] - graph.first[old];
  };
  std::vector<Run> all;
  for (Index j = 0; j < static_cast<Index>(o.order.size()); ++j) {
    const bool joins = j > 0 && o.parent[at(j - 1)] == j && count[at(j - 1)] == count[at(j)] + 1;
    if (!joins) all.push_back({.first = j, .last = j});
    all.back().last = j;
    all.back().width += size(j);
  }
  for (auto& run : all) run.below = 3.0 * (count[at(run.last)] - 1);
  std::vector<Run> joined;
  for (auto run : all) {
    // The previous run is a child of this one where its last column has its parent in this run.
    while (!joined.empty()) {
      const auto& child = joined.back();
      const Index p = o.parent[at(child.last)];
      double zeros = 0.0;
      if (p < run.first || p > run.last || !worth_joining(child, run, zeros)) break;
      run = {child.first, run.last, child.width + run.width, run.below, zeros};
      joined.pop_back();
    }
    joined.push_back(run);
  }
  return joined;
}

// The groups below each run, from its own columns and from its children's.
std::vector<std::vector<Index>> structures(const QuotientGraph& graph, const Ordered& o,
                                           const std::vector<Run>& all,
                                           std::vector<Index>& parent_run) {
  std::vector<Index> run_of(o.order.size());
  for (std::size_t s = 0; s < all.size(); ++s) {
    for (Index j = all[s].first; j <= all[s].last; ++j) run_of[at(j)] = static_cast<Index>(s);
  }
  std::vector<std::vector<Index>> below(all.size());
  std::vector<std::vector<Index>> children(all.size());
  std::vector<Index> mark(o.order.size(), -1);
  parent_run.assign(all.size(), -1);
  for (std::size_t s = 0; s < all.size(); ++s) {
    const auto own = static_cast<Index>(s);
    const auto note = [&](Index j) {
      if (j > all[s].last && mark[at(j)] != own) {
        mark[at(j)] = own;
        below[s].push_back(j);
      }
    };
    for (Index j = all[s].first; j <= all[s].last; ++j) {
      const auto old = at(o.order[at(j)]);
      for (auto k = graph.start[old]; k < graph.start[old + 1]; ++k) {
        note(o.position[at(graph.neighbour[at(k)])]);
      }
    }
    for (const Index child : children[s]) {
      for (const Index j : below[at(child)]) note(j);
    }
    std::sort(below[s].begin(), below[s].end());
    if (!below[s].empty()) {
      parent_run[s] = run_of[at(below[s].front())];
      children[at(parent_run[s])].push_back(own);
    }
  }
  return below;
}

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
    node.place = tree.factor_size;
    const auto size = panel_size(node);
    tree.factor_size += size;
    tree.largest_panel = std::max(tree.largest_panel, size);
    tree.tallest_front = std::max<std::int64_t>(
        tree.tallest_front, node.width + static_cast<std::int64_t>(node.rows.size()));
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

Symbolic::Tree build(const SparseMatrix& pattern) {
  const auto graph = quotient_graph(pattern);
  const auto o = ordered(graph);
  const auto all = runs(graph, o);
  std::vector<Index> parent_run;
  const auto below = structures(graph, o, all, parent_run);

  Symbolic::Tree tree;
  std::vector<Index> place(o.order.size() + 1, 0);  // new number of a group's first dof
  for (std::size_t j = 0; j < o.order.size(); ++j) {
    const auto old = at(o.order[j]);
    for (Index dof = graph.first[old]; dof < graph.first[old + 1]; ++dof) tree.order.push_back(dof);
    place[j + 1] = static_cast<Index>(tree.order.size());
  }
  tree.position = inverse(tree.order);
  tree.nodes.resize(all.size());
  for (std::size_t s = 0; s < all.size(); ++s) {
    auto& node = tree.nodes[s];
    node.first = place[at(all[s].first)];
    node.width = place[at(all[s].last) + 1] - node.first;
    node.parent = parent_run[s];
    for (const Index j : below[s]) {
      for (Index dof = place[at(j)]; dof < place[at(j) + 1]; ++dof) node.rows.push_back(dof);
    }
    if (node.parent != -1) {
      tree.nodes[at(node.parent)].children.push_back(static_cast<Index>(s));
    }
  }
  sum_up(tree);
  tree.entries = static_cast<double>(pattern.nonZeros());
  tree.threads = thread_count();
  choose_subtrees(tree, tree.threads);
  size_stacks(tree);
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

FactorForecast Symbolic::forecast() const {
  const auto size = static_cast<double>(tree_->factor_size);
  const auto stacks = static_cast<double>(tree_->stack_size[0] + tree_->stack_size[1]);
  const auto matrix = 1.5 * tree_->entries + static_cast<double>(tree_->order.size());
  return {.entries = size,
          .flops = tree_->flops,
          .factor_bytes = 8.0 * size,
          .work_bytes =
              8.0 * (tree_->threads * stacks + static_cast<double>(tree_->detached_size) + matrix)};
}

}  // namespace chladni::fem
