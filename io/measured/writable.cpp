#include "io/writable.h"

#include <string>

#include "io/frf_file.h"
#include "io/measured/measured_format.h"
#include "io/time_file.h"
#include "io/uff/frf_uff.h"
#include "io/uff/time_uff.h"

namespace chladni::io {

void require_writable_frf(const std::filesystem::path& file,
                          const std::vector<modal::MeasuredChannel>& outputs,
                          const std::vector<modal::MeasuredChannel>& inputs) {
  modal::FrfSet set;
  set.outputs = outputs;
  set.inputs = inputs;
  set.frequency_hz = Eigen::VectorXd::Ones(1);
  set.value.assign(1, Eigen::MatrixXcd::Zero(set.output_count(), set.input_count()));
  std::vector<std::string> lost;
  switch (written_format(file)) {
    case MeasuredFormat::csv:
      static_cast<void>(frf_csv(set));
      return;
    case MeasuredFormat::uff:
      static_cast<void>(frf_uff(set, UffEncoding::binary, lost));
      return;
    case MeasuredFormat::mat:
      return;
    default:
      refuse_ending(file);
  }
}

void require_writable_time(const std::filesystem::path& file, recordings::TimeData data) {
  const auto samples = [](const auto& channels) {
    return Eigen::MatrixXd(Eigen::MatrixXd::Zero(1, static_cast<Eigen::Index>(channels.size())));
  };
  data.sample_time_s = 1.0;
  data.records.assign(1, {.outputs = samples(data.outputs),
                          .inputs = samples(data.inputs),
                          .references = samples(data.references)});
  std::vector<std::string> lost;
  switch (written_format(file)) {
    case MeasuredFormat::csv:
      static_cast<void>(time_csv(data));
      return;
    case MeasuredFormat::uff:
      static_cast<void>(time_uff(data, UffEncoding::binary, lost));
      return;
    case MeasuredFormat::mat:
      return;
    default:
      refuse_ending(file);
  }
}

}  // namespace chladni::io
