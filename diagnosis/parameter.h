// A number of an effect: its meaning, its unit and its prior.
#pragma once

#include <limits>
#include <string_view>

namespace chladni::diagnosis {

/// A size further from the centre of its prior than this many widths is not considered.
inline constexpr double kPlausible = 6.0;

/// A parameter of an effect. The search moves its coordinate x, whose prior is normal; that of a
/// place is uniform over the surface.
struct Parameter {
  enum class Scale {
    linear,       ///< value = x
    logarithmic,  ///< value = exp(x): positive
    relative,     ///< value = exp(x) − 1: above −1
    factor,       ///< value = exp(x): positive, and 1 where nothing changes
  };
  enum class Role {
    strength,   ///< a mass, a stiffness, a gain, a relative change
    offset,     ///< distance along the surface from a stated place
    frequency,  ///< of a pole or a corner
    place_u,    ///< with place_v a place on the surface
    place_v,
    extent,  ///< [m]: the effect acts within this distance of its place
    shape,   ///< any other number: a damping ratio, a radius of gyration
  };
  std::string_view name, unit;
  Scale scale = Scale::linear;
  Role role = Role::strength;
  /// The effect vanishes at one end of this coordinate, or where it is 0.
  bool is_size = false;
  double centre = 0.0, width = 1.0;                       ///< of the prior of x
  double step = 1e-4;                                     ///< of x, for finite differences
  double most = std::numeric_limits<double>::infinity();  ///< a larger x is impossible

  [[nodiscard]] double value(double x) const;
  [[nodiscard]] double coordinate(double value) const;
  [[nodiscard]] double value_per_coordinate(double x) const;
  /// The values of x that are considered; all of a place, which the surface bounds.
  struct Ends {
    double low = 0.0, high = 0.0;
  };
  [[nodiscard]] Ends ends() const;
  [[nodiscard]] bool is_place() const { return role == Role::place_u || role == Role::place_v; }
  /// True for a difference, or a factor that is usually 1: no change at x = 0.
  [[nodiscard]] bool is_about_zero() const { return !is_place() && scale != Scale::logarithmic; }
};

}  // namespace chladni::diagnosis
