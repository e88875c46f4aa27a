#include "io/writable.h"

#include <string>

#include "io/frf_file.h"
#include "io/measured/measured_format.h"
#include "io/time_file.h"
#include "io/uff/frf_uff.h"
#include "io/uff/time_uff.h"

namespace chladni::io {

namespace {

// Makes what a file of this format holds and throws it away. A .mat holds any name.
template <typename Csv, typename Uff>
void require_made(const std::filesystem::path& file, const Csv& csv, const Uff& uff) {
  std::vector<std::string> lost;
  static_cast<void>(in_written_format(
      file, csv, [&] { return uff(UffEncoding::binary, lost); }, [] { return std::string(); }));
}

}  // namespace

void require_writable_frf(const std::filesystem::path& file,
                          const std::vector<modal::MeasuredChannel>& outputs,
                          const std::vector<modal::MeasuredChannel>& inputs) {
  modal::FrfSet set;
  set.outputs = outputs;
  set.inputs = inputs;
  set.frequency_hz = Eigen::VectorXd::Ones(1);
  set.value.assign(1, Eigen::MatrixXcd::Zero(set.output_count(), set.input_count()));
  require_made(
      file, [&] { return frf_csv(set); },
      [&](UffEncoding encoding, auto& lost) { return frf_uff(set, encoding, lost); });
}

void require_writable_time(const std::filesystem::path& file, recordings::TimeData data) {
  const auto samples = [](const auto& channels) {
    return Eigen::MatrixXd(Eigen::MatrixXd::Zero(1, static_cast<Eigen::Index>(channels.size())));
  };
  data.sample_time_s = 1.0;
  data.records.assign(1, {.outputs = samples(data.outputs),
                          .inputs = samples(data.inputs),
                          .references = samples(data.references)});
  require_made(
      file, [&] { return time_csv(data); },
      [&](UffEncoding encoding, auto& lost) { return time_uff(data, encoding, lost); });
}

}  // namespace chladni::io
