// Reads one table of a study: what it asks for is known, what else stands there is a fault.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "app/study/toml/problems.h"
#include "app/study/toml/toml_tree.h"

namespace chladni::app {

/// Which values a number may have.
enum class Sign { any, positive, not_negative };

/// Faults go to `problems` and the value comes back as none (NaN where a number was required), so
/// that reading goes on and finds the next one. Both arguments must outlive it.
class TableReader {
 public:
  /// `path` names the table in messages: "geometry.plate"; empty for the whole file.
  TableReader(const TomlNode& table, std::string path, Problems& problems);

  [[nodiscard]] int line() const { return table_.line; }
  [[nodiscard]] const std::string& path() const { return path_; }
  [[nodiscard]] bool has(std::string_view key) const;
  /// The value of `key`, which is known from now on; null where it is not there.
  const TomlNode* find(std::string_view key);

  /// A text with a unit, in SI. A dimensionless one ("1") may be a bare number.
  std::optional<double> quantity(std::string_view key, std::string_view si_unit,
                                 Sign sign = Sign::any);
  double required_quantity(std::string_view key, std::string_view si_unit, Sign sign = Sign::any);
  /// `count` of them.
  std::optional<Eigen::VectorXd> quantities(std::string_view key, std::string_view si_unit,
                                            Eigen::Index count, Sign sign = Sign::any);
  std::optional<long long> integer(std::string_view key, long long least, long long most);
  std::optional<std::string> text(std::string_view key);
  std::string required_text(std::string_view key);
  std::optional<std::string> choice(std::string_view key, const std::vector<std::string>& names);
  std::optional<bool> truth(std::string_view key);
  std::vector<std::string> texts(std::string_view key);
  std::optional<TableReader> table(std::string_view key);
  /// The tables of [[key]]; none where it is not there.
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
  /// Every key that nobody asked for is a problem, with the nearest known one.
  void refuse_unknown();

 private:
  const TomlNode& table_;
  std::string path_;
  Problems* problems_;
  std::vector<std::string> known_;
};

}  // namespace chladni::app
