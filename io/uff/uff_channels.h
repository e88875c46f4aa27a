// The channels of a universal file: degrees of freedom with names, units and places.
#pragma once

#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "io/uff/uff.h"
#include "modal/frf_set.h"

namespace chladni::io {

/// The channels of one side, in the order of their first use. Each degree of freedom is a channel.
class UffChannels {
 public:
  /// The number of the channel of `dof`. @param name  its name in the file; may be empty
  Eigen::Index number(const UffDof& dof, const std::string& name);
  [[nodiscard]] Eigen::Index size() const { return static_cast<Eigen::Index>(dofs_.size()); }
  /// The channels. Their names are those of the file if all differ, else node and direction
  /// ("101z").
  [[nodiscard]] std::vector<modal::MeasuredChannel> channels() const;

 private:
  using Key = std::tuple<std::string, long long, int>;
  std::map<Key, Eigen::Index> numbers_;
  std::vector<UffDof> dofs_;
  std::vector<std::string> names_;
};

/// The name of a degree of freedom: "101z", "-101z" against the axis, "101rz" for a rotation, "101"
/// for a scalar.
[[nodiscard]] std::string name_of(const UffDof& dof);
/// The unit vector along a direction; zero for scalars and rotations.
[[nodiscard]] Eigen::Vector3d vector_of(int direction);

/// The SI value of 1 on an ordinate, and the unit; an empty unit is not stated.
struct UffScale {
  double factor = 1.0;
  std::string unit;
  std::optional<modal::FrfKind> kind;  ///< for a motion
  std::string note;  ///< set where units contradict each other, or one is not known
};
/// The scale of a displacement, velocity or acceleration, from its label, else from dataset 164. A
/// rotation is in rad, rad/s or rad/s^2: no unit of length scales it, and a study has no such
/// channels.
[[nodiscard]] UffScale motion_scale(const UffFunction& function);
/// The scale of a force at a degree of freedom, from its label, else from dataset 164. At a
/// rotation it is a moment, in N m.
[[nodiscard]] UffScale force_scale(const UffDof& dof, const UffAxis& axis,
                                   const std::optional<UffUnits>& units);

/// The scale of the force of a response: that of its denominator, or the one beside the motion
/// ("g/lbf") where the denominator has no unit. It is 1 beside "m/(s^2 kN)", whose motion is scaled
/// to that of a newton.
[[nodiscard]] UffScale input_scale(const UffFunction& function);

/// Whether the type of the data is that of a reaction or an excitation.
[[nodiscard]] bool is_load(const UffAxis& axis);
/// Whether the type of the data is that of a motion; where it is left open, whether the label says
/// so, or a unit of velocities or accelerations.
[[nodiscard]] bool is_motion(const UffAxis& axis);
/// Whether the label beside the values is a unit of a motion, also over that of a force.
[[nodiscard]] bool has_unit_of_motion(const UffAxis& axis);
/// How many Hz or s (`si`) 1 of the abscissa is: "kHz", "rad/s", "RPM", "ms". 1 where no unit is
/// stated. None: the unit is of another kind, or not known.
[[nodiscard]] std::optional<double> abscissa_factor(const UffAxis& axis, const std::string& si);
/// "the unit 'orders' of the abscissa is not known: values are taken as Hz"
[[nodiscard]] std::string unknown_abscissa(const UffAxis& axis, const std::string& si);

/// The channel as a degree of freedom, at its node or else at node `otherwise`.
[[nodiscard]] UffDof dof_of(const modal::MeasuredChannel& channel, long long otherwise);
using UffSides = std::vector<const std::vector<modal::MeasuredChannel>*>;
/// The degrees of freedom of channels, by side. A channel without a node gets the lowest node
/// number that no channel has; channels of one name share it.
[[nodiscard]] std::vector<std::vector<UffDof>> dofs_of(const UffSides& sides);
/// The places of their nodes. Adds to `lost` which directions and places UFF cannot hold.
[[nodiscard]] std::map<long long, Eigen::Vector3d> places_of(
    const UffSides& sides, const std::vector<std::vector<UffDof>>& dofs,
    std::vector<std::string>& lost);

/// Marks in our own files for names that are too long for ten columns.
inline constexpr std::string_view kResponseName = "response: ";
inline constexpr std::string_view kReferenceName = "reference: ";
/// The text after `mark` in one of the identification lines, else the entity's name.
[[nodiscard]] std::string stated_name(const UffFunction& function, std::string_view mark,
                                      const UffDof& dof);

}  // namespace chladni::io
