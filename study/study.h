// A study: the content of one TOML file, checked and in SI units (docs/reference/study.md).
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "diagnosis/calibrated.h"
#include "fem/attachment.h"
#include "fem/material.h"
#include "mesh/bodies.h"
#include "study/diagnosis_plan.h"
#include "study/excitation_plan.h"
#include "study/observer_plan.h"
#include "study/place.h"
#include "study/recording_plan.h"
#include "study/variation_plan.h"

namespace chladni::study {

struct FileGeometry {
  std::filesystem::path file;
  std::string unit;  ///< unit of its numbers; empty for formats that state one
};

struct Geometry {
  std::string kind;  ///< "plate", "beam", "disc", "quadrilateral", "sphere", "wafer_table", "file"
  std::variant<mesh::Plate, mesh::Disc, mesh::Quadrilateral, mesh::Sphere, mesh::WaferTable,
               FileGeometry>
      body;
};

struct StudyMaterial {
  std::string region;    ///< empty: every region without a material of its own
  std::string symmetry;  ///< "isotropic", "cubic" or "orthotropic"
  std::vector<std::pair<std::string, double>> constants;  ///< as given, in SI, for study.json
  fem::Material material;
  bool is_turned = false;  ///< it has an angle or axes of its own
};

struct MeshPlan {
  double edge_length = 0.0;  ///< [m]; 0: from the geometry
  int order = 0;             ///< 1, 2, 3; 0: chosen
  int layers = 0;            ///< through the thickness of a layered mesh; 0: chosen
  int across_ribs = 0;       ///< cells through a rib of a layered table; 0: chosen
  std::string mesher;        ///< "layered" or "tetgen"; empty: chosen
  bool remesh = true;        ///< remesh a file's surface before TetGen
  bool fill_holes = false;   ///< repair = "fill"
};

struct ModesPlan {
  int count = 20;              ///< flexible modes
  double up_to_hz = 0.0;       ///< all modes below this instead; 0: use `count`
  double damping_ratio = 0.0;  ///< of every flexible mode
  std::string
      engine;  ///< what starts the ranks that find them: "mpiexec -n 4"; empty: this process
  /// "x", "y", "z": the body is its own mirror image across them, and its modes are found in parts.
  std::vector<std::string> mirrors;
  std::string uff = "none";  ///< dataset of the shapes in modes.unv: "55" or "2414"
};

/// Attachments of fem/attachment.h before their places on the body are found.
struct AttachmentPlan {
  std::string name, kind;
  Place at;
  double footprint = 0.0;  ///< [m]
  std::variant<fem::PointMass, fem::GroundSpring, fem::GroundTorsionSpring, fem::LinkSpring,
               fem::Resonator>
      what;
  std::optional<Place> to;  ///< the other end of a link
};

struct Channel {
  std::string name;
  Place at;
  Eigen::Vector3d direction;      ///< unit
  std::string quantity;           ///< "displacement", "velocity", "acceleration"; "force"
  std::optional<long long> node;  ///< its number in a UFF file
  // Its path to or from the record: gain e^{−sτ} / (1 + s / ω_c).
  double gain = 1.0;
  double delay = 0.0;        ///< [s]
  double low_pass_hz = 0.0;  ///< ω_c / 2π; 0: none
};

struct LayoutPlan {
  std::string name;
  std::vector<std::string> sensors, actuators;  ///< names of channels
};

struct KeepOut {
  std::string shape;  ///< "box" (from, to), "disc" (from its centre, diameter) or "patch" (name)
  Eigen::Vector2d from = Eigen::Vector2d::Zero(), to = Eigen::Vector2d::Zero();  ///< [m]
  double diameter = 0.0;                                                         ///< [m]
  std::string patch;
  int line = 0, column = 0;  ///< of the study, for messages
};

/// Allowed places: a mounting grid seen from above.
struct GridPlan {
  Eigen::Vector2d pitch = Eigen::Vector2d::Zero();   ///< [m]
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  ///< [m]
  int columns = 0, rows = 0;                         ///< along x and y
};

/// Standard deviations of the uncertain properties: relative and smooth over the body; masses
/// anywhere.
struct UncertaintyPlan {
  double modulus = 0.0, density = 0.0, thickness = 0.0;
  double attached_mass = 0.0;  ///< [kg], each of four
  int members = 32;
  bool worst = true;  ///< true: the worst member counts; false: their mean
};

/// A layout for the observer of [observer]: what it is to know, and of which devices it consists.
struct ObserverLayoutPlan {
  std::vector<KeepOut> region;  ///< where the motion is wanted; empty: points, or all faces
  int sensors = 0, actuators = 0, pairs = 0;  ///< to choose; all 0: sensors, PlacementPlan::sites
  double effort = 0.0;         ///< [m/N]: motion that a force of 1 N is worth; 0: no loop
  double suspension_hz = 1.0;  ///< that holds rigid-body modes
  int line = 0;                ///< of the study, for messages
};

struct PlacementPlan {
  std::vector<int> modes;  ///< flexible ones, counted from 1
  int modes_line = 0, modes_column = 0;
  double up_to_hz = 0.0;  ///< all modes below this instead; 0: use `modes`
  std::string criterion = "weakest_mode";
  std::optional<Eigen::Vector3d> direction;  ///< of the pair; none: by the rule of `faces_of`
  bool along_normal = false;                 ///< the study asks for the surface's normal
  FacePlan on;
  std::vector<KeepOut> keep_out;
  double edge_distance = 0.0;  ///< [m]
  double footprint = 0.0;      ///< [m], diameter
  double spacing = 0.0;        ///< [m] between two devices
  std::optional<GridPlan> grid;
  std::vector<std::string> there;  ///< channels that keep their places
  int pairs = 1;
  double noise = 0.01;                ///< of an identified shape's entry, over the shape's rms
  double frf_noise = 0.0;             ///< [m/N] per line, instead of `noise`
  double resolution_hz = 0.0;         ///< between lines, with frf_noise
  double position_error = 0.0;        ///< [m]
  double frequency_tolerance = 0.01;  ///< closer neighbours count as one group
  std::optional<UncertaintyPlan> uncertainty;
  std::vector<Place> interest;
  int sites = 0;  ///< number to choose; 0: the number of the study's channels' points
  std::string choose_by = "determinant";       ///< or "interpolation_error", "observer"
  std::optional<ObserverLayoutPlan> observer;  ///< always there beside choose_by "observer"
};

struct MeasurementPlan {
  std::filesystem::path frf;         ///< may not exist yet: `simulate` writes it; or empty
  std::filesystem::path time;        ///< recordings that FRFs are estimated from; or empty
  std::filesystem::path validation;  ///< responses or recordings that no fit sees; or empty
  std::filesystem::path shapes;  ///< a table of measured mode shapes (io/shape_table.h); or empty
  std::filesystem::path truth;   ///< a study whose modes stand for measured ones; or empty
  double noise = 0.01;  ///< of a shape's value over its root mean square, if none is stated
  int modes = 0;  ///< flexible modes of `truth` that are measured; 0: those in view, at most 12
  std::filesystem::path modes_file;   ///< measured modes, for a diagnosis; or empty
  std::filesystem::path reference;    ///< modes measured before something changed; or empty
  std::vector<std::string> hold_out;  ///< names of channels that are held out of every fit
  std::string source;       ///< where to get files that do not come with the study; or empty
  double mass = 0.0;        ///< [kg], as scales have it; 0: not weighed
  RecordingPlan recording;  ///< how responses are estimated from `time`
};

/// "; it does not come with the study: SOURCE"; empty if the plan states none.
[[nodiscard]] std::string source_text(const MeasurementPlan& plan);

/// Another specimen of the design that the study is of.
struct SpecimenPlan {
  std::string name;
  std::filesystem::path file;  ///< its study
  std::string group;           ///< specimens that are more alike; or empty
  std::string same_as;         ///< the specimen above that is measured again; or empty
};

/// A virtual experiment (docs/reference/experiments.md).
struct ExperimentPlan {
  std::string structure = "study";  ///< or "rigid_chain", "rigid_chain_with_carried_body"
  double sample_rate_hz = 4096.0;
  int samples = 16384;  ///< of a period
  int periods = 10, realisations = 10, warm_up = 0;
  double amplitude = 1.0;                ///< [N], rms of each force
  double low_hz = 0.0, high_hz = 0.0;    ///< high 0: from the first line to an eighth of the rate
  std::string lines = "all";             ///< "odd", "odd_with_detection"
  std::string inputs = "one_at_a_time";  ///< or "orthogonal"
  double noise = 0.0;                    ///< rms of every sensor, in its SI unit
  double noise_ratio = 0.0;              ///< instead of `noise`: rms over that of the response
  double process_noise = 0.0;            ///< [N], rms on every actuator
  double quantisation = 0.0;             ///< step of every sensor, in its SI unit
  double delay = 0.0;                    ///< [s]
  std::string compensate = "all";        ///< removed from the estimate: "all", "hold", "none"
  double cubic_stiffness = 0.0;          ///< [N/m³], spring to ground
  std::string cubic_sensor, cubic_actuator;  ///< its place: a collocated pair
  std::vector<std::string> controlled;       ///< actuators in the loop; empty: open
  double bandwidth_hz = 0.0;
  bool leaves_time = false;          ///< writes the recordings instead of the responses
  std::filesystem::path excitation;  ///< recordings whose inputs are played instead; or empty
};

/// The fit of a modal model to the measurement.
struct IdentificationPlan {
  double low_hz = 0.0, high_hz = 0.0;  ///< the band; high 0: all lines
  std::string method = "likelihood";   ///< or "thesis"
  std::string damping = "modal";       ///< or "general": complex shapes
  std::string weighting = "variance";  ///< or "inverse_magnitude"
  double cut_off_db = 40.0;            ///< of inverse_magnitude
  double clip_db = 0.0;                ///< of inverse_magnitude: its minima; 0: not clipped
  // For the thesis' method; 0: the least degree that contains the modes.
  int fraction_degree = 0;
  int sanathanan_koerner = 30, levenberg_marquardt = 10, modal_iterations = 10;
  std::optional<double> model_error;  ///< of |G|; none: 0 if the file states variances, else 1 %
  int modes = 0;                      ///< flexible modes; 0: found by the fit
  int rigid_body_modes = -1;          ///< at 0 Hz; −1: found if nothing holds the body
  int suspended_modes = -1;           ///< above 0 Hz, rigid body on springs; −1: found by the fit
  bool delay = true, residual = true;  ///< fitted
  bool cross_validation = true;        ///< of recordings: parts that a fit does not see, in turn
  std::string delay_of = "all";        ///< "sensors" or "actuators": one delay for each of them
  std::string unit;                    ///< of the sensors, if the file states none
  std::vector<std::pair<std::string, std::string>> pairs;  ///< sensor, actuator
  double pairs_within = 1e-3;                              ///< [m]: if no pairs are named
  std::string gain = "tied";                               ///< or "thesis"
  std::string gain_errors = "none";  ///< side with wrong gains: "sensors", "actuators"
  int stabilisation = 0;             ///< highest order of the diagram; 0: none
  std::string uff = "55";            ///< dataset of the shapes in identified.unv: or "2414", "none"
};

/// State spaces for the design and the running of a controller.
struct StateSpacePlan {
  double sample_rate_hz = 0.0;  ///< of the discrete model; 0: that of the experiment, else none
  int states = 0;               ///< after balanced reduction; 0: all
  int pade_order = 0;           ///< of the continuous model's delays; 0: they stay delays
};

/// A point whose motion the study asks for.
struct PointPlan {
  std::string name;
  Place at;
};

struct InterpolationPlan {
  std::vector<std::string> methods;  ///< names; empty: the default and two of the thesis
  FacePlan on;
  std::optional<Eigen::Vector3d> direction;  ///< of the motion; none: by the rule of `faces_of`
  bool along_normal = false;                 ///< the study asks for the surface's normal
  std::vector<PointPlan> points;
  double table_pitch = 0.0;                 ///< [m] of the lookup table; 0: none
  int polynomial_degree = 0;                ///< in x and y; 0: none
  std::string uff = "none";                 ///< dataset in mode_field.unv: "55" or "2414"
  std::string predicted = "predicted.csv";  ///< file of the responses without a sensor
};

/// Hyper-parameters of a Gaussian process that are learned from the modes.
struct PriorsPlan {
  std::string kernel = "squared_exponential";
  bool per_axis = false;  ///< a length scale for each axis
  std::string by = "marginal_likelihood";
  int modes = 0;  ///< flexible ones; 0: the first 12
  int modes_line = 0, modes_column = 0;
  std::vector<int> samples = {25, 50, 100, 200, 400};  ///< ascending
  double noise_ratio = 1e-8;  ///< variance of the noise over that of the prior
  bool learn_noise = false;
  FacePlan on;
  std::optional<Eigen::Vector3d> direction;  ///< none: by the rule of `faces_of`
  bool along_normal = false;                 ///< the study asks for the surface's normal
};

struct Expectation {
  std::string key;   ///< "frequency_3", "mass", ... (docs/reference/study.md)
  std::string unit;  ///< SI
  double value = 0.0;
  double within = 0.0;     ///< half width of the band, in `unit`
  std::string as_written;  ///< "183.8 Hz within 1 %"
  int line = 0;
};

/// A file of data that the study names.
struct DataFile {
  std::string key;  ///< "measurement.frf"
  std::filesystem::path path;
  int line = 0, column = 0;  ///< of the study
};

struct Study {
  std::string title;
  std::string name;            ///< name of the default output folder
  std::filesystem::path file;  ///< as written on the command line
  std::string sha256;          ///< of the file's bytes
  /// The file's. With `extends`, materials by name or arrays of devices that of the whole, without
  /// comments.
  std::string text;
  /// The files of which it is a part: studies that it extends, the nearest first, then the CSV
  /// files of its arrays of devices.
  std::vector<std::filesystem::path> bases;
  std::optional<unsigned> seed;
  Geometry geometry;
  std::vector<StudyMaterial> materials;
  /// Constants that state how well they are known. A diagnosis of modes calibrates them.
  std::vector<diagnosis::CalibratedConstant> constants;
  /// Length, width and mass that state a deviation: compared between specimens.
  std::vector<diagnosis::CalibratedConstant> sheet;
  MeshPlan mesh;
  ModesPlan modes;
  std::vector<fem::Support> supports;
  std::vector<int> support_lines;  ///< line in the file, per support
  std::vector<AttachmentPlan> attachments;
  std::vector<VariationPlan> variations;
  std::vector<Channel> sensors, actuators;
  std::vector<LayoutPlan> layouts;
  std::optional<PlacementPlan> placement;
  std::optional<MeasurementPlan> measurement;
  std::optional<ExperimentPlan> experiment;
  std::optional<ExcitationPlan> design;
  std::optional<IdentificationPlan> identification;
  std::optional<StateSpacePlan> state_space;
  std::optional<ObserverPlan> observer;
  std::optional<InterpolationPlan> interpolation;
  std::optional<PriorsPlan> priors;
  std::optional<DiagnosisPlan> diagnosis;
  std::vector<SpecimenPlan> specimens;
  std::vector<DataFile> files;  ///< all that it names, but for bases and tables of places
  std::vector<Expectation> expectations;
  std::vector<std::string> warnings;  ///< implausible values: "<file>:<line>:<column>: ..."
};

/// True if a body's file does not state the unit of its lengths: .stl, .off, ...
[[nodiscard]] bool needs_unit(const std::filesystem::path& file);

[[nodiscard]] std::vector<std::string> names_of(const std::vector<Channel>& channels);
/// Names of the sensors, then of the actuators.
[[nodiscard]] std::vector<std::string> channel_names(const Study& study);

/// The study in `file`. Its paths are relative to its folder and must stay below it, or below one
/// of the folders `allowed`.
/// @throws InvalidInput  all errors, the first 20, each with line and column
[[nodiscard]] Study read_study(const std::filesystem::path& file,
                               const std::vector<std::filesystem::path>& allowed = {});

/// The same from bytes. `file` is only a name, with the folder for relative paths.
[[nodiscard]] Study parse_study(std::string_view bytes, const std::filesystem::path& file,
                                const std::vector<std::filesystem::path>& allowed = {});

/// The study, then every file that it names, and that those name which are studies themselves: its
/// bases, its truth, its specimens. They may be missing, and the study may have errors: then what
/// is named before the first one that stops its reading.
[[nodiscard]] std::vector<std::filesystem::path> files_of(
    const std::filesystem::path& file, const std::vector<std::filesystem::path>& allowed = {});

}  // namespace chladni::study
