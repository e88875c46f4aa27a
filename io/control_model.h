// State spaces as MATLAB, Python and C take them.
#pragma once

#include <string>
#include <vector>

#include "io/json.h"
#include "io/mat.h"
#include "modal/control_model.h"

namespace chladni::io {

/// A structure with A, B, C, D, Ts [s] (0: continuous) and `properties`: pairs of a name and a
/// value as MATLAB's ss takes them after Ts: names and units of states, inputs and outputs,
/// InputDelay and OutputDelay ([s], or samples of a discrete model). In MATLAB, `m` being the
/// structure: ss(m.A, m.B, m.C, m.D, m.Ts, m.properties{:}).
[[nodiscard]] MatValue control_model_mat(const modal::ControlModel& model);

/// { "A", "B", "C", "D", "sample_time_s", "states", "state_units", "inputs", ..., "input_delay",
/// "output_delay", "delay_unit" }.
[[nodiscard]] Json control_model_json(const modal::ControlModel& model);

/// What a C header says beside the model.
struct CHeaderText {
  std::string title;             ///< of the study
  std::vector<double> position;  ///< factor of the position state of each mode: q_m = factor x_2m;
                                 ///< empty where the states are not those of modes
  std::string prefix = "chladni";  ///< of all names, so that a program may hold several models
};

/// A C99 header that needs only <string.h>: the model, `chladni_reset`, `chladni_step` and, for
/// states of modes, `chladni_displacement_at`: C(ρ) x at a place with the shape values φ(ρ). Zeros
/// of A, B, C and D cost nothing at run time; delays are rings of past values.
/// @throws InvalidInput  a continuous model; an input or output that is missing
[[nodiscard]] std::string control_model_c(const modal::ControlModel& model,
                                          const CHeaderText& text);

}  // namespace chladni::io
