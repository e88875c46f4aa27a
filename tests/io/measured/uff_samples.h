// Universal files as other programs write them, built from the format's description.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <complex>
#include <cstring>
#include <string>
#include <vector>

namespace chladni::io {

/// Dataset 58 of a response at node 12, z, to a force at node 3, −z.
struct Sample58 {
  int ordinate_type = 5;  ///< 2, 4 real; 5, 6 complex
  bool even = true, binary = false, big_endian = false;
  int function_type = 4, ordinate = 12, denominator = 13;
  std::string label = "Acceleration", unit = "m/s^2", input_unit = "N", eol = "\n", extra = "";
  std::string abscissa_unit = "";  ///< empty: Hz, or s of a recording
  std::vector<double> x{1.0, 1.5, 2.0, 2.5, 3.0};
  std::vector<std::complex<double>> y{
      {1.5, -2.25}, {-3.0, 4.0}, {0.125, 1e-3}, {-1e4, -1e-5}, {7, 8}};
  int response_node = 12, response_direction = 3, reference_node = 3, reference_direction = -3;
  std::string response_name = "NONE";
  int load_case = 0;
};

inline void append_number(std::string& bytes, double value, bool is_double, bool big_endian) {
  std::array<char, 8> raw{};
  const auto single = static_cast<float>(value);
  const std::size_t size = is_double ? 8 : 4;
  if (is_double) {
    std::memcpy(raw.data(), &value, 8);
  } else {
    std::memcpy(raw.data(), &single, 4);
  }
  if (big_endian) std::reverse(raw.begin(), raw.begin() + static_cast<long>(size));
  bytes.append(raw.data(), size);
}

// Fortran: 6E13.5; 6E13.5; 4E20.12; E13.5,2E20.12, ...
inline std::string numbers_of(const Sample58& s) {
  const bool is_double = s.ordinate_type == 4 || s.ordinate_type == 6;
  const bool is_complex = s.ordinate_type >= 5;
  std::string text;
  int column = 0;
  const auto put = [&](double value, bool wide) {
    if (s.binary) {
      append_number(text, value, wide || is_double, s.big_endian);
      return;
    }
    const std::string number =
        wide ? fmt::format("{:20.12E}", value) : fmt::format("{:13.5E}", value);
    if (column + static_cast<int>(number.size()) > 80) {
      text += s.eol;
      column = 0;
    }
    text += number;
    column += static_cast<int>(number.size());
  };
  for (std::size_t k = 0; k < s.x.size(); ++k) {
    if (!s.even) put(s.x[k], false);
    put(s.y[k].real(), is_double);
    if (is_complex) put(s.y[k].imag(), is_double);
  }
  return s.binary ? text : text + s.eol;
}

inline std::string dataset_58(const Sample58& s) {
  const std::string data = numbers_of(s);
  const std::string& eol = s.eol;
  std::string text = "    -1" + eol;
  text += s.binary ? fmt::format("    58b{:6}{:6}{:12}{:12}{:6}{:6}{:12}{:12}",
                                 s.big_endian ? 2 : 1, 2, 11, data.size(), 0, 0, 0, 0)
                   : std::string("    58");
  text += eol + "response" + eol + "NONE" + eol + "21-Nov-26 10:00:00" + eol + "NONE" + eol + eol;
  text += fmt::format("{:5}{:10}{:5}{:10} {:<10}{:10}{:4} {:<10}{:10}{:4}", s.function_type, 0, 1,
                      s.load_case, s.response_name, s.response_node, s.response_direction, "NONE",
                      s.reference_node, s.reference_direction) +
          eol;
  text += fmt::format("{:10}{:10}{:10}{:13.5E}{:13.5E}{:13.5E}", s.ordinate_type, s.x.size(),
                      s.even ? 1 : 0, s.even ? s.x[0] : 0.0, s.even ? s.x[1] - s.x[0] : 0.0, 0.0) +
          eol;
  const auto axis = [&](int type, const std::string& label, const std::string& unit) {
    text += fmt::format("{:10}{:5}{:5}{:5} {:<20} {:<20}", type, 0, 0, 0, label, unit) + eol;
  };
  const bool is_time = s.function_type == 1;
  const std::string usual = is_time ? "s" : "Hz";
  axis(is_time ? 17 : 18, is_time ? "Time" : "Frequency",
       s.abscissa_unit.empty() ? usual : s.abscissa_unit);
  axis(s.ordinate, s.label, s.unit);
  axis(s.denominator, s.denominator == 13 ? "Excitation force" : "NONE", s.input_unit);
  axis(0, "NONE", "NONE");
  return text + s.extra + data + (s.binary ? s.extra + eol : "") + "    -1" + eol;
}

inline std::string dataset_164(double length, double force, const std::string& eol = "\n") {
  std::string factors = fmt::format("{:25.17E}{:25.17E}{:25.17E}", length, force, 1.0);
  std::replace(factors.begin(), factors.end(), 'E', 'D');
  return "    -1" + eol + "   164" + eol +
         fmt::format("{:10}{:<20}{:10}", 5, "MM: mm (milli-newton)", 2) + eol + factors + eol +
         fmt::format("{:25.17E}", 273.15) + eol + "    -1" + eol;
}

/// How many of the notes hold the word.
inline int times(const std::vector<std::string>& said, const std::string& word) {
  return static_cast<int>(std::count_if(said.begin(), said.end(), [&](const auto& one) {
    return one.find(word) != std::string::npos;
  }));
}

}  // namespace chladni::io
