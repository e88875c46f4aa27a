#include "io/uff/frf_uff.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <tuple>

#include "base/error.h"
#include "base/quantity.h"
#include "io/measured/frf_units.h"
#include "io/measured/measurable.h"
#include "io/scan.h"
#include "io/uff/uff_channels.h"
#include "io/uff/uff_systems.h"

namespace chladni::io {
namespace {

using Index = Eigen::Index;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

struct Placed {
  const UffFunction* function = nullptr;
  Index output = 0, input = 0;
};

bool is_response(const UffFunction& function) {
  if (function.type == 4) return function.is_complex;
  return function.type == 0 && function.is_complex && function.abscissa.type == 18;
}

// Whether it is a motion over a motion, a force over a motion or a force over a force. What stands
// beside the values counts more than the type of the data.
bool is_of_another_ratio(const UffFunction& function) {
  const auto& [above, over] = std::tie(function.ordinate, function.denominator);
  return (!is_load(over) && is_motion(over) && !force_unit(over.unit)) ||
         (is_load(above) && !has_unit_of_motion(above));
}

std::string place(const UffFunction& function) {
  return "line " + fmt::to_string(function.line) + " (" + name_of(function.response) + " over " +
         name_of(function.reference) + ")";
}

Eigen::VectorXd hertz_of(const UffFunction& function) {
  return abscissa_factor(function.abscissa, "Hz").value_or(1.0) * function.x;
}

// Whether the lines are equal to six digits. Two programs may round the same line differently.
bool same_lines(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  return a.size() == b.size() && (a - b).cwiseAbs().maxCoeff() <= 1e-6 * b.cwiseAbs().maxCoeff();
}

class Collector {
 public:
  Collector(const Uff& uff, const std::string& name, const FrfOptions& options)
      : uff_(uff), name_(name), options_(options) {}

  FrfFile file() {
    file_.format = "UFF 58";
    file_.notes = uff_.notes;
    sort_functions();
    if (responses_.empty()) throw NoResponses(name_ + ": " + nothing_found());
    require_equal_lines();
    file_.set.outputs = outputs_.channels();
    file_.set.inputs = inputs_.channels();
    file_.set.frequency_hz = hertz_of(*responses_.front().function);
    require_room();
    fill();
    add_coherence();
    place_all();
    return std::move(file_);
  }

  [[nodiscard]] bool kinds_known() const { return kinds_known_; }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw InvalidInput(name_ + ": " + what); }

  [[nodiscard]] std::string nothing_found() const {
    const auto times = std::count_if(uff_.functions.begin(), uff_.functions.end(),
                                     [](const auto& f) { return f.type == 1; });
    return "no frequency response (dataset 58, function type 4) among " +
           fmt::to_string(uff_.functions.size()) + " functions" +
           (times > 0 ? "; " + fmt::to_string(times) + " are time responses" : "");
  }

  void sort_functions() {
    std::map<int, int> others;
    for (const auto& function : uff_.functions) {
      if (function.binary) file_.format = "UFF 58b";
      if (is_response(function) && is_of_another_ratio(function)) {
        ratios_.push_back(&function);
      } else if (is_response(function)) {
        responses_.push_back(
            {&function,
             outputs_.number(function.response,
                             stated_name(function, kResponseName, function.response)),
             inputs_.number(function.reference,
                            stated_name(function, kReferenceName, function.reference))});
      } else if (function.type == 6) {
        coherences_.push_back(&function);
      } else {
        ++others[function.type];
      }
    }
    note_ratios();
    for (const auto& [type, count] : others) {
      file_.notes.push_back(fmt::to_string(count) + (count == 1 ? " function" : " functions") +
                            " of type " + fmt::to_string(type) + ": not frequency responses" +
                            (type == 4 ? " with a phase" : "") + ", not read");
    }
  }

