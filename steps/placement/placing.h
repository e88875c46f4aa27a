// The steps of `placed`.
#pragma once

#include "steps/placement.h"

namespace chladni::steps {

/// The study's plan, or a default one.
[[nodiscard]] study::PlacementPlan placement_plan(const study::Study& study);

/// True if the plan says that the channel stays in its place.
[[nodiscard]] bool stays(const study::PlacementPlan& plan, const study::Channel& channel);

/// @throws InvalidInput  a mode that does not exist; the message says how many there are
[[nodiscard]] WantedModes wanted_modes(const study::Study& study, const stage::Solution& solution,
                                       const study::PlacementPlan& plan,
                                       const placement::Surface& surface,
                                       std::vector<std::string>& notes);

/// @throws InvalidInput  a rule names a patch that does not exist
[[nodiscard]] std::vector<placement::Rule> rules_of(const study::Study& study,
                                                    const stage::Solution& solution,
                                                    const study::PlacementPlan& plan,
                                                    const stage::Faces& faces);

/// The study's collocated sensors and actuators, by index: on one line, at most 1 mm beside it, and
/// at most a twentieth of the body's diagonal apart along it.
[[nodiscard]] std::vector<std::pair<Eigen::Index, Eigen::Index>> pairs_of(
    const study::Study& study, const stage::Solution& solution,
    const std::vector<std::size_t>& sensors, const std::vector<std::size_t>& actuators);
[[nodiscard]] std::vector<std::pair<Eigen::Index, Eigen::Index>> pairs_of(
    const study::Study& study, const stage::Solution& solution);

/// Allowed places of devices: points of the surface, or of the mounting grid, that no rule forbids.
struct Candidates {
  placement::Sites sites;
  bool from_grid = false;
};
[[nodiscard]] Candidates candidates_of(const study::PlacementPlan& plan,
                                       const placement::Sampler& sampler, const Placed& placed);

/// The shapes at sites for the criteria: of the study's model, then of the members of the ensemble.
class Views {
 public:
  Views(const study::Study& study, const stage::Solution& solution,
        const study::PlacementPlan& plan, const placement::Surface& surface,
        const WantedModes& wanted, std::vector<stage::Member> members);

  [[nodiscard]] std::vector<placement::PairView> of(const placement::Sites& sites) const;
  [[nodiscard]] placement::Over over() const { return over_; }

 private:
  [[nodiscard]] Eigen::MatrixXd seen(const Eigen::MatrixXd& shapes, std::size_t member) const;

  WantedModes wanted_;
  std::vector<stage::Member> members_;
  std::vector<placement::GroupNorms> norms_;  // of the model, then of each member
  Eigen::MatrixXd present_, actuators_;       // rows×all modes
  double position_error_;
  placement::Over over_;
};

/// Adds scores of the study's layouts, and the best possible layouts.
void add_layouts(const study::Study& study, const stage::Solution& solution,
                 const study::PlacementPlan& plan, Placed& placed);
void add_optima(const study::Study& study, const stage::Solution& solution,
                const study::PlacementPlan& plan, const Candidates& candidates, unsigned seed,
                Placed& placed);

}  // namespace chladni::steps
