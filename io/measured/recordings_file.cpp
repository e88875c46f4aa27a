// A table of recordings, row by row.
#include "io/recordings_file.h"

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/interrupt.h"
#include "io/bytes/csv_table.h"
#include "io/bytes/scratch_file.h"
#include "io/measured/time_columns.h"

namespace chladni::io {
namespace {

using Eigen::Index;

constexpr std::size_t kBlockRows = 65536;

/// Columns of the scratch file beside those of the channels.
enum Extra : Index { time_column = 0, line_column = 1, extra_columns = 2 };

/// Some rows of a record, column by column.
struct Block {
  std::uint64_t at = 0;
  Index first = 0, rows = 0;
};

/// The samples on the disk: channels of the three sides, then time and lines of the file.
class Store {
 public:
  void begin_record() { records_.emplace_back(); }

  void append(const Eigen::MatrixXd& columns) {
    auto& blocks = records_.back();
    const Index first = blocks.empty() ? 0 : blocks.back().first + blocks.back().rows;
    blocks.push_back({file_.append(columns.data(), static_cast<std::size_t>(columns.size())), first,
                      columns.rows()});
  }

  [[nodiscard]] Eigen::VectorXd read(std::size_t record, Index column, Index first,
                                     Index count) const {
    throw_if_interrupted();
    Eigen::VectorXd result(count);
    const auto& blocks = records_[record];
    auto block = std::ranges::upper_bound(blocks, first, {}, &Block::first) - 1;
    for (Index done = 0; done < count; ++block) {
      const Index skip = first + done - block->first;
      const Index rows = std::min(count - done, block->rows - skip);
      const auto place = static_cast<std::uint64_t>(column * block->rows + skip);
      file_.read(block->at + sizeof(double) * place, result.data() + done,
                 static_cast<std::size_t>(rows));
      done += rows;
    }
    return result;
  }

 private:
  ScratchFile file_;
  std::vector<std::vector<Block>> records_;
};

/// Reads the rows of a file into a store, record by record and block by block.
class Pieces {
 public:
  Pieces(const std::filesystem::path& file, const TimeOptions& options)
      : rows_(file), options_(options), table_(rows_.head()) {
    layout_ = layout_of(table_, options_, head_);
    require(layout_.time >= 0 || options.sample_time_s > 0.0, no_sample_time(table_));
    head_.data.sample_time_s = options.sample_time_s;
    head_.data.period = options.period;
  }

  RecordingsFile all() {
    std::vector<double> before;
    std::vector<double> row;
    std::vector<int> line;
    while (rows_.next(row, line)) {
      if (before.empty() || starts_another(before, row)) begin(row, line);
      numbers_.insert(numbers_.end(), row.begin(), row.end());
      table_.line.push_back(line.front());
      std::swap(before, row);
      row.clear();
      line.clear();
      if (table_.line.size() == kBlockRows) put_away();
    }
    require(!recordings_.records.empty(), table_.file + ": no line of numbers below the names");
    finish();
    return {"CSV", recordings(), head_.notes};
  }

 private:
  [[nodiscard]] bool starts_another(const std::vector<double>& before,
                                    const std::vector<double>& row) const {
    const auto differs = [&](Index column) {
      const auto c = static_cast<std::size_t>(column);
      return column >= 0 && row[c] != before[c];
    };
    return differs(layout_.experiment) || differs(layout_.realisation);
  }

  // A record begins with this row. Its numbers are refused before what is wrong with the one
  // before.
  void begin(const std::vector<double>& row, const std::vector<int>& line) {
    CsvTable one = rows_.head();
    one.line = line;
    one.values = Eigen::Map<const Eigen::RowVectorXd>(row.data(), std::ssize(row));
    const auto start = stretches_of(one, layout_).front();
    if (!recordings_.records.empty()) finish();
    recordings_.records.push_back({0, start.experiment, start.realisation});
    store_->begin_record();
  }

