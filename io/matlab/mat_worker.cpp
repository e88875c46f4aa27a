// The program chladni-mat reads the .mat file named on its command line with libmatio, checks every
// size before it reads the data, and writes the variables to stdout, or a part of one of them. A
// crash of it does no harm.
#include <matio.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <exception>
#include <iostream>
#include <limits>
#include <memory>

#include "base/error.h"
#include "io/bytes/message.h"
#include "io/matlab/mat_worker_checks.h"

namespace {

using chladni::require;
using chladni::io::Json;
using chladni::io::JsonArray;
using chladni::io::JsonObject;
using chladni::io::Message;
using chladni::mat_worker::place_of;
using chladni::mat_worker::require_whole;

constexpr int kDeepest = 16;
constexpr std::size_t kMostElements = 100'000;  // cells and fields

std::string first_error;  // of libmatio

void keep_error(int level, char* words) {
  if ((level & (MATIO_LOG_LEVEL_ERROR | (MATIO_LOG_LEVEL_CRITICAL))) != 0 && first_error.empty()) {
    first_error = words;
  }
}

// MATLAB's name of the class.
const char* class_name(const matvar_t& variable) {
  constexpr const char* names[] = {"empty",  "cell",   "struct", "object", "char",     "sparse",
                                   "double", "single", "int8",   "uint8",  "int16",    "uint16",
                                   "int32",  "uint32", "int64",  "uint64", "function", "opaque"};
  const auto index = static_cast<std::size_t>(variable.class_type);
  return variable.isLogical != 0 ? "logical" : index < std::size(names) ? names[index] : "unknown";
}

// The number of elements. It refuses more than the limit, before anything is allocated.
std::size_t element_count(const matvar_t& variable, std::size_t limit) {
  double count = 1.0;
  require(
      variable.rank >= 0 && variable.rank <= 32 && (variable.rank == 0 || variable.dims != nullptr),
      "an array of " + std::to_string(variable.rank) + " dimensions");
  for (int d = 0; d < variable.rank; ++d) count *= static_cast<double>(variable.dims[d]);
  require(count <= static_cast<double>(limit),
          std::string("a variable ") + (variable.name != nullptr ? variable.name : "") + " of " +
              std::to_string(count) + " elements is more than is read at once (" +
              std::to_string(limit) + ")");
  return static_cast<std::size_t>(count);
}

class Reader {
 public:
  explicit Reader(std::size_t limit_bytes) : limit_(limit_bytes) {}

  // @param large_bytes  of real variables that are left in the file
  Message read(const char* file, double large_bytes) {
    const auto mat = opened(file);
    JsonArray variables;
    while (matvar_t* next = Mat_VarReadNextInfo(mat.get())) {
      const std::unique_ptr<matvar_t, void (*)(matvar_t*)> variable(next, Mat_VarFree);
      const std::string name = next->name != nullptr ? next->name : "";
      if (is_left(*next, large_bytes)) {
        variables.emplace_back(JsonObject{
            {"name", name},
            {"value",
             JsonObject{{"class", class_name(*next)}, {"dims", dims(*next)}, {"kind", "large"}}}});
        continue;
      }
      static_cast<void>(element_count(*next, limit_ / 8));
      if (Mat_VarReadDataAll(mat.get(), next) != 0 || !first_error.empty()) {
        throw chladni::InvalidInput("the variable " + name + " is damaged" +
                                    (first_error.empty() ? "" : ": " + first_error));
      }
      variables.emplace_back(JsonObject{{"name", name}, {"value", value(*next, 0)}});
      require(variables.size() < kMostElements, "more than 100 000 variables");
    }
    require(first_error.empty(), "damaged: " + first_error);
    const auto version = Mat_GetVersion(mat.get());
    message_.head = JsonObject{{"format", version == MAT_FT_MAT73  ? "MAT 7.3"
                                          : version == MAT_FT_MAT4 ? "MAT 4"
                                                                   : "MAT 5"},
                               {"notes", std::move(notes_)},
                               {"variables", std::move(variables)}};
    return std::move(message_);
  }

