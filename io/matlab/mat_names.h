// Finds variables of a .mat file by their possible names.
#pragma once

#include <initializer_list>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "io/mat.h"

namespace chladni::io {

/// The value of the first of these names that exists, else of the first one of which there is a
/// name that differs in the case of letters; null where none exists.
[[nodiscard]] const MatValue* mat_value(const MatFields& fields,
                                        std::initializer_list<std::string_view> names);

/// Whether it is there and is an array of numbers, in memory or left in the file.
[[nodiscard]] bool has_numbers(const MatValue* value);

/// Notes the variables that are neither among the values that were read nor called by one of these
/// names.
void note_unread(const MatFields& fields, const std::set<const MatValue*>& read,
                 const std::set<std::string>& names, std::vector<std::string>& notes);

/// Variables that are looked up by name, and those that are left.
class MatLookup {
 public:
  /// The fields must live longer.
  explicit MatLookup(const MatFields& fields) : fields_(fields) {}

  /// As `mat_value`; what is found counts as read.
  const MatValue* find(std::initializer_list<std::string_view> names);
  void count_as_read(const MatValue* value) { read_.insert(value); }
  /// As `note_unread`.
  void note_rest(const std::set<std::string>& names, std::vector<std::string>& notes) const;

 private:
  const MatFields& fields_;
  std::set<const MatValue*> read_;
};

/// All numbers of the value; empty where the value is null.
/// @throws InvalidInput  the value has no numbers
[[nodiscard]] Eigen::VectorXd mat_numbers(const MatValue* value, std::string_view what);

/// The number; none where the value is null or empty. @throws InvalidInput  as `mat_numbers`, or it
/// is several numbers
[[nodiscard]] std::optional<double> mat_number(const MatValue* value, std::string_view what);

/// The texts of a cell array, or the rows of a char array without trailing blanks; empty where the
/// value is null. @throws InvalidInput  the value is neither
[[nodiscard]] std::vector<std::string> mat_texts(const MatValue* value, std::string_view what);

/// The size of the value as text: "8000 x 3 x 3".
[[nodiscard]] std::string mat_size(const MatValue& value);

}  // namespace chladni::io
