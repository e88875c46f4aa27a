// Channels of a universal file: degrees of freedom with names, units and places.
#pragma once

#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "io/uff/uff.h"
#include "modal/frf_set.h"

namespace chladni::io {

/// One side's channels as they are met; each degree of freedom is one.
class UffChannels {
 public:
  /// The number of the channel that `dof` is. @param name  what the file calls it; may be empty
  Eigen::Index number(const UffDof& dof, const std::string& name);
  [[nodiscard]] Eigen::Index size() const { return static_cast<Eigen::Index>(dofs_.size()); }
  /// Names: the file's own where every channel has another, else node and direction ("101z").
  [[nodiscard]] std::vector<modal::MeasuredChannel> channels() const;

 private:
  using Key = std::tuple<std::string, long long, int>;
  std::map<Key, Eigen::Index> numbers_;
  std::vector<UffDof> dofs_;
  std::vector<std::string> names_;
};

/// "101z", "-101z" against the axis, "101rz" a rotation, "101" a scalar.
[[nodiscard]] std::string name_of(const UffDof& dof);
/// Unit vector along a direction; zero for scalars and rotations.
[[nodiscard]] Eigen::Vector3d vector_of(int direction);

/// What one number of an ordinate is in SI, and its unit; empty: not stated.
struct UffScale {
  double factor = 1.0;
  std::string unit;
  std::optional<modal::FrfKind> kind;  ///< of a motion
  std::string note;                    ///< label and dataset 164 contradict each other
};
/// Of a displacement, velocity or acceleration, by its label, else by dataset 164.
[[nodiscard]] UffScale motion_scale(const UffAxis& axis, const std::optional<UffUnits>& units);
/// Of a force, likewise.
[[nodiscard]] UffScale force_scale(const UffAxis& axis, const std::optional<UffUnits>& units);

/// The channel as a degree of freedom: its node, else `otherwise`.
[[nodiscard]] UffDof dof_of(const modal::MeasuredChannel& channel, long long otherwise);
/// Node numbers for channels that have none: the lowest that no channel has.
[[nodiscard]] std::vector<UffDof> dofs_of(const std::vector<modal::MeasuredChannel>& channels,
                                          const std::vector<modal::MeasuredChannel>& others);

/// How our own files keep a name that ten columns are too short for.
inline constexpr std::string_view kResponseName = "response: ";
inline constexpr std::string_view kReferenceName = "reference: ";
/// What follows `mark` in one of the identification lines; else the entity's name.
[[nodiscard]] std::string stated_name(const UffFunction& function, std::string_view mark,
                                      const UffDof& dof);

}  // namespace chladni::io
