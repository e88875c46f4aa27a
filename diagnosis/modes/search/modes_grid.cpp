// Starts of an effect, by the roles of its parameters.
#include <algorithm>
#include <array>
#include <cmath>

#include "diagnosis/constants.h"
#include "diagnosis/modes/search/modes_search.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr Index kPlaces = 48;     // of an effect with a place
constexpr Index kFewPlaces = 24;  // of one that also has a frequency or an extent
constexpr int kFrequencies = 8;   // over the band

// Sizes of what is light for its prior, in widths: where its frequency is that of a mode it splits
// the mode in two, and moves no other one.
constexpr std::array kLight{-1.75, -0.75};
constexpr Index kTunedPlaces = 16;

// Places that are far from each other: each next one is the farthest from those before.
std::vector<Index> spread(const Eigen::MatrixX2d& places, Index count) {
  std::vector<Index> chosen;
  if (places.rows() == 0) return chosen;
  VectorXd distance = VectorXd::Constant(places.rows(), HUGE_VAL);
  Index next = 0;
  while (static_cast<Index>(chosen.size()) < std::min(count, places.rows())) {
    chosen.push_back(next);
    distance = distance.cwiseMin((places.rowwise() - places.row(next)).rowwise().squaredNorm());
    distance.maxCoeff(&next);
  }
  return chosen;
}

using Values = std::vector<double>;

// A stiffness or a mass that is large for its prior is not rare where the first mode of the
// structure is one of its suspension, far below those that were measured.
Values sizes_of(const Parameter& parameter, bool few, StartSizes sizes) {
  Values values;
  Values parts = parameter.is_about_zero()
                     ? (few ? Values{-1.0, -0.1, 0.1, 1.0}
                            : Values{-2.0, -1.0, -0.3, -0.1, -0.03, 0.03, 0.1, 0.3, 1.0, 2.0})
                     : (few ? Values{-1.0, 0.0, 1.0, 2.0, 3.0}
                            : Values{-1.5, -1.0, -0.5, 0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 3.5});
  if (sizes == StartSizes::near && !few && !parameter.is_about_zero()) {
    const double step = std::min(0.5, kConstants.near_size / parameter.width);
    parts.clear();
    for (double part = -1.5; part <= 3.5; part += step) parts.push_back(part);
  }
  for (const double part : parts) values.push_back(parameter.centre + part * parameter.width);
  return values;
}

// A scale of the whole body may be far off. Its modes then pair with none, and no step leads there.
constexpr std::array kFar{0.5, 0.7, 0.9, 1.1, 1.3};
void add_far(Values& values) {
  for (const double size : kFar) {
    values.push_back(size);
    values.push_back(-size);
  }
}

Values values_of(const Parameter& parameter, const VectorXd& measured_hz) {
  using Role = Parameter::Role;
  const double c = parameter.centre;
  const double w = parameter.width;
  switch (parameter.role) {
    case Role::frequency: {
      Values values;
      const double low = 0.7 * measured_hz.minCoeff();
      const double high = 1.4 * measured_hz.maxCoeff();
      for (int i = 0; i < kFrequencies; ++i) {
        const double part = (i + 0.5) / kFrequencies;
        values.push_back(parameter.coordinate(low * std::pow(high / low, part)));
      }
      return values;
    }
    case Role::offset:
      return {c - 1.5 * w, c - 0.5 * w, c, c + 0.5 * w, c + 1.5 * w};
    default:
      return {c};
  }
}

bool has_role(const std::vector<Parameter>& parameters, Parameter::Role role) {
  return std::ranges::find(parameters, role, &Parameter::role) != parameters.end();
}

