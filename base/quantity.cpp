#include "base/quantity.h"

#include <udunits2.h>

#include <array>
#include <charconv>
#include <cmath>
#include <memory>
#include <mutex>
#include <vector>

#include "base/error.h"

namespace chladni {
namespace {

struct FreeUnit {
  void operator()(ut_unit* unit) const { ut_free(unit); }
};
using Unit = std::unique_ptr<ut_unit, FreeUnit>;
struct FreeConverter {
  void operator()(cv_converter* converter) const { cv_free(converter); }
};
using Converter = std::unique_ptr<cv_converter, FreeConverter>;

constexpr std::size_t kLongestUnit = 64;
// More than the library needs for a unit. Where it gets none, its scanner ends the process.
constexpr std::size_t kRoom = std::size_t{64} << 10U;

// The usual name of a dimension, and an example.
struct Kind {
  const char* si_unit;
  const char* noun;
  const char* example;
};
constexpr std::array kKinds = {
    Kind{"m", "a length", "20 mm"},
    Kind{"Pa", "a pressure or modulus", "70 GPa"},
    Kind{"kg/m^3", "a density", "2700 kg/m^3"},
    Kind{"kg", "a mass", "0.2 kg"},
    Kind{"Hz", "a frequency", "150 Hz"},
    Kind{"N/m", "a spring stiffness", "1200 N/m"},
    Kind{"N m/rad", "a rotational stiffness", "50 N m/rad"},
    Kind{"N s/m", "a damping", "10 N s/m"},
    Kind{"N m s/rad", "a rotational damping", "0.1 N m s/rad"},
    Kind{"kg m^2", "a moment of inertia", "0.01 kg m^2"},
    Kind{"rad", "an angle", "30 deg"},
    Kind{"1", "a ratio", "2 %"},
    Kind{"s", "a time", "2 s"},
    Kind{"N", "a force", "10 N"},
    Kind{"N m", "a torque", "3 N m"},
    Kind{"m/s", "a velocity", "5 mm/s"},
    Kind{"m/s^2", "an acceleration", "9.81 m/s^2"},
    Kind{"rad/s", "an angular velocity", "3000 rpm"},
    Kind{"m^2", "an area", "4 cm^2"},
    Kind{"m^3", "a volume", "8 cm^3"},
    Kind{"V", "a voltage", "10 V"},
    Kind{"A", "a current", "2 A"},
};

// The database of UDUNITS-2. The library keeps state, so every use holds the lock.
struct Database {
  std::mutex lock;
  ut_system* system = nullptr;

  Database() {
    ut_set_error_message_handler(ut_ignore);  // else the library writes to stderr
    system = ut_read_xml(nullptr);
    if (system == nullptr) {
      throw OutOfResources(
          "the unit database of UDUNITS-2 cannot be read: install the package libudunits2-data, or "
          "set UDUNITS2_XML_PATH to its udunits2.xml");
    }
    const Unit degree(ut_get_unit_by_name(system, "degree"));
    ut_map_name_to_unit("deg", UT_ASCII, degree.get());
  }
};

Database& database() {
  static Database only;
  return only;
}

// @throws std::bad_alloc  the library would have no memory
void require_room() { std::vector<char>().reserve(kRoom); }

Unit parsed(std::string_view text) {
  require_room();
  return Unit(ut_parse(database().system, std::string(text).c_str(), UT_UTF8));
}

// The components of a unit, as UDUNITS-2 shows them to a visitor.
struct Anatomy {
  int angle = 0;       // the power of the radian
  bool other = false;  // whether it contains anything but radians and seconds
  bool plain = true;   // a factor times basic units: no offset, no logarithm, no date
};

ut_status visit_basic(const ut_unit* unit, void* data) {
  auto& anatomy = *static_cast<Anatomy*>(data);
  const char* name = ut_get_name(unit, UT_ASCII);
  const std::string_view called = name == nullptr ? "" : name;
  if (called == "radian") anatomy.angle = 1;
  if (called != "radian" && called != "second") anatomy.other = true;
  return UT_SUCCESS;
}

ut_status visit_product(const ut_unit* /*unit*/, int count, const ut_unit* const* basics,
                        const int* powers, void* data) {
  auto& anatomy = *static_cast<Anatomy*>(data);
  for (int i = 0; i < count; ++i) {
    Anatomy one;
    visit_basic(basics[i], &one);
    anatomy.angle += one.angle * powers[i];
    anatomy.other = anatomy.other || one.other;
  }
  return UT_SUCCESS;
}

ut_status visit_galilean(const ut_unit* /*unit*/, double /*scale*/, const ut_unit* underlying,
                         double origin, void* data);

ut_status visit_timestamp(const ut_unit* /*unit*/, const ut_unit* /*time*/, double /*origin*/,
                          void* data) {
  static_cast<Anatomy*>(data)->plain = false;
  return UT_SUCCESS;
}

ut_status visit_logarithmic(const ut_unit* /*unit*/, double /*base*/, const ut_unit* /*reference*/,
                            void* data) {
  static_cast<Anatomy*>(data)->plain = false;
  return UT_SUCCESS;
}

constexpr ut_visitor kVisitor = {visit_basic, visit_product, visit_galilean, visit_timestamp,
                                 visit_logarithmic};

ut_status visit_galilean(const ut_unit* /*unit*/, double /*scale*/, const ut_unit* underlying,
                         double origin, void* data) {
  if (origin != 0.0) static_cast<Anatomy*>(data)->plain = false;
  return ut_accept_visitor(underlying, &kVisitor, data);
}

Anatomy anatomy_of(const ut_unit* unit) {
  Anatomy anatomy;
  ut_accept_visitor(unit, &kVisitor, &anatomy);
  return anatomy;
}

// Whether the conversion is a factor. UDUNITS-2 also converts reciprocals (2 ms to 500 Hz, a
// compliance to a stiffness), so the test is that twice the value converts to twice the result.
bool is_factor(ut_unit* from, ut_unit* into) {
  const Converter converter(ut_get_converter(from, into));
  const double one = cv_convert_double(converter.get(), 1.0);
  return std::abs(cv_convert_double(converter.get(), 2.0) - 2.0 * one) <= 1e-9 * std::abs(one);
}

// For UDUNITS-2 a radian is 1, so 10 rad/s would count as 10 Hz. Where a unit contains only angle
// and time, the powers of the radian must agree. In other units (N m/rad for N m) the radian does
// not change the factor.
bool converts(ut_unit* from, ut_unit* into) {
  if (ut_are_convertible(from, into) == 0 || !is_factor(from, into)) return false;
  const Anatomy a = anatomy_of(from);
  const Anatomy b = anatomy_of(into);
  return a.angle == b.angle || (a.other && b.other);
}

const Kind* kind_of(ut_unit* unit) {
  for (const auto& kind : kKinds) {
    const Unit known = parsed(kind.si_unit);
    const bool same = known && converts(unit, known.get());
    if (same && anatomy_of(unit).angle == anatomy_of(known.get()).angle) return &kind;
  }
  return nullptr;
}

std::string expected(std::string_view si_unit, ut_unit* into) {
  if (const Kind* kind = kind_of(into)) {
    return std::string("expected ") + kind->noun + " such as \"" + kind->example + "\"";
  }
  return "expected a number and a unit that converts to " + std::string(si_unit);
}

// UDUNITS-2 also reads "3 mm" and "mm 5" as units. Here a second number is a mistake, so a digit
// may only be an exponent or the 1 of "1/s".
bool has_stray_number(std::string_view unit) {
  if (unit.starts_with("1/") || unit == "1") unit.remove_prefix(1);
  for (std::size_t i = 0; i < unit.size(); ++i) {
    const char c = unit[i];
    const bool number = c >= '0' && c <= '9';
    const char before = i == 0 ? ' ' : unit[i - 1];
    if (number && std::string_view(" \t.,*/(").find(before) != std::string_view::npos) return true;
  }
  return false;
}

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view blank = " \t\r\n";
  const auto begin = text.find_first_not_of(blank);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(blank) - begin + 1);
}