  // @param places  a start and a count for each dimension
  Message read_part(const char* file, const char* name, const std::vector<int>& places) {
    const auto mat = opened(file);
    const std::unique_ptr<matvar_t, void (*)(matvar_t*)> variable(Mat_VarReadInfo(mat.get(), name),
                                                                  Mat_VarFree);
    require(variable != nullptr, std::string("there is no variable ") + name);
    const auto rank = static_cast<std::size_t>(variable->rank);
    const Put store = putter(variable->class_type);
    require(store != nullptr && variable->isComplex == 0 && places.size() == 2 * rank,
            std::string("the variable ") + name + " has no such part");
    std::vector<int> start(rank), count(rank), stride(rank, 1);
    double numbers = 1.0;
    for (std::size_t d = 0; d < rank; ++d) {
      start[d] = places[2 * d];
      count[d] = places[2 * d + 1];
      numbers *= count[d];
      const auto end = static_cast<std::size_t>(start[d]) + static_cast<std::size_t>(count[d]);
      require(start[d] >= 0 && count[d] > 0 && end <= variable->dims[d],
              std::string("the variable ") + name + " has no such part");
    }
    require(8.0 * numbers <= static_cast<double>(limit_), "a part that is larger than the limit");
    const auto size = static_cast<std::size_t>(numbers);
    std::vector<double> room(size);  // no class of numbers is wider
    if (Mat_VarReadData(mat.get(), variable.get(), room.data(), start.data(), stride.data(),
                        count.data()) != 0 ||
        !first_error.empty()) {
      throw chladni::InvalidInput(std::string("the variable ") + name + " is damaged" +
                                  (first_error.empty() ? "" : ": " + first_error));
    }
    message_.head = JsonObject{{"real", (this->*store)(room.data(), size)}};
    return std::move(message_);
  }

 private:
  using File = std::unique_ptr<mat_t, int (*)(mat_t*)>;

  static File opened(const char* file) {
    File mat(Mat_Open(file, MAT_ACC_RDONLY), Mat_Close);
    require(mat != nullptr,
            "it does not begin as a .mat file" + (first_error.empty() ? "" : ": " + first_error));
    require_whole(file);
    return mat;
  }

  static bool is_left(const matvar_t& variable, double large_bytes) {
    if (putter(variable.class_type) == nullptr || variable.isComplex != 0) return false;
    double bytes = 8.0;
    for (int d = 0; d < variable.rank; ++d) bytes *= static_cast<double>(variable.dims[d]);
    return bytes > large_bytes;
  }

  Json value(const matvar_t& variable, int depth) {
    require(depth < kDeepest, "cells and structures more than 16 deep");
    JsonObject result{{"class", class_name(variable)}, {"dims", dims(variable)}};
    const auto count = element_count(variable, limit_ / 8);
    switch (variable.class_type) {
      case MAT_C_CHAR:
        add_text(variable, count, result);
        break;
      case MAT_C_CELL:
        add_cells(variable, count, depth, result);
        break;
      case MAT_C_STRUCT:
        add_fields(variable, count, depth, result);
        break;
      default:
        add_numbers(variable, count, result);
    }
    return result;
  }

  static Json dims(const matvar_t& variable) {
    JsonArray sizes;
    for (int d = 0; d < variable.rank; ++d)
      sizes.emplace_back(static_cast<long long>(variable.dims[d]));
    while (sizes.size() < 2) sizes.emplace_back(sizes.empty() ? 0LL : 1LL);
    return sizes;
  }

  // Counts a cell or field and refuses too many of them.
  void count_element() {
    require(++elements_ <= kMostElements, "more than 100 000 cells and fields");
  }

  void add_cells(const matvar_t& variable, std::size_t count, int depth, JsonObject& result) {
    JsonArray cells;
    auto* const* data = static_cast<matvar_t* const*>(variable.data);
    for (std::size_t c = 0; c < count && data != nullptr; ++c) {
      count_element();
      cells.push_back(data[c] != nullptr ? value(*data[c], depth + 1) : nothing());
    }
    result.emplace_back("kind", "cell");
    result.emplace_back("cells", std::move(cells));
  }

