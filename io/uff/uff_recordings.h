// The recordings of a universal file: their channels, and which functions hold their samples.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/time_file.h"
#include "io/uff/uff.h"
#include "io/uff/uff_channels.h"

namespace chladni::io {

/// Identification lines of what time_uff writes.
inline constexpr std::string_view kUffSide = "side: ", kUffPeriod = "period: ";
inline constexpr std::array<std::string_view, 3> kUffSides{"output", "input", "reference"};

/// Whether a function is the time response of a channel.
[[nodiscard]] bool is_recording(const UffFunction& function);

/// What the samples of a function say; they may lie elsewhere.
struct UffTrace {
  Eigen::Index count = 0;
  double step = 0.0, start = 0.0;  ///< [s]
  std::string fault;               ///< of its time; empty: none
  bool is_finite = true;
};
[[nodiscard]] UffTrace trace_of(const UffFunction& function);

/// The samples of one channel in a recording.
struct UffPart {
  std::size_t function = 0;  ///< its number in the file
  Side side = Side::output;
  Eigen::Index channel = 0;
  double factor = 1.0;  ///< to SI
};

struct UffRecord {
  int experiment = 0, realisation = 0;
  Eigen::Index samples = 0;
  std::vector<UffPart> parts;  ///< one per channel
};

/// The names of channels. Degrees of freedom that share a name in the file get names made of node
/// and direction.
class UffNames {
 public:
  explicit UffNames(const std::vector<UffFunction>& functions);
  [[nodiscard]] std::string of(const UffFunction& function) const;

 private:
  using Degree = std::pair<long long, int>;
  std::map<std::string, std::set<Degree>> whose_;
};

/// Channels and recordings, from the heads of the functions and what their samples say.
class UffRecordings {
 public:
  /// @param traces  of each function; all arguments outlive this
  /// @throws InvalidInput  no recording; recordings that differ in channels, length or step; a time
  ///                       without one step, a sample that is no number
  UffRecordings(const Uff& uff, const std::vector<UffTrace>& traces, const std::string& name,
                const TimeOptions& options);

  /// Format, channels, sampling and notes, without samples.
  [[nodiscard]] const TimeFile& head() const { return file_; }
  [[nodiscard]] const std::vector<UffRecord>& records() const { return records_; }
  /// The factor on the values of a part, after its own: of a unit that the options state.
  [[nodiscard]] double stated_factor(const UffPart& part) const {
    return part.side == Side::output ? stated_factor_(part.channel) : 1.0;
  }

 private:
  using Key = std::array<long long, 3>;            // experiment, version, count within its channel
  using Taking = std::pair<long long, long long>;  // version and count

  [[noreturn]] void fail(const std::string& what) const;
  [[nodiscard]] std::string place(const UffFunction& function) const;
  [[nodiscard]] std::string place(const UffPart& part) const;
  std::vector<modal::MeasuredChannel>& channels(Side side);
  void take(std::size_t f);
  // Whether what a function states is another quantity than that of its channel before.
  [[nodiscard]] bool is_of_another_quantity(Side side, Eigen::Index number, const UffScale& scale);
  void note_once(const std::string& note);
  void take_sample_time(const UffFunction& function, const UffTrace& trace);
  void finish();
  void state_unit();
  // The realisations: versions, where each is there once, else in order of version and count.
  [[nodiscard]] std::map<Taking, int> realisations() const;
  void add_record(long long experiment, int realisation, const std::vector<UffPart>& parts);

  const Uff& uff_;
  const std::vector<UffTrace>& traces_;
  const std::string& name_;
  const TimeOptions& options_;
  UffNames names_;
  TimeFile file_;
  std::map<Key, std::vector<UffPart>> parts_;
  std::vector<UffRecord> records_;
  std::vector<std::optional<modal::FrfKind>> stated_kind_;  // of each output, by the file
  Eigen::VectorXd stated_factor_;
};

}  // namespace chladni::io
