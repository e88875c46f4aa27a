// How well a block model fits the data, and the step that would fit it better.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "identification/fit_data.h"
#include "identification/likelihood/block_model.h"

namespace chladni::identification {

/// The data as the sums want them: a column per response, real parts of all lines, then imaginary.
struct Target {
  Eigen::Index outputs = 0, inputs = 0;
  Eigen::VectorXd x;           ///< K: ω / scale
  Eigen::MatrixXd value;       ///< pq×2K
  Eigen::MatrixXd squared;     ///< pq×K: w²
  double total = 0.0;          ///< Σ |w G|²
  double expected_cost = 0.5;  ///< of noise alone

  /// noise_level of the data, no parameters taken off, but without its floor: a descent on data
  /// that are better than they say goes on to where their own errors end it.
  [[nodiscard]] double noise_level(double cost) const;
  [[nodiscard]] Eigen::Index line_count() const { return x.size(); }
  [[nodiscard]] Eigen::Index response_count() const { return value.cols(); }
};

[[nodiscard]] Target target(const FitData& data, double scale);

/// What is fitted beside the blocks.
struct Fitted {
  bool residual = true, delay = false;
  DelayOf delay_of = DelayOf::all;

  /// How many delays there are, and which of them is that of response e = i + p j.
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

/// The model's residual is the best for its blocks; what is left of the data then.
struct Misfit {
  Eigen::MatrixXd error;     ///< 2K×pq: data turned back by the delay, less the model
  Eigen::MatrixXd response;  ///< 2K×pq: the model without its delay; empty where none is fitted
  double cost = 0.0;         ///< Σ |w error|²
};

/// Sets model.residual to the best where it is fitted. Cost: 2K·pq per entry of the blocks' H.
[[nodiscard]] Misfit misfit(BlockModel& model, const Target& target, const Fitted& fitted);

/// JᵀJ and Jᵀr of the weighted errors, residual eliminated. Parameters: of each block left (column
/// by column), right, stiffness, damping (of a general block σ, ω instead); the delays last.
struct NormalEquations {
  Eigen::MatrixXd matrix;    ///< lower triangle
  Eigen::VectorXd gradient;  ///< the step that lowers the cost is along it
};

/// The gradient is exact. Where all responses have the same weights the sums of one are those of
/// all (equal_weights.h), if that costs less; else response by response.
[[nodiscard]] NormalEquations normal_equations(const BlockModel& model, const Misfit& misfit,
                                               const Target& target, const Fitted& fitted);

/// From one sum per pole and response (as PoleProducts, with the squares of the fractions too):
/// the matrix to 1e-7 of its diagonal where poles are very near.
/// Cost: some 10 n·K·pq and 100 n²·pq operations, shared between the threads.
[[nodiscard]] NormalEquations normal_equations_by_response(const BlockModel& model,
                                                           const Misfit& misfit,
                                                           const Target& target,
                                                           const Fitted& fitted);

[[nodiscard]] Eigen::Index parameter_count(const Block& block);
[[nodiscard]] Eigen::Index parameter_count(const BlockModel& model, const Fitted& fitted);

/// The model moved by a step in its parameters, balanced.
[[nodiscard]] BlockModel moved(const BlockModel& model, const Eigen::VectorXd& step,
                               const Fitted& fitted);

}  // namespace chladni::identification
