// What all methods share: shapes measured at a few places in, fields over the whole body out.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/arrays.h"

namespace chladni::priors {

/// n places of the body, each with its direction of measurement or prediction.
struct Places {
  Points position;         ///< n×3 [m]
  Points direction;        ///< n×3, unit
  Eigen::MatrixXd shapes;  ///< n×r [kg^-1/2]: the simulation's modes there, along the direction
  Eigen::MatrixXd harmonics = {};  ///< n×h: harmonics of the surface there; may be empty

  [[nodiscard]] Eigen::Index count() const { return position.rows(); }
};

/// The given rows.
[[nodiscard]] Places part(const Places& places, const std::vector<Eigen::Index>& rows);

/// A model that differs from the simulation in its uncertain parameters, on the simulation's modes.
struct SimilarModel {
  Eigen::VectorXd frequency_hz;  ///< r
  Eigen::MatrixXd turn;          ///< r×r: its mass-normalised shapes are Φ · turn
};

/// One possible difference of the real structure from the simulation: the change of stiffness and
/// mass per unit of a parameter, in the simulation's mass-normalised modes.
struct Correction {
  std::string name;
  Eigen::MatrixXd stiffness;  ///< r×r, symmetric [s^-2]; empty: nothing
  Eigen::MatrixXd mass;       ///< r×r, symmetric [1]; empty: nothing
  double deviation = 0.0;     ///< prior deviation of the parameter about 0
};

/// The data of a simulation: r mass-normalised modes, rigid-body modes first, at N points that
/// represent the surface where the shapes are predicted.
struct Simulation {
  Eigen::VectorXd frequency_hz;              ///< r, ascending; rigid-body modes exactly 0
  Places surface;                            ///< N
  Eigen::VectorXd area;                      ///< N [m²]: the area of each point
  std::vector<SimilarModel> similar;         ///< may be empty
  std::vector<Correction> corrections = {};  ///< may be empty
  Eigen::VectorXd harmonic_eigenvalue = {};  ///< h [1/m²], for Places::harmonics; may be empty

  [[nodiscard]] Eigen::Index mode_count() const { return frequency_hz.size(); }
  [[nodiscard]] Eigen::Index rigid_count() const { return (frequency_hz.array() == 0.0).count(); }
};

/// The two sides of a modal model: sensors and, by reciprocity, actuators. With the true shape φ
/// and an error δ of the scale between both sides, the value is φ e^δ at a sensor and φ e^−δ at an
/// actuator. The shapes of all modes are mass-normalised up to one common factor.
struct BothSides {
  std::vector<bool> actuator;     ///< s
  Eigen::VectorXd log_deviation;  ///< m: prior standard deviation of δ
  Eigen::MatrixXd noise;          ///< s×m: standard deviations, without the error of the scale
};

/// m shapes measured at s places. All values of a shape have one unit, which is free; it is kg^-1/2
/// if the shapes are mass-normalised.
struct MeasuredShapes {
  Places places;
  Eigen::VectorXd frequency_hz;         ///< m, identified
  Eigen::MatrixXd values;               ///< s×m
  Eigen::MatrixXd noise;                ///< s×m: standard deviation of each value, in its unit
  std::optional<BothSides> sides = {};  ///< of a modal model

  [[nodiscard]] Eigen::Index mode_count() const { return frequency_hz.size(); }
};

/// Shapes at n places.
struct Field {
  Eigen::MatrixXd mean;       ///< n×m, in the unit of the measured values
  Eigen::MatrixXd deviation;  ///< n×m: standard deviation; NaN if a method gives none
};

/// Results of a fit, per mode and in total.
struct FitSummary {
  /// One learned quantity: name, unit, and one value per mode (or one for all).
  struct Parameter {
    std::string name, unit;
    Eigen::VectorXd value;
    bool at_bound = false;  ///< some value is at the end of its range
  };
  std::vector<Parameter> parameters;
  Eigen::VectorXd log_evidence;    ///< m, or empty: natural logarithm of the density of the values
  std::vector<std::string> notes;  ///< facts for the user: bounds, rank, doubts about the model
  /// The deviations contain the error of the scale between sensors and actuators (BothSides); the
  /// field is then that of the sensors' side.
  bool includes_scale = false;
};

struct Interpolator;

/// m mode shapes on the whole body with their uncertainty.
class ModeField {
 public:
  friend std::unique_ptr<ModeField> mode_field(const Interpolator& method,
                                               const MeasuredShapes& measured,
                                               const Simulation& simulation);
  virtual ~ModeField() = default;
  ModeField(const ModeField&) = delete;
  ModeField& operator=(const ModeField&) = delete;

  /// @throws InvalidInput  `places` lacks what the method needs (shapes, a common direction), its
  ///                       arrays have unequal rows or hold a number that is not finite
  [[nodiscard]] Field at(const Places& places) const;
  [[nodiscard]] const FitSummary& summary() const { return summary_; }

 protected:
  explicit ModeField(FitSummary summary) : summary_(std::move(summary)) {}

 private:
  [[nodiscard]] virtual Field field_at(const Places& places) const = 0;

  FitSummary summary_;
};

/// A method of interpolation. A new one needs a file with one of these and a line
/// in interpolators().
struct Interpolator {
  const char* name;     ///< in a study: "dynamic_residual"
  const char* summary;  ///< one line
  const char* source;   ///< its publication
  bool uses_modes;      ///< needs Places::shapes
  bool has_deviation;   ///< gives a standard deviation
  std::unique_ptr<ModeField> (*fit)(const MeasuredShapes&, const Simulation&);
};

/// All methods, the default first.
[[nodiscard]] std::span<const Interpolator* const> interpolators();

/// @throws InvalidInput  no method has this name; the message lists the names
[[nodiscard]] const Interpolator& interpolator(const std::string& name);

/// Fits after the checks that every method needs.
/// @throws InvalidInput      fewer than three places, arrays that do not fit each other, a value or
///                           frequency that is not finite, noise that is not positive, places at
///                           one point whose values differ by more than 8 deviations of the noise
///                           and not by one gain of up to 10 % (which widens the noise of both)
/// @throws NumericalFailure  the method failed; says at which mode
[[nodiscard]] std::unique_ptr<ModeField> mode_field(const Interpolator& method,
                                                    const MeasuredShapes& measured,
                                                    const Simulation& simulation);

/// Deviations on each side of the mean that contain 95 % of a normal distribution.
inline constexpr double kTwoSided95 = 1.959963984540054;
/// Unknown part of a shape's mean square above which a note is given.
inline constexpr double kHardlySeen = 0.3;

/// Error of a field against the truth on the simulation's surface, per mode: Σ w (φ̂−φ)² / Σ w φ²
/// (thesis, figure 5.12), w the area. @param mean, truth  N×m
[[nodiscard]] Eigen::VectorXd squared_error(const Eigen::MatrixXd& mean,
                                            const Eigen::MatrixXd& truth,
                                            const Eigen::VectorXd& area);

/// Part of the surface, per mode, where the truth lies within ±1.96 deviations; NaN where the field
/// has none. @param truth  N×m
/// @param area   N [m²]; what is 0 does not count
[[nodiscard]] Eigen::VectorXd coverage(const Field& field, const Eigen::MatrixXd& truth,
                                       const Eigen::VectorXd& area);

}  // namespace chladni::priors
