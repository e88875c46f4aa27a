// The unit of measured data that is read without a study.
#pragma once

#include <string_view>

#include "base/error.h"
#include "io/frf_file.h"

namespace chladni::app {

/// @throws InvalidInput  "SI" for each sensor: without a study nothing tells what sensors measure
inline void require_one_unit(std::string_view unit) {
  require(unit != io::kEachInSi,
          "--unit SI: only a study knows what each sensor measures; state one unit, or read the "
          "file in a study");
}

}  // namespace chladni::app
