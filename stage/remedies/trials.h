// Other meshes of a study's body, tried: what they need, and the error that they leave.
#pragma once

#include <functional>
#include <optional>

#include "stage/remedies.h"

namespace chladni::stage {

struct Elements {
  int order = 0;
  double edge_length = 0.0;  ///< [m]; 0: the study's, or from the geometry
  std::vector<std::string> mirrors = {};
};

/// What the solution on a mesh needs.
struct Demand {
  Elements elements;
  double degrees_of_freedom = 0.0;
  double memory_bytes = 0.0;  ///< of this process at the peak
  double factor_bytes = 0.0;
  double cell_size = 0.0;  ///< mean of the cells' longest edges [m]
};

/// What a mesh leaves in the wanted frequencies.
struct MeshError {
  double relative = 0.0;  ///< the largest
  double highest_hz = 0.0;
};

class Trials {
 public:
  /// @param have_bytes  what there is for a solution
  Trials(const study::Study& study, const Introduction& introduction, double have_bytes,
         Work& work);

  /// The finest mesh whose solution leaves a tenth of the memory free; none if there is none.
  /// @param elements  with the order and the mirrors; the edges are found
  /// @param more      factor by which a solution needs more than its forecast, as far as is known
  [[nodiscard]] std::optional<Demand> fitting(Elements elements, double more);
  /// What these elements need.
  [[nodiscard]] std::optional<Demand> demand(const Elements& elements);
  /// Whether that leaves a tenth of the memory free.
  [[nodiscard]] bool fits(const Demand& demand) const;
  /// The axes across which the body with all that is attached to it is its own mirror image: "x",
  /// "y", "z".
  [[nodiscard]] std::vector<std::string> mirrors(int order);
  /// What the finest mesh of at most so many degrees of freedom needs.
  [[nodiscard]] std::optional<Demand> smaller(Elements elements, double degrees_of_freedom);
  /// None where the meshes that can be solved in seconds are too coarse to tell.
  [[nodiscard]] std::optional<MeshError> error(const Demand& demand);

 private:
  struct Solved {
    MeshError error;
    double cell_size = 0.0;
  };
  [[nodiscard]] study::Study with(const Elements& elements) const;
  [[nodiscard]] std::optional<Cost> cost(const Elements& elements) const;
  [[nodiscard]] std::optional<Elements> finest(Elements elements,
                                               const std::function<bool(const Cost&)>& passes);
  [[nodiscard]] std::optional<Elements> at_most(Elements elements, double degrees_of_freedom);
  [[nodiscard]] Demand analysed(const Elements& elements);
  [[nodiscard]] std::optional<Solved> solved(const Elements& elements);

  const study::Study& study_;
  const Introduction& introduction_;
  double have_bytes_;
  bool by_ranks_;
  fem::ModesOptions options_;
  Progress progress_;
  Work quiet_;  // tells nobody of the trials
};

}  // namespace chladni::stage
