// A discrete model as a C header for a real-time target.
#include <fmt/format.h>

#include <algorithm>
#include <numbers>
#include <string_view>

#include "base/error.h"
#include "io/control_model.h"

namespace chladni::io {
namespace {

// Texts of a study inside a comment or a string of C: letters that could end either are replaced.
std::string harmless(const std::string& text) {
  std::string result;
  for (const char c : text) {
    const bool plain = static_cast<unsigned char>(c) >= 0x20U && c != '"' && c != '\\' && c != '*';
    result += plain ? c : '_';
  }
  return result;
}

// The entries of an array, at most eight on a line.
template <typename Number>
std::string entries(const std::vector<Number>& all) {
  std::string text;
  for (std::size_t i = 0; i < all.size(); ++i) {
    text += i % 8 == 0 ? "\n  " : " ";
    if constexpr (std::is_same_v<Number, double>) {
      text += fmt::format("{:.17g},", all[i]);
    } else {
      text += fmt::format("{},", all[i]);
    }
  }
  return text;
}

template <typename Number>
std::string array(const char* type, const std::string& name, std::vector<Number> all) {
  const auto text = entries(all.empty() ? std::vector<Number>{Number{}} : all);
  return fmt::format("static const {} {}[] = {{{}\n}};\n", type, name, text);
}

// A matrix by the entries that are not 0, row after row.
std::string sparse(const std::string& name, const Eigen::MatrixXd& matrix) {
  std::vector<double> value;
  std::vector<int> column;
  std::vector<int> begin{0};
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    for (Eigen::Index j = 0; j < matrix.cols(); ++j) {
      if (matrix(i, j) == 0.0) continue;
      value.push_back(matrix(i, j));
      column.push_back(static_cast<int>(j));
    }
    begin.push_back(static_cast<int>(value.size()));
  }
  return array("double", name + "_value", value) + array("int", name + "_column", column) +
         array("int", name + "_begin", begin);
}

std::vector<int> whole(const Eigen::VectorXd& delay) {
  std::vector<int> samples;
  for (const double one : delay) samples.push_back(static_cast<int>(one));
  return samples;
}

std::string names(const char* side, const std::vector<modal::Signal>& signals) {
  std::string text = fmt::format("/* {}:", side);
  for (std::size_t i = 0; i < signals.size(); ++i) {
    text +=
        fmt::format("\n   {}  {} [{}]", i, harmless(signals[i].name), harmless(signals[i].unit));
  }
  return text + " */\n";
}

// The same text with another prefix than "chladni" of all names.
std::string renamed(const std::string& text, const std::string& prefix) {
  std::string upper = prefix;
  for (char& c : upper) c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  std::string result;
  for (std::size_t at = 0; at < text.size();) {
    const auto name = std::string_view(text).substr(at, 8);
    const bool own = name == "chladni_" || name == "CHLADNI_";
    result += own ? (name[0] == 'c' ? prefix : upper) + "_" : text.substr(at, 1);
    at += own ? 8 : 1;
  }
  return result;
}

constexpr const char* kFunctions = R"(
typedef struct {
  double x[CHLADNI_STATES + 1];
  double past_u[CHLADNI_INPUTS * (CHLADNI_INPUT_RING + 1)];
  double past_y[CHLADNI_OUTPUTS * (CHLADNI_OUTPUT_RING + 1)];
  int u_at, y_at;
} chladni_model;

/* At rest. */
static inline void chladni_reset(chladni_model* m) { memset(m, 0, sizeof *m); }

static inline double chladni_row(const double* value, const int* column, const int* begin, int row,
                                 const double* x) {
  double sum = 0.0;
  for (int k = begin[row]; k < begin[row + 1]; ++k) sum += value[k] * x[column[k]];
  return sum;
}

/* u: the inputs from now to the next sample; y: the outputs at this sample. Goes on by one sample. */
static inline void chladni_step(chladni_model* m, const double u[CHLADNI_INPUTS],
                                double y[CHLADNI_OUTPUTS]) {
  double now[CHLADNI_INPUTS];
  double next[CHLADNI_STATES + 1];
  for (int j = 0; j < CHLADNI_INPUTS; ++j) {
    double* ring = m->past_u + j * (CHLADNI_INPUT_RING + 1);
    ring[m->u_at] = u[j];
    int at = m->u_at - chladni_input_delay[j];
    now[j] = ring[at < 0 ? at + CHLADNI_INPUT_RING + 1 : at];
  }
  for (int i = 0; i < CHLADNI_OUTPUTS; ++i) {
    double* ring = m->past_y + i * (CHLADNI_OUTPUT_RING + 1);
    ring[m->y_at] =
        chladni_row(chladni_c_value, chladni_c_column, chladni_c_begin, i, m->x) +
        chladni_row(chladni_d_value, chladni_d_column, chladni_d_begin, i, now);
    int at = m->y_at - chladni_output_delay[i];
    y[i] = ring[at < 0 ? at + CHLADNI_OUTPUT_RING + 1 : at];
  }
  for (int s = 0; s < CHLADNI_STATES; ++s) {
    next[s] = chladni_row(chladni_a_value, chladni_a_column, chladni_a_begin, s, m->x) +
              chladni_row(chladni_b_value, chladni_b_column, chladni_b_begin, s, now);
  }
  memcpy(m->x, next, CHLADNI_STATES * sizeof(double));
  m->u_at = m->u_at < CHLADNI_INPUT_RING ? m->u_at + 1 : 0;
  m->y_at = m->y_at < CHLADNI_OUTPUT_RING ? m->y_at + 1 : 0;
}
)";

