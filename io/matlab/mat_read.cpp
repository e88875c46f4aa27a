// Reads the reply of the worker chladni-mat.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "host/atomic_file.h"
#include "host/worker.h"
#include "io/bytes/message.h"
#include "io/mat.h"
#include "io/matlab/mat_parts.h"

namespace chladni::io {
namespace {

Eigen::VectorXd numbers(const Message& found, const Json& json, const char* key) {
  const std::string& name = json.at(key).string();
  if (name.empty()) return {};
  return found.numbers(name).reshaped();
}

// The dimensions. They must be whole numbers, and their product must not be too large.
std::vector<Eigen::Index> dims_of(const Json& json) {
  constexpr double most = 1e15;
  std::vector<Eigen::Index> dims;
  double product = 1.0;
  for (const auto& n : json.at("dims").array()) {
    const double size = n.number();
    product *= std::max(size, 1.0);
    require(size >= 0.0 && size == std::floor(size) && product <= most,
            "its reader says that an array has a dimension of " + fmt::to_string(size));
    dims.push_back(static_cast<Eigen::Index>(size));
  }
  require(dims.size() >= 2, "its reader says that an array has less than two dimensions");
  return dims;
}

// Checks that the counts of numbers and cells agree with the dimensions.
void require_size(const MatValue& value) {
  const auto fits = [&](Eigen::Index count) {
    require(count == value.size(), "its reader says that an array has " +
                                       fmt::to_string(value.size()) + " elements, and sends " +
                                       fmt::to_string(count));
  };
  if (value.kind == MatValue::Kind::cell || value.kind == MatValue::Kind::structures) {
    fits(std::ssize(value.cells));
  }
  if (value.kind != MatValue::Kind::number) return;
  fits(value.real.size());
  if (value.imag.size() > 0) fits(value.imag.size());
}

MatValue value_of(const Message& found, const Json& json) {
  MatValue value;
  value.class_name = json.at("class").string();
  value.dims = dims_of(json);
  const std::string& kind = json.at("kind").string();
  if (kind == "number") {
    value.kind = MatValue::Kind::number;
    value.real = numbers(found, json, "real");
    value.imag = numbers(found, json, "imag");
  } else if (kind == "large") {
    value.kind = MatValue::Kind::large;
  } else if (kind == "text") {
    value.kind = MatValue::Kind::text;
    for (const auto& row : json.at("rows").array()) value.text.push_back(row.string());
  } else if (kind == "cell" || kind == "structures") {
    value.kind = kind == "cell" ? MatValue::Kind::cell : MatValue::Kind::structures;
    for (const auto& cell : json.at("cells").array()) value.cells.push_back(value_of(found, cell));
  } else if (kind == "structure") {
    value.kind = MatValue::Kind::structure;
    for (const auto& field : json.at("fields").array()) {
      value.fields.emplace_back(field.at("name").string(), value_of(found, field.at("value")));
    }
  }
  require_size(value);
  return value;
}

MatFile file_of(const Message& found) {
  MatFile file;
  file.format = found.head.at("format").string();
  for (const auto& note : found.head.at("notes").array()) file.notes.push_back(note.string());
  for (const auto& variable : found.head.at("variables").array()) {
    file.variables.emplace_back(variable.at("name").string(),
                                value_of(found, variable.at("value")));
  }
  return file;
}

// The limits of time and memory grow with the allowed content. A file that needs more is not valid.
WorkerLimits limits(const std::filesystem::path& file, std::size_t limit_bytes) {
  return {.time = std::chrono::seconds(30 + limit_bytes / 20'000'000),
          .memory_bytes = (std::size_t{1} << 30U) + 4 * limit_bytes,
          .confined = true,
          .files = {file}};
}

// Asks the worker, and reads its reply. @param arguments  after the name of the file
template <class Read>
auto answer_of(const std::filesystem::path& file, std::vector<std::string> arguments,
               std::size_t limit_bytes, Read read) {
  require(std::filesystem::is_regular_file(file),
          file.string() + ": there is no such file, or it is not a regular one");
  const std::filesystem::path worker = worker_path("chladni-mat");
  arguments.insert(arguments.begin(), file.string());
  try {
    const auto result = run_worker(worker, arguments, "", limits(file, limit_bytes));
    return reply_of(worker, [&] { return read(message(result.output)); });
  } catch (const UnusableReply&) {
    throw;
  } catch (const ForbiddenCall& call) {
    throw ForbiddenCall(file.string() + ": " + call.what());
  } catch (const WorkerDied& died) {
    throw InvalidInput(file.string() + ": not a readable .mat file: " + died.what());
  } catch (const InvalidInput& error) {
    throw InvalidInput(file.string() + ": " + error.what());
  }
}

}  // namespace

MatFile read_mat(const std::filesystem::path& file, std::size_t limit_bytes) {
  return answer_of(file, {fmt::to_string(limit_bytes)}, limit_bytes, &file_of);
}

MatFile read_mat_heads(const std::filesystem::path& file, std::size_t limit_bytes,
                       std::size_t large_bytes) {
  return answer_of(file, {fmt::to_string(limit_bytes), fmt::to_string(large_bytes)}, limit_bytes,
                   &file_of);
}

Eigen::VectorXd read_mat_part(const std::filesystem::path& file, const std::string& variable,
                              const std::vector<Eigen::Index>& start,
                              const std::vector<Eigen::Index>& count) {
  Eigen::Index numbers_in_all = 1;
  for (const auto n : count) numbers_in_all *= n;
  const auto bytes = sizeof(double) * static_cast<std::size_t>(numbers_in_all);
  std::vector<std::string> arguments{fmt::to_string(bytes), "part", variable};
  for (std::size_t d = 0; d < start.size(); ++d) {
    arguments.push_back(fmt::to_string(start[d]));
    arguments.push_back(fmt::to_string(count[d]));
  }
  return answer_of(file, arguments, bytes, [&](const Message& found) -> Eigen::VectorXd {
    Eigen::VectorXd part = numbers(found, found.head, "real");
    require(part.size() == numbers_in_all, "its reader sends " + fmt::to_string(part.size()) +
                                               " numbers of " + fmt::to_string(numbers_in_all));
    return part;
  });
}

}  // namespace chladni::io
