// How a study says an effect: which table it adds or changes, and which number goes into which key.
#pragma once

#include <string_view>

#include "diagnosis/few.h"

namespace chladni::diagnosis {

/// One key of a table, and the number of the effect that goes into it.
struct StudyKey {
  enum class How {
    set,             ///< key = number
    times,           ///< key · number
    times_one_plus,  ///< key · (1 + number)
    plus,            ///< key + number
    plus_lag,        ///< a corner frequency: 1 / (1 / key + 1 / number)
    computed,  ///< follows from the study and the whole cause; the code of the extension has it
  };
  std::string_view key = {};     ///< "stiffness"; "wafer.thickness" in a table of the table
  std::string_view number = {};  ///< a parameter or the number of a choice; empty if computed
  std::string_view unit = {};    ///< of the number: "N/m"; empty: none
  How how = How::set;
};

struct InStudy {
  enum class Table {
    none,                  ///< no key of a study says it
    attachment,            ///< a new one, at the place of the cause
    sensor_attachments,    ///< a new one at each sensor
    actuator_attachments,  ///< a new one at each actuator
    variation,             ///< a new one
    materials,             ///< the keys of every material
    geometry,              ///< the keys of the body
    modes,
    sensors,      ///< the keys of the sensor that the cause names
    actuators,    ///< the keys of the actuator that the cause names
    all_sensors,  ///< the keys of every sensor
  };
  Table table = Table::none;
  std::string_view kind = {};  ///< of an attachment: `kind`; of a variation: `of`
  bool along_normal = false;   ///< an attachment with `direction` along the normal of the chart
  bool at_place = false;       ///< a variation with `at` the place of the cause
  bool is_positive = false;    ///< refused where the first number is not positive
  Few<StudyKey, 6> keys = {};
  std::string_view refusal = {};  ///< why no key says it; empty if there is nothing to advise
};

}  // namespace chladni::diagnosis
