// Responses as curves of the report: magnitude, phase and error over frequency.
#pragma once

#include <string>
#include <vector>

#include "io/report.h"

namespace chladni::show {

/// One measured response and what predicts it, over common lines.
struct OneResponse {
  std::string name;                         ///< "s1 by a2"
  Eigen::VectorXcd measured;                ///< k; NaN: not measured
  Eigen::VectorXd deviation;                ///< k: root of E|G − G₀|²; empty: not known
  std::vector<Eigen::VectorXcd> predicted;  ///< k each
};

/// What stands beside each measured response.
struct Prediction {
  std::string name;  ///< "simulated"
  int colour = 1;    ///< as io::PlotSeries::colour
};

/// |measured − predicted| over |measured|, over all lines; NaN: nothing was measured.
[[nodiscard]] double relative_error(const Eigen::VectorXcd& measured,
                                    const Eigen::VectorXcd& predicted);

/// The label of an axis for all of `responses`, each of which has one of `labels`: "receptance
/// [m/N]". Where they differ, it has no unit, and each response gets its own behind its name.
/// @param labels  at least one
[[nodiscard]] std::string common_label(const std::vector<std::string>& labels,
                                       std::vector<OneResponse>& responses);

/// The responses as choices, those that the first prediction misses most first. As many as fit into
/// about `bytes` of the page, four at least; of more than 1500 lines those that keep peaks and
/// troughs. What is left out stands in the caption.
/// @param label  of the magnitude, with its unit: "receptance [m/N]"
/// @throws InvalidInput  there is no response
[[nodiscard]] io::Curves response_curves(const Eigen::VectorXd& frequency_hz,
                                         const std::vector<Prediction>& predictions,
                                         std::vector<OneResponse> responses,
                                         const std::string& label, std::size_t bytes = 300'000);

/// The panels of a plot as choices of one pane. A series is known by its name; in all panels it has
/// the same lines.
/// @throws InvalidInput  a series has other lines in another panel
[[nodiscard]] io::Curves curves_of(const io::Plot& plot, const std::string& name,
                                   const std::string& chooser);

}  // namespace chladni::show
