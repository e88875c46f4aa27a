// The content of the datasets of universal files (UFF, UNV), before its interpretation.
#pragma once

#include <Eigen/Core>
#include <array>
#include <complex>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/bytes/room.h"

namespace chladni::io {

/// Dataset 164: SI units per unit of the file.
struct UffUnits {
  std::string description;
  double length = 1.0, force = 1.0;
};

/// A node with a direction: ±1 x, ±2 y, ±3 z, ±4 to ±6 rotations about x, y, z, 0 a scalar.
struct UffDof {
  std::string entity;  ///< empty where the file says NONE
  long long node = 0;
  int direction = 0;
};

/// The quantity along an axis. Types: 8 displacement, 11 velocity, 12 acceleration, 9 or 13 force,
/// 17 time, 18 frequency, 0 unknown.
struct UffAxis {
  int type = 0;
  int length_exponent = 0, force_exponent = 0;
  std::string label, unit;  ///< empty where the file says NONE
};

/// Dataset 58, ASCII or binary.
struct UffFunction {
  std::size_t line = 0;  ///< line of the file where it begins
  bool binary = false;
  std::array<std::string, 5> id;
  int type = 0;  ///< 1 time response, 2 auto spectrum, 4 FRF, 6 coherence, ...
  long long version = 0, load_case = 0;
  UffDof response, reference;
  UffAxis abscissa, ordinate, denominator;
  bool is_complex = false;
  Eigen::VectorXd x;              ///< n, as in the file
  Eigen::VectorXcd y;             ///< n
  std::optional<UffUnits> units;  ///< from the dataset 164 that is valid here
};

/// Dataset 55 or 2414: a mode shape at nodes.
struct UffShape {
  int dataset = 55;
  std::size_t line = 0;
  std::array<std::string, 5> id;
  int analysis = 0;  ///< 2 normal modes, 3 and 7 complex eigenvalues
  int type = 0;      ///< as in UffAxis
  double frequency_hz = 0.0, damping_ratio = 0.0, modal_mass = 0.0;
  std::complex<double> eigenvalue;  ///< [rad/s] of complex eigenvalues
  std::vector<long long> nodes;     ///< n
  Eigen::MatrixXcd values;          ///< n×3 or n×6
};

/// Datasets 18 and 2420: a coordinate system. It is given by three points, one per column, in the
/// system `reference` (0: the global system): its origin, a point on its x axis and a point in its
/// xz plane.
struct UffSystem {
  int type = 0;  ///< 0 Cartesian, 1 cylindrical, 2 spherical
  long long reference = 0;
  Eigen::Matrix3d points = Eigen::Matrix3d::Zero();
  std::string fault;  ///< the reason why it cannot be used; empty: it can be used
};

using UffSystems = std::map<long long, UffSystem>;  ///< by number

/// The systems of a node's place and of its displacements; 0: the global system.
struct UffNodeSystems {
  long long place = 0, displacement = 0;
};

struct Uff {
  std::optional<std::string> title;                  ///< dataset 151: the model's name
  std::optional<UffUnits> units;                     ///< the first dataset 164
  std::map<long long, Eigen::Vector3d> nodes;        ///< 15, 781, 2411; as in the file
  std::map<long long, UffNodeSystems> node_systems;  ///< where they are not the global system
  UffSystems systems;
  bool defines_systems = false;  ///< there is a dataset 18 or 2420, readable or not
  std::vector<UffFunction> functions;
  std::vector<UffShape> shapes;
  std::vector<std::vector<long long>> trace_lines;  ///< 82: nodes; a 0 lifts the pen
  std::vector<std::vector<long long>> elements;     ///< 2412: nodes of each
  std::vector<std::string> notes;
};

using UffVisitor = std::function<void(UffFunction& function)>;

/// Reads datasets 15, 18, 55, 58, 58b, 82, 151, 164, 781, 2411, 2412, 2414 and 2420; other datasets
/// are noted. It accepts Fortran's D exponents, numbers without blanks between them, blank lines,
/// line ends of any kind, line feeds before and after binary data, either byte order in each
/// dataset, and a missing last -1. No length is trusted. Cost: linear; memory is a multiple of the
/// bytes for any content.
/// @throws InvalidInput  names the file, the dataset, the line (and byte), what was found and what
///                       was expected
/// @param limit  limit of the memory for all functions [bytes]
/// @param visit  called with each function when it is read; it may take x and y away, and then one
///               function at a time needs memory
[[nodiscard]] Uff parse_uff(std::string_view bytes, const std::string& name,
                            std::size_t limit = reading_limit(), const UffVisitor& visit = {});

enum class UffEncoding { text, binary };

/// The dataset of a function, with its lines of -1, in double precision.
[[nodiscard]] std::string uff_dataset(const UffFunction& function, UffEncoding encoding);
/// Datasets 151, 164 (SI) and, where there are nodes [m], 2411.
/// @param program  with its version, which made the file
[[nodiscard]] std::string uff_head(const std::string& title,
                                   const std::map<long long, Eigen::Vector3d>& nodes,
                                   const std::string& program = "chladni");

}  // namespace chladni::io
