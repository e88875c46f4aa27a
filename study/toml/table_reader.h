// Reads one table of a study. Every key that it does not ask for is an error.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "study/problems.h"
#include "study/toml/toml_tree.h"

namespace chladni::study {

/// Allowed values of a number.
enum class Sign { any, positive, not_negative };

/// Errors go to `problems`, and the value is then none (NaN if a number was required), so that
/// reading continues to the next error. Both arguments must outlive it.
class TableReader {
 public:
  /// `path` names the table in messages: "geometry.plate"; empty for the whole file, which `whole`
  /// names.
  TableReader(const TomlNode& table, std::string path, Problems& problems,
              std::string whole = "the study");

  [[nodiscard]] int line() const { return table_.line; }
  [[nodiscard]] const std::string& path() const { return path_; }
  [[nodiscard]] bool has(std::string_view key) const;
  /// The value of `key`, which is known from now on; null if it is missing.
  const TomlNode* find(std::string_view key);

  /// A text with a unit, in SI. A dimensionless one ("1") may be a bare number.
  std::optional<double> quantity(std::string_view key, std::string_view si_unit,
                                 Sign sign = Sign::any);
  double required_quantity(std::string_view key, std::string_view si_unit, Sign sign = Sign::any);
  /// `count` quantities.
  std::optional<Eigen::VectorXd> quantities(std::string_view key, std::string_view si_unit,
                                            Eigen::Index count, Sign sign = Sign::any);
  std::optional<long long> integer(std::string_view key, long long least, long long most);
  std::optional<std::string> text(std::string_view key);
  std::string required_text(std::string_view key);
  std::optional<std::string> choice(std::string_view key, const std::vector<std::string>& names);
  std::optional<bool> truth(std::string_view key);
  std::vector<std::string> texts(std::string_view key);
  std::optional<TableReader> table(std::string_view key);
  /// The tables of [[key]]; none if the key is missing.
  std::vector<TableReader> tables(std::string_view key);
  /// "x", "-z", or three numbers (any length but 0): a unit vector.
  std::optional<Eigen::Vector3d> direction(std::string_view key);

  void missing(std::string_view key, std::string_view expected);
  void wrong(const TomlNode& where, const std::string& message);
  /// The name of a key in messages: "geometry.plate.thickness".
  [[nodiscard]] std::string name(std::string_view key) const;
  /// One number in SI, or NaN and a problem.
  double value_of(const TomlNode& node, const std::string& what, std::string_view si_unit,
                  Sign sign);
  /// Reports every key that nobody asked for, with the nearest known one.
  void refuse_unknown();

 private:
  const TomlNode& table_;
  std::string path_;
  Problems* problems_;
  std::string whole_;
  std::vector<std::string> known_;
};

}  // namespace chladni::study
