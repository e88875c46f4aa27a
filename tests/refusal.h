// What a call says when it refuses its input.
#pragma once

#include <string>

#include "base/error.h"

namespace chladni {

/// The message of the InvalidInput that `call` throws; empty where it throws none.
template <typename Call>
std::string refusal_of(const Call& call) {
  try {
    static_cast<void>(call());
  } catch (const InvalidInput& refused) {
    return refused.what();
  }
  return "";
}

}  // namespace chladni
