// The misfit between a block model and the data, and the step that lowers it.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "identification/fit_data.h"
#include "identification/likelihood/block_model.h"

namespace chladni::identification {

/// The data in the layout of the sums: a column per response, first the real parts of all lines,
/// then the imaginary parts.
struct Target {
  Eigen::Index outputs = 0, inputs = 0;
  Eigen::VectorXd x;           ///< K: ω / scale
  Eigen::MatrixXd value;       ///< 2K×pq
  Eigen::MatrixXd squared;     ///< K×pq: w²
  double total = 0.0;          ///< Σ |w G|²
  double expected_cost = 0.5;  ///< left by noise alone

  /// noise_level of the data without parameters and without its floor of 1. If the data are better
  /// than they state, the descent continues until their own errors stop it.
  [[nodiscard]] double noise_level(double cost) const;
  [[nodiscard]] Eigen::Index line_count() const { return x.size(); }
  [[nodiscard]] Eigen::Index response_count() const { return value.cols(); }
};

[[nodiscard]] Target target(const FitData& data, double scale);

/// The quantities that are fitted beside the blocks.
struct Fitted {
  bool residual = true, delay = false;
  DelayOf delay_of = DelayOf::all;

  /// Number of delays, and the index of the delay of response e = i + p j.
  [[nodiscard]] Eigen::Index delay_count(Eigen::Index outputs, Eigen::Index inputs) const {
    if (!delay) return 0;
    if (delay_of == DelayOf::all) return 1;
    return delay_of == DelayOf::outputs ? outputs : inputs;
  }
  [[nodiscard]] Eigen::Index delay_index(Eigen::Index e, Eigen::Index outputs) const {
    if (delay_of == DelayOf::all) return 0;
    return delay_of == DelayOf::outputs ? e % outputs : e / outputs;
  }
};

/// The remaining error of the data, with the best residual for the model's blocks.
struct Misfit {
  Eigen::MatrixXd error;     ///< 2K×pq: data without the delay, less the model
  Eigen::MatrixXd response;  ///< 2K×pq: the model without its delay; empty if no delay is fitted
  double cost = 0.0;         ///< Σ |w error|²
};

/// Sets model.residual to its best value if it is fitted. Cost: 2K·pq per entry of the blocks' H.
[[nodiscard]] Misfit misfit(BlockModel& model, const Target& target, const Fitted& fitted);

/// JᵀJ and Jᵀr of the weighted errors, with the residual eliminated. Parameters of each block: left
/// (column by column), right, stiffness, damping (σ, ω for a general block). The delays come last.
struct NormalEquations {
  Eigen::MatrixXd matrix;    ///< lower triangle
  Eigen::VectorXd gradient;  ///< points along the step that lowers the cost
};

/// The gradient is exact. If all responses have the same weights and it costs less, the sums of one
/// response serve for all (equal_weights.h); else it takes each response by itself.
[[nodiscard]] NormalEquations normal_equations(const BlockModel& model, const Misfit& misfit,
                                               const Target& target, const Fitted& fitted);

/// Uses one sum per pole and response (like PoleProducts, with the squares of the fractions as
/// well). Where poles are very near, the error of the matrix is 1e-7 of its diagonal.
/// Cost: some 10 n·K·pq and 100 n²·pq operations, shared between the threads.
[[nodiscard]] NormalEquations normal_equations_by_response(const BlockModel& model,
                                                           const Misfit& misfit,
                                                           const Target& target,
                                                           const Fitted& fitted);

[[nodiscard]] Eigen::Index parameter_count(const Block& block);
[[nodiscard]] Eigen::Index parameter_count(const BlockModel& model, const Fitted& fitted);

/// The model after a step in its parameters, balanced.
[[nodiscard]] BlockModel moved(const BlockModel& model, const Eigen::VectorXd& step,
                               const Fitted& fitted);

}  // namespace chladni::identification
