// The simulation in the form that a diagnosis uses: modes at the channels, places where a cause may
// be attached, and the contribution of each part of the body to stiffness and mass.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace chladni::diagnosis {

/// Motion of the r modes at one place of the surface, along its normal and aside. The slopes of the
/// first are along the axes of the chart; for thin bodies they are rotations of the material.
struct PointMotion {
  Eigen::VectorXd shape;             ///< r [kg^-1/2]
  Eigen::VectorXd slope_u, slope_v;  ///< r [kg^-1/2 m^-1]
  /// u, or empty: φ/ω [kg^-1/2 s] and its slopes for modes far above the band, which yield
  /// statically.
  Eigen::VectorXd upper, upper_slope_u, upper_slope_v;
  /// r×2 [kg^-1/2] and u×2: the same along the axes of the chart, or empty (Surface::directions).
  Eigen::MatrixXd aside = Eigen::MatrixXd(0, 2), upper_aside = Eigen::MatrixXd(0, 2);
};

/// The c channels of one side.
struct ChannelSide {
  std::vector<std::string> names;
  Eigen::MatrixXd shapes;            ///< c×r, along each channel's direction [kg^-1/2]
  Eigen::MatrixXd slope_u, slope_v;  ///< c×r: change when the channel moves [kg^-1/2 m^-1]
  /// c×r: shapes along the chart's axes instead [kg^-1/2]. 0 for a channel that does not lie along
  /// the chart's normal: a turn towards an axis is no tilt there.
  Eigen::MatrixXd aside_u, aside_v;
  Eigen::MatrixX2d places;  ///< c×2, on the chart [m]
  Eigen::MatrixXd upper;    ///< c×u, or c×0: as PointMotion::upper
  /// c×3, of norm 1, along u, v and the normal of the chart; 0×3: all along the normal.
  Eigen::MatrixX3d directions = Eigen::MatrixX3d(0, 3);

  [[nodiscard]] Eigen::Index count() const { return shapes.rows(); }
};

/// The side with these of its channels, in this order.
[[nodiscard]] ChannelSide part_of(const ChannelSide& side, const std::vector<Eigen::Index>& rows);

/// A part of the surface with two coordinates (for a plate: its top, x and y).
struct Surface {
  Eigen::MatrixX2d places;  ///< n×2 [m]: places of the scan, evenly spread
  Eigen::VectorXd area;     ///< n [m²]
  Eigen::MatrixXd shapes;   ///< n×r, along the normal
  /// 3: the motion of a place has its parts aside; 1: it is along the normal alone.
  Eigen::Index directions = 1;
  /// The motion at any place on it; none for a place outside it.
  std::function<std::optional<PointMotion>(const Eigen::Vector2d&)> at;
  /// Whether `at` has a motion there, where that is cheaper to tell; or none.
  std::function<bool(const Eigen::Vector2d&)> has_place;
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  ///< [m]: of the chart, in the body's frame
  Eigen::Vector3d axis_u = Eigen::Vector3d::UnitX(), axis_v = Eigen::Vector3d::UnitY();

  /// Maxima of a scan count as one if their distance is below this part of size().
  static constexpr double kOnePeak = 0.08;

  [[nodiscard]] Eigen::Index count() const { return places.rows(); }
  /// Whether a place is on it.
  [[nodiscard]] bool holds(const Eigen::Vector2d& place) const {
    return has_place ? has_place(place) : at(place).has_value();
  }
  /// [m]: diagonal of the box around the places of the scan.
  [[nodiscard]] double size() const {
    return (places.colwise().maxCoeff() - places.colwise().minCoeff()).norm();
  }
  /// The position of a place [m], in the body's frame.
  [[nodiscard]] Eigen::Vector3d in_body(const Eigen::Vector2d& place) const {
    return origin + place(0) * axis_u + place(1) * axis_v;
  }
};

/// About so many places of the scan, evenly spread.
[[nodiscard]] std::vector<Eigen::Index> spread_places(const Surface& surface, Eigen::Index about);

/// The body in parts, seen along the normal of the chart. If nothing is attached, the sums over all
/// cells are diag(ω²) for stiffness and 1 for mass.
struct BodyCells {
  Eigen::MatrixX2d centres;                                                        ///< b×2 [m]
  Eigen::Vector2d from = Eigen::Vector2d::Zero(), size = Eigen::Vector2d::Zero();  ///< [m]: box
  Eigen::VectorXd area;                                                            ///< b [m²]
  std::vector<Eigen::MatrixXd> stiffness, mass;  ///< b, each r×r: Φᵀ K_c Φ [s^-2], Φᵀ M_c Φ [1]
  /// For a body that bends: the parts with another power of the thickness t, b each or none. The
  /// part of the stiffness (t³) that resists transverse shear goes as t. The part of the mass (t)
  /// that resists rotation goes as t³.
  std::vector<Eigen::MatrixXd> shear, rotary;
  /// First-order changes by fields that vary smoothly over the body, r×r for each of smooth_fields.
  /// If empty, the cells are used, each with one value.
  struct Waves {
    std::vector<Eigen::MatrixXd> modulus;          ///< of K by E (1 + x f)
    std::vector<Eigen::MatrixXd> bent, thickened;  ///< of K and M by t (1 + x f)
  };
  Waves waves;

