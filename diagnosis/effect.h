// What may be wrong with a simulation: the catalogue, one entry per cause.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "diagnosis/fit/state.h"

namespace chladni::diagnosis {

/// A number of an effect. The search moves its coordinate x, whose prior is normal.
struct Parameter {
  enum class Scale {
    linear,       ///< value = x
    logarithmic,  ///< value = exp(x): positive
    relative,     ///< value = exp(x) − 1: above −1
    place_u,      ///< value = x: with place_v uniform over the surface
    place_v,
  };
  std::string_view name, unit;
  Scale scale = Scale::linear;
  double centre = 0.0, width = 1.0;  ///< of the prior, of x
  double step = 1e-4;                ///< for differences, of x

  [[nodiscard]] double value(double x) const;
  [[nodiscard]] double coordinate(double value) const;
  [[nodiscard]] double value_per_coordinate(double x) const;
  [[nodiscard]] bool is_place() const { return scale == Scale::place_u || scale == Scale::place_v; }
};

/// Where a search of an effect begins.
struct EffectStart {
  Eigen::Index option = 0;
  Eigen::VectorXd x;  ///< coordinates of the parameters
};

/// What a choice says beside its channels: a unit, a quantity. Two that differ in it are not of one
/// name.
struct Choice {
  std::string text;         ///< "g taken for m/s^2"; or empty
  std::string_view number;  ///< the name of what it fixes: "factor", "derivative"; or empty
  double value = 0.0;       ///< [1], of that number
};

class Scene;  // diagnosis/search/scene.h

/// An effect: some numbers, and perhaps a choice (which channel). With all its sizes at 0 (or at
/// −∞ of their logarithm) it changes nothing.
struct Effect {
  std::string_view name;        ///< "point_mass"
  std::string_view summary;     ///< one line
  std::string_view source;      ///< where its mathematics comes from
  std::string_view confusable;  ///< with what, and what tells them apart

  std::vector<Parameter> (*parameters)(const Structure& structure);
  Eigen::Index (*options)(const Structure& structure);  ///< choices; 0: cannot be here
  std::vector<std::string> (*channels)(const Structure& structure, Eigen::Index option);
  /// @param x  coordinates, as many as parameters
  void (*apply)(State& state, const Structure& structure, Eigen::Index option,
                const Eigen::VectorXd& x);
  /// Coordinates worth a look, cheap to find; empty: what the scene offers by itself is enough.
  std::vector<EffectStart> (*starts)(const Scene& scene);
  /// `apply` in two steps, where its first, which needs no state, is the dear one (`at_once` then
  /// makes `apply` of it); or none.
  std::function<void(State&)> (*change)(const Structure& structure, Eigen::Index option,
                                        const Eigen::VectorXd& x) = nullptr;
  /// How far off, relative, what it does to the responses may be: what could mend as much beside it
  /// is not believed, and what it leaves is no reason for more (error_of). 0: it is exact.
  double error = 0.0;
  /// What its choices say beside the channels; or none.
  Choice (*choice)(Eigen::Index option) = nullptr;
  /// A number that follows from its own, of the name that a simpler effect has for it; or none.
  std::optional<double> (*implied)(std::string_view name, const Eigen::VectorXd& x) = nullptr;
};

/// Empty for an effect whose choices are its channels, or that has none.
[[nodiscard]] Choice choice_of(const Effect& effect, Eigen::Index option);

/// All effects, in the order in which equals are told.
[[nodiscard]] std::span<const Effect* const> effects();

/// @throws InvalidInput  there is none of that name; the message lists those there are
[[nodiscard]] const Effect& effect(std::string_view name);

/// An effect of which another is more general: where both explain the data about equally it is
/// meant, and where it leaves less than `share` of what the general one explains.
struct Simpler {
  const Effect* effect = nullptr;
  double share = 0.0;
};
[[nodiscard]] std::vector<Simpler> simpler_of(const Effect& effect);

/// An effect with its numbers.
struct Supposed {
  const Effect* effect = nullptr;
  Eigen::Index option = 0;
  Eigen::VectorXd x;
};

/// Its effect's error; of what has a "factor" in proportion to that, up to 1.
[[nodiscard]] double error_of(const Supposed& supposed, const Structure& structure);

/// What it does to any state, for many states; as long as both arguments live.
[[nodiscard]] std::function<void(State&)> change_of(const Supposed& supposed,
                                                    const Structure& structure);

/// Each simpler one with what numbers both share or the general one implies.
[[nodiscard]] std::vector<Supposed> simplified(const Supposed& supposed,
                                               const Structure& structure);

/// Where on the surface; none for effects that have no place.
[[nodiscard]] std::optional<Eigen::Vector2d> place_of(const Supposed& supposed,
                                                      const Structure& structure);
/// How far around its place it acts [m]: its "radius", or 0.
[[nodiscard]] double reach_of(const Supposed& supposed, const Structure& structure);

/// Widths of its prior within which a size is thought of at all.
inline constexpr double kPlausible = 6.0;

/// ln of the prior density of the coordinates and of the choice; −∞ beside the surface and for
/// sizes that are not plausible.
[[nodiscard]] double log_prior(const Supposed& supposed, const Structure& structure);

/// What lies beside the surface taken back toward where it came from, by halves, until it is on it;
/// or all the way.
void keep_on_surface(const Structure& structure, const Supposed& from, Supposed& to);

/// For entries of the table: `apply` of an effect that has a `change`.
template <auto change>
void at_once(State& state, const Structure& structure, Eigen::Index option,
             const Eigen::VectorXd& x) {
  change(structure, option, x)(state);
}
/// Effects without a choice.
[[nodiscard]] Eigen::Index one_option(const Structure& structure);
[[nodiscard]] std::vector<std::string> no_channels(const Structure& structure, Eigen::Index option);

}  // namespace chladni::diagnosis
