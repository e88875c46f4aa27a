// Catalogue of possible errors of a simulation: one record per cause.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "diagnosis/few.h"
#include "diagnosis/fit/state.h"
#include "diagnosis/in_study.h"
#include "diagnosis/parameter.h"
#include "diagnosis/tolerances.h"

namespace chladni::diagnosis {

/// A start of the search for an effect.
struct EffectStart {
  Eigen::Index option = 0;
  Eigen::VectorXd x;  ///< coordinates of the parameters
};

/// Additional data of a choice, beside its channels: a unit, a quantity. Choices with different
/// data have different names.
struct Choice {
  std::string text;         ///< "g taken for m/s^2"; or empty
  std::string_view number;  ///< the number that it fixes: "factor", "derivative"; or empty
  double value = 0.0;       ///< [1], value of that number
};

class Scene;  // diagnosis/search/scene.h
struct Effect;

/// A simpler special case of an effect. It is preferred where both explain the data about equally,
/// or where it leaves less than `share` of what the general effect explains.
struct Simpler {
  const Effect* effect = nullptr;
  double share = 0.0;
};

/// An effect: some parameters, and perhaps a discrete choice (which channel). With all sizes at 0
/// (or their logarithm at −∞) it changes nothing.
struct Effect {
  std::string_view name;        ///< "point_mass"
  std::string_view summary;     ///< one line
  std::string_view source;      ///< source of its mathematics
  std::string_view confusable;  ///< similar effects, and what separates them

  std::vector<Parameter> (*parameters)(const Structure& structure);
  Eigen::Index (*options)(const Structure& structure);  ///< number of choices; 0: not possible here
  std::vector<std::string> (*channels)(const Structure& structure, Eigen::Index option);
  /// @param x  coordinates, as many as parameters
  void (*apply)(State& state, const Structure& structure, Eigen::Index option,
                const Eigen::VectorXd& x);
  /// Promising starts, cheap to find; empty: no start in this scene.
  std::vector<EffectStart> (*starts)(const Scene& scene);
  /// `apply` in two steps, or none. The first step is the expensive one and needs no state.
  /// `at_once` makes `apply` from `change`.
  std::function<void(State&)> (*change)(const Structure& structure, Eigen::Index option,
                                        const Eigen::VectorXd& x) = nullptr;
  /// Relative model-form error of its effect on the responses. A further cause that only corrects
  /// an error of this size is not believed, and a residual of this size is no reason for one
  /// (error_of). 0: exact.
  double error = 0.0;
  /// The error is that of an effect whose size is 1; a smaller one has less in proportion.
  bool error_follows_size = false;
  /// Additional data of each choice, beside its channels; or none.
  Choice (*choice)(Eigen::Index option) = nullptr;
  /// The value of a parameter `name` of a simpler effect that follows from this one's x; or none.
  std::optional<double> (*implied)(std::string_view name, const Eigen::VectorXd& x) = nullptr;
  /// Its special cases. A parameter of the same name is the same number in both.
  Few<Simpler, 3> simpler = {};
  /// The deviation of a sound structure that acts as this effect does; or none.
  double Tolerances::*tolerance = nullptr;
  /// A constant factor on channels: left out where a search lets all gains free.
  bool is_gain = false;
  /// It scales the body or all responses: the weight of the body tells such effects apart.
  bool is_scale = false;
  /// Its sizes are the material's or the dimensions' of the whole body.
  bool is_of_body = false;
  InStudy in_study = {};
};

/// Empty for an effect whose choices are its channels, or that has no choices.
[[nodiscard]] Choice choice_of(const Effect& effect, Eigen::Index option);

/// All effects. Equally good ones are reported in this order.
[[nodiscard]] std::span<const Effect* const> effects();

/// @throws InvalidInput  no effect has this name; the message lists all names
[[nodiscard]] const Effect& effect(std::string_view name);

/// An effect with its parameter values.
struct Supposed {
  const Effect* effect = nullptr;
  Eigen::Index option = 0;
  Eigen::VectorXd x;
};

/// The error of its effect, times its |size| (at most 1) where it follows the size.
[[nodiscard]] double error_of(const Supposed& supposed, const Structure& structure);

/// The change that it makes to a state, for use on many states. Both arguments must outlive it.
[[nodiscard]] std::function<void(State&)> change_of(const Supposed& supposed,
                                                    const Structure& structure);

/// The effect that stands for a cause of another effect, with the same choice, the numbers that
/// both share or that the cause implies, and the others at the centres of their priors.
[[nodiscard]] Supposed counterpart(const Supposed& cause, const Effect& effect,
                                   const Structure& structure);
/// The counterparts of each simpler effect that has the choice.
[[nodiscard]] std::vector<Supposed> simplified(const Supposed& supposed,
                                               const Structure& structure);

/// The place on the surface; none for effects without a place.
[[nodiscard]] std::optional<Eigen::Vector2d> place_of(const Supposed& supposed,
                                                      const Structure& structure);
/// True if both have no place, or places within this part of the surface's size.
[[nodiscard]] bool near(const Structure& structure, const Supposed& a, const Supposed& b,
                        double part);
/// True for the same effect and choice, near each other.
[[nodiscard]] bool same_choice(const Structure& structure, const Supposed& a, const Supposed& b,
                               double part);
/// Radius [m] around its place in which it acts: its extent, or 0.
[[nodiscard]] double reach_of(const Supposed& supposed, const Structure& structure);

/// ln of the prior density of the coordinates and of the choice. −∞ for a place outside the surface
/// and for implausible sizes.
[[nodiscard]] double log_prior(const Supposed& supposed, const Structure& structure);

/// Moves a place outside the surface back toward `from`, by halves, until it is on the surface. If
/// that fails, it takes the place of `from`.
void keep_on_surface(const Structure& structure, const Supposed& from, Supposed& to);

/// For entries of the table: the `apply` of an effect that has a `change`.
template <auto change>
void at_once(State& state, const Structure& structure, Eigen::Index option,
             const Eigen::VectorXd& x) {
  change(structure, option, x)(state);
}
/// For effects without a choice.
[[nodiscard]] Eigen::Index one_option(const Structure& structure);
[[nodiscard]] std::vector<std::string> no_channels(const Structure& structure, Eigen::Index option);

}  // namespace chladni::diagnosis
