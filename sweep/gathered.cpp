#include "sweep/gathered.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <string_view>
#include <system_error>

#include "base/error.h"
#include "host/atomic_file.h"

namespace chladni::sweep {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kLargestResult = std::size_t{256} << 20U;

const io::Json* member(const io::Json& json, const std::string& key) {
  if (const auto* object = std::get_if<io::JsonObject>(&json.value())) {
    for (const auto& [name, value] : *object) {
      if (name == key) return &value;
    }
  }
  if (const auto* array = std::get_if<io::JsonArray>(&json.value())) {
    std::size_t index = 0;
    const auto [end, fault] = std::from_chars(key.data(), key.data() + key.size(), index);
    if (fault == std::errc() && end == key.data() + key.size() && index < array->size()) {
      return &(*array)[index];
    }
  }
  return nullptr;
}

// The results of one variant; each of its files is read once.
Eigen::VectorXd results_of(const study::SweepPlan& plan, const Entry& entry) {
  Eigen::VectorXd results = Eigen::VectorXd::Constant(std::ssize(plan.results), kNone);
  if (!entry.record || entry.record->exit != 0) return results;
  std::map<std::string, std::optional<io::Json>> files;
  for (Eigen::Index r = 0; r < results.size(); ++r) {
    const auto& result = plan.results[static_cast<std::size_t>(r)];
    auto [at, is_new] = files.try_emplace(result.file);
    std::error_code ignored;
    if (is_new && std::filesystem::exists(entry.folder / result.file, ignored)) {
      at->second = io::parse_json(read_whole(entry.folder / result.file, kLargestResult));
    }
    if (at->second) results(r) = number_at(*at->second, result.at);
  }
  return results;
}

constexpr double kEqual = 1e-9;  // relative: eigenvalues repeat to it

bool dominates(const Eigen::MatrixXd& values, Eigen::Index a, Eigen::Index b) {
  bool better = false;
  for (Eigen::Index k = 0; k < values.cols(); ++k) {
    const double size = std::max(std::abs(values(a, k)), std::abs(values(b, k)));
    if (values(a, k) < values(b, k) - kEqual * size) return false;
    better = better || values(a, k) > values(b, k) + kEqual * size;
  }
  return better;
}

void find_front(const study::SweepPlan& plan, Gathered& gathered) {
  std::vector<Eigen::Index> compared;
  for (std::size_t r = 0; r < plan.results.size(); ++r) {
    if (plan.results[r].better != study::SweepResult::Better::none) {
      compared.push_back(static_cast<Eigen::Index>(r));
    }
  }
  if (compared.empty()) return;
  Eigen::MatrixXd values(std::ssize(gathered.rows), std::ssize(compared));
  for (Eigen::Index i = 0; i < values.rows(); ++i) {
    for (Eigen::Index k = 0; k < values.cols(); ++k) {
      const auto r = compared[static_cast<std::size_t>(k)];
      const bool more =
          plan.results[static_cast<std::size_t>(r)].better == study::SweepResult::Better::more;
      const double value = gathered.rows[static_cast<std::size_t>(i)].results(r);
      values(i, k) = more ? value : -value;
    }
  }
  const auto front = pareto_front(values);
  for (std::size_t i = 0; i < front.size(); ++i) gathered.rows[i].on_front = front[i];
}

}  // namespace

double number_at(const io::Json& json, const std::string& place) {
  const io::Json* at = &json;
  std::string_view rest = place;
  while (at != nullptr && !rest.empty()) {
    const auto dot = rest.find('.');
    at = member(*at, std::string(rest.substr(0, dot)));
    rest = dot == std::string_view::npos ? std::string_view() : rest.substr(dot + 1);
  }
  if (at == nullptr) return kNone;
  if (const auto* whole = std::get_if<long long>(&at->value())) {
    return static_cast<double>(*whole);
  }
  if (const auto* real = std::get_if<double>(&at->value())) return *real;
  return kNone;
}

std::vector<bool> pareto_front(const Eigen::MatrixXd& values) {
  std::vector<bool> front(static_cast<std::size_t>(values.rows()), false);
  for (Eigen::Index i = 0; i < values.rows(); ++i) {
    if (!values.row(i).allFinite()) continue;
    bool dominated = false;
    for (Eigen::Index other = 0; other < values.rows() && !dominated; ++other) {
      dominated = values.row(other).allFinite() && dominates(values, other, i);
    }
    front[static_cast<std::size_t>(i)] = !dominated;
  }
  return front;
}

Gathered gathered(const Sweep& sweep) {
  Gathered all;
  for (long long i = 0; i < sweep.size(); ++i) {
    GatheredRow row{sweep.entry(i), {}, false};
    row.entry.text.clear();
    row.results = results_of(sweep.plan(), row.entry);
    if (!row.entry.record) {
      ++all.open;
    } else if (row.entry.record->exit == 0) {
      ++all.done;
    } else {
      ++all.failed;
    }
    all.rows.push_back(std::move(row));
  }
  find_front(sweep.plan(), all);
  return all;
}

}  // namespace chladni::sweep
