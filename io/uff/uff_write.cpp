// Writes universal files.
#include <fmt/format.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include "base/error.h"
#include "io/scan.h"
#include "io/uff/uff.h"
#include "io/uff/uff_fields.h"

namespace chladni::io {
namespace {

double read_back(double value) { return number_in(trimmed(in_13(value))).value_or(0.0); }

// Whether the written start and increment reproduce every abscissa.
bool is_even(const Eigen::VectorXd& x, double tolerance) {
  if (x.size() < 2) return false;
  const double first = read_back(x(0));
  const double step = read_back(x(1) - x(0));
  for (Eigen::Index k = 0; k < x.size(); ++k) {
    const double found = first + step * static_cast<double>(k);
    if (std::abs(found - x(k)) > tolerance * (std::abs(x(k)) + step)) return false;
  }
  return step > 0.0;
}

void require_columns(long long number, std::size_t columns, const std::string& what) {
  const std::string text = fmt::to_string(number);
  require(text.size() <= columns, "UFF has " + fmt::to_string(columns) + " columns for " + what +
                                      "; " + text + " does not fit");
}

std::string degree(const UffDof& dof) {
  const std::string entity = in_columns(dof.entity.empty() ? "NONE" : dof.entity, 10);
  return fmt::format(" {}{:10}{:4}", entity, dof.node, dof.direction);
}

std::string axis_line(const UffAxis& axis) {
  const auto word = [](const std::string& text) {
    return in_columns(text.empty() ? "NONE" : text, 20);
  };
  return fmt::format("{:10}{:5}{:5}{:5} {} {}\n", axis.type, axis.length_exponent,
                     axis.force_exponent, 0, word(axis.label), word(axis.unit));
}

void append(std::string& bytes, double value) {
  std::array<char, 8> raw;
  std::memcpy(raw.data(), &value, 8);
  bytes.append(raw.data(), 8);
}

std::string binary_values(const UffFunction& function, bool even) {
  std::string bytes;
  for (Eigen::Index k = 0; k < function.y.size(); ++k) {
    if (!even) append(bytes, function.x(k));
    append(bytes, function.y(k).real());
    if (function.is_complex) append(bytes, function.y(k).imag());
  }
  return bytes;
}

// The values as text: 4E20.12 where the abscissa is even, else one point per line.
std::string text_values(const UffFunction& function, bool even) {
  std::string text;
  int on_line = 0;
  const auto put = [&](double value) {
    text += std::isfinite(value) ? fmt::format("{:20.12E}", value) : fmt::format("{:>20}", "NaN");
    if (++on_line == 4) {
      text += '\n';
      on_line = 0;
    }
  };
  for (Eigen::Index k = 0; k < function.y.size(); ++k) {
    if (!even) text += in_13(function.x(k));
    put(function.y(k).real());
    if (function.is_complex) put(function.y(k).imag());
    if (!even && on_line > 0) {
      text += '\n';
      on_line = 0;
    }
  }
  return on_line > 0 ? text + '\n' : text;
}

}  // namespace

std::string uff_dataset(const UffFunction& function, UffEncoding encoding) {
  require(function.x.size() == function.y.size() && function.x.size() > 0,
          "UFF: a function without values, or with other abscissas than values");
  require_columns(function.version, 5, "the number of a realisation");
  require_columns(function.load_case, 10, "the number of an experiment");
  for (const auto* dof : {&function.response, &function.reference}) {
    require_columns(dof->node, 10, "the number of a node");
  }
  const bool binary = encoding == UffEncoding::binary;
  const bool even = is_even(function.x, binary ? 0.0 : 1e-12);  // binary data are exact
  std::string head;
  for (const auto& id : function.id) head += line_80(id);
  head += fmt::format("{:5}{:10}{:5}{:10}", function.type, 0, function.version, function.load_case);
  head += degree(function.response) + " " + degree(function.reference).substr(1) + "\n";
  const double first = even ? function.x(0) : 0.0;
  const double step = even ? function.x(1) - function.x(0) : 0.0;
  head += fmt::format("{:10}{:10}{:10}{}{}{}\n", function.is_complex ? 6 : 4, function.x.size(),
                      even ? 1 : 0, in_13(first), in_13(step), in_13(0.0));
  head += axis_line(function.abscissa) + axis_line(function.ordinate) +
          axis_line(function.denominator) + axis_line({});
  if (!binary) return uff_block(58, head + text_values(function, even));
  const std::string values = binary_values(function, even);
  constexpr int order = std::endian::native == std::endian::big ? 2 : 1;
  return kUffDelimiter +
         fmt::format("    58b{:6}{:6}{:12}{:12}{:6}{:6}{:12}{:12}\n", order, 2, 11, values.size(),
                     0, 0, 0, 0) +
         head + values + "\n" + kUffDelimiter;
}

std::string uff_head(const std::string& title, const std::map<long long, Eigen::Vector3d>& nodes,
                     const std::string& program) {
  std::string text = uff_block(151, line_80(title) + line_80("written by chladni") +
                                        line_80(program) + "\n" + "\n" + line_80(program) + "\n");
  text += uff_block(164, fmt::format("{:10}{:<20}{:10}\n", 1, "SI: metre, newton", 2) + in_25(1.0) +
                             in_25(1.0) + in_25(1.0) + "\n" + in_25(273.15) + "\n");
  if (nodes.empty()) return text;
  std::string places;
  for (const auto& [label, place] : nodes) {
    places += fmt::format("{:10}{:10}{:10}{:10}\n", label, 0, 0, 11) + in_25(place.x()) +
              in_25(place.y()) + in_25(place.z()) + "\n";
  }
  return text + uff_block(2411, places);
}

}  // namespace chladni::io
