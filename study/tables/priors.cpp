// [priors] of a study: the hyper-parameters to learn from its modes.
#include <algorithm>

#include "priors/kernel.h"
#include "study/tables/tables.h"

namespace chladni::study {
namespace {

constexpr double kFewestSamples = 4.0;
constexpr double kMostSamples = 4000.0;  // N³: a minute and 400 MB

void read_samples(TableReader& table, PriorsPlan& plan) {
  const TomlNode* node = table.find("samples");
  if (node == nullptr) return;
  plan.samples.clear();
  const auto add = [&](const TomlNode& one) {
    if (one.kind == TomlNode::Kind::integer && one.number >= kFewestSamples &&
        one.number <= kMostSamples) {
      plan.samples.push_back(static_cast<int>(one.number));
    } else {
      table.wrong(one, table.name("samples") + " holds " + description(one) +
                           "; expected numbers of samples from 4 to 4000");
    }
  };
  if (node->kind == TomlNode::Kind::array && !node->elements.empty()) {
    for (const auto& element : node->elements) add(element);
  } else {
    add(*node);
  }
  std::sort(plan.samples.begin(), plan.samples.end());
}

}  // namespace

void read_priors(TableReader& root, Study& study) {
  auto table = root.table("priors");
  if (!table) return;
  auto& plan = study.priors.emplace();
  std::vector<std::string> names;
  for (const auto* kernel : priors::kernels()) names.emplace_back(kernel->name);
  plan.kernel = table->choice("kernel", names).value_or(plan.kernel);
  plan.per_axis = table->choice("axes", {"isotropic", "per_axis"}).value_or("") == "per_axis";
  plan.by = table->choice("by", {"marginal_likelihood", "leave_one_out"}).value_or(plan.by);
  plan.modes = static_cast<int>(table->integer("modes", 1, kMostModes).value_or(0));
  if (const TomlNode* node = table->find("modes")) {
    plan.modes_line = node->line;
    plan.modes_column = node->column;
  }
  read_samples(*table, plan);
  const TomlNode* ratio = table->find("noise_ratio");
  if (ratio != nullptr && ratio->text == "learned") {
    plan.learn_noise = true;
  } else {
    plan.noise_ratio =
        table->quantity("noise_ratio", "1", Sign::positive).value_or(plan.noise_ratio);
    if (plan.noise_ratio < 1e-8 || plan.noise_ratio > 1.0) {
      table->wrong(*ratio, table->name("noise_ratio") +
                               " is outside 1e-8 to 1; below, rounding would choose the length");
    }
  }
  plan.on = read_faces(*table, "on");
  read_motion(*table, plan.direction, plan.along_normal);
  table->refuse_unknown();
}

}  // namespace chladni::study
