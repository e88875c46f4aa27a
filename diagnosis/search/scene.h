// The data for the search of a further cause: the responses of the best explanation so far, and
// their residual.
#pragma once

#include <vector>

#include "diagnosis/effect.h"
#include "diagnosis/fit/responses.h"
#include "diagnosis/observed.h"

namespace chladni::diagnosis {

/// The misfit that an attachment at each place of the surface could remove.
struct PlaceScan {
  Eigen::VectorXd explained;        ///< n: fall of χ² with one free complex number per line
  std::vector<Eigen::Index> peaks;  ///< largest local maxima, descending
};

/// Responses with variances that the tolerances widen, line by line. It is coarse and cheap, and it
/// cannot see an effect that a tolerance can explain.
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

  /// χ² of the state with the effect added, for each start; infinite if that is impossible. It is
  /// cheap if only channels, paths or one more attachment or frame change. It is cheaper still if
  /// successive starts have the same place.
  [[nodiscard]] Eigen::VectorXd misfits(const Effect& effect,
                                        const std::vector<EffectStart>& starts) const;
  /// True if the misfit of this cause is cheap.
  [[nodiscard]] bool is_cheap(const Supposed& cause) const;
  /// Least-squares real factor between the model and recorded row (column) i.
  [[nodiscard]] double row_factor(Eigen::Index output) const;
  [[nodiscard]] double column_factor(Eigen::Index input) const;
  /// The solution of a state on the scene's lines; cheap if its body is that of the scene.
  [[nodiscard]] Solved solved_at(const State& state) const;
  /// First-order fall of χ² along d value / dx, and the step in x that brings it.
  struct Gain {
    double fall = 0.0, step = 0.0;
  };
  [[nodiscard]] Gain gain(const Eigen::MatrixXcd& change) const;

  /// Scan of a point attachment with one free complex number per line. Made by the constructor.
  [[nodiscard]] const PlaceScan& places() const { return places_; }
  /// Relative step of a frequency search: the mean damping ratio (half of a half-power bandwidth).
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
  /// Factor between the model and the observed columns first, first + stride, ...
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

/// The scan of Scene::places. At each place of the surface and each line it finds the complex τ
/// that fits G − τ g_s g_aᵀ best (methods of low-rank modification; Woodbury), and sums the falls
/// of χ².
/// Cost: places × lines × (r (p + q) + p q).
[[nodiscard]] PlaceScan place_scan(const Structure& structure, const Observed& observed,
                                   const Solved& now, const State& state);

}  // namespace chladni::diagnosis
