// Writes measured responses as variables of a .mat file.
#include <array>
#include <limits>

#include "io/matlab/frf_mat.h"

namespace chladni::io {
namespace {

using Index = Eigen::Index;

void add_channels(const std::string& side, const std::vector<modal::MeasuredChannel>& channels,
                  MatFields& fields) {
  const auto count = static_cast<Index>(channels.size());
  const double nothing = std::numeric_limits<double>::quiet_NaN();
  std::vector<std::string> names, units;
  Eigen::MatrixXd node = Eigen::MatrixXd::Constant(count, 1, nothing);
  Eigen::MatrixXd direction(count, 3);
  Eigen::MatrixXd position = Eigen::MatrixXd::Constant(count, 3, nothing);
  bool any_unit = false;
  for (Index c = 0; c < count; ++c) {
    const auto& channel = channels[static_cast<std::size_t>(c)];
    names.push_back(channel.name);
    units.push_back(channel.unit);
    any_unit = any_unit || !channel.unit.empty();
    if (channel.node) node(c) = static_cast<double>(*channel.node);
    direction.row(c) = channel.direction.transpose();
    if (channel.position) position.row(c) = channel.position->transpose();
  }
  fields.emplace_back(side + "_names", names);
  if (any_unit) fields.emplace_back(side + "_unit", units);
  if (!node.array().isNaN().all()) fields.emplace_back(side + "_node", node);
  if (direction.any()) fields.emplace_back(side + "_direction", direction);
  if (!position.array().isNaN().all()) fields.emplace_back(side + "_position", position);
}

// The numbers of all lines as one array p×q×k.
template <typename Matrix, typename Part>
Eigen::VectorXd flat(const std::vector<Matrix>& lines, Part part) {
  const Index each = lines.empty() ? 0 : lines.front().size();
  Eigen::VectorXd numbers(each * static_cast<Index>(lines.size()));
  for (std::size_t k = 0; k < lines.size(); ++k) {
    for (Index n = 0; n < each; ++n) numbers(static_cast<Index>(k) * each + n) = part(lines[k](n));
  }
  return numbers;
}

}  // namespace

MatFields mat_of_frf(const modal::FrfSet& set) {
  modal::check(set);
  const std::vector<Index> dims{set.output_count(), set.input_count(), set.line_count()};
  MatFields fields;
  fields.emplace_back("freq_hz", Eigen::MatrixXd(set.frequency_hz));
  fields.emplace_back(
      "H", MatValue(dims, flat(set.value, [](const auto& value) { return value.real(); }),
                    flat(set.value, [](const auto& value) { return value.imag(); })));
  const auto itself = [](double value) { return value; };
  const auto add = [&](const char* name, const std::vector<Eigen::MatrixXd>& of) {
    if (!of.empty()) fields.emplace_back(name, MatValue(dims, flat(of, itself)));
  };
  add("variance", set.variance);
  add("noise_variance", set.noise_variance);
  add("coherence", set.coherence);
  if (set.averages > 0.0) fields.emplace_back("averages", set.averages);
  constexpr std::array<const char*, 3> kinds{"receptance", "mobility", "accelerance"};
  std::vector<std::string> kind;
  for (const auto& output : set.outputs) {
    kind.emplace_back(kinds[static_cast<std::size_t>(output.kind)]);
  }
  fields.emplace_back("kind", kind);
  add_channels("output", set.outputs, fields);
  add_channels("input", set.inputs, fields);
  return fields;
}

}  // namespace chladni::io
