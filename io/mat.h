// MATLAB's .mat files. A worker reads them; they are written as version 5 or 7.3.
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
  /// `large`: numbers that were left in the file.
  enum class Kind { number, large, text, cell, structure, structures, other };

  MatValue() = default;
  MatValue(double number);
  MatValue(const Eigen::MatrixXd& matrix);
  MatValue(const Eigen::MatrixXcd& matrix);
  MatValue(std::string text);
  /// A cell column of texts.
  MatValue(const std::vector<std::string>& texts);
  /// Numbers of more than two dimensions, with the first dimension fastest.
  MatValue(std::vector<Eigen::Index> dims, Eigen::VectorXd real, Eigen::VectorXd imag = {});

  Kind kind = Kind::other;
  std::vector<Eigen::Index> dims;  ///< two or more
  Eigen::VectorXd real, imag;      ///< all numbers; imag is empty where they are real
  std::vector<std::string> text;   ///< rows of a text
  std::vector<MatValue> cells;     ///< of an array of cells or structures, first dimension fastest
  MatFields fields;                ///< of one structure
  std::string class_name = "double";  ///< MATLAB's name of the class, for messages

  [[nodiscard]] Eigen::Index size() const;  ///< product of the dims
};

/// Version of a file that is written. 7.3 is HDF5: it holds variables of 2 GB and more, and Julia,
/// Octave and libraries of HDF5 read it. The time of writing is part of its bytes.
enum class MatVersion { mat_5, mat_7_3 };

struct MatFile {
  std::string format;  ///< "MAT 4", "MAT 5", "MAT 7.3"
  MatFields variables;
  std::vector<std::string> notes;  ///< parts that were not read
};

/// All variables of a file of version 4 to 7.3. The program chladni-mat reads the file with limits,
/// because libmatio expands small files without bound. It checks sizes before it reads data.
/// @param limit_bytes  of all numbers together
/// @throws InvalidInput  the file does not exist, is damaged, or is larger than the limit
/// @throws WorkerDied    the program chladni-mat is missing
[[nodiscard]] MatFile read_mat(const std::filesystem::path& file, std::size_t limit_bytes);

/// The version that holds these variables: 5, or 7.3 where one has more than 2 GB.
[[nodiscard]] MatVersion mat_version_for(const MatFields& variables);

/// Writes the file, uncompressed, whole or not at all. In version 5 the same variables give the
/// same bytes. Variables that are too large for version 5 are written as 7.3 in any case.
/// @throws InvalidInput    a name that MATLAB does not take (a letter, then letters, digits and _,
///                         at most 63), a value that is `other`
/// @throws OutOfResources  the file cannot be written
void write_mat(const std::filesystem::path& file, const MatFields& variables,
               MatVersion version = MatVersion::mat_5);

}  // namespace chladni::io
