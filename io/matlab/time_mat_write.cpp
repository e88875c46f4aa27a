#include <fmt/format.h>

#include "base/error.h"
#include "io/matlab/mat_channels.h"
#include "io/matlab/time_mat.h"
#include "io/matlab/time_sides.h"

namespace chladni::io {

MatFields mat_of_time(const recordings::TimeData& data) {
  MatFields fields;
  const auto records = static_cast<Eigen::Index>(data.records.size());
  const Eigen::Index samples = data.records.empty() ? 0 : data.records.front().outputs.rows();
  const std::array sides{&data.outputs, &data.inputs, &data.references};
  Eigen::MatrixXd experiment(records, 1);
  Eigen::MatrixXd realisation(records, 1);
  for (std::size_t s = 0; s < 3; ++s) {
    if (sides[s]->empty()) continue;
    const auto count = static_cast<Eigen::Index>(sides[s]->size());
    Eigen::VectorXd numbers(samples * count * records);
    for (Eigen::Index r = 0; r < records; ++r) {
      const auto& record = data.records[static_cast<std::size_t>(r)];
      const auto& part = record.*kSamplesOf[s];
      require(part.rows() == samples && part.cols() == count,
              "MAT: record " + fmt::to_string(r + 1) + " has " + fmt::to_string(part.rows()) +
                  " samples of " + kSide[s] + "s, the first has " + fmt::to_string(samples));
      numbers.segment(r * samples * count, samples * count) = part.reshaped();
      experiment(r) = record.experiment;
      realisation(r) = record.realisation;
    }
    fields.emplace_back(kVariable[s], MatValue({samples, count, records}, std::move(numbers)));
    add_channels(fields, kSide[s], *sides[s]);
  }
  add_kinds(fields, data.outputs);
  fields.emplace_back("sample_time_s", data.sample_time_s);
  if (data.period > 0) fields.emplace_back("period", static_cast<double>(data.period));
  fields.emplace_back("experiment", experiment);
  fields.emplace_back("realisation", realisation);
  return fields;
}

}  // namespace chladni::io