  static Json nothing() {
    return JsonObject{{"class", "double"},
                      {"dims", JsonArray{0, 0}},
                      {"kind", "number"},
                      {"real", ""},
                      {"imag", ""}};
  }

  // The fields of the structure at `index` of an array of them.
  JsonArray fields(const matvar_t& variable, std::size_t index, int depth) {
    const unsigned names = Mat_VarGetNumberOfFields(const_cast<matvar_t*>(&variable));
    char* const* name = Mat_VarGetStructFieldnames(&variable);
    auto* const* data = static_cast<matvar_t* const*>(variable.data);
    JsonArray found;
    for (unsigned f = 0; f < names && data != nullptr; ++f) {
      count_element();
      const auto* field = data[index * names + f];
      found.emplace_back(JsonObject{
          {"name", name[f]}, {"value", field != nullptr ? value(*field, depth + 1) : nothing()}});
    }
    return found;
  }

  void add_fields(const matvar_t& variable, std::size_t count, int depth, JsonObject& result) {
    if (Mat_VarGetStructFieldnames(&variable) == nullptr) {
      result.emplace_back("kind", "other");
      return;
    }
    if (count == 1) {
      result.emplace_back("kind", "structure");
      result.emplace_back("fields", fields(variable, 0, depth));
      return;
    }
    const auto elements = elements_, bytes = bytes_, arrays = message_.doubles.size();
    try {
      auto each = structures(variable, count, depth);
      result.emplace_back("kind", "structures");
      result.emplace_back("cells", std::move(each));
    } catch (const chladni::InvalidInput&) {  // more than is read of it: it may matter to nobody
      elements_ = elements;
      bytes_ = bytes;
      while (message_.doubles.size() > arrays) message_.doubles.erase(last_array());
      result.emplace_back("kind", "other");
    }
  }

  JsonArray structures(const matvar_t& variable, std::size_t count, int depth) {
    JsonArray each;
    for (std::size_t c = 0; c < count; ++c) {
      count_element();
      each.emplace_back(JsonObject{{"class", "struct"},
                                   {"dims", JsonArray{1, 1}},
                                   {"kind", "structure"},
                                   {"fields", fields(variable, c, depth)}});
    }
    return each;
  }

  [[nodiscard]] std::string last_array() const {
    return "a" + std::to_string(message_.doubles.size() - 1);
  }

  template <typename Number>
  std::string put(const void* data, std::size_t count) {
    bytes_ += 8 * count;
    require(bytes_ <= limit_, "more than " + std::to_string(limit_ >> 20U) + " MB of numbers");
    const std::string name = "a" + std::to_string(message_.doubles.size());
    auto& array = message_.doubles[name];
    array.resize(static_cast<Eigen::Index>(count), 1);
    const auto* from = static_cast<const Number*>(data);
    for (std::size_t k = 0; k < count; ++k) {
      array(static_cast<Eigen::Index>(k)) = static_cast<double>(from[k]);
    }
    return name;
  }

  using Put = std::string (Reader::*)(const void*, std::size_t);

  static Put putter(matio_classes of) {
    switch (of) {
      case MAT_C_DOUBLE:
        return &Reader::put<double>;
      case MAT_C_SINGLE:
        return &Reader::put<float>;
      case MAT_C_INT8:
        return &Reader::put<std::int8_t>;
      case MAT_C_UINT8:
        return &Reader::put<std::uint8_t>;
      case MAT_C_INT16:
        return &Reader::put<std::int16_t>;
      case MAT_C_UINT16:
        return &Reader::put<std::uint16_t>;
      case MAT_C_INT32:
        return &Reader::put<std::int32_t>;
      case MAT_C_UINT32:
        return &Reader::put<std::uint32_t>;
      case MAT_C_INT64:
        return &Reader::put<std::int64_t>;
      case MAT_C_UINT64:
        return &Reader::put<std::uint64_t>;
      default:
        return nullptr;
    }
  }

