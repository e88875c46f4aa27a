// The simulation as the diagnosis sees it: its modes where they were measured, where something may
// hang on it, and what each part of the body adds to stiffness and mass.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace chladni::diagnosis {

/// Motion of the r modes at one place of the surface, along its normal. The slopes are along the
/// chart's axes: a rotation of the material there, for thin bodies.
struct PointMotion {
  Eigen::VectorXd shape;             ///< r [kg^-1/2]
  Eigen::VectorXd slope_u, slope_v;  ///< r [kg^-1/2 m^-1]
  /// u, or empty: φ/ω [kg^-1/2 s] and its slopes of modes far above the band, which yield at once.
  Eigen::VectorXd upper, upper_slope_u, upper_slope_v;
};

/// Channels of one side, c of them.
struct ChannelSide {
  std::vector<std::string> names;
  Eigen::MatrixXd shapes;            ///< c×r, along each channel's direction [kg^-1/2]
  Eigen::MatrixXd slope_u, slope_v;  ///< c×r: how they change when it is moved [kg^-1/2 m^-1]
  Eigen::MatrixXd aside_u, aside_v;  ///< c×r: along the chart's axes instead [kg^-1/2]
  Eigen::MatrixX2d places;           ///< c×2, on the chart [m]
  Eigen::MatrixXd upper;             ///< c×u, or c×0: as PointMotion's

  [[nodiscard]] Eigen::Index count() const { return shapes.rows(); }
};

/// A part of the surface as a map of two coordinates (for a plate: its top, x and y).
struct Surface {
  Eigen::MatrixX2d places;  ///< n×2 [m]: of the scan, evenly spread
  Eigen::VectorXd area;     ///< n [m²]
  Eigen::MatrixXd shapes;   ///< n×r, along the normal
  /// Anywhere on it; none beside it.
  std::function<std::optional<PointMotion>(const Eigen::Vector2d&)> at;
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  ///< [m]: of the chart, in the body's frame
  Eigen::Vector3d axis_u = Eigen::Vector3d::UnitX(), axis_v = Eigen::Vector3d::UnitY();

  /// Maxima of a scan that are nearer to each other, as a part of size(), are one.
  static constexpr double kOnePeak = 0.08;

  [[nodiscard]] Eigen::Index count() const { return places.rows(); }
  /// [m]: the diagonal of what the scan spans.
  [[nodiscard]] double size() const {
    return (places.colwise().maxCoeff() - places.colwise().minCoeff()).norm();
  }
  /// [m], in the body's frame.
  [[nodiscard]] Eigen::Vector3d in_body(const Eigen::Vector2d& place) const {
    return origin + place(0) * axis_u + place(1) * axis_v;
  }
};

/// The body in parts, seen along the normal of the chart: sums of all are diag(ω²) and 1 where
/// nothing is attached.
struct BodyCells {
  Eigen::MatrixX2d centres;                                                        ///< b×2 [m]
  Eigen::Vector2d from = Eigen::Vector2d::Zero(), size = Eigen::Vector2d::Zero();  ///< [m]: box
  Eigen::VectorXd area;                                                            ///< b [m²]
  std::vector<Eigen::MatrixXd> stiffness, mass;  ///< b, each r×r: Φᵀ K_c Φ [s^-2], Φᵀ M_c Φ [1]
  /// Of a body that bends, the parts that go otherwise with its thickness t, b each or none: of the
  /// stiffness (as t³) what resists transverse shear (as t), of the mass (as t) what resists
  /// turning (as t³).
  std::vector<Eigen::MatrixXd> shear, rotary;
  /// To first order what fields that vary smoothly over the body change, r×r for each of
  /// smooth_fields, or none: then the cells, each of one value, tell it.
  struct Waves {
    std::vector<Eigen::MatrixXd> modulus;          ///< of K by E (1 + x f)
    std::vector<Eigen::MatrixXd> bent, thickened;  ///< of K and M by t (1 + x f)
  };
  Waves waves;

  [[nodiscard]] Eigen::Index count() const { return centres.rows(); }
};

/// The stiffness in smaller parts, for what is soft or stiff in one place only. The motion there is
/// not that of the r modes: u modes above them come in too, as ones that yield at once.
struct FineCells {
  Eigen::MatrixX2d centres;                         ///< f×2 [m]
  Eigen::Vector2d pitch = Eigen::Vector2d::Zero();  ///< [m] along u and v; 0: one cell spans it
  /// f, each (r + u)×(r + u): of the r modes as BodyCells', of the first u of ChannelSide::upper.
  std::vector<Eigen::MatrixXd> stiffness;

  [[nodiscard]] Eigen::Index count() const { return centres.rows(); }
};

/// What the stiffness gains, Φᵀ K Φ [s^-2], when one elastic constant of the whole body doubles:
/// along u, along v, between the two, in shear. They sum to diag(ω²) (nearly, for solids).
struct Directional {
  Eigen::MatrixXd along_u, along_v, across, shear;
};

/// A simulation on r modes: rigid-body modes first, flexible ones well beyond the band (two to
/// three times), mass-normalised. The r modes are the coordinates of every hypothesis.
struct Structure {
  Eigen::VectorXd frequency_hz;   ///< r, ascending; rigid-body modes exactly 0
  Eigen::VectorXd damping_ratio;  ///< r
  /// r, or empty for none: how far, relative, mesh and solver may have left each frequency.
  Eigen::VectorXd frequency_error;
  Eigen::MatrixXd dashpots;  ///< r×r Φᵀ C Φ [1/s] of known dampers, beside the ratios; or 0×0
  /// What the study attaches to the body, within diag(ω²) [s^-2] and 1: r×r, or 0×0 for nothing.
  /// What scales the body leaves it as it is.
  Eigen::MatrixXd springs, masses;
  Eigen::Index rigid_count = 0;
  ChannelSide outputs, inputs;  ///< p displacements, q forces
  Eigen::MatrixXd residual;     ///< p×q [m/N]: static flexibility of the modes left out
  Surface surface;
  BodyCells cells;          ///< may be empty: then no cause inside the body is sought
  FineCells fine;           ///< may be empty: then no place inside the body is sought
  Directional directional;  ///< may be empty (0×0): then no orthotropy is sought
  /// (thickness)^power: 3 for bodies that bend; 0: thickness means nothing here.
  double bending_power = 3.0;
  double thickness = 0.0;  ///< [m]; 0: not known
  double mass_kg = 0.0;

  [[nodiscard]] Eigen::Index mode_count() const { return frequency_hz.size(); }
  [[nodiscard]] Eigen::Index output_count() const { return outputs.count(); }
  [[nodiscard]] Eigen::Index input_count() const { return inputs.count(); }
};

/// @throws InvalidInput  arrays do not fit together, an entry is not finite
void check(const Structure& structure);

}  // namespace chladni::diagnosis
