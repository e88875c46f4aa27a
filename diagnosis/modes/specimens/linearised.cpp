#include "diagnosis/modes/specimens/linearised.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "base/error.h"
#include "base/index.h"
#include "diagnosis/modes/specimens/pairs.h"
#include "diagnosis/modes/specimens/slopes.h"
#include "diagnosis/modes/specimens/specimen_constants.h"
#include "modal/pairing.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Kind = CalibratedConstant::Kind;

bool is_of_sheet(const CalibratedConstant& one) {
  return one.effect == "mass" || one.effect.starts_with("length_along");
}

// Constants as they are calibrated for the first pairing: an entry may be a blunder.
std::vector<CalibratedConstant> held_of(const Specimen& specimen) {
  std::vector<CalibratedConstant> held;
  for (auto one : specimen.constants) {
    if (is_of_sheet(one) || one.effect == "modal_damping") continue;
    if (one.kind == Kind::measured) one.deviation = std::hypot(one.deviation, kSpecimens.blunder);
    held.push_back(std::move(one));
  }
  return held;
}

void pair_again(SpecimenModel& one) {
  one.fit.matching = nearest_pairs(*one.problem, one.given.measured, one.fit.model);
}

// True: the model has modes with these constants, which are taken.
bool take_constants(SpecimenModel& one, const VectorXd& x) {
  ModesFit there;
  there.constants = x;
  auto model = one.problem->modes(one.problem->with(there), false);
  if (!model) return false;
  one.fit.constants = x;
  one.fit.model = std::move(*model);
  pair_again(one);
  return true;
}

// Motion of the modes at places of the first specimen, as parts of the width and the length.
MatrixXd shapes_on(const Structure& design, const SpecimenModel& one) {
  const auto normal = [](const Structure& structure) {
    const Eigen::MatrixX2d& places = structure.surface.places;
    const Eigen::RowVector2d low = places.colwise().minCoeff();
    const Eigen::RowVector2d size = (places.colwise().maxCoeff() - low).cwiseMax(1e-12);
    return Eigen::MatrixX2d((places.rowwise() - low).array().rowwise() / size.array());
  };
  const Eigen::MatrixX2d there = normal(design), own = normal(one.given.structure);
  const MatrixXd all = one.given.structure.surface.shapes * one.fit.model.motion;
  MatrixXd shapes(there.rows(), all.cols());
  for (Index i = 0; i < there.rows(); ++i) {
    Index nearest = 0;
    (own.rowwise() - there.row(i)).rowwise().squaredNorm().minCoeff(&nearest);
    shapes.row(i) = all.row(nearest);
  }
  return shapes.colwise().normalized();
}

// The modes of the design so far.
struct DesignModes {
  MatrixXd shapes;
  std::vector<double> ln_hz;
};

std::vector<Index> numbered(const MatrixXd& shapes, const VectorXd& hz, DesignModes& design) {
  const Index known = design.shapes.cols();
  MatrixXd cost = 1.0 - (shapes.transpose() * design.shapes).array().square();
  for (Index k = 0; k < cost.rows(); ++k) {
    for (Index j = 0; j < known; ++j) {
      cost(k, j) += kSpecimens.apart_at_all * std::pow(std::log(hz(k)) - design.ln_hz[at(j)], 2);
    }
  }
  std::vector<Index> number(at(shapes.cols()), -1);
  for (const auto& [k, j] : modal::assigned(cost, 1.0 - kSpecimens.same_mode)) number[at(k)] = j;
  for (Index k = 0; k < shapes.cols(); ++k) {
    if (number[at(k)] >= 0) continue;
    number[at(k)] = design.shapes.cols();
    design.shapes.conservativeResize(shapes.rows(), design.shapes.cols() + 1);
    design.shapes.rightCols(1) = shapes.col(k);
    design.ln_hz.push_back(std::log(hz(k)));
  }
  return number;
}

