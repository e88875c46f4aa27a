// A study in SI units: the output of `chladni check`.
#include <algorithm>

#include "mesh/tetrahedralize.h"
#include "show/interpolation.h"
#include "show/solution.h"
#include "stage/solution.h"
#include "study/schemas.h"

namespace chladni::show {
namespace {

void append(io::JsonObject members, io::JsonObject& object) {
  for (auto& member : members) object.push_back(std::move(member));
}

io::Json body_json(const mesh::Plate& plate) { return study::plate_schema().json(plate); }
io::Json body_json(const mesh::Disc& disc) { return study::disc_schema().json(disc); }
io::Json body_json(const mesh::Quadrilateral& plate) {
  return study::quadrilateral_schema().json(plate);
}
io::Json body_json(const mesh::Sphere& sphere) { return study::sphere_schema().json(sphere); }
io::Json body_json(const mesh::WaferTable& table) {
  auto object = study::wafer_table_schema().json(table);
  append(study::wafer_schema().json(table), object);
  return object;
}
io::Json body_json(const study::FileGeometry& file) { return study::file_schema().json(file); }

io::Json material_json(const study::StudyMaterial& material) {
  io::JsonObject object = study::material_schema().json(material);
  for (const auto& [name, value] : material.constants) object.emplace_back(name, value);
  object.emplace_back("stiffness_pa", io::Json::rows(Eigen::MatrixXd(material.material.stiffness)));
  return object;
}

template <typename Plan>
io::Json list_json(const study::Schema<Plan>& schema, const std::vector<Plan>& plans) {
  io::JsonArray array;
  for (const auto& plan : plans) array.emplace_back(schema.json(plan));
  return array;
}

const auto& schema_of(const fem::PointMass& /*what*/) { return study::mass_schema(); }
const auto& schema_of(const fem::GroundSpring& /*what*/) { return study::spring_schema(); }
const auto& schema_of(const fem::GroundTorsionSpring& /*what*/) {
  return study::torsion_spring_schema();
}
const auto& schema_of(const fem::LinkSpring& /*what*/) { return study::link_schema(); }
const auto& schema_of(const fem::Resonator& /*what*/) { return study::resonator_schema(); }

io::Json attachments_json(const std::vector<study::AttachmentPlan>& plans) {
  io::JsonArray array;
  for (const auto& plan : plans) {
    auto object = study::attachment_schema().json(plan);
    std::visit([&](const auto& what) { append(schema_of(what).json(what), object); }, plan.what);
    array.emplace_back(object);
  }
  return array;
}

io::Json constants_json(const std::vector<diagnosis::CalibratedConstant>& constants) {
  using Kind = diagnosis::CalibratedConstant::Kind;
  io::JsonArray array;
  for (const auto& one : constants) {
    io::JsonObject object{{"key", one.name}, {"value", one.value}, {"unit", one.unit}};
    if (one.kind == Kind::unknown) object.emplace_back("unknown", true);
    if (one.kind == Kind::known) object.emplace_back("within", one.deviation);
    if (one.kind == Kind::measured) object.emplace_back("measured", one.deviation);
    array.emplace_back(object);
  }
  return array;
}

io::Json estimate_json(const stage::Understood& body, const stage::Cost& cost) {
  return io::JsonObject{{"extent_m", io::Json(body.extent_m)},
                        {"volume_m3", body.volume_m3},
                        {"mass_kg", body.mass_kg},
                        {"first_frequency_hz", body.first_frequency_hz},
                        {"taken_for", body.estimate_name},
                        {"degrees_of_freedom", cost.degrees_of_freedom},
                        {"memory_bytes", cost.memory_bytes},
                        {"seconds", cost.seconds}};
}

}  // namespace

io::JsonObject study_json(const study::Study& study, const stage::Introduction& introduction) {
  io::JsonArray materials;
  for (const auto& material : study.materials) materials.push_back(material_json(material));
  io::JsonObject object = {
      {"geometry",
       io::JsonObject{{study.geometry.kind, std::visit([](const auto& b) { return body_json(b); },
                                                       study.geometry.body)}}},
      {"materials", materials},
      {"mesh", study::mesh_schema().json(study.mesh)},
      {"modes", study::modes_schema().json(study.modes)},
      {"supports", list_json(study::support_schema(), study.supports)},
      {"attachments", attachments_json(study.attachments)},
      {"variations", list_json(study::variation_schema(), study.variations)},
      {"sensors", list_json(study::sensor_schema(), study.sensors)},
      {"actuators", list_json(study::actuator_schema(), study.actuators)},
      {"layouts", list_json(study::layout_schema(), study.layouts)}};
  const auto add = [&](const char* table, const auto& schema, const auto& plan) {
    if (plan) object.emplace_back(table, schema.json(*plan));
  };
  add("placement", study::placement_schema(), study.placement);
  add("measurement", study::measurement_schema(), study.measurement);
  add("experiment", study::experiment_schema(), study.experiment);
  add("design", study::design_schema(), study.design);
  add("identification", study::identification_schema(), study.identification);
  add("state_space", study::state_space_schema(), study.state_space);
  add("observer", study::observer_schema(), study.observer);
  add("interpolation", study::interpolation_schema(), study.interpolation);
  add("priors", study::priors_schema(), study.priors);
  add("diagnosis", study::diagnosis_schema(), study.diagnosis);
  if (!study.constants.empty()) object.emplace_back("constants", constants_json(study.constants));
  if (!study.sheet.empty()) object.emplace_back("sheet", constants_json(study.sheet));
  if (!study.specimens.empty()) {
    object.emplace_back("specimens", list_json(study::specimen_schema(), study.specimens));
  }
  object.emplace_back("expect", study::expectations_json(study.expectations));
  object.emplace_back("estimate", estimate_json(introduction.body, introduction.cost));
  object.emplace_back("warnings", io::Json::texts(introduction.warnings));
  return object;
}

void add_judged(const std::vector<steps::JudgedExpectation>& judged, io::JsonObject& study_json) {
  io::JsonObject expect;
  for (const auto& [expected, found, met] : judged) {
    const auto alone = study::expectations_json({expected});
    auto entry = std::get<io::JsonObject>(alone.at(expected.key).value());
    append({{"found", found}, {"met", met}}, entry);
    expect.emplace_back(expected.key, std::move(entry));
  }
  const auto known = std::ranges::find(study_json, "expect", &io::JsonObject::value_type::first);
  known->second = std::move(expect);
}

}  // namespace chladni::show