  void add_numbers(const matvar_t& variable, std::size_t count, JsonObject& result) {
    const Put store = putter(variable.class_type);
    if (store == nullptr && variable.class_type != MAT_C_EMPTY) {
      result.emplace_back("kind", "other");
      return;
    }
    const std::size_t needed = count * static_cast<std::size_t>(std::max(variable.data_size, 0));
    const bool is_there = store != nullptr && count > 0 && variable.data != nullptr;
    require(!is_there || variable.nbytes >= needed, "an array of " + std::to_string(count) +
                                                        " elements has " +
                                                        std::to_string(variable.nbytes) + " bytes");
    require(is_there || count == 0,
            "an array of " + std::to_string(count) + " elements has no data");
    std::string real, imag;
    if (is_there && variable.isComplex != 0) {
      const auto* parts = static_cast<const mat_complex_split_t*>(variable.data);
      require(parts->Re != nullptr && parts->Im != nullptr, "complex numbers without a part");
      real = (this->*store)(parts->Re, count);
      imag = (this->*store)(parts->Im, count);
    } else if (is_there) {
      real = (this->*store)(variable.data, count);
    }
    result.emplace_back("kind", "number");
    result.emplace_back("real", real);
    result.emplace_back("imag", imag);
  }

  // The letter at `index` of a char array, as UTF-8.
  static void append_letter(const matvar_t& variable, std::size_t index, std::string& text) {
    const auto* bytes = static_cast<const unsigned char*>(variable.data);
    if (variable.data_size <= 1) {
      if (index < variable.nbytes) text += static_cast<char>(bytes[index]);
      return;
    }
    if (2 * index + 1 >= variable.nbytes || variable.data_size != 2) return;
    const unsigned code = static_cast<const std::uint16_t*>(variable.data)[index];
    if (code < 0x80) {
      text += static_cast<char>(code);
    } else if (code < 0x800) {
      text += static_cast<char>(0xC0U | (code >> 6U));
      text += static_cast<char>(0x80U | (code & 0x3FU));
    } else {
      text += static_cast<char>(0xE0U | (code >> 12U));
      text += static_cast<char>(0x80U | ((code >> 6U) & 0x3FU));
      text += static_cast<char>(0x80U | (code & 0x3FU));
    }
  }

  void add_text(const matvar_t& variable, std::size_t count, JsonObject& result) {
    const std::size_t rows = variable.rank == 2 ? variable.dims[0] : 0;
    require(rows <= kMostElements, "a text of more than 100 000 rows");
    JsonArray lines;
    const bool is_utf8 = variable.data_type == MAT_T_UTF8 && rows == 1;
    for (std::size_t r = 0; r < rows && variable.data != nullptr; ++r) {
      std::string line;
      if (is_utf8) {  // its letters may have more bytes than it has columns
        line.assign(static_cast<const char*>(variable.data), variable.nbytes);
      } else {
        for (std::size_t c = r; c < count; c += rows) append_letter(variable, c, line);
      }
      line.erase(std::find(line.begin(), line.end(), '\0'), line.end());
      lines.emplace_back(line);
    }
    result.emplace_back("kind", "text");
    result.emplace_back("rows", std::move(lines));
  }

  std::size_t limit_, bytes_ = 0, elements_ = 0;
  Message message_;
  JsonArray notes_;
};

}  // namespace

int main(int argc, char** argv) {
  try {
    const bool is_part = argc > 4 && argc % 2 == 1 && std::string_view(argv[3]) == "part";
    require(argc == 3 || argc == 4 || is_part,
            "usage: chladni-mat FILE.mat LIMIT_BYTES [LARGE_BYTES | part NAME START COUNT...]");
    Mat_LogInitFunc("chladni-mat", keep_error);
    Reader reader(std::stoull(argv[2]));
    std::vector<int> places;
    for (int a = 5; a < argc; ++a) places.push_back(place_of(argv[a]));
    const double large = argc == 4 ? static_cast<double>(std::stoull(argv[3]))
                                   : std::numeric_limits<double>::infinity();
    const std::string found = chladni::io::bytes(
        is_part ? reader.read_part(argv[1], argv[4], places) : reader.read(argv[1], large));
    std::cout.write(found.data(), static_cast<std::streamsize>(found.size()));
    return std::cout.flush() ? 0 : 1;
  } catch (const std::bad_alloc&) {
    std::cerr << "a count in it asks for more memory than it may need\n";
  } catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
  }
  return 1;
}
