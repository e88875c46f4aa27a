// One function of a .mat file of Simcenter Testlab.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <string>
#include <vector>

#include "io/mat.h"

namespace chladni::io {

enum class TestlabKind { response, coherence, recording, other };

struct TestlabFunction {
  std::string name;  ///< of the variable, with its index: "FRF(2)"
  std::string type;  ///< as the file states it; empty: it does not
  TestlabKind kind = TestlabKind::other;
  std::string output, input;    ///< channels; empty: not stated
  std::string label;            ///< of the values, as the file states it
  bool is_transformed = false;  ///< beside the label stands a transformation of it
  std::string unit;             ///< of the values; empty: not told
  Eigen::VectorXd x;            ///< [Hz] of responses, [s] of recordings
  double step = 0.0;            ///< of x; 0: x is stated value by value
  Eigen::VectorXcd values;
};

/// All functions of the variables, which may stand in cells, in structures and in arrays of these.
/// @param unit  that the user states for the values: it counts where it is not told whether values
///              are in the unit of their label or in SI
/// @throws InvalidInput  names the function, what was found and what was expected
[[nodiscard]] std::vector<TestlabFunction> testlab_functions(const MatFields& variables,
                                                             const std::string& unit);

/// Whether it is a structure with x_values and y_values.
[[nodiscard]] bool is_testlab_function(const MatValue& value);

}  // namespace chladni::io
