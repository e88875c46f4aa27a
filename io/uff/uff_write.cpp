// Writes universal files.
#include <fmt/format.h>

#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>

#include "base/error.h"
#include "io/scan.h"
#include "io/uff/uff.h"

namespace chladni::io {
namespace {

constexpr const char* kDelimiter = "    -1\n";

// A number in 13 columns with a blank before it, with all its digits if they fit.
std::string in_13(double value) {
  std::array<char, 40> buffer;
  auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr;
  std::string digits(buffer.data(), end);
  if (digits.find_first_of(".e") == std::string_view::npos) digits += '.';
  for (int most = 11; digits.size() > 12 && most > 3; --most) {
    end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value,
                        std::chars_format::general, most)
              .ptr;
    digits.assign(buffer.data(), end);
    if (digits.find_first_of(".e") == std::string_view::npos) digits += '.';
  }
  return fmt::format("{:>13}", digits);
}

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

std::string line_80(const std::string& words) {
  std::string line = words.empty() ? "NONE" : words.substr(0, 80);
  for (char& c : line) c = c < ' ' ? ' ' : c;
  return line + "\n";
}

std::string degree(const UffDof& dof) {
  const std::string entity = dof.entity.empty() ? "NONE" : dof.entity.substr(0, 10);
  return fmt::format(" {:<10}{:10}{:4}", entity, dof.node, dof.direction);
}

std::string axis_line(const UffAxis& axis) {
  const auto word = [](const std::string& text) {
    return text.empty() ? std::string("NONE") : text;
  };
  return fmt::format("{:10}{:5}{:5}{:5} {:<20} {:<20}\n", axis.type, axis.length_exponent,
                     axis.force_exponent, 0, word(axis.label).substr(0, 20),
                     word(axis.unit).substr(0, 20));
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
  if (!binary)
    return kDelimiter + std::string("    58\n") + head + text_values(function, even) + kDelimiter;
  const std::string values = binary_values(function, even);
  constexpr int order = std::endian::native == std::endian::big ? 2 : 1;
  return kDelimiter +
         fmt::format("    58b{:6}{:6}{:12}{:12}{:6}{:6}{:12}{:12}\n", order, 2, 11, values.size(),
                     0, 0, 0, 0) +
         head + values + "\n" + kDelimiter;
}

std::string uff_head(const std::string& title, const std::map<long long, Eigen::Vector3d>& nodes) {
  std::string text = kDelimiter + std::string("   151\n") + line_80(title);
  text +=
      line_80("written by chladni") + line_80("") + "\n" + line_80("chladni") + "\n\n" + kDelimiter;
  text += kDelimiter + std::string("   164\n");
  text += fmt::format("{:10}{:<20}{:10}\n", 1, "SI: metre, newton", 2);
  text += fmt::format("{:25.17E}{:25.17E}{:25.17E}\n{:25.17E}\n", 1.0, 1.0, 1.0, 273.15);
  text += kDelimiter;
  if (nodes.empty()) return text;
  text += kDelimiter + std::string("  2411\n");
  for (const auto& [label, place] : nodes) {
    text += fmt::format("{:10}{:10}{:10}{:10}\n{:25.16E}{:25.16E}{:25.16E}\n", label, 0, 0, 11,
                        place.x(), place.y(), place.z());
  }
  return text + kDelimiter;
}

}  // namespace chladni::io
