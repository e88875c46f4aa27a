#include <Eigen/Core>
#include <limits>

#include "base/error.h"
#include "identification/constants.h"
#include "identification/gains/block_covariance.h"
#include "identification/gains/matched_sides.h"
#include "identification/gains/matching.h"

namespace chladni::identification {
namespace {

// χ² of the two sides as one motion; infinite where no scale makes them one.
double motion_misfit(const TwoSides& sides, const RigidGeometry& geometry) {
  try {
    return scaled_by_motion(sides, geometry.outputs, geometry.inputs, geometry.bending).chi_square;
  } catch (const NumericalFailure&) {
    return std::numeric_limits<double>::infinity();
  }
}

// 1 or −1 for the sign that makes a suspended mode one motion; 0: both or none do.
int vote_of_suspended(const Matching& state, std::size_t group) {
  const auto& geometry = *state.options.geometry;
  const auto sides = sides_of(state, group);
  const double as_is = motion_misfit(sides, geometry);
  const double other = motion_misfit(turned(sides), geometry);
  if (as_is == other) return 0;
  return as_is < other ? 1 : -1;
}

// 1 or −1 for the sign with which the 1/s² term has a positive mass beyond chance; 0: it has none
// with either.
int vote_of_mass(const Matching& state, const modal::ModeGroup& group) {
  const auto& geometry = *state.options.geometry;
  const auto fitted = fitted_block(state, group);
  const Eigen::MatrixXd product = fitted.outputs * fitted.inputs;
  const Eigen::MatrixXd deviation = product_deviation(state, group);
  for (const int side : {1, -1}) {
    try {
      const auto body = rigid_body(side * product, deviation, geometry.outputs, geometry.inputs);
      return body.mass(0, 0) > Constants::no_chance * body.mass_std(0, 0) ? side : 0;
    } catch (const NumericalFailure&) {  // this sign has no mass
    }
  }
  return 0;
}

}  // namespace

SideByMotion side_by_motion(const Matching& state) {
  if (!state.options.geometry) return {};
  int votes = 0;
  int at_zero = 0;
  for (std::size_t g = 0; g < state.groups.size(); ++g) {
    const auto& group = state.groups[g];
    if (tells_mass(state, group)) {
      at_zero += vote_of_mass(state, group);
    } else if (group.size == 1 && is_suspended(state, group.first)) {
      votes += vote_of_suspended(state, g);
    }
  }
  if (at_zero != 0) return {at_zero < 0 ? -1 : 1, ToldSide::at_zero};
  if (votes == 0) return {};
  return {votes < 0 ? -1 : 1, ToldSide::suspended};
}

}  // namespace chladni::identification
