// Writes measured responses as variables of a .mat file.
#include <array>

#include "io/matlab/frf_mat.h"
#include "io/matlab/mat_channels.h"

namespace chladni::io {
namespace {

using Index = Eigen::Index;

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
  const bool is_cube = dims[0] == dims[1] && dims[1] == dims[2] && dims[2] > 1;
  if (is_cube) fields.emplace_back("dimensions", std::string(kLinesLast));
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
  add_channels(fields, "output", set.outputs);
  add_channels(fields, "input", set.inputs);
  return fields;
}

}  // namespace chladni::io
