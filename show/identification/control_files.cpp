// state_space.mat, state_space.json and state_space.h
#include <fmt/format.h>

#include <filesystem>
#include <functional>
#include <new>
#include <optional>

#include "base/error.h"
#include "host/atomic_file.h"
#include "io/control_model.h"
#include "show/control_models.h"
#include "show/readable.h"

namespace chladni::show {
namespace {

// "delay 968 us", or the range over channels; empty without delays.
std::string delay_text(const Eigen::VectorXd& input, const Eigen::VectorXd& output) {
  const auto of = [](const Eigen::VectorXd& delay, const char* side) {
    if (delay.size() == 0 || delay.maxCoeff() == 0.0) return std::string();
    const double least = 1e6 * delay.minCoeff();
    const double most = 1e6 * delay.maxCoeff();
    return least == most ? fmt::format(", delay of the {} {:.2f} us", side, most)
                         : fmt::format(", delays of the {} {:.2f} to {:.2f} us", side, least, most);
  };
  return of(input, "inputs") + of(output, "outputs");
}

std::string sampled_text(const modal::ControlModel& model, const std::string& stem) {
  return fmt::format("sampled at {:.6g} Hz: {} states, at most {:.0f} samples of delay ({}.h)\n",
                     1.0 / model.space.sample_time_s, model.space.a.rows(),
                     model.input_delay.maxCoeff() + model.output_delay.maxCoeff(), stem);
}

io::Json reduction_json(const steps::ControlModels& models) {
  return io::JsonObject{{"states", static_cast<long long>(models.kept_states)},
                        {"all_states", static_cast<long long>(models.all_states)},
                        {"hankel_singular_values", io::Json(models.hankel)},
                        {"error_bound", models.error_bound}};
}

void write_files(const study::Study& study, const steps::ControlModels& models,
                 const std::string& stem, Run& run) {
  io::MatFields variables{{"continuous", io::control_model_mat(models.continuous)},
                          {"hankel_singular_values", Eigen::MatrixXd(models.hankel)},
                          {"error_bound", models.error_bound}};
  io::JsonObject json{{"continuous", io::control_model_json(models.continuous)}};
  const auto header = run / (stem + ".h");
  if (models.discrete) {
    variables.insert(variables.begin() + 1, {"discrete", io::control_model_mat(*models.discrete)});
    json.emplace_back("discrete", io::control_model_json(*models.discrete));
    write_atomically(header, io::control_model_c(*models.discrete, {study.title, models.position}));
  } else {
    std::filesystem::remove(header);  // of a run with a sample rate
  }
  json.emplace_back("reduction", reduction_json(models));
  json.emplace_back(
      "position", io::Json(Eigen::Map<const Eigen::VectorXd>(
                      models.position.data(), static_cast<Eigen::Index>(models.position.size()))));
  json.emplace_back("notes", io::Json::texts(models.notes));
  io::write_mat(run / (stem + ".mat"), variables);
  run.leave(stem + ".json", json, false);
}

}  // namespace

std::string control_models_text(const steps::ControlModels& models, const std::string& stem) {
  const auto& model = models.continuous;
  const auto of_delays = model.space.a.rows() - models.kept_states;
  std::string text = fmt::format("\nstate space: {} states", models.kept_states);
  if (models.kept_states < models.all_states) {
    text += fmt::format(" of {} (balanced, error at most {:.3g}; largest Hankel value {:.3g})",
                        models.all_states, models.error_bound, models.hankel(0));
  }
  if (of_delays > 0) text += fmt::format(" and {} of Pade delays", of_delays);
  text += fmt::format(", {}, {}{}\n", how_many(std::ssize(model.inputs), "input"),
                      how_many(std::ssize(model.outputs), "output"),
                      delay_text(model.input_delay, model.output_delay));
  if (models.discrete) text += sampled_text(*models.discrete, stem);
  return text + "in MATLAB: m = load('" + stem +
         ".mat').continuous; G = ss(m.A, m.B, m.C, m.D, m.Ts, m.properties{:});\n";
}

namespace {

void remove_models(const std::string& stem, const Run& run) {
  for (const char* end : {".mat", ".json", ".h"}) std::filesystem::remove(run / (stem + end));
}

// What prevents a state space is a warning, and files of an earlier run go: all other results of
// the verb are there without it.
void leave_models(const study::Study& study, const std::string& stem,
                  const std::function<steps::ControlModels()>& made, Run& run) {
  std::optional<steps::ControlModels> models;
  try {
    models = made();
  } catch (const Interrupted&) {
    throw;
  } catch (const OutOfResources&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& fault) {
    remove_models(stem, run);
    run.warn(std::string("no state space: ") + fault.what());
    return;
  }
  for (const auto& note : models->notes) run.warn(note);
  write_files(study, *models, stem, run);
  run.show(control_models_text(*models, stem));
}

}  // namespace

void leave_control_models(const study::Study& study, const steps::IdentifiedModel& model,
                          Run& run) {
  leave_models(
      study, "state_space", [&] { return steps::control_models(study, model); }, run);
}

void leave_control_models(const study::Study& study, const stage::Solution& solution, Run& run) {
  const std::string stem = "simulated_state_space";
  if (!study.state_space) {
    remove_models(stem, run);  // of a study that had the table
    return;
  }
  const auto made = [&] { return steps::control_models(study, solution); };
  leave_models(
      study, stem, [&] { return run.timed("state space", made); }, run);
}

}  // namespace chladni::show