  void note_ratios() {
    if (ratios_.empty()) return;
    const auto text = fmt::format(
        "{} function{} of no motion over a force (transmissibility, dynamic stiffness, apparent "
        "mass), such as {}",
        ratios_.size(), ratios_.size() == 1 ? " is" : "s are", place(*ratios_.front()));
    if (responses_.empty()) fail(text);
    file_.notes.push_back(text + ": not read");
  }

  void require_equal_lines() const {
    const auto& first = *responses_.front().function;
    const auto lines = hertz_of(first);
    for (Index k = 0; k < lines.size(); ++k) {
      if (lines(k) >= 0.0 && (k == 0 || lines(k) > lines(k - 1))) continue;
      fail(place(first) + ": value " + fmt::to_string(k + 1) + " is at " +
           fmt::format("{:.9g}", lines(k)) + " Hz; expected ascending frequencies, 0 or more");
    }
    for (const auto& response : responses_) {
      const auto other = hertz_of(*response.function);
      if (same_lines(other, lines)) continue;
      const auto band = [](const Eigen::VectorXd& f) {
        return fmt::to_string(f.size()) + " values from " + fmt::format("{:.6g}", f(0)) + " to " +
               fmt::to_string(f(f.size() - 1)) + " Hz";
      };
      fail("unequal frequency lines: " + place(first) + " has " + band(lines) + ", " +
           place(*response.function) + " has " + band(other));
    }
  }

  void require_room() const {
    try {
      require_channels(outputs_.size(), "outputs");
      require_channels(inputs_.size(), "inputs");
      io::require_room(file_.set, file_.set.line_count(), coherences_.empty() ? 0 : 1,
                       options_.limit_bytes);
    } catch (const InvalidInput& e) {
      fail(e.what() + (" (it has " + fmt::to_string(responses_.size()) + " responses)"));
    }
  }

  template <typename Number>
  std::vector<Eigen::Matrix<Number, Eigen::Dynamic, Eigen::Dynamic>> empty_lines(Number nothing) {
    return {static_cast<std::size_t>(file_.set.line_count()),
            Eigen::Matrix<Number, Eigen::Dynamic, Eigen::Dynamic>::Constant(
                outputs_.size(), inputs_.size(), nothing)};
  }

  // Sets the unit of an output or input. All its responses share this unit.
  static void state_unit(modal::MeasuredChannel& channel, const UffScale& scale) {
    channel.kind = scale.kind.value_or(channel.kind);
    channel.unit = scale.unit;
  }

  // The scale of an output. Where the user says that each is in SI, the motion states its unit.
  [[nodiscard]] UffScale output_scale(const UffFunction& function) const {
    auto scale = motion_scale(function);
    const bool is_in_si = options_.unit == kEachInSi && !options_.kind;
    if (is_in_si && scale.kind && scale.unit.empty()) scale.unit = si_unit_of(*scale.kind);
    return scale;
  }

  void fill() {
    file_.set.value = empty_lines(std::complex<double>(kNan, kNan));
    std::map<std::pair<Index, Index>, const UffFunction*> seen;
    std::vector<std::optional<UffScale>> of_output(file_.set.outputs.size());
    std::set<Index> known_inputs;
    for (const auto& [function, i, j] : responses_) {
      const auto [other, is_new] = seen.emplace(std::pair(i, j), function);
      if (!is_new) {
        repeated(*other->second, *function);
        continue;
      }
      const auto output = output_scale(*function);
      const auto input = input_scale(*function);
      auto& known = of_output[static_cast<std::size_t>(i)];
      if (known && (known->kind != output.kind || known->unit != output.unit)) {
        fail(place(*function) +
             ": the output is of another kind or unit than in the response before");
      }
      known = output;
      kinds_known_ = kinds_known_ && output.kind;
      for (const auto& note : {output.note, input.note}) add_note(note);
      if (!abscissa_factor(function->abscissa, "Hz")) {
        add_note(unknown_abscissa(function->abscissa, "Hz"));
      }
      state_unit(file_.set.outputs[static_cast<std::size_t>(i)], output);
      auto& channel = file_.set.inputs[static_cast<std::size_t>(j)];
      if (!known_inputs.insert(j).second && channel.unit != input.unit) {
        add_note("the unit of the input " + channel.name +
                 " is stated in some responses only: each is read as it says");
      }
      state_unit(channel, input);
      for (Index k = 0; k < file_.set.line_count(); ++k) {
        file_.set.value[static_cast<std::size_t>(k)](i, j) =
            function->y(k) * (output.factor / input.factor);
      }
    }
  }