  // Checks the rows that were read, and writes them to the store.
  void put_away() {
    throw_if_interrupted();
    using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    const Index rows = std::ssize(table_.line);
    if (rows == 0) return;
    table_.values = Eigen::Map<const Rows>(numbers_.data(), rows, std::ssize(table_.names));
    check_times(table_, layout_);
    look_at_periods([&] { runs_.add(table_, 0, rows, layout_.period); });
    const auto record = record_of(table_, layout_, {.first = 0, .end = rows});
    Eigen::MatrixXd columns(rows, channel_count() + extra_columns);
    columns << record.outputs, record.inputs, record.references,
        Eigen::MatrixXd::Zero(rows, extra_columns);
    if (layout_.time >= 0) {
      columns.col(channel_count() + time_column) =
          layout_.seconds * table_.values.col(layout_.time);
    }
    for (Index row = 0; row < rows; ++row) {
      columns(row, channel_count() + line_column) = table_.line[static_cast<std::size_t>(row)];
    }
    store_->append(columns);
    recordings_.records.back().samples += rows;
    numbers_.clear();
    table_.line.clear();
  }

  void finish() {
    put_away();
    if (layout_.time >= 0) look_at_steps();
    look_at_periods([&] { runs_.end(); });
    require(period_fault_.empty(), period_fault_);
    if (has_period_column()) head_.data.period = runs_.length();
  }

  // A period that is too short is told after the time of the record: samples may be missing.
  template <typename Look>
  void look_at_periods(Look look) {
    if (!has_period_column() || !period_fault_.empty()) return;
    try {
      look();
    } catch (const InvalidInput& fault) {
      period_fault_ = fault.what();
    }
  }

  [[nodiscard]] bool has_period_column() const {
    return options_.period == 0 && layout_.period >= 0;
  }
  [[nodiscard]] Index channel_count() const {
    return std::ssize(head_.data.outputs) + std::ssize(head_.data.inputs) +
           std::ssize(head_.data.references);
  }
  // Those of the record that ends.
  [[nodiscard]] RecordedTimes times() const {
    const auto record = recordings_.records.size() - 1;
    const auto column = channel_count();
    return {.file = table_.file,
            .name = time_name(table_, layout_),
            .samples = recordings_.records.back().samples,
            .times =
                [store = store_, record, column](Index first, Index count) {
                  return store->read(record, column + time_column, first, count);
                },
            .line =
                [store = store_, record, column](Index row) {
                  return static_cast<int>(store->read(record, column + line_column, row, 1)(0));
                }};
  }

  void look_at_steps() {
    const auto time = times();
    auto& step = head_.data.sample_time_s;
    if (recordings_.records.size() == 1) step = step_of(time);
    check_steps(time, step);
  }

  [[nodiscard]] recordings::Recordings recordings() {
    recordings_.head = head_.data;
    const auto outputs = std::ssize(head_.data.outputs);
    const auto inputs = std::ssize(head_.data.inputs);
    recordings_.samples = [store = store_, outputs, inputs](std::size_t record,
                                                            recordings::Side side, Index channel,
                                                            Index first, Index count) {
      const Index before = side == recordings::Side::outputs  ? 0
                           : side == recordings::Side::inputs ? outputs
                                                              : outputs + inputs;
      return store->read(record, before + channel, first, count);
    };
    return recordings_;
  }

  CsvRows rows_;
  const TimeOptions& options_;
  CsvTable table_;  ///< rows of the record that is read, which are not put away yet
  std::vector<double> numbers_;
  TimeFile head_{.format = "CSV", .data = {}, .notes = {}};
  RecordLayout layout_;
  PeriodRuns runs_;
  std::string period_fault_;  ///< of the record that is read; empty: none
  recordings::Recordings recordings_;
  std::shared_ptr<Store> store_ = std::make_shared<Store>();
};

}  // namespace

RecordingsFile read_csv_in_pieces(const std::filesystem::path& file, const TimeOptions& options) {
  return Pieces(file, options).all();
}

}  // namespace chladni::io
