#include <fmt/format.h>

#include <array>

#include "base/error.h"
#include "io/measured/frf_units.h"
#include "io/measured/record_sides.h"
#include "io/scan.h"
#include "io/uff/time_uff.h"
#include "io/uff/uff_channels.h"
#include "io/uff/uff_recordings.h"

namespace chladni::io {
namespace {

using Index = Eigen::Index;

UffAxis ordinate_of(const modal::MeasuredChannel& channel, Side side) {
  constexpr std::array<int, 3> types{8, 11, 12};
  constexpr std::array<const char*, 3> labels{"Displacement", "Velocity", "Acceleration"};
  UffAxis axis;
  axis.unit = channel.unit;
  const auto kind = static_cast<std::size_t>(channel.kind);
  if (side == Side::output) {
    axis.label = labels[kind];
    if (motion_unit(channel.unit)) axis.type = types[kind];
  } else if (force_unit(channel.unit)) {
    axis.type = 13;
    axis.label = "Excitation";
  }
  return axis;
}

}  // namespace

std::string time_uff(const recordings::TimeData& data, UffEncoding encoding,
                     std::vector<std::string>& lost) {
  const UffSides sides{&data.outputs, &data.inputs, &data.references};
  const auto dofs = dofs_of(sides);
  std::string text = uff_head("recordings", places_of(sides, dofs, lost));
  UffFunction function;
  function.type = 1;
  function.abscissa.type = 17;
  function.abscissa.label = "Time";
  function.abscissa.unit = "s";
  if (data.period > 0) function.id[2] = std::string(kUffPeriod) + fmt::to_string(data.period);
  for (const auto& record : data.records) {
    function.load_case = record.experiment;
    function.version = record.realisation;
    for (std::size_t s = 0; s < 3; ++s) {
      const auto& samples = record.*kSamplesOf[s];
      function.id[4] = std::string(kUffSide) + std::string(kUffSides[s]);
      for (std::size_t c = 0; c < sides[s]->size(); ++c) {
        const auto& channel = (*sides[s])[c];
        require(channel.name.size() <= 60 && trimmed(channel.name) == channel.name &&
                    channel.name.find_first_of("\r\n") == std::string::npos,
                "UFF cannot hold the channel name " + shown(channel.name));
        function.id[3] = std::string(kResponseName) + channel.name;
        function.response = dofs[s][c];
        function.ordinate = ordinate_of(channel, static_cast<Side>(s));
        function.x = Eigen::VectorXd::LinSpaced(samples.rows(), 0.0,
                                                static_cast<double>(samples.rows() - 1)) *
                     data.sample_time_s;
        function.y = samples.col(static_cast<Index>(c)).cast<std::complex<double>>();
        text += uff_dataset(function, encoding);
      }
    }
  }
  return text;
}

}  // namespace chladni::io
