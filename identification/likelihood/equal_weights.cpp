#include "identification/likelihood/equal_weights.h"

#include <algorithm>
#include <vector>

#include "base/draw.h"
#include "dense/algebra.h"
#include "dense/blas.h"
#include "host/parallel.h"
#include "identification/likelihood/block_functions.h"

namespace chladni::identification {
namespace {

using Eigen::Index;
constexpr std::size_t kShares = 8;  // parts of the responses for the threads
constexpr Index kSpare = 4;         // combinations of functions beyond the dimension of their span

// Removes from the real parts of each column their mean with these weights (the best constant).
void take_constant(const Eigen::VectorXd& weight, Eigen::MatrixXd& columns) {
  const auto lines = weight.size();
  const double sum = std::max(weight.sum(), 1e-300);
  for (Index c = 0; c < columns.cols(); ++c) {
    auto real = columns.col(c).head(lines);
    real.array() -= weight.dot(real) / sum;
  }
}

// Products of the functions (rows) with the columns of all responses: pq×rows.
Eigen::MatrixXd products_with(const Eigen::MatrixXd& functions, const Eigen::MatrixXd& columns) {
  const auto count = static_cast<std::size_t>(columns.cols());
  const auto shares = std::min(count, kShares);
  Eigen::MatrixXd result(columns.cols(), functions.rows());
  parallel_ranges(shares, [&](std::size_t begin, std::size_t end) {
    for (auto share = begin; share < end; ++share) {
      const auto first = static_cast<Index>(share * count / shares);
      const auto some = static_cast<Index>((share + 1) * count / shares) - first;
      Eigen::MatrixXd part = Eigen::MatrixXd::Zero(functions.rows(), some);
      dense::add_product(functions, columns.middleCols(first, some), 1.0, part);
      result.middleRows(first, some) = part.transpose();
    }
  });
  return result;
}

// Functions as combinations of fewer orthonormal ones: basis·coefficient.
struct Spanned {
  Eigen::MatrixXd basis, coefficient;  // 2K×M, M×U
};

// Finds a basis for a block's functions. The dimension of their span is known. A few more random
// combinations of all functions (in units of their size) have the same span.
Spanned spanned(Eigen::MatrixXd functions, Index size) {
  const auto columns = 4 * size + kSpare;
  const auto count = functions.cols();
  if (count <= columns) return {std::move(functions), Eigen::MatrixXd::Identity(count, count)};
  const Eigen::VectorXd norm = functions.colwise().norm().cwiseMax(1e-300);
  Draw draw(1);
  Eigen::MatrixXd mix(count, columns);
  for (double& value : mix.reshaped()) value = draw.normal();
  mix = norm.cwiseInverse().asDiagonal() * mix;
  Eigen::MatrixXd drawn = Eigen::MatrixXd::Zero(functions.rows(), columns);
  dense::add_product(functions, mix, 1.0, drawn);
  const Eigen::MatrixXd basis = dense::orthonormal_basis(drawn);
  Eigen::MatrixXd coefficient = Eigen::MatrixXd::Zero(columns, count);
  dense::add_product(basis.transpose(), functions, 1.0, coefficient);
  return {basis, std::move(coefficient)};
}

class CommonProducts {
 public:
  CommonProducts(const BlockModel& model, const Misfit& misfit, const Target& target,
                 const Fitted& fitted);
  [[nodiscard]] NormalEquations equations() const;

 private:
  [[nodiscard]] Eigen::MatrixXd over_inputs(Index c, Index kind, Index d, Index other) const;
  [[nodiscard]] Eigen::MatrixXd over_outputs(Index c, Index kind, Index d, Index other) const;
  void fill_functions(const BlockModel& model);
  void add_like_sides(Index c, Index d, Eigen::MatrixXd& matrix) const;
  void add_left_right(Index c, Index d, Eigen::MatrixXd& matrix) const;
  void add_sides_own(Index c, Index d, Eigen::MatrixXd& matrix) const;
  void add_own(Index c, Index d, Eigen::MatrixXd& matrix) const;
  [[nodiscard]] Eigen::MatrixXd sums_with(const Eigen::MatrixXd& columns) const;
  [[nodiscard]] Eigen::VectorXd along_parameters(const Eigen::MatrixXd& sums) const;
  void add_delay(NormalEquations& result) const;