  [[nodiscard]] Eigen::Index count() const { return centres.rows(); }
};

/// The stiffness in smaller parts, for a body that is soft or stiff in one place only. The r modes
/// alone cannot describe the motion there. So u modes above them are included; these yield
/// statically.
struct FineCells {
  Eigen::MatrixX2d centres;                         ///< f×2 [m]
  Eigen::Vector2d pitch = Eigen::Vector2d::Zero();  ///< [m] along u and v; 0: one cell spans it
  /// f, each (r + u)×(r + u): the r modes as in BodyCells, then the first u of ChannelSide::upper.
  std::vector<Eigen::MatrixXd> stiffness;

  [[nodiscard]] Eigen::Index count() const { return centres.rows(); }
};

/// Increase of the stiffness, Φᵀ K Φ [s^-2], when one elastic constant of the whole body doubles:
/// along u, along v, between the two, in shear. They sum to diag(ω²) (nearly, for solids).
struct Directional {
  Eigen::MatrixXd along_u, along_v, across, shear;
};

/// Springs, masses or dashpots of the study as n linear forms on the modes, on the body as drawn
/// and on smaller and larger ones. Their matrix is the sum of squares, rowsᵀ rows, so it is not
/// negative on a body of any size.
struct GrownForms {
  Eigen::MatrixXd rows;                          ///< n×r: springs [s^-1], masses [1], dashpots
  Eigen::VectorXd steps;                         ///< m, above 0 and ascending: see `at`
  std::vector<Eigen::MatrixXd> smaller, larger;  ///< m: n×r for 1 - 1/λ = -step and step

  [[nodiscard]] Eigen::Index count() const { return rows.rows(); }
  /// n×r on a body that is λ times as large, by = 1 - 1/λ: the polynomial through the rows of that
  /// side. Beyond the last step they stay.
  [[nodiscard]] Eigen::MatrixXd at(double by) const;
  /// r×r: what the matrix gains there.
  [[nodiscard]] Eigen::MatrixXd gain(double by) const;
};

/// What the study attaches to the body, on a body that has grown along u and v about the middle of
/// BodyCells' box. The shapes grow with the body. What is attached keeps its place in space, so it
/// moves on the body, and the body turns less beneath it. The flexibility of the modes above is
/// left out. No rows: none is attached.
struct BeneathAttached {
  GrownForms springs, masses, dashpots;
};

/// A simulation in r modes: rigid-body modes first, then flexible modes to well above the band (two
/// to three times), mass-normalised. The r modes are the coordinates of every hypothesis.
struct Structure {
  Eigen::VectorXd frequency_hz;   ///< r, ascending; rigid-body modes exactly 0
  Eigen::VectorXd damping_ratio;  ///< r
  /// r, or empty for none: relative error of each frequency by mesh and solver.
  Eigen::VectorXd frequency_error;
  Eigen::MatrixXd dashpots;  ///< r×r Φᵀ C Φ [1/s] of known dampers, added to the ratios; or 0×0
  /// Parts that the study attaches to the body, contained in diag(ω²) [s^-2] and 1: r×r, or 0×0 for
  /// none. An effect that scales the body does not change them.
  Eigen::MatrixXd springs, masses;
  /// Springs, masses and dashpots on a larger body; without them they move with it.
  BeneathAttached grown;
  /// r×r, or 0×0 for none [s^-2]: added to diag(ω²), so that the modes are those of a reference.
  Eigen::MatrixXd correction;
  Eigen::Index rigid_count = 0;
  ChannelSide outputs, inputs;  ///< p displacements, q forces
  Eigen::MatrixXd residual;     ///< p×q [m/N]: residual flexibility of the modes above
  Surface surface;
  BodyCells cells;          ///< may be empty: then the search has no cause inside the body
  FineCells fine;           ///< may be empty: then the search has no place inside the body
  Directional directional;  ///< may be empty (0×0): then the search has no orthotropy
  /// (thickness)^power: 3 for bodies that bend; 0: thickness has no meaning here.
  double bending_power = 3.0;
  double thickness = 0.0;  ///< [m]; 0: not known
  double mass_kg = 0.0;

  [[nodiscard]] Eigen::Index mode_count() const { return frequency_hz.size(); }
  [[nodiscard]] Eigen::Index output_count() const { return outputs.count(); }
  [[nodiscard]] Eigen::Index input_count() const { return inputs.count(); }
};

/// c: what each channel of the side sees of a motion along the normal of the chart: the cosine of
/// its direction. A side that states no directions is judged by its shapes, beside those of the
/// nearest place of the scan: −1 where their cosine is below −Constants::against_normal, else 1.
[[nodiscard]] Eigen::VectorXd parts_along_normal(const Structure& structure,
                                                 const ChannelSide& side);

/// @throws InvalidInput  array sizes do not agree, an entry is not finite
void check(const Structure& structure);

}  // namespace chladni::diagnosis
