#include "python/values/given.h"

#include <fmt/format.h>

#include <cmath>
#include <string_view>

#include "base/error.h"

namespace chladni::python {

namespace py = pybind11;

std::string shown(py::handle object) {
  constexpr std::size_t kLongest = 80;
  const py::bytes repr = py::repr(object).attr("encode")("utf-8", "backslashreplace");
  std::string text = repr;
  if (text.size() <= kLongest) return text;
  auto end = kLongest - 4;
  while ((static_cast<unsigned char>(text[end]) & 0xc0U) == 0x80U) --end;  // within a character
  return text.substr(0, end) + " ...";
}

bool is_complex(py::handle given) {
  const auto found = py::array::ensure(given);
  return found && found.dtype().kind() == 'c';
}

py::array numbers_in(py::handle given, const std::string& name, const std::string& expected,
                     bool can_be_complex) {
  auto found = py::array::ensure(given);
  const char kind = found ? found.dtype().kind() : 'V';
  require(can_be_complex || kind != 'c', name + " is complex; expected " + expected);
  const bool has_numbers = std::string_view("biufcO").find(kind) != std::string_view::npos;
  require(has_numbers && found.ndim() > 0, name + " is " + shown(given) + "; expected " + expected);
  return found;
}

void refuse_shape(const py::array& found, const std::string& name, const std::string& expected) {
  if (found.dtype().kind() == 'O') {
    throw InvalidInput(name + " is " + shown(found) + "; expected " + expected);
  }
  throw InvalidInput(name + " has the shape " + py::str(found.attr("shape")).cast<std::string>() +
                     "; expected " + expected);
}

void require_positive(double number, const std::string& name) {
  require(std::isfinite(number) && number > 0.0,
          fmt::format("{} is {:g}; expected more than 0", name, number));
}

void require_not_negative(double number, const std::string& name) {
  require(std::isfinite(number) && number >= 0.0,
          fmt::format("{} is {:g}; expected 0 or more", name, number));
}

void require_frequencies(const Eigen::VectorXd& frequency_hz) {
  for (const double f : frequency_hz) {
    require(std::isfinite(f) && f >= 0.0,
            fmt::format("frequency_hz has {:g}; expected 0 or more", f));
  }
}

void require_lines(const Eigen::VectorXd& frequency_hz) {
  require_frequencies(frequency_hz);
  for (Eigen::Index k = 1; k < frequency_hz.size(); ++k) {
    require(frequency_hz(k) > frequency_hz(k - 1),
            fmt::format("frequency_hz has {:g} after {:g}; expected ascending frequencies",
                        frequency_hz(k), frequency_hz(k - 1)));
  }
}

void require_band(double low_hz, double high_hz) {
  require(low_hz <= high_hz,
          fmt::format("the band is from {:g} to {:g} Hz; expected two frequencies, the lower one "
                      "first",
                      low_hz, high_hz));
}

}  // namespace chladni::python
