// Arrays and numbers that Python gives. What cannot be meant is refused by name.
#pragma once

#include <fmt/format.h>
#include <pybind11/eigen.h>
#include <pybind11/numpy.h>

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>

namespace chladni::python {

/// How an object looks in a message: its repr, cut where it is long.
[[nodiscard]] std::string shown(pybind11::handle object);

/// What NumPy makes of an argument.
/// @param expected       what the message asks for
/// @throws InvalidInput  it makes no array of numbers of it, or a complex one where real numbers
///                       are meant
[[nodiscard]] pybind11::array numbers_in(pybind11::handle given, const std::string& name,
                                         const std::string& expected, bool can_be_complex);

/// Whether NumPy makes complex numbers of it.
[[nodiscard]] bool is_complex(pybind11::handle given);

/// @throws InvalidInput  always, with the shape that was found
[[noreturn]] void refuse_shape(const pybind11::array& found, const std::string& name,
                               const std::string& expected);

/// "n x 3 numbers", or what else a Matrix or an array of NumPy holds.
template <typename Matrix>
std::string expected_of() {
  if constexpr (std::is_base_of_v<pybind11::array, Matrix>) {
    return "an array of numbers";
  } else {
    const auto size = [](int count, const char* letter) {
      return count == Eigen::Dynamic ? std::string(letter) : fmt::to_string(count);
    };
    const auto rows = size(Matrix::RowsAtCompileTime, "n");
    if (Matrix::ColsAtCompileTime == 1) return rows + " numbers";
    return rows + " x " + size(Matrix::ColsAtCompileTime, "m") + " numbers";
  }
}

/// The array of an argument as a Matrix, or as an array_t of NumPy.
/// @throws InvalidInput  as numbers_in; another shape
template <typename Matrix>
Matrix array_in(pybind11::handle given, const std::string& name) {
  using Number = typename Matrix::value_type;
  const auto expected = expected_of<Matrix>();
  const auto found = numbers_in(given, name, expected, !std::is_same_v<Number, double>);
  pybind11::detail::make_caster<Matrix> caster;
  if (!caster.load(found, true)) refuse_shape(found, name, expected);
  return std::move(pybind11::detail::cast_op<Matrix&>(caster));
}

/// A text as an argument of a template.
template <std::size_t size>
struct Word {
  consteval Word(const char (&text)[size]) { std::copy_n(text, size, letters); }
  char letters[size];
};

/// An argument of that name, an array.
template <Word name, typename Matrix>
struct Given {
  Matrix value;
};

/// The array of an argument that may be None.
template <Word name, typename Matrix>
std::optional<Matrix> value_of(const std::optional<Given<name, Matrix>>& given) {
  if (!given) return std::nullopt;
  return given->value;
}

/// @throws InvalidInput  names the number where it is not above 0, below 0, or not finite
void require_positive(double number, const std::string& name);
void require_not_negative(double number, const std::string& name);

/// Frequencies at which something is asked for.
/// @throws InvalidInput  one is negative or not finite
void require_frequencies(const Eigen::VectorXd& frequency_hz);
/// Those of the lines of responses. @throws InvalidInput  also where they do not ascend
void require_lines(const Eigen::VectorXd& frequency_hz);
/// @throws InvalidInput  not two frequencies, the lower one first; they may be infinite
void require_band(double low_hz, double high_hz);

}  // namespace chladni::python

namespace pybind11::detail {

template <chladni::python::Word argument, typename Matrix>
struct type_caster<chladni::python::Given<argument, Matrix>> {
  using Value = chladni::python::Given<argument, Matrix>;
  PYBIND11_TYPE_CASTER(Value, make_caster<Matrix>::name);
  bool load(handle given, bool /*convert*/) {
    value.value = chladni::python::array_in<Matrix>(given, argument.letters);
    return true;
  }
};

}  // namespace pybind11::detail
