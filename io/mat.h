// MATLAB's .mat files: read in a worker, written as version 5.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace chladni::io {

class MatValue;
using MatFields = std::vector<std::pair<std::string, MatValue>>;  ///< in the file's order

/// A value of a variable, cell or field.
class MatValue {
 public:
  enum class Kind { number, text, cell, structure, other };

  MatValue() = default;
  MatValue(double number);
  MatValue(const Eigen::MatrixXd& matrix);
  MatValue(const Eigen::MatrixXcd& matrix);
  MatValue(std::string text);
  /// A cell column of texts.
  MatValue(const std::vector<std::string>& texts);
  /// Numbers of more than two dimensions, the first running fastest.
  MatValue(std::vector<Eigen::Index> dims, Eigen::VectorXd real, Eigen::VectorXd imag = {});

  Kind kind = Kind::other;
  std::vector<Eigen::Index> dims;     ///< two or more
  Eigen::VectorXd real, imag;         ///< of numbers: all of them; imag empty where they are real
  std::vector<std::string> text;      ///< of a text: its rows
  std::vector<MatValue> cells;        ///< of a cell array, the first dimension running fastest
  MatFields fields;                   ///< of one structure; arrays of them are `other`
  std::string class_name = "double";  ///< MATLAB's name of it, for messages

  [[nodiscard]] Eigen::Index size() const;  ///< product of the dims
};

struct MatFile {
  std::string format;  ///< "MAT 4", "MAT 5", "MAT 7.3"
  MatFields variables;
  std::vector<std::string> notes;  ///< what was not read
};

/// All variables of a file of version 4 to 7.3, read by the program chladni-mat with limits:
/// libmatio expands small files without bound. Sizes are looked at before data is read.
/// @param limit_bytes  of all numbers together
/// @throws InvalidInput  no such file, damaged, or larger than the limit
/// @throws WorkerDied    the program chladni-mat is missing
[[nodiscard]] MatFile read_mat(const std::filesystem::path& file, std::size_t limit_bytes);

/// Version 5, uncompressed; the same variables give the same bytes. Whole or not at all.
/// @throws InvalidInput    a name that MATLAB does not take (a letter, then letters, digits and _,
///                         at most 63), a value that is `other`
/// @throws OutOfResources  the file cannot be written
void write_mat(const std::filesystem::path& file, const MatFields& variables);

}  // namespace chladni::io
