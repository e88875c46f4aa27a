#include "io/uff/time_uff.h"

#include <array>
#include <cstdint>
#include <memory>

#include "base/interrupt.h"
#include "io/bytes/scratch_file.h"
#include "io/measured/record_sides.h"
#include "io/uff/uff_recordings.h"

namespace chladni::io {
namespace {

using Index = Eigen::Index;
using recordings::Record;

Record uff_record_of(const UffRecordings& all, const UffRecord& found, const Uff& uff) {
  const auto& data = all.head().data;
  Record record;
  record.outputs.setZero(found.samples, std::ssize(data.outputs));
  record.inputs.setZero(found.samples, std::ssize(data.inputs));
  record.references.setZero(found.samples, std::ssize(data.references));
  record.experiment = found.experiment;
  record.realisation = found.realisation;
  for (const auto& part : found.parts) {
    (record.*kSamplesOf[static_cast<std::size_t>(part.side)]).col(part.channel) =
        all.stated_factor(part) * (part.factor * uff.functions[part.function].y.real());
  }
  return record;
}

/// Samples of recordings on the disk.
struct UffStore {
  struct Samples {
    std::uint64_t at = 0;
    double factor = 1.0, stated_factor = 1.0;
  };
  using Where = std::array<std::vector<Samples>, 3>;  // of the channels of each side
  ScratchFile file;
  std::vector<Where> records;

  [[nodiscard]] Eigen::VectorXd read(std::size_t record, recordings::Side side, Index channel,
                                     Index first, Index count) const {
    throw_if_interrupted();
    const auto& where =
        records[record][static_cast<std::size_t>(side)][static_cast<std::size_t>(channel)];
    Eigen::VectorXd samples(count);
    file.read(where.at + sizeof(double) * static_cast<std::uint64_t>(first), samples.data(),
              static_cast<std::size_t>(count));
    return where.stated_factor * (where.factor * samples);
  }
};

UffStore::Where where_of(const UffRecordings& all, const UffRecord& found,
                         const std::vector<std::uint64_t>& begins) {
  const auto& data = all.head().data;
  UffStore::Where where;
  where[0].resize(data.outputs.size());
  where[1].resize(data.inputs.size());
  where[2].resize(data.references.size());
  for (const auto& part : found.parts) {
    where[static_cast<std::size_t>(part.side)][static_cast<std::size_t>(part.channel)] = {
        begins[part.function], part.factor, all.stated_factor(part)};
  }
  return where;
}

}  // namespace

TimeFile parse_time_uff(std::string_view bytes, const std::string& name,
                        const TimeOptions& options) {
  const Uff uff = parse_uff(bytes, name, options.limit_bytes);
  std::vector<UffTrace> traces;
  for (const auto& function : uff.functions) traces.push_back(trace_of(function));
  const UffRecordings all(uff, traces, name, options);
  TimeFile file = all.head();
  for (const auto& found : all.records()) {
    file.data.records.push_back(uff_record_of(all, found, uff));
  }
  return file;
}

bool states_period(std::string_view begin_of_file) {
  return begin_of_file.find("\n" + std::string(kUffPeriod)) != std::string_view::npos;
}

RecordingsFile parse_time_uff_in_pieces(std::string_view bytes, const std::string& name,
                                        const TimeOptions& options) {
  const auto store = std::make_shared<UffStore>();
  std::vector<UffTrace> traces;
  std::vector<std::uint64_t> begins;  // of the samples of each function
  const Uff uff = parse_uff(bytes, name, options.limit_bytes, [&](UffFunction& function) {
    throw_if_interrupted();
    traces.push_back(trace_of(function));
    Eigen::VectorXd samples;
    if (is_recording(function)) samples = function.y.real();
    begins.push_back(store->file.append(samples.data(), static_cast<std::size_t>(samples.size())));
    function.x.resize(0);
    function.y.resize(0);
  });
  const UffRecordings all(uff, traces, name, options);
  RecordingsFile result{all.head().format, {}, all.head().notes};
  result.data.head = all.head().data;
  for (const auto& found : all.records()) {
    result.data.records.push_back({found.samples, found.experiment, found.realisation});
    store->records.push_back(where_of(all, found, begins));
  }
  result.data.samples = [store](std::size_t record, recordings::Side side, Index channel,
                                Index first, Index count) {
    return store->read(record, side, channel, first, count);
  };
  return result;
}

}  // namespace chladni::io