  void repeated(const UffFunction& first, const UffFunction& second) {
    if (first.y == second.y) {
      add_note(place(second) + " repeats that of line " + fmt::to_string(first.line) +
               ": not read");
    } else {
      fail("two responses of one pair that differ: " + place(first) + " and " + place(second));
    }
  }

  void repeated_coherence(const UffFunction& first, const UffFunction& second) {
    if (first.y == second.y) return;
    add_note("two coherences of one pair that differ, " + place(first) + " and " + place(second) +
             ": the first is taken");
  }

  void add_note(const std::string& note) {
    if (!note.empty() && noted_.insert(note).second) file_.notes.push_back(note);
  }

  void add_coherence() {
    std::size_t lost = 0;
    std::map<std::pair<Index, Index>, const UffFunction*> seen;
    for (const auto* function : coherences_) {
      const auto match = std::find_if(responses_.begin(), responses_.end(), [&](const Placed& r) {
        const auto same = [](const UffDof& a, const UffDof& b) {
          return a.node == b.node && a.direction == b.direction && a.entity == b.entity;
        };
        return same(r.function->response, function->response) &&
               same(r.function->reference, function->reference);
      });
      if (match == responses_.end() || !same_lines(hertz_of(*function), file_.set.frequency_hz)) {
        ++lost;
        continue;
      }
      const auto [first, is_new] = seen.emplace(std::pair(match->output, match->input), function);
      if (!is_new) {
        repeated_coherence(*first->second, *function);
        continue;
      }
      if (file_.set.coherence.empty()) file_.set.coherence = empty_lines(kNan);
      for (Index k = 0; k < file_.set.line_count(); ++k) {
        file_.set.coherence[static_cast<std::size_t>(k)](match->output, match->input) =
            rounded_coherence(function->y(k).real());
      }
    }
    if (lost > 0) {
      file_.notes.push_back(fmt::to_string(lost) +
                            " coherences have no response of the same pair and lines: not read");
    }
  }

  void place_all() {
    if (uff_.nodes.empty()) return;
    std::optional<double> length;
    if (!options_.length_unit.empty()) length = unit_factor(options_.length_unit, "m");
    if (uff_.units && length && std::abs(*length / uff_.units->length - 1.0) > 1e-6) {
      add_note("the file states its unit of lengths (dataset 164): \"" + options_.length_unit +
               "\" is not used");
    }
    if (uff_.units) length = uff_.units->length;
    if (!length) {
      file_.notes.emplace_back(
          "the nodes have no unit (no dataset 164): their places are not read; "
          "say it as length_unit = \"mm\"");
    }
    place_channels(uff_, length, file_.set.outputs, file_.notes);
    place_channels(uff_, length, file_.set.inputs, file_.notes);
  }

  const Uff& uff_;
  const std::string& name_;
  const FrfOptions& options_;
  FrfFile file_;
  UffChannels outputs_, inputs_;
  std::vector<Placed> responses_;
  std::vector<const UffFunction*> coherences_, ratios_;
  std::set<std::string> noted_;
  bool kinds_known_ = true;
};

}  // namespace

FrfFile parse_frf_uff(std::string_view bytes, const std::string& name, const FrfOptions& options) {
  const Uff uff = parse_uff(bytes, name, options.limit_bytes);
  Collector collector(uff, name, options);
  FrfFile file = collector.file();
  state_units(file, collector.kinds_known(), options);
  try {
    modal::check(file.set);
  } catch (const InvalidInput& e) {
    throw InvalidInput(name + ": " + e.what());
  }
  return file;
}

}  // namespace chladni::io