constexpr const char* kDisplacement = R"(
/* C(rho) x: the displacement of the model's state, [m] where all is in SI, at a place whose
   mass-normalised shape values are phi [kg^-1/2], one for each mode. Delays of outputs and the
   flexibility of omitted modes are not in it. */
static inline double chladni_displacement_at(const chladni_model* m,
                                             const double phi[CHLADNI_MODES]) {
  double sum = 0.0;
  for (int k = 0; k < CHLADNI_MODES; ++k) sum += phi[k] * chladni_position[k] * m->x[2 * k];
  return sum;
}
)";

// The modes that phi has values of. A mode at 0 Hz has another name of its position state.
std::string modes_of_phi(const modal::ControlModel& model, const std::vector<double>& position) {
  std::string text = "/* phi has a value for each of these modes:";
  for (std::size_t k = 0; k < position.size(); ++k) {
    require(2 * k < model.states.size(), "C header: fewer states than two for each mode");
    const bool above = model.states[2 * k].name.ends_with("omega_position");
    text +=
        fmt::format("\n   {}  {:.6g} Hz", k, above ? 0.5 / (std::numbers::pi * position[k]) : 0.0);
  }
  return text +
         "\n   Fields between the sensors (mode_field.csv, mode_field_polynomial.json) have the "
         "modes of\n"
         "   those frequencies in interpolation.json: none at 0 Hz, and none whose scale is not "
         "known.\n"
         "   spatio_temporal.json has all modes. */\n";
}

}  // namespace

std::string control_model_c(const modal::ControlModel& model, const CHeaderText& text) {
  modal::check(model);
  const auto& space = model.space;
  require(space.sample_time_s > 0.0,
          "C header: the model is continuous; expected one with a sample time");
  require(space.b.cols() > 0 && space.c.rows() > 0,
          "C header: the model has no input or no output");
  const auto input = whole(model.input_delay);
  const auto output = whole(model.output_delay);
  std::string header = fmt::format(
      "/* Written by Chladni: \"{}\", sampled at {:.10g} Hz with a zero-order hold.\n"
      "   x[k+1] = A x[k] + B u[k], y[k] = C x[k] + D u[k], with whole samples of delay. */\n"
      "#ifndef CHLADNI_STATE_SPACE_H\n#define CHLADNI_STATE_SPACE_H\n\n#include <string.h>\n\n"
      "#define CHLADNI_SAMPLE_TIME {:.17g} /* s */\n"
      "enum {{\n  CHLADNI_STATES = {},\n  CHLADNI_INPUTS = {},\n  CHLADNI_OUTPUTS = {},\n"
      "  CHLADNI_INPUT_RING = {},\n  CHLADNI_OUTPUT_RING = {}\n}};\n",
      harmless(text.title), 1.0 / space.sample_time_s, space.sample_time_s, space.a.rows(),
      space.b.cols(), space.c.rows(), *std::max_element(input.begin(), input.end()),
      *std::max_element(output.begin(), output.end()));
  header += names("inputs", model.inputs) + names("outputs", model.outputs);
  header +=
      array("int", "chladni_input_delay", input) + array("int", "chladni_output_delay", output);
  header += sparse("chladni_a", space.a) + sparse("chladni_b", space.b) +
            sparse("chladni_c", space.c) + sparse("chladni_d", space.d) + kFunctions;
  if (!text.position.empty()) {
    header += fmt::format("\nenum {{ CHLADNI_MODES = {} }};\n", text.position.size());
    header += modes_of_phi(model, text.position) +
              array("double", "chladni_position", text.position) + kDisplacement;
  }
  return renamed(header + "\n#endif\n", text.prefix);
}

}  // namespace chladni::io
