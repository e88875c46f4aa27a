// One cause as changes of a study's text.
#pragma once

#include <string>
#include <string_view>

#include "app/study/study.h"
#include "app/study/toml/toml_edit.h"
#include "diagnosis/diagnosed.h"

namespace chladni::app {

/// A study's document that is to say a cause.
struct Extension {
  TomlEdit& edit;
  const Study& study;               ///< what the document says now
  const diagnosis::Surface& chart;  ///< of the cause's u and v
  const diagnosis::Cause& cause;
  bool fits_variations = true;  ///< the chart's axes are those of [[variation]]

  /// A number that was fitted, or that the cause's option fixes.
  /// @throws InvalidInput  the cause has no number of that name
  [[nodiscard]] double number(std::string_view name) const;
  [[nodiscard]] bool has(std::string_view name) const;
  /// "diagnosis: point_mass: mass = 0.2 ± 0.001 kg, ...; probability 0.99", and what stood there.
  [[nodiscard]] std::string comment(std::string_view before = {}) const;
};

/// Makes the changes. @returns  empty, or why no key of a study can say it; then what is half made
/// is to be thrown away
using Extend = std::string (*)(const Extension& by);

/// None where no entry of the table is for that effect.
[[nodiscard]] Extend extend(std::string_view effect);

// Parts of the table.
[[nodiscard]] Extend extend_body(std::string_view effect);
[[nodiscard]] Extend extend_channels(std::string_view effect);
[[nodiscard]] Extend extend_attachments(std::string_view effect);

/// A quantity as a study writes it, times a factor: "70 GPa" by 1.02 is "71.4 GPa". Of an array,
/// each of its values. @throws InvalidInput  it does not begin with a number
void scale(const Extension& by, const TomlNode& value, double factor);
/// The same with so many metres more.
void lengthen(const Extension& by, const TomlNode& value, double metres);

/// Whether the chart is x and y of the body's frame.
[[nodiscard]] bool looks_down(const Extension& by);
/// `at` of the cause's u and v: seen from above where the chart looks down, else the nearest point.
[[nodiscard]] std::string place(const Extension& by);
/// `at` as a study writes it.
[[nodiscard]] std::string place(const Place& at);

/// Nine digits, enough for any number that was measured.
[[nodiscard]] std::string digits(double number);

}  // namespace chladni::app
