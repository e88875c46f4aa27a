// Normal equations response by response, from sums of partial fractions.
#pragma once

#include <utility>
#include <vector>

#include "identification/likelihood/block_fractions.h"
#include "identification/likelihood/normal_equations.h"

namespace chladni::identification {

/// The derivatives of a response by a block's parameters are sums of 1/(s − p) and 1/(s − p)² of
/// its poles. So all weighted products follow from m₁ = Σ w²/(s−p) and m₂ = Σ w²/(s−p)²:
/// S₁₁ = (m₁(a) − m₁(b))/(a−b) as in PoleProducts, S₂₁ = (m₂(a) − S₁₁)/(a−b) and
/// S₂₂ = (m₂(a) + m₂(b) − 2S₁₁)/(a−b)².
class ResponseProducts {
 public:
  /// The arguments must live longer than this object.
  ResponseProducts(const BlockModel& model, const Misfit& misfit, const Target& target,
                   const Fitted& fitted);

  /// Adds the contributions of the responses [begin, end) to the normal equations.
  void add(Eigen::Index begin, Eigen::Index end, NormalEquations& sum) const;

 private:
  // Weighted sums of the functions over the lines, for some responses.
  struct Sums {
    Eigen::Index begin = 0, count = 0;
    Eigen::MatrixXd of;  // 2·rows×(kinds·count)
    [[nodiscard]] Eigen::VectorXcd complex(Eigen::Index kind, Eigen::Index e) const;
    // Σ w² f̄ v for a complex v; the kinds `real` and `real` + 1 are its two parts.
    [[nodiscard]] Eigen::VectorXcd with(Eigen::Index real, Eigen::Index e) const;
  };
  // Products of all functions of one response; the data's error is one of the functions.
  struct Products {
    Eigen::MatrixXcd gram;   // functions of the poles, rigid, 1, delay
    Eigen::VectorXcd right;  // with the error
  };
  void list_fractions();
  void fill_lines();
  [[nodiscard]] Sums sums(Eigen::Index begin, Eigen::Index end) const;
  void fill_pole_pairs(const Eigen::VectorXcd& moment, Eigen::MatrixXcd& gram) const;
  void list_near_poles();
  void fill_near_poles(Eigen::Index e, Eigen::MatrixXcd& gram) const;
  void fill_single_functions(Eigen::Index e, Products& products) const;
  [[nodiscard]] Products products(Eigen::Index e, const Sums& sums) const;
  using SmallReal = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 24, 24>;
  using SmallColumn = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, 24, 1>;
  // Derivatives of a response by the parameters of one block.
  struct Part {
    Eigen::Index row;  // the block's first function
    SmallComplex by;
    std::vector<Eigen::Index> parameter;
    SmallColumn with_residual;
  };
  [[nodiscard]] std::vector<Part> parts_of(Eigen::Index e) const;
  // Re byᴴ gram by between two blocks.
  [[nodiscard]] static SmallReal between(const Eigen::MatrixXcd& gram, const Part& c,
                                         const Part& d);
  void add_gradient(const Products& products, double pivot, std::vector<Part>& parts,
                    NormalEquations& sum) const;
  void scatter(Eigen::Index e, const Products& products, NormalEquations& sum) const;

  [[nodiscard]] Eigen::Index rigid_row() const { return rows_; }
  [[nodiscard]] Eigen::Index residual_row() const { return rows_ + (rigid_ ? 1 : 0); }
  [[nodiscard]] Eigen::Index delay_row() const {
    return residual_row() + (fitted_.residual ? 1 : 0);
  }
  [[nodiscard]] Eigen::Index function_count() const {
    return delay_row() + (fitted_.delay ? 1 : 0);
  }

  const BlockModel& model_;
  const Misfit& misfit_;
  const Target& target_;
  const Fitted& fitted_;
  std::vector<BlockFractions> blocks_;
  Eigen::Index rows_ = 0, parameters_ = 0;  // functions of the poles, parameters of the blocks
  bool rigid_ = false;
  Eigen::VectorXcd pole_;                     // poles of all blocks
  std::vector<Eigen::Index> plain_, square_;  // rows of each pole's fraction and of its square
  /// Pairs of poles that are much nearer to each other than to any line. The formula loses its
  /// digits there, so their products are summed over the lines.
  std::vector<std::pair<std::size_t, std::size_t>> near_;
  Eigen::VectorXd slow_;   // K: 1/x²
  Eigen::MatrixXd lines_;  // 2·rows×K: real parts, then imaginary
};

}  // namespace chladni::identification
