// What is seen when a further cause is looked for: the responses of the best explanation so far,
// and what they leave.
#pragma once

#include <vector>

#include "diagnosis/effect.h"
#include "diagnosis/fit/responses.h"
#include "diagnosis/observed.h"

namespace chladni::diagnosis {

/// How much of the misfit an attachment at a place of the surface could take, and what it would be.
struct PlaceScan {
  Eigen::VectorXd explained;        ///< n: fall of χ² with a free complex number per line
  std::vector<Eigen::Index> peaks;  ///< largest local maxima, descending
};

/// Misfits are taken with variances that the tolerances widen, line by line: coarse, cheap and
/// blind to what a tolerance may be.
class Scene {
 public:
  /// @param widening  K×pq: Σ |d value / d eta|² over the deviations [m²/N²]
  Scene(const Structure& structure, const Observed& observed, State state,
        const Eigen::MatrixXd& widening);

  [[nodiscard]] const Structure& structure() const { return structure_; }
  [[nodiscard]] const Observed& observed() const { return observed_; }  ///< weights widened
  [[nodiscard]] const State& state() const { return state_; }
  [[nodiscard]] const Solved& now() const { return now_; }
  [[nodiscard]] double misfit() const { return misfit_; }  ///< χ², widened

  /// χ² of the state with the effect on top, per start; infinite where that cannot be. Cheap where
  /// only channels, paths or one more attachment or frame change; the same place in succession is
  /// cheaper still.
  [[nodiscard]] Eigen::VectorXd misfits(const Effect& effect,
                                        const std::vector<EffectStart>& starts) const;
  /// Whether such a misfit is cheap.
  [[nodiscard]] bool is_cheap(const Supposed& cause) const;
  /// The least-squares real factor by which recorded row (column) i differs from the model.
  [[nodiscard]] double row_factor(Eigen::Index output) const;
  [[nodiscard]] double column_factor(Eigen::Index input) const;
  /// Of a state on the scene's lines; cheap where the body is the scene's own.
  [[nodiscard]] Solved solved_at(const State& state) const;
  /// First-order fall of χ² along d value / dx, and the step in x that brings it.
  struct Gain {
    double fall = 0.0, step = 0.0;
  };
  [[nodiscard]] Gain gain(const Eigen::MatrixXcd& change) const;

  /// Any point attachment: a free complex number per line. Made on first use.
  [[nodiscard]] const PlaceScan& places() const { return places_; }
  /// Steps of a half-power bandwidth or so: how finely a frequency must be searched.
  [[nodiscard]] double frequency_step() const { return frequency_step_; }
  [[nodiscard]] double low_hz() const;
  [[nodiscard]] double high_hz() const;

 private:
  /// Responses to and from one displacement of the body, per line.
  struct Touched {
    Eigen::VectorXd shape;      ///< r
    Eigen::MatrixXcd to, from;  ///< p×K, q×K
    Eigen::VectorXcd own;       ///< K
  };
  [[nodiscard]] Touched touched(const Attached& attached) const;
  /// By which the observed columns first, first + stride, ... differ from the model's.
  [[nodiscard]] double factor(Eigen::Index first, Eigen::Index stride, Eigen::Index count) const;
  [[nodiscard]] bool near(const State& changed) const;
  [[nodiscard]] double quick_misfit(const State& changed, Touched& touch) const;

  const Structure& structure_;
  Observed observed_;
  State state_;
  Body body_;
  Solved now_;
  double misfit_ = 0.0;
  double frequency_step_ = 0.0;
  PlaceScan places_;
};

/// The scan of Scene::places: at each place of the surface and each line the complex τ that fits
/// G − τ g_s g_aᵀ best (methods of low-rank modification; Woodbury), its fall of χ² summed.
/// Cost: places × lines × (r (p + q) + p q).
[[nodiscard]] PlaceScan place_scan(const Structure& structure, const Observed& observed,
                                   const Solved& now, const State& state);

}  // namespace chladni::diagnosis
