// State spaces for MATLAB and as JSON.
#include "io/control_model.h"

namespace chladni::io {
namespace {

std::vector<std::string> signal_names(const std::vector<modal::Signal>& signals) {
  std::vector<std::string> names;
  for (const auto& signal : signals) names.push_back(signal.name);
  return names;
}

std::vector<std::string> signal_units(const std::vector<modal::Signal>& signals) {
  std::vector<std::string> units;
  for (const auto& signal : signals) units.push_back(signal.unit);
  return units;
}

}  // namespace

MatValue control_model_mat(const modal::ControlModel& model) {
  MatValue properties;
  properties.kind = MatValue::Kind::cell;
  const auto add = [&](const char* name, MatValue value) {
    properties.cells.emplace_back(std::string(name));
    properties.cells.push_back(std::move(value));
  };
  add("StateName", signal_names(model.states));
  add("StateUnit", signal_units(model.states));
  add("InputName", signal_names(model.inputs));
  add("InputUnit", signal_units(model.inputs));
  add("OutputName", signal_names(model.outputs));
  add("OutputUnit", signal_units(model.outputs));
  add("InputDelay", Eigen::MatrixXd(model.input_delay));
  add("OutputDelay", Eigen::MatrixXd(model.output_delay));
  properties.dims = {1, static_cast<Eigen::Index>(properties.cells.size())};
  MatValue structure;
  structure.kind = MatValue::Kind::structure;
  structure.dims = {1, 1};
  structure.fields = {{"A", model.space.a},
                      {"B", model.space.b},
                      {"C", model.space.c},
                      {"D", model.space.d},
                      {"Ts", model.space.sample_time_s},
                      {"properties", properties}};
  return structure;
}

Json control_model_json(const modal::ControlModel& model) {
  return JsonObject{{"A", Json::rows(model.space.a)},
                    {"B", Json::rows(model.space.b)},
                    {"C", Json::rows(model.space.c)},
                    {"D", Json::rows(model.space.d)},
                    {"sample_time_s", model.space.sample_time_s},
                    {"states", Json::texts(signal_names(model.states))},
                    {"state_units", Json::texts(signal_units(model.states))},
                    {"inputs", Json::texts(signal_names(model.inputs))},
                    {"input_units", Json::texts(signal_units(model.inputs))},
                    {"outputs", Json::texts(signal_names(model.outputs))},
                    {"output_units", Json::texts(signal_units(model.outputs))},
                    {"input_delay", Json(model.input_delay)},
                    {"output_delay", Json(model.output_delay)},
                    {"delay_unit", model.space.sample_time_s > 0.0 ? "samples" : "s"}};
}

}  // namespace chladni::io