  [[nodiscard]] auto left(Index c) const { return left_.middleCols(place(c).mode, place(c).size); }
  [[nodiscard]] auto right(Index c) const {
    return right_.middleRows(place(c).mode, place(c).size);
  }
  [[nodiscard]] const BlockFunctions& place(Index c) const {
    return places_[static_cast<std::size_t>(c)];
  }

  const Misfit& misfit_;
  const Target& target_;
  const Fitted& fitted_;
  std::vector<BlockFunctions> places_;
  Index parameters_;
  Eigen::MatrixXd left_, right_;      // p×modes, modes×q: of all blocks
  Eigen::MatrixXd outputs_, inputs_;  // modes²: LᵀL, RRᵀ
  Eigen::VectorXd weight_;            // K: w²
  Eigen::MatrixXd basis_;             // M×2K, weighted: basis of the functions
  Eigen::MatrixXd coefficient_;       // M×U
  Eigen::MatrixXd gram_;              // U×U
};

CommonProducts::CommonProducts(const BlockModel& model, const Misfit& misfit, const Target& target,
                               const Fitted& fitted)
    : misfit_(misfit),
      target_(target),
      fitted_(fitted),
      places_(functions_of(model, target.outputs, target.inputs)),
      parameters_(parameter_count(model, fitted)),
      weight_(target.squared.col(0)) {
  const auto modes = places_.back().mode + places_.back().size;
  left_.resize(target.outputs, modes);
  right_.resize(modes, target.inputs);
  for (std::size_t c = 0; c < places_.size(); ++c) {
    left_.middleCols(places_[c].mode, places_[c].size) = model.blocks[c].left;
    right_.middleRows(places_[c].mode, places_[c].size) = model.blocks[c].right;
  }
  outputs_ = left_.transpose() * left_;
  inputs_ = right_ * right_.transpose();
  fill_functions(model);
}

// Computes the functions, weighted and without the constant, and all their products.
void CommonProducts::fill_functions(const BlockModel& model) {
  const Eigen::VectorXd root = weight_.cwiseSqrt().replicate(2, 1);
  std::vector<Spanned> blocks(places_.size());
  parallel_ranges(places_.size(), [&](std::size_t begin, std::size_t end) {
    for (auto c = begin; c < end; ++c) {
      Eigen::MatrixXd values = function_values(model.blocks[c], target_.x);
      if (fitted_.residual) take_constant(weight_, values);
      values = root.asDiagonal() * values;
      blocks[c] = spanned(std::move(values), places_[c].size);
    }
  });
  Index count = 0;
  for (const auto& block : blocks) count += block.basis.cols();
  Eigen::MatrixXd basis(root.size(), count);
  coefficient_.setZero(count, function_count(places_));
  Index row = 0;
  for (std::size_t c = 0; c < blocks.size(); ++c) {
    const auto& [own, by] = blocks[c];
    basis.middleCols(row, own.cols()) = own;
    coefficient_.block(row, places_[c].first, by.rows(), by.cols()) = by;
    row += own.cols();
  }
  Eigen::MatrixXd square = Eigen::MatrixXd::Zero(count, count);
  dense::add_gram(basis, square);
  square.triangularView<Eigen::StrictlyUpper>() = square.transpose();
  Eigen::MatrixXd half = Eigen::MatrixXd::Zero(count, coefficient_.cols());
  dense::add_product(square, coefficient_, 1.0, half);
  gram_.setZero(coefficient_.cols(), coefficient_.cols());
  dense::add_product(coefficient_.transpose(), half, 1.0, gram_);
  basis_ = basis.transpose() * root.asDiagonal();
}

// Sums over the lines of each function with each column: pq×U.
Eigen::MatrixXd CommonProducts::sums_with(const Eigen::MatrixXd& columns) const {
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(columns.cols(), coefficient_.cols());
  dense::add_product(products_with(basis_, columns), coefficient_, 1.0, result);
  return result;
}

// Σ_bb' ⟨F_ab, F'_a'b'⟩ (R R'ᵀ)_bb': g×g', in a and a'.
Eigen::MatrixXd CommonProducts::over_inputs(Index c, Index kind, Index d, Index other) const {
  const auto& one = place(c);
  const auto& two = place(d);
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(one.size, two.size);
  for (Index b = 0; b < one.size; ++b) {
    for (Index e = 0; e < two.size; ++e) {
      sum += inputs_(one.mode + b, two.mode + e) *
             gram_.block(one.column(kind, 0, b), two.column(other, 0, e), one.size, two.size);
    }
  }
  return sum;
}

// Σ_aa' ⟨F_ab, F'_a'b'⟩ (LᵀL')_aa': g×g', in b and b'.
Eigen::MatrixXd CommonProducts::over_outputs(Index c, Index kind, Index d, Index other) const {
  const auto& one = place(c);
  const auto& two = place(d);
  Eigen::MatrixXd sum(one.size, two.size);
  const auto shapes = outputs_.block(one.mode, two.mode, one.size, two.size);
  for (Index b = 0; b < one.size; ++b) {
    for (Index e = 0; e < two.size; ++e) {
      sum(b, e) = gram_.block(one.column(kind, 0, b), two.column(other, 0, e), one.size, two.size)
                      .cwiseProduct(shapes)
                      .sum();
    }
  }
  return sum;
}

// Products of left shapes of one output, and of right shapes of one input.
void CommonProducts::add_like_sides(Index c, Index d, Eigen::MatrixXd& matrix) const {
  const auto& one = place(c);
  const auto& two = place(d);
  const auto p = target_.outputs;
  const auto outer = over_inputs(c, 0, d, 0);
  const auto inner = over_outputs(c, 0, d, 0);
  for (Index b = 0; b < two.size; ++b) {
    for (Index a = 0; a < one.size; ++a) {
      for (Index i = 0; i < p; ++i) {
        matrix(one.left + i + p * a, two.left + i + p * b) = outer(a, b);
      }
      for (Index j = 0; j < target_.inputs; ++j) {
        matrix(one.right + a + one.size * j, two.right + b + two.size * j) = inner(a, b);
      }
    }
  }
}

// Products of left shapes of one block and right shapes of another: Σ l'_ia' ⟨H_ab, H'_a'b'⟩ r_bj.
void CommonProducts::add_left_right(Index c, Index d, Eigen::MatrixXd& matrix) const {
  const auto& one = place(c);
  const auto& two = place(d);
  const auto p = target_.outputs;
  Eigen::MatrixXd between(two.size, one.size);
  for (Index a = 0; a < one.size; ++a) {
    for (Index e = 0; e < two.size; ++e) {
      for (Index b = 0; b < one.size; ++b) {
        for (Index f = 0; f < two.size; ++f) {
          between(f, b) = gram_(one.column(0, a, b), two.column(0, f, e));
        }
      }
      const Eigen::MatrixXd all = left(d) * between * right(c);
      for (Index j = 0; j < all.cols(); ++j) {
        const auto of_right = two.right + e + two.size * j;
        const auto of_left = one.left + p * a;
        if (of_left > of_right) {
          matrix.col(of_right).segment(of_left, p) = all.col(j);
        } else {
          matrix.row(of_right).segment(of_left, p) = all.col(j).transpose();
        }
      }
    }
  }
}

// Products of the shapes of one block with the own parameters of another.
void CommonProducts::add_sides_own(Index c, Index d, Eigen::MatrixXd& matrix) const {
  const auto& one = place(c);
  const auto& two = place(d);
  const auto entry = [&](Index u, Index v) -> double& {
    return matrix(std::max(u, v), std::min(u, v));
  };
  for (Index t = 1; t < two.kinds; ++t) {
    const Eigen::MatrixXd lefts = left(d) * over_inputs(c, 0, d, t).transpose();  // p×g
    const Eigen::MatrixXd rights = over_outputs(c, 0, d, t) * right(d);           // g×q
    for (Index n = 0; n < lefts.size(); ++n) {
      entry(one.left + n, two.own + t - 1) = lefts.reshaped()(n);
    }
    for (Index n = 0; n < rights.size(); ++n) {
      entry(one.right + n, two.own + t - 1) = rights.reshaped()(n);
    }
  }
}

void CommonProducts::add_own(Index c, Index d, Eigen::MatrixXd& matrix) const {
  const auto& one = place(c);
  const auto& two = place(d);
  const auto shapes = outputs_.block(one.mode, two.mode, one.size, two.size);
  for (Index t = 1; t < one.kinds; ++t) {
    for (Index u = 1; u < two.kinds; ++u) {
      matrix(one.own + t - 1, two.own + u - 1) = over_inputs(c, t, d, u).cwiseProduct(shapes).sum();
    }
  }
}

// Gradient-like sum over all parameters: `sums` of each response with each function, times the
// function's factor in the derivative of the response.
Eigen::VectorXd CommonProducts::along_parameters(const Eigen::MatrixXd& sums) const {
  const auto p = target_.outputs;
  const auto q = target_.inputs;
  Eigen::VectorXd result = Eigen::VectorXd::Zero(parameters_);
  for (Index c = 0; c < static_cast<Index>(places_.size()); ++c) {
    const auto& one = place(c);
    for (Index b = 0; b < one.size; ++b) {
      for (Index a = 0; a < one.size; ++a) {
        const auto of = [&](Index kind) {
          return Eigen::Map<const Eigen::MatrixXd>(sums.col(one.column(kind, a, b)).data(), p, q);
        };
        const Eigen::VectorXd l = left(c).col(a);
        const Eigen::VectorXd r = right(c).row(b).transpose();
        result.segment(one.left + p * a, p) += of(0) * r;
        const Eigen::VectorXd inner = of(0).transpose() * l;
        for (Index j = 0; j < q; ++j) result(one.right + b + one.size * j) += inner(j);
        for (Index t = 1; t < one.kinds; ++t) result(one.own + t - 1) += l.dot(of(t) * r);
      }
    }
  }
  return result;
}

void CommonProducts::add_delay(NormalEquations& result) const {
  const auto lines = target_.line_count();
  Eigen::MatrixXd late(misfit_.response.rows(), misfit_.response.cols());  // −s Ĝ
  late.topRows(lines) = target_.x.asDiagonal() * misfit_.response.bottomRows(lines);
  late.bottomRows(lines) = (-target_.x).asDiagonal() * misfit_.response.topRows(lines);
  if (fitted_.residual) take_constant(weight_, late);
  const auto sums = sums_with(late);
  const auto count = fitted_.delay_count(target_.outputs, target_.inputs);
  const auto first = parameters_ - count;
  for (Index n = 0; n < count; ++n) {
    Eigen::MatrixXd own = sums;
    for (Index e = 0; e < own.rows(); ++e) {
      if (fitted_.delay_index(e, target_.outputs) != n) own.row(e).setZero();
    }
    result.matrix.row(first + n).head(first) = along_parameters(own).head(first).transpose();
  }
  const Eigen::VectorXd weight = weight_.replicate(2, 1);
  for (Index e = 0; e < late.cols(); ++e) {
    const auto at = first + fitted_.delay_index(e, target_.outputs);
    const Eigen::VectorXd weighted = weight.cwiseProduct(late.col(e));
    result.matrix(at, at) += weighted.dot(late.col(e));
    result.gradient(at) += weighted.dot(misfit_.error.col(e));
  }
}

NormalEquations CommonProducts::equations() const {
  NormalEquations result{Eigen::MatrixXd::Zero(parameters_, parameters_),
                         along_parameters(sums_with(misfit_.error))};
  const auto count = static_cast<Index>(places_.size());
  for (Index c = 0; c < count; ++c) {
    for (Index d = 0; d <= c; ++d) {
      add_like_sides(c, d, result.matrix);
      add_left_right(c, d, result.matrix);
      if (c != d) add_left_right(d, c, result.matrix);
      add_sides_own(c, d, result.matrix);
      if (c != d) add_sides_own(d, c, result.matrix);
      add_own(c, d, result.matrix);
    }
  }
  if (fitted_.delay) add_delay(result);
  return result;
}

}  // namespace

bool equal_weights_pay(const BlockModel& model, const Target& target) {
  if (model.blocks.empty()) return false;
  const auto places = functions_of(model, target.outputs, target.inputs);
  const auto functions = static_cast<double>(function_count(places));
  double spans = 0.0;
  for (const auto& one : places) {
    const auto own = one.kinds * one.size * one.size;
    spans += static_cast<double>(std::min(own, 4 * one.size + kSpare));
  }
  const auto modes = static_cast<double>(places.back().mode + places.back().size);
  const auto lines = static_cast<double>(target.line_count());
  const auto responses = static_cast<double>(target.response_count());
  const double here = lines * (spans * (4.0 * responses + 2.0 * spans) + 20.0 * functions) +
                      2.0 * spans * functions * (responses + functions);
  if (here > responses * modes * (48.0 * lines + 100.0 * modes)) return false;
  const auto first = target.squared.col(0);
  for (Index e = 1; e < target.response_count(); ++e) {
    if (target.squared.col(e) != first) return false;
  }
  return true;
}

NormalEquations normal_equations_of_equal_weights(const BlockModel& model, const Misfit& misfit,
                                                  const Target& target, const Fitted& fitted) {
  const dense::OneBlasThread one_thread;
  return CommonProducts(model, misfit, target, fitted).equations();
}

}  // namespace chladni::identification
