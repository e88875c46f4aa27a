// One cause as changes to a study's text.
#pragma once

#include <string>
#include <string_view>

#include "diagnosis/diagnosed.h"
#include "steps/extend/extended_study.h"
#include "study/study.h"
#include "study/toml_edit.h"

namespace chladni::steps {

/// A study's document and the cause to add.
struct Extension {
  study::TomlEdit& edit;
  const study::Study& study;        ///< the present content of the document
  const diagnosis::Surface& chart;  ///< for the cause's u and v
  const diagnosis::Cause& cause;
  bool fits_variations = true;  ///< the chart's axes are those of [[variation]]
  const DiagnosedOn& on;        ///< what the diagnosis had
  /// Relative growth of the body along x and y by another cause. The place of a cause is one of the
  /// body as drawn, and moves with it.
  double growth = 0.0;

  /// A fitted number of the cause, or one that its option fixes.
  /// @throws InvalidInput  the cause has no number of that name
  [[nodiscard]] double number(std::string_view name) const;
  [[nodiscard]] bool has(std::string_view name) const;
  /// "diagnosis: point_mass: mass = 0.2 ± 0.001 kg, ...; probability 0.99", and the old text.
  [[nodiscard]] std::string comment(std::string_view before = {}) const;
};

/// Makes the changes. @returns  empty, or the reason why no key of a study can express it;
/// incomplete changes must then be discarded
using Extend = std::string (*)(const Extension& by);

/// The changes of the code's own tables, where keys are computed; else those of the effect's
/// record.
[[nodiscard]] Extend extend(std::string_view effect);

/// @throws InvalidInput  no effect has the name of the cause
[[nodiscard]] std::string extend_by_record(const Extension& by);

// Tables of effects whose keys are computed; none if a table has no entry for the effect.
[[nodiscard]] Extend extend_body(std::string_view effect);
[[nodiscard]] Extend extend_channels(std::string_view effect);
[[nodiscard]] Extend extend_attachments(std::string_view effect);
[[nodiscard]] Extend extend_constants(std::string_view effect);

/// Multiplies a quantity in the text by a factor: "70 GPa" by 1.02 is "71.4 GPa". For an array,
/// each of its values; of a number that states how well it is known, its value. @throws
/// InvalidInput  it does not begin with a number
void scale(const Extension& by, const study::TomlNode& value, double factor);
/// Adds `metres` to a quantity in the text.
void lengthen(const Extension& by, const study::TomlNode& value, double metres);

/// True if the chart is x and y of the body's frame.
[[nodiscard]] bool looks_down(const Extension& by);
/// `at` for the cause's u and v, on the body as it has grown: seen from above if the chart looks
/// down, else the point of the body that is seen there along the chart's normal.
[[nodiscard]] std::string place(const Extension& by);
/// `at` in the form that a study uses.
[[nodiscard]] std::string place(const study::Place& at);

/// Nine digits, enough for any measured number.
[[nodiscard]] std::string digits(double number);

}  // namespace chladni::steps