std::unique_ptr<SpecimenModel> made(const Specimen& specimen, const DiagnosisOptions& options) {
  auto one = std::make_unique<SpecimenModel>();
  one->given = given(specimen.structure, specimen.measured);
  const bool learned = options.levels == Levels::learned;
  one->held = held_constants(one->given.structure, held_of(specimen),
                             believable(options.tolerances, learned), one->given.notes);
  for (const auto& constant : specimen.constants) {
    const bool is_length = constant.effect.starts_with("length_along");
    if (is_length && one->given.structure.directional.along_u.size() == 0) {
      one->given.notes.push_back(constant.name +
                                 " is taken as it is: the body is not thin enough for its effect");
    } else if (is_of_sheet(constant)) {
      one->sheet.push_back(constant);
    }
  }
  one->problem = std::make_unique<ModesProblem>(one->given.structure, one->given.measured,
                                                options.tolerances, learned, one->held);
  one->fit = one->problem->nothing();
  require(one->fit.model.count() > 0,
          specimen.name + ": its model has no mode near those measured");
  pair_again(*one);
  const auto all = std::ssize(one->fit.matching.model);
  const auto paired = all - count_alone(one->fit.matching);
  require(paired >= 2, fmt::format("{}: {} of {} measured modes have a partner in its model; at "
                                   "least two are expected",
                                   specimen.name, paired, all));
  return one;
}

// Fills the rows of one measurement.
class Filler {
 public:
  Filler(Series& series, const SpecimenModel& one, Index first)
      : series_(series), one_(one), first_(first) {}

  void constants() {
    const MatrixXd slopes = frequency_slopes(*one_.problem, one_.fit, one_.fit.model);
    for (std::size_t c = 0; c < one_.held.size(); ++c) {
      const auto& stated = one_.held[c].stated;
      const double x = one_.fit.constants(static_cast<Index>(c));
      const bool is_entry = stated.kind == Kind::measured;
      VectorXd column = at_rows(slopes.col(static_cast<Index>(c)));
      series_.error += x * column;
      const bool has_mass = stated.effect == "density" || stated.effect == "thickness";
      if (has_mass) add_mass(column);
      if (is_entry) {
        series_.entries[at(entry_of(series_, one_.body, stated.name))].slope += column;
        continue;
      }
      auto& constant = series_.constants[at(constant_of(series_, stated.name))];
      constant.slope.col(one_.body) += column;
      series_.error += constant.of_body(one_.body) * column;
    }
  }

  void sheet() {
    for (const auto& stated : one_.sheet) {
      const Index e = entry_of(series_, one_.body, stated.name);
      if (e < 0) continue;
      auto& slope = series_.entries[at(e)].slope;
      if (stated.effect == "mass") {
        for (Index i = 0; i < series_.count(); ++i) {
          if (is_own_mass(i)) slope(i) = -1.0;
        }
        continue;
      }
      VectorXd column = at_rows(length_slopes(*one_.problem, one_.fit, one_.fit.model,
                                              stated.effect == "length_along_u"));
      add_mass(column);
      slope += column;
    }
  }

 private:
  // Values of the model's modes at the rows of their measured partners.
  [[nodiscard]] VectorXd at_rows(const VectorXd& of_modes) const {
    VectorXd column = VectorXd::Zero(series_.count());
    for (Index i = first_; i < series_.count(); ++i) {
      const auto& row = series_.rows[at(i)];
      if (row.measurement != series_.rows[at(first_)].measurement || row.mode < 0) break;
      column(i) = of_modes(one_.fit.matching.model[at(row.measured)]);
    }
    return column;
  }
  [[nodiscard]] bool is_own_mass(Index i) const {
    const auto& row = series_.rows[at(i)];
    return row.mode < 0 && row.measurement == series_.rows[at(first_)].measurement;
  }
  void add_mass(VectorXd& column) const {
    for (Index i = 0; i < series_.count(); ++i) {
      if (is_own_mass(i)) column(i) += 1.0;
    }
  }

  Series& series_;
  const SpecimenModel& one_;
  Index first_;
};

const CalibratedConstant* mass_of(const SpecimenModel& one) {
  const auto found = std::ranges::find(one.sheet, "mass", &CalibratedConstant::effect);
  return found == one.sheet.end() ? nullptr : &*found;
}

