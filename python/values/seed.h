// The seed of everything random as Python gives it.
#pragma once

#include <fmt/format.h>
#include <pybind11/pybind11.h>

#include <limits>
#include <string>

#include "base/error.h"

namespace chladni::python {

struct Seed {
  unsigned value = 1;
};

}  // namespace chladni::python

namespace pybind11::detail {

template <>
struct type_caster<chladni::python::Seed> {
  PYBIND11_TYPE_CASTER(chladni::python::Seed, const_name("int"));
  /// @throws InvalidInput  a whole number that is no seed
  bool load(handle given, bool /*convert*/) {
    const auto number = reinterpret_steal<object>(PyNumber_Index(given.ptr()));
    if (!number) {
      PyErr_Clear();
      return false;
    }
    int overflow = 0;
    const long long seed = PyLong_AsLongLongAndOverflow(number.ptr(), &overflow);
    constexpr auto most = std::numeric_limits<unsigned>::max();
    chladni::require(
        overflow == 0 && seed >= 0 && seed <= static_cast<long long>(most),
        fmt::format("seed is {}; expected 0 to {}", str(number).cast<std::string>(), most));
    value.value = static_cast<unsigned>(seed);
    return true;
  }
};

}  // namespace pybind11::detail