// The factor from `unit` (the end of `text`) to `si_unit`, after all checks.
double factor(std::string_view text, std::string_view unit, std::string_view si_unit) {
  const std::scoped_lock guard(database().lock);
  const Unit into = parsed(si_unit);
  require(into != nullptr, "\"" + std::string(si_unit) + "\" is no unit that UDUNITS-2 knows");
  const auto refuse = [&](const std::string& why) {
    throw InvalidInput("\"" + std::string(text) + "\" " + why + "; " +
                       expected(si_unit, into.get()));
  };
  const bool printable = unit.find_first_of(std::string_view("\0\n\r\t", 4)) == unit.npos;
  if (unit.size() > kLongestUnit || !printable) refuse("has a unit that is too long or not text");
  if (unit.starts_with(',')) refuse("has a decimal comma (write 1.5 with a point)");
  if (has_stray_number(unit)) refuse("has more than one number");
  const Unit from = parsed(unit);
  if (!from) refuse("has the unknown unit \"" + std::string(unit) + "\"");
  if (!anatomy_of(from.get()).plain) refuse("has a unit with an offset or a scale of its own");
  if (!converts(from.get(), into.get())) {
    const Kind* kind = kind_of(from.get());
    refuse(kind == nullptr ? "has another dimension" : std::string("is ") + kind->noun);
  }
  const Converter converter(ut_get_converter(from.get(), into.get()));
  return cv_convert_double(converter.get(), 1.0);
}

}  // namespace

double quantity(std::string_view text, std::string_view si_unit) {
  const auto refuse = [&](const char* why) {
    const std::scoped_lock guard(database().lock);
    const Unit into = parsed(si_unit);
    throw InvalidInput("\"" + std::string(text) + "\" " + why + "; " +
                       (into ? expected(si_unit, into.get()) : "expected a number and a unit"));
  };
  std::string_view rest = trimmed(text);
  if (rest.starts_with('+') && !rest.starts_with("+-")) rest.remove_prefix(1);
  double number = 0.0;
  const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), number);
  if (error == std::errc::invalid_argument) refuse("does not start with a number");
  if (error != std::errc{} || !std::isfinite(number)) refuse("is not finite");
  const std::string_view unit = trimmed(rest.substr(static_cast<std::size_t>(end - rest.data())));
  if (unit.empty() && si_unit == "1") return number;
  if (unit.empty()) refuse("has no unit");
  const double value = number * factor(text, unit, si_unit);
  if (!std::isfinite(value)) refuse("is too large");
  return value;
}

double unit_factor(std::string_view unit, std::string_view si_unit) {
  const std::string_view name = trimmed(unit);
  require(!name.empty(),
          "an empty text is no unit; expected one that converts to " + std::string(si_unit));
  return factor(unit, name, si_unit);
}

}  // namespace chladni