// The rows of a measurement with their errors, where the constants stay as they are. A body is
// weighed with its first measurement, and repeats to some deviation where it is measured again.
void add_rows(const SpecimenModel& one, Index measurement, bool is_first, bool is_again,
              Series& series, std::vector<double>& error, std::vector<double>& noise) {
  const auto& measured = one.given.measured;
  for (std::size_t i = 0; i < one.fit.matching.model.size(); ++i) {
    const Index k = one.fit.matching.model[i];
    if (k < 0) continue;
    const auto row = static_cast<Index>(i);
    series.rows.push_back({measurement, one.body, one.of_mode[at(k)], row});
    error.push_back(std::log(measured.frequency_hz(row) / one.fit.model.frequency_hz(k)));
    noise.push_back(std::hypot(measured.frequency_std(row), is_again ? kSpecimens.repeated : 0.0));
  }
  const auto* mass = mass_of(one);
  if (mass != nullptr && is_first) {
    series.rows.push_back({measurement, one.body, -1, -1});
    error.push_back(std::log(mass->value / one.given.structure.mass_kg));
    noise.push_back(0.0);
  }
}

void add_constants(const SpecimenModel& one, Index bodies, Series& series) {
  const auto entry = [&](const CalibratedConstant& stated) {
    if (entry_of(series, one.body, stated.name) >= 0) return;
    series.entries.push_back(
        {stated, one.body, stated.kind == Kind::measured, VectorXd::Zero(series.count())});
  };
  for (const auto& held : one.held) {
    if (held.stated.kind == Kind::measured) {
      CalibratedConstant stated = held.stated;
      stated.deviation = std::sqrt(
          std::max(std::pow(stated.deviation, 2) - std::pow(kSpecimens.blunder, 2), 1e-12));
      entry(stated);
      continue;
    }
    if (constant_of(series, held.stated.name) < 0) {
      series.constants.push_back({held.stated, held.width, MatrixXd::Zero(series.count(), bodies),
                                  VectorXd::Constant(bodies, std::nan(""))});
    }
    series.constants[at(constant_of(series, held.stated.name))].of_body(one.body) =
        std::log(held.stated.value);
  }
  for (const auto& stated : one.sheet) entry(stated);
}

// The mean of what is stated becomes the value of each constant.
void centre(Series& series) {
  for (auto& one : series.constants) {
    const auto is_stated = one.of_body.array().isFinite();
    const double mean = is_stated.select(one.of_body.array(), 0.0).sum() /
                        static_cast<double>(std::max<Index>(is_stated.count(), 1));
    one.stated.value = std::exp(mean);
    one.of_body = is_stated.select(one.of_body.array() - mean, 0.0).matrix().eval();
  }
}

}  // namespace

SpecimenModels::SpecimenModels(const std::vector<Specimen>& specimens,
                               const DiagnosisOptions& options)
    : specimens_(specimens) {
  Index bodies = 0;
  for (const auto& specimen : specimens) {
    tell(options.progress, specimen.name);
    models_.push_back(made(specimen, options));
    auto& one = *models_.back();
    const auto before =
        std::ranges::find(specimens, specimen.same_as, &Specimen::name) - specimens.begin();
    one.body = specimen.same_as.empty() ? bodies++ : models_[at(before)]->body;
    for (const auto& note : one.given.notes) notes_.push_back(specimen.name + ": " + note);
  }
  start_from_the_others();
  number_the_modes();
}

