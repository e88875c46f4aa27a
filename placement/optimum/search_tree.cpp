#include "placement/optimum/search_tree.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <queue>

#include "placement/constants.h"
#include "placement/optimum/relaxation.h"
#include "placement/optimum/spacing.h"

namespace chladni::placement {
namespace {

using Indices = std::vector<Eigen::Index>;

struct Node {
  Indices in, free;  // `in`: chosen finally; `free`: not yet decided. All others are out.
  double bound = 0.0;
};

struct ByBound {
  bool operator()(const Node& a, const Node& b) const { return a.bound < b.bound; }
};

class BranchAndBound {
 public:
  BranchAndBound(const DeterminantProblem& problem, const DeterminantOptions& options, Choice& best)
      : problem_(problem), options_(options), best_(best) {}

  void run() {
    Node root;
    root.free.resize(static_cast<std::size_t>(problem_.rows.rows()));
    std::iota(root.free.begin(), root.free.end(), 0);
    root.bound = HUGE_VAL;
    expand(root);
    best_.bound = root_bound_;
    while (!open_.empty() && best_.nodes < options_.node_limit) {
      if (open_.top().bound <= best_.score + options_.enough) break;
      const Node node = open_.top();
      open_.pop();
      expand(node);
    }
    const double left = open_.empty() ? best_.score : std::max(best_.score, open_.top().bound);
    if (options_.node_limit > 0) best_.bound = std::min(best_.bound, left);
    best_.bound = std::max(best_.bound, best_.score);
    best_.proven = best_.bound <= best_.score + options_.enough;
  }

 private:
  void expand(const Node& node) {
    ++best_.nodes;
    const Eigen::Index wanted = problem_.count - static_cast<Eigen::Index>(node.in.size());
    const Eigen::MatrixXd rows = problem_.rows(node.free, Eigen::all);
    const double target = best_.score + options_.enough;
    // A node that will be split needs a looser tolerance only.
    const double tolerance =
        node.in.empty() ? Constants::root_tolerance : Constants::node_tolerance;
    const auto relaxation =
        relaxed(rows, information(problem_, node.in), wanted, target, tolerance);
    if (node.in.empty() && root_bound_ == HUGE_VAL) root_bound_ = relaxation.bound;
    offer(node, relaxation, wanted);
    if (relaxation.bound <= best_.score + options_.enough || options_.node_limit == 0) return;
    branch(node, relaxation, wanted);
  }

  // Tries the candidates of largest weight as a choice.
  void offer(const Node& node, const Relaxation& relaxation, Eigen::Index wanted) {
    if (problem_.spacing > 0.0) return;
    Indices order(node.free.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](Eigen::Index a, Eigen::Index b) {
      return relaxation.z(a) > relaxation.z(b);
    });
    Indices sites = node.in;
    for (Eigen::Index k = 0; k < wanted; ++k) {
      sites.push_back(node.free[static_cast<std::size_t>(order[static_cast<std::size_t>(k)])]);
    }
    const double score = log_determinant(problem_, sites);
    if (score <= best_.score + 1e-12) return;
    best_.sites = exchanged(problem_, sites);
    best_.score = log_determinant(problem_, best_.sites);
  }

  // Fixes candidates by reduced cost and by the spacing, then splits at the weight nearest to one
  // half.
  void branch(const Node& node, const Relaxation& relaxation, Eigen::Index wanted) {
    Eigen::VectorXd sorted = relaxation.gain;
    std::sort(sorted.data(), sorted.data() + sorted.size(), std::greater<>());
    const double last_in = sorted(wanted - 1);
    const double first_out = wanted < sorted.size() ? sorted(wanted) : 0.0;
    const double slack = relaxation.bound - (best_.score + options_.enough);
    Node rest;
    rest.in = node.in;
    rest.bound = std::min(node.bound, relaxation.bound);
    Eigen::VectorXd weight = Eigen::VectorXd::Zero(problem_.rows.rows());
    for (Eigen::Index c = 0; c < relaxation.z.size(); ++c) {
      const Eigen::Index candidate = node.free[static_cast<std::size_t>(c)];
      weight(candidate) = relaxation.z(c);
      if (last_in - relaxation.gain(c) > slack) continue;
      (relaxation.gain(c) - first_out > slack ? rest.in : rest.free).push_back(candidate);
    }
    if (keeps_spacing(rest)) push(rest, weight);
  }

  // Leaves out what is too near to a chosen one. @return  false: two chosen ones are too near
  [[nodiscard]] bool keeps_spacing(Node& node) const {
    if (problem_.spacing <= 0.0) return true;
    if (!spaced(node.in)) return false;
    std::erase_if(node.free, [&](Eigen::Index candidate) {
      return !fits(problem_.position, problem_.spacing, node.in, candidate);
    });
    return true;
  }

  void push(Node& rest, const Eigen::VectorXd& weight) {
    const auto wanted = [&](const Node& node) {
      return problem_.count - static_cast<Eigen::Index>(node.in.size());
    };
    if (rest.free.empty() || wanted(rest) <= 0) {
      settle(rest, wanted(rest));
      return;
    }
    const auto off = [&](Eigen::Index candidate) { return std::abs(weight(candidate) - 0.5); };
    const Eigen::Index split = *std::ranges::min_element(rest.free, {}, off);
    std::erase(rest.free, split);
    Node with = rest;
    with.in.push_back(split);
    for (Node* child : {&with, &rest}) {
      if (!keeps_spacing(*child)) continue;
      const auto left = static_cast<Eigen::Index>(child->free.size());
      if (wanted(*child) <= 0 || wanted(*child) >= left) {
        settle(*child, wanted(*child));
      } else {
        open_.push(std::move(*child));
      }
    }
  }

  // All is decided: either all free candidates are needed, or none.
  void settle(const Node& node, Eigen::Index wanted) {
    Indices sites = node.in;
    if (wanted > static_cast<Eigen::Index>(node.free.size()) || wanted < 0) return;
    if (wanted > 0) sites.insert(sites.end(), node.free.begin(), node.free.end());
    if (!spaced(sites)) return;
    const double score = log_determinant(problem_, sites);
    if (score <= best_.score + 1e-12) return;
    std::sort(sites.begin(), sites.end());
    best_.sites = sites;
    best_.score = score;
  }

  [[nodiscard]] bool spaced(const Indices& sites) const {
    for (std::size_t a = 0; a < sites.size(); ++a) {
      for (std::size_t b = 0; b < a; ++b) {
        if (too_near(problem_.position, problem_.spacing, sites[a], sites[b])) return false;
      }
    }
    return true;
  }

  const DeterminantProblem& problem_;
  const DeterminantOptions& options_;
  Choice& best_;
  std::priority_queue<Node, std::vector<Node>, ByBound> open_;
  double root_bound_ = HUGE_VAL;
};

}  // namespace

void search(const DeterminantProblem& problem, const DeterminantOptions& options, Choice& best) {
  BranchAndBound(problem, options, best).run();
}

}  // namespace chladni::placement
