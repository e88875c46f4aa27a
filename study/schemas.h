// The keys of all tables of a study.
#pragma once

#include <string>
#include <vector>

#include "diagnosis/tolerances.h"
#include "study/schema.h"
#include "study/study.h"

namespace chladni::study {

/// Also of a beam.
[[nodiscard]] const Schema<mesh::Plate>& plate_schema();
[[nodiscard]] const Schema<mesh::Disc>& disc_schema();
[[nodiscard]] const Schema<mesh::Quadrilateral>& quadrilateral_schema();
[[nodiscard]] const Schema<mesh::Sphere>& sphere_schema();
/// Without the wafer.
[[nodiscard]] const Schema<mesh::WaferTable>& wafer_table_schema();
[[nodiscard]] const Schema<mesh::Bore>& bore_schema();
[[nodiscard]] const Schema<mesh::WaferTable>& wafer_schema();
[[nodiscard]] const Schema<FileGeometry>& file_schema();
/// Without the constants.
[[nodiscard]] const Schema<StudyMaterial>& material_schema();
/// The constants of a symmetry: "isotropic", "cubic" or "orthotropic". study.json has them as
/// `StudyMaterial::constants`.
[[nodiscard]] const Schema<StudyMaterial>& constants_schema(const std::string& symmetry);
[[nodiscard]] const Schema<MeshPlan>& mesh_schema();
[[nodiscard]] const Schema<ModesPlan>& modes_schema();
[[nodiscard]] const Schema<ExperimentPlan>& experiment_schema();
[[nodiscard]] const Schema<ExcitationPlan>& design_schema();
/// What stands above all tables.
[[nodiscard]] const Schema<Study>& top_schema();
[[nodiscard]] const Schema<Channel>& sensor_schema();
[[nodiscard]] const Schema<Channel>& actuator_schema();
[[nodiscard]] const Schema<LayoutPlan>& layout_schema();
[[nodiscard]] const Schema<fem::Support>& support_schema();
[[nodiscard]] const Schema<VariationPlan>& variation_schema();
/// What attachments of all kinds have.
[[nodiscard]] const Schema<AttachmentPlan>& attachment_schema();
[[nodiscard]] const Schema<fem::PointMass>& mass_schema();
[[nodiscard]] const Schema<fem::GroundSpring>& spring_schema();
/// A ground spring without stiffness.
[[nodiscard]] const Schema<fem::GroundSpring>& damper_schema();
[[nodiscard]] const Schema<fem::GroundTorsionSpring>& torsion_spring_schema();
[[nodiscard]] const Schema<fem::LinkSpring>& link_schema();
[[nodiscard]] const Schema<fem::Resonator>& resonator_schema();
[[nodiscard]] const Schema<PlacementPlan>& placement_schema();
[[nodiscard]] const Schema<GridPlan>& grid_schema();
[[nodiscard]] const Schema<UncertaintyPlan>& uncertainty_schema();
/// The part of the plan that is in placement.choose.
[[nodiscard]] const Schema<PlacementPlan>& choose_schema();
[[nodiscard]] const Schema<ObserverLayoutPlan>& observer_layout_schema();
[[nodiscard]] const Schema<MeasurementPlan>& measurement_schema();
[[nodiscard]] const Schema<IdentificationPlan>& identification_schema();
[[nodiscard]] const Schema<StateSpacePlan>& state_space_schema();
[[nodiscard]] const Schema<ObserverPlan>& observer_schema();
[[nodiscard]] const Schema<DisturbancePlan>& disturbance_schema();
[[nodiscard]] const Schema<ObserverLoopPlan>& observer_loop_schema();
[[nodiscard]] const Schema<InterpolationPlan>& interpolation_schema();
[[nodiscard]] const Schema<PriorsPlan>& priors_schema();
[[nodiscard]] const Schema<DiagnosisPlan>& diagnosis_schema();
[[nodiscard]] const Schema<diagnosis::Tolerances>& tolerances_schema();
[[nodiscard]] const Schema<diagnosis::MeasurementCosts>& costs_schema();
[[nodiscard]] const Schema<SpecimenPlan>& specimen_schema();

/// A place in study.json: two or three coordinates.
[[nodiscard]] io::Json place_json(const Place& place);

/// The keys of one table.
struct TableText {
  std::string heading;  ///< "`[mesh]`"
  std::vector<KeyText> keys;
};

/// The keys of [expect]: the unit of each follows from its name.
[[nodiscard]] TableText expected_keys();
/// The same in study.json, in the order of the file: "frequency_1": { value, within, unit }.
[[nodiscard]] io::Json expectations_json(const std::vector<Expectation>& expectations);

/// All tables of a study.
[[nodiscard]] std::vector<TableText> tables_of_a_study();

/// The same as Markdown: docs/reference/keys.md.
[[nodiscard]] std::string page_of_keys();

}  // namespace chladni::study