// All points of the grid of one choice.
class Grid {
 public:
  Grid(const Structure& structure, const Effect& effect, const VectorXd& measured_hz,
       StartSizes sizes)
      : structure_(structure), parameters_(effect.parameters(structure)) {
    const bool tuned = is_tuned(structure, effect);
    const bool has_place = std::ranges::any_of(parameters_, &Parameter::is_place);
    const bool has_more = tuned || has_role(parameters_, Parameter::Role::extent);
    for (const auto& parameter : parameters_) {
      values_.push_back(parameter.role == Parameter::Role::strength
                            ? sizes_of(parameter, tuned, sizes)
                            : values_of(parameter, measured_hz));
    }
    if (effect.is_scale && effect.is_of_body) add_far(values_.front());
    if (has_place) places_ = spread(structure.surface.places, has_more ? kFewPlaces : kPlaces);
    x_.resize(static_cast<Index>(parameters_.size()));
    put_all();
    if (!tuned) return;
    tune(measured_hz);
    places_ = spread(structure.surface.places, kTunedPlaces);
    put_all();
  }
  [[nodiscard]] const std::vector<VectorXd>& points() const { return points_; }

 private:
  // Light ones at the frequencies of the measured modes.
  void tune(const VectorXd& measured_hz) {
    for (std::size_t i = 0; i < parameters_.size(); ++i) {
      const auto& parameter = parameters_[i];
      if (parameter.role == Parameter::Role::frequency) {
        values_[i].clear();
        for (const double hz : measured_hz) values_[i].push_back(parameter.coordinate(hz));
      } else if (parameter.role == Parameter::Role::strength) {
        values_[i].clear();
        for (const double part : kLight) {
          values_[i].push_back(parameter.centre + part * parameter.width);
        }
      }
    }
  }
  void put_all() {
    if (places_.empty()) put_strengths();
    for (const Index place : places_) {
      put_place(place);
      put_strengths();
    }
  }
  void put_place(Index place) {
    for (std::size_t i = 0; i < parameters_.size(); ++i) {
      const auto role = parameters_[i].role;
      const auto axis = role == Parameter::Role::place_u ? 0 : 1;
      if (parameters_[i].is_place()) {
        x_(static_cast<Index>(i)) = structure_.surface.places(place, axis);
      }
    }
  }
  // Each strength in turn is moved; the others stay at their centres.
  void put_strengths() {
    bool any = false;
    for (std::size_t i = 0; i < parameters_.size(); ++i) {
      if (parameters_[i].role != Parameter::Role::strength) continue;
      any = true;
      moved_ = i;
      put(0);
    }
    moved_ = parameters_.size();
    if (!any) put(0);
  }
  void put(std::size_t i) {
    if (i == parameters_.size()) {
      points_.push_back(x_);
      return;
    }
    const auto& parameter = parameters_[i];
    const bool stays = parameter.role == Parameter::Role::strength && i != moved_;
    if (parameter.is_place() || stays) {
      if (stays) x_(static_cast<Index>(i)) = parameter.centre;
      put(i + 1);
      return;
    }
    for (const double value : values_[i]) {
      x_(static_cast<Index>(i)) = value;
      put(i + 1);
    }
  }

  const Structure& structure_;
  std::vector<Parameter> parameters_;
  std::vector<Values> values_;
  std::vector<Index> places_;
  std::vector<VectorXd> points_;
  VectorXd x_;
  std::size_t moved_ = 0;
};

}  // namespace

bool is_tuned(const Structure& structure, const Effect& effect) {
  const auto parameters = effect.parameters(structure);
  return std::ranges::any_of(parameters, &Parameter::is_place) &&
         has_role(parameters, Parameter::Role::frequency);
}

std::vector<Supposed> grid_of(const Structure& structure, const Effect& effect,
                              const Eigen::VectorXd& measured_hz, StartSizes sizes) {
  std::vector<Supposed> starts;
  const Index options = effect.options(structure);
  if (options <= 0) return starts;
  const Grid grid(structure, effect, measured_hz, sizes);
  for (Index option = 0; option < options; ++option) {
    for (const auto& point : grid.points()) starts.push_back({&effect, option, point});
  }
  return starts;
}

}  // namespace chladni::diagnosis