// A specimen by itself may find constants that pair its modes wrongly. Where constants near the
// median of all specimens do about as well, its modes are paired by these.
void SpecimenModels::start_from_the_others() {
  std::map<std::string, std::vector<double>> values;  // ln, of each constant
  for (const auto& one : models_) {
    for (std::size_t c = 0; c < one->held.size(); ++c) {
      values[one->held[c].stated.name].push_back(std::log(one->held[c].stated.value) +
                                                 one->fit.constants(static_cast<Index>(c)));
    }
  }
  for (auto& one : models_) {
    ModesFit start;
    start.constants = VectorXd::Zero(one->fit.constants.size());
    for (std::size_t c = 0; c < one->held.size(); ++c) {
      const auto& stated = one->held[c].stated;
      if (stated.kind == Kind::measured) continue;
      auto& all = values.at(stated.name);
      std::ranges::sort(all);
      const double median = 0.5 * (all[(all.size() - 1) / 2] + all[all.size() / 2]);
      start.constants(static_cast<Index>(c)) = median - std::log(stated.value);
    }
    const auto cost = [&](const ModesFit& fit) {
      return square_misfit(one->given.measured, fit.model, fit.matching) +
             ((fit.constants - start.constants) / kSpecimens.far_from_others).squaredNorm();
    };
    auto own = one->fit;
    if (!take_constants(*one, start.constants)) continue;
    one->fit = one->problem->fitted(one->fit);
    pair_again(*one);
    if (!(cost(one->fit) < cost(own))) one->fit = std::move(own);
  }
}

void SpecimenModels::number_the_modes() {
  const Structure& design = models_.front()->given.structure;
  if (std::ranges::any_of(
          models_, [](const auto& one) { return one->given.structure.surface.count() == 0; })) {
    for (auto& one : models_) {
      one->of_mode.resize(at(one->fit.model.count()));
      for (std::size_t k = 0; k < one->of_mode.size(); ++k) {
        one->of_mode[k] = static_cast<Index>(k);
        modes_ = std::max(modes_, one->of_mode[k] + 1);
      }
    }
    return;
  }
  DesignModes modes{MatrixXd(design.surface.count(), 0), {}};
  for (auto& one : models_) {
    one->of_mode = numbered(shapes_on(design, *one), one->fit.model.frequency_hz, modes);
  }
  modes_ = modes.shapes.cols();
}

Series SpecimenModels::series() const {
  Series series;
  series.modes = modes_;
  std::vector<double> error, noise;
  std::vector<Index> first;
  std::vector<std::string> groups;
  for (std::size_t m = 0; m < models_.size(); ++m) {
    const auto& own = *models_[m];
    const bool is_again = std::ranges::count_if(models_, [&](const auto& other) {
                            return other->body == own.body;
                          }) > 1;
    first.push_back(static_cast<Index>(error.size()));
    add_rows(own, static_cast<Index>(m), specimens_[m].same_as.empty(), is_again, series, error,
             noise);
    if (!specimens_[m].same_as.empty()) continue;
    series.bodies.push_back(specimens_[m].name);
    const auto& name = specimens_[m].group;
    const auto known = std::ranges::find(groups, name);
    series.has_groups = series.has_groups || (!name.empty() && known != groups.end());
    series.group.push_back(name.empty() || known == groups.end() ? static_cast<Index>(groups.size())
                                                                 : known - groups.begin());
    if (name.empty() || known == groups.end()) groups.push_back(name);
  }
  series.error = Eigen::Map<const VectorXd>(error.data(), static_cast<Index>(error.size()));
  series.noise = Eigen::Map<const VectorXd>(noise.data(), static_cast<Index>(noise.size()));
  for (const auto& one : models_) add_constants(*one, series.body_count(), series);
  centre(series);
  for (std::size_t m = 0; m < models_.size(); ++m) {
    Filler filler(series, *models_[m], first[m]);
    filler.constants();
    filler.sheet();
  }
  return series;
}

void SpecimenModels::move_to(const Series& series, const JointModel& model, const JointFit& fit) {
  for (auto& one : models_) {
    VectorXd x = one->fit.constants;
    for (std::size_t c = 0; c < one->held.size(); ++c) {
      const auto& stated = one->held[c].stated;
      auto& own = x(static_cast<Index>(c));
      if (stated.kind == Kind::measured) {
        own = model.entry(fit, at(entry_of(series, one->body, stated.name)))(0);
        continue;
      }
      const std::size_t constant = at(constant_of(series, stated.name));
      own = model.constant(fit, constant).mean(one->body) -
            series.constants[constant].of_body(one->body);
    }
    take_constants(*one, x);
  }
  number_the_modes();
}

}  // namespace chladni::diagnosis
